# SPDX-License-Identifier: GPL-3.0-or-later
import os
import shutil
import subprocess

import hosts
import mlx
import ply
import pytest
import shapes

PYMESHLABS = sorted(
    folder.name for folder in (hosts.BUILD / "plugins").glob("pymeshlab-*") if folder.is_dir()
) or ["pymeshlab"]


def start_display(size):
    """Starts an X server of our own on a free display. Returns the process and the display's name."""
    if shutil.which("Xvfb") is None:
        raise hosts.Missing("Xvfb is not installed")
    reader, writer = os.pipe()
    process = subprocess.Popen(
        ["Xvfb", "-displayfd", str(writer), "-screen", "0", f"{size}x24", "-nolisten", "tcp"],
        pass_fds=[writer], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
    )
    os.close(writer)
    with os.fdopen(reader) as pipe:
        number = pipe.readline().strip()
    if not number:
        process.wait()
        raise hosts.Missing("Xvfb does not start")
    return process, f":{number}"


@pytest.fixture(scope="session")
def display():
    try:
        process, name = start_display("1400x1000")
    except hosts.Missing as reason:
        pytest.skip(str(reason))
    yield name
    process.terminate()
    process.wait()


@pytest.fixture(scope="session")
def server(display, tmp_path_factory):
    try:
        return hosts.MeshLabServer(tmp_path_factory.mktemp("meshlab-2020.09"), display)
    except hosts.Missing as reason:
        pytest.skip(str(reason))


@pytest.fixture(scope="session", params=PYMESHLABS)
def pymeshlab(request):
    try:
        return hosts.PyMeshLab(request.param)
    except hosts.Missing as reason:
        pytest.skip(str(reason))


@pytest.fixture(scope="session", params=["meshlab-2020.09", *PYMESHLABS])
def host(request):
    """Every host that applies scripts, one after the other."""
    try:
        if request.param == "meshlab-2020.09":
            return request.getfixturevalue("server")
        return hosts.PyMeshLab(request.param)
    except hosts.Missing as reason:
        pytest.skip(str(reason))


@pytest.fixture(scope="session")
def command():
    try:
        return hosts.Command()
    except hosts.Missing as reason:
        pytest.skip(str(reason))


@pytest.fixture(scope="session")
def clean_and_noisy(tmp_path_factory):
    """A cube and the same with noise, as files in single precision."""
    folder = tmp_path_factory.mktemp("meshes")
    positions, faces = shapes.cube()
    noisy = shapes.with_noise(positions, 0.2 * 2 / 12)
    return (
        ply.write(folder / "clean.ply", positions, faces),
        ply.write(folder / "noisy.ply", noisy, faces),
    )


@pytest.fixture
def script(tmp_path):
    """Writes a filter script into this test's folder."""
    return lambda *steps: mlx.write(tmp_path / "script.mlx", *steps)
