# SPDX-License-Identifier: GPL-3.0-or-later
"""A host that answers false to a progress report. None of today's does, so this is one of our own for
the interface of MeshLab 2020.09; it also tells the names and defaults of parameters, which
meshlabserver keeps to itself."""

import os
import subprocess
import sys

import hosts
import mlx
import pytest

LIBRARY = hosts.BUILD / "tests" / "hosts" / "libcancel_host.so"
CALL = """
import ctypes, sys
ctypes.CDLL(sys.argv[1], ctypes.RTLD_GLOBAL)
host = ctypes.CDLL(sys.argv[2])
plugin, name, percent, on = sys.argv[3:]
sys.exit(host.apply_and_cancel(plugin.encode(), name.encode(), int(percent), on.encode()))
"""
NEVER = 1000
# From the refused report to the return, on a mesh of 20480 faces. The core looks twenty times a second.
MILLISECONDS = 200


@pytest.fixture(scope="module")
def apply(tmp_path_factory):
    try:
        plugin = hosts.plugin_for("meshlab-2020.09")
        tree = hosts.private_tree(tmp_path_factory.mktemp("cancel")).parent
        if not LIBRARY.is_file():
            raise hosts.Missing(f"meshlab-2020.09: {LIBRARY} was not built")
    except hosts.Missing as reason:
        pytest.skip(str(reason))
    common = next(tree.glob("lib/*/meshlab/libmeshlab-common.so"))

    def call(name, percent, on=""):
        done = subprocess.run(
            [sys.executable, "-c", CALL, common, LIBRARY, plugin, name, str(percent), on],
            env={**os.environ, "QT_QPA_PLATFORM": "offscreen"}, capture_output=True, text=True,
            timeout=hosts.TIMEOUT,
        )
        assert done.returncode == 0, done.stdout + done.stderr
        lines = [line.split(" ", 1) for line in done.stdout.splitlines() if " " in line]
        facts = {word: value for word, value in lines if word != "parameter"}
        facts["parameters"] = [value.split() for word, value in lines if word == "parameter"]
        return facts

    return call


@pytest.mark.parametrize("name, on", [
    (mlx.DENOISE, ""), (mlx.DENOISE, "compare_with_reference"), (mlx.ERROR, "")])
# How many reports there are depends on the time the work takes, but each of its steps makes one as it
# begins. With a comparison, the first and the last of these are within the measuring.
@pytest.mark.parametrize("percent", [0, 3, 40, 80, 90])
def test_cancel_leaves_the_mesh_alone(apply, name, on, percent):
    stopped = apply(name, percent, on)
    assert stopped["applied"] == "0" and stopped["changed"] == "0", stopped
    assert "stopped on request" in stopped["message"]
    assert float(stopped["milliseconds"]) < MILLISECONDS
    # It is not asked again and again.
    assert stopped["calls_after"] == "0"


@pytest.mark.parametrize("name, on", [
    (mlx.DENOISE, ""), (mlx.DENOISE, "compare_with_reference"), (mlx.ERROR, "")])
def test_without_a_cancel_the_same_is_changed(apply, name, on):
    whole = apply(name, NEVER, on)
    assert whole["applied"] == "1" and whole["changed"] == "1"
    assert int(whole["calls"]) >= 4


@pytest.mark.parametrize("entry", mlx.TABLE["filters"], ids=lambda entry: entry["python_name"])
def test_names_types_and_defaults(apply, entry):
    facts = apply(entry["name"], NEVER)
    assert facts["menu"] == entry["menu"]
    found = facts["parameters"]
    assert [name for name, _, _ in found] == [p["name"] for p in entry["parameters"]]
    for (_, kind, value), frozen in zip(found, entry["parameters"]):
        assert kind == frozen["type"]
        default = frozen["default"]
        if kind == "RichEnum":
            default = frozen["choices"].index(default)
        assert float(value) == pytest.approx(float(default)), frozen
