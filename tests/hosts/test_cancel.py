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
plugin, name, calls = sys.argv[3:]
sys.exit(host.apply_and_cancel(plugin.encode(), name.encode(), int(calls)))
"""
NEVER = 1000000
# From the refused report to the return, on a mesh of 20480 faces: DESIGN asks for 200.
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

    def call(name, calls):
        done = subprocess.run(
            [sys.executable, "-c", CALL, common, LIBRARY, plugin, name, str(calls)],
            env={**os.environ, "QT_QPA_PLATFORM": "offscreen"}, capture_output=True, text=True,
            timeout=hosts.TIMEOUT,
        )
        assert done.returncode == 0, done.stdout + done.stderr
        lines = [line.split(" ", 1) for line in done.stdout.splitlines() if " " in line]
        facts = {word: value for word, value in lines if word != "parameter"}
        facts["parameters"] = [value.split() for word, value in lines if word == "parameter"]
        return facts

    return call


@pytest.mark.parametrize("name", [mlx.DENOISE, mlx.ERROR])
@pytest.mark.parametrize("share", [0, 0.3, 0.6])
def test_cancel_leaves_the_mesh_alone(apply, name, share):
    whole = apply(name, NEVER)
    assert whole["applied"] == "1" and whole["changed"] == "1"
    calls = int(whole["calls"])
    assert calls >= 2
    # How many reports there are depends on the time the work takes, so not too near the end.
    allowed = int(share * calls)
    stopped = apply(name, allowed)
    assert stopped["applied"] == "0" and stopped["changed"] == "0", stopped
    assert "stopped on request" in stopped["message"]
    assert float(stopped["milliseconds"]) < MILLISECONDS
    # It is not asked again and again.
    assert int(stopped["calls"]) <= allowed + 1


@pytest.mark.parametrize("entry", mlx.TABLE["filters"], ids=lambda entry: entry["python_name"])
def test_names_types_and_defaults(apply, entry):
    found = apply(entry["name"], NEVER)["parameters"]
    assert [name for name, _, _ in found] == [p["name"] for p in entry["parameters"]]
    for (_, kind, value), frozen in zip(found, entry["parameters"]):
        assert kind == frozen["type"]
        default = frozen["default"]
        if kind == "RichEnum":
            default = frozen["choices"].index(default)
        assert float(value) == pytest.approx(float(default)), frozen
