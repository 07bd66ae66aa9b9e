# SPDX-License-Identifier: GPL-3.0-or-later
"""The programs that the plugin and the core run in, each behind the same few methods."""

import json
import os
import pathlib
import re
import shutil
import subprocess

import numpy as np
import ply

ROOT = pathlib.Path(__file__).resolve().parents[2]
BUILD = pathlib.Path(os.environ.get("ORTHOPOLY_BUILD_DIR", ROOT / "build")).resolve()
CACHE = pathlib.Path(
    os.environ.get("ORTHOPOLY_CACHE")
    or pathlib.Path(os.environ.get("XDG_CACHE_HOME") or "~/.cache").expanduser() / "filter_orthopoly"
)
DRIVER = pathlib.Path(__file__).with_name("pymeshlab_driver.py")
COMMAND = BUILD / "bin" / "orthopoly"
TIMEOUT = 300


class Missing(Exception):
    """A host that is not here, and why."""


class Outcome:
    """What a host made of a script: whether it succeeded, what it said, the layer it ended with."""

    def __init__(self, ok, log, mesh=None, outputs=None):
        self.ok, self.log, self.mesh, self.outputs = ok, log, mesh, outputs or {}


def plugin_for(host):
    plugin = BUILD / "plugins" / host / "libfilter_orthopoly.so"
    if not plugin.is_file():
        raise Missing(f"{host}: {plugin} was not built")
    return plugin


def private_tree(folder):
    """A copy of the installed MeshLab 2020.09 with our plugin among its own: it finds its plugins
    from the place of its binary. Returns the folder with the two programs."""
    plugin = plugin_for("meshlab-2020.09")
    server = shutil.which("meshlabserver")
    if server is None:
        raise Missing("meshlab-2020.09: meshlabserver is not installed")
    libraries = next(pathlib.Path("/usr/lib").glob("*/meshlab/libmeshlab-common.so"), None)
    if libraries is None:
        raise Missing("meshlab-2020.09: libmeshlab-common.so is not in /usr/lib/*/meshlab")
    libraries = libraries.parent
    target = folder / "lib" / libraries.parent.name / "meshlab"
    (target / "plugins").mkdir(parents=True)
    (folder / "bin").mkdir()
    for program in ("meshlab", "meshlabserver"):
        shutil.copy2(pathlib.Path(server).with_name(program), folder / "bin" / program)
    (target / "libmeshlab-common.so").symlink_to(libraries / "libmeshlab-common.so")
    for library in (libraries / "plugins").glob("*.so"):
        if library.name != plugin.name:
            (target / "plugins" / library.name).symlink_to(library)
    (target / "plugins" / plugin.name).symlink_to(plugin)
    return folder / "bin"


class MeshLabServer:
    """meshlabserver 2020.09, which needs a display and knows its layers by their place."""

    name = "meshlab-2020.09"

    def __init__(self, folder, display):
        self.binaries = private_tree(folder)
        self.display = display

    def call(self, *arguments):
        environment = {**os.environ, "DISPLAY": self.display, "QT_QPA_PLATFORM": "xcb", "LC_ALL": "C.UTF-8"}
        return subprocess.run(
            [self.binaries / "meshlabserver", *map(str, arguments)],
            env=environment, capture_output=True, text=True, errors="replace", timeout=TIMEOUT,
        )

    def run_script(self, folder, script, meshes):
        """Applies a script to the meshes; the last one is the current layer."""
        output = folder / f"{self.name}.ply"
        output.unlink(missing_ok=True)
        inputs = [word for mesh in meshes for word in ("-i", mesh)]
        done = self.call(*inputs, "-o", output, "-m", "fc", "fq", "vq", "-s", script)
        log = done.stdout + done.stderr
        # 255 is how it reports a failed script; anything else that is not 0 is a crash.
        assert done.returncode in (0, 255), f"meshlabserver ended with {done.returncode}:\n{log}"
        told = re.findall(r"output values:(.*)", log)
        words = [word.split("=") for word in told[-1].split()] if told else []
        outputs = {name: float(value) for name, value in words}
        ok = done.returncode == 0 and output.is_file()
        return Outcome(ok, log, ply.read(output) if ok else None, outputs)


class PyMeshLab:
    """One version of pymeshlab, in the Python it was installed for."""

    def __init__(self, host):
        self.name = host
        self.plugin = plugin_for(host)
        self.python = BUILD / f"venv-{host}" / "bin" / "python"
        if not self.python.is_file():
            raise Missing(f"{host}: there is no {self.python}")

    def run_steps(self, folder, steps):
        """Does the steps of pymeshlab_driver.py. Returns what came of each, and all that was said."""
        results = folder / f"{self.name}.json"
        results.unlink(missing_ok=True)
        done = subprocess.run(
            [self.python, DRIVER, results],
            input=json.dumps({"plugin": str(self.plugin), "steps": steps}, default=str),
            env={**os.environ, "LC_ALL": "C.UTF-8", "PYTHONUNBUFFERED": "1"},
            capture_output=True, text=True, errors="replace", timeout=TIMEOUT,
        )
        log = done.stdout + done.stderr
        assert done.returncode == 0, f"{self.name} ended with {done.returncode}:\n{log}"
        return json.loads(results.read_text()), log

    def run_script(self, folder, script, meshes):
        saved = folder / f"{self.name}.npz"
        results, log = self.run_steps(
            folder,
            [{"do": "load", "path": mesh} for mesh in meshes]
            + [{"do": "script", "path": script}, {"do": "save", "path": saved}],
        )
        applied = results[len(meshes)]
        return Outcome(applied["ok"], log + applied.get("error", ""), load(saved), applied.get("outputs"))


def load(path):
    """The layer that a pymeshlab saved."""
    data = np.load(path)
    mesh = ply.Mesh(data["positions"], data["faces"])
    if "face_colors" in data:
        mesh.face_colors = np.rint(data["face_colors"][:, :3] * 255).astype("u1")
    mesh.face_quality = data["face_quality"] if "face_quality" in data else None
    mesh.vertex_quality = data["vertex_quality"] if "vertex_quality" in data else None
    return mesh


class Command:
    """`orthopoly`, the small command beside the plugin."""

    name = "orthopoly"

    def __init__(self):
        if not COMMAND.is_file():
            raise Missing(f"orthopoly: {COMMAND} was not built")

    def denoise(self, folder, mesh, **options):
        output = folder / "orthopoly.ply"
        words = [word for item in options.items() for word in ("--set", "{}={}".format(*item))]
        done = subprocess.run(
            [COMMAND, "denoise", mesh, output, *words],
            capture_output=True, text=True, timeout=TIMEOUT,
        )
        ok = done.returncode == 0
        return Outcome(ok, done.stdout + done.stderr, ply.read(output) if ok else None)
