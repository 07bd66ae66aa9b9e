# SPDX-License-Identifier: GPL-3.0-or-later
"""The plugin in MeshLab's own window: listed in the menus, dialog opened, previewed, applied, faces
coloured. The pictures stay in build/screenshots."""

import subprocess
from dataclasses import dataclass
from typing import Callable

import gui
import hosts
import ply
import pytest
import shapes
from conftest import start_display


@dataclass
class Layout:
    """Where things are in one version's window, in pixels."""

    version: str
    start: Callable
    # Layer list, from the right and the top: the eye of the first layer, the name of the second.
    eye: tuple
    second_layer: tuple
    # Denoising dialog, from the left and the bottom.
    compare: tuple
    preview: tuple
    apply: tuple


LAYOUTS = {
    layout.version: layout
    for layout in (
        Layout("2020.09", gui.start_2020, (382, 133), (324, 164), (26, 442), (26, 84), (390, 23)),
        Layout("2022.02", gui.start_suite, (362, 130), (300, 161), (191, 227), (17, 79), (354, 22)),
        Layout("2025.07", gui.start_suite, (398, 130), (346, 161), (190, 315), (15, 169), (310, 22)),
    )
}

# Entries of the menu Filters, counted from the first that can be chosen, and those of its submenus. One
# more above them is in use as soon as a filter has been applied.
SMOOTHING, QUALITY, AFTER_THE_FIRST = 7, 8, 1
DENOISE_ENTRY, ERROR_ENTRY = 11, 0


@pytest.fixture(scope="module")
def big_display():
    try:
        gui.need("openbox", "xdotool", "import", "convert")
        process, name = start_display(f"{gui.WIDTH}x{gui.HEIGHT}")
    except hosts.Missing as reason:
        pytest.skip(str(reason))
    manager = subprocess.Popen(
        ["openbox", "--sm-disable"], env={"DISPLAY": name, "HOME": "/nonexistent", "PATH": "/usr/bin:/bin"},
        stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
    )
    yield name
    manager.terminate()
    manager.wait()
    process.terminate()
    process.wait()


@pytest.fixture(params=list(LAYOUTS))
def window(request, big_display, tmp_path):
    layout = LAYOUTS[request.param]
    positions, faces = shapes.cube(24)
    meshes = [
        ply.write(tmp_path / "clean.ply", positions, faces),
        ply.write(tmp_path / "noisy.ply", shapes.with_noise(positions, 0.25 * 2 / 24), faces),
    ]
    try:
        process = layout.start(layout.version, tmp_path, big_display, meshes)
    except hosts.Missing as reason:
        pytest.skip(str(reason))
    window = gui.Window(layout.version, process, tmp_path, big_display)
    try:
        window.wait_for_window(f"MeshLab {layout.version} - ")
        window.wait_for_log("Opened mesh", times=2)
        # The reference lies in the mesh: hide it, and return to the noisy layer.
        window.click(gui.WIDTH - layout.eye[0], layout.eye[1])
        window.click(gui.WIDTH - layout.second_layer[0], layout.second_layer[1])
        yield window
    finally:
        window.close()


def in_dialog(window, dialog, place):
    left, top, _, height = window.geometry(dialog)
    window.click(left + place[0], top + height - place[1])


def saturated(picture):
    """Share of the 3D view that has a colour of the ramp: one channel full, another none."""
    view = picture[150:900, 40:1000]
    return ((view.max(axis=2) > 200) & (view.min(axis=2) < 40)).mean()


def pure_blue(picture):
    view = picture[150:900, 40:1000]
    return ((view[..., 2] > 200) & (view[..., 0] < 40) & (view[..., 1] < 100)).mean()


def picture_that(window, name, condition, what):
    """A picture that fulfils condition(picture): the window draws when it gets round to it."""
    return window.wait(
        lambda: [picture for picture in [window.screenshot(name)] if condition(picture)],
        f"waited for {what}", seconds=30)[0]


def test_error_is_drawn_and_denoising_previewed_and_applied(window):
    layout = LAYOUTS[window.version]
    picture_that(
        window, "1-noisy", lambda picture: saturated(picture) < 0.01, "the reference to be hidden")

    window.open_menu(QUALITY, ERROR_ENTRY)
    window.screenshot("2-menu-quality")
    window.key("Return")
    dialog = window.wait_for_window("Angular Error from Reference Mesh$")
    window.screenshot("3-dialog-error")
    in_dialog(window, dialog, layout.apply)
    window.wait_for_log("Applied filter Angular Error from Reference Mesh" if window.version == "2020.09"
                        else "Applied filter")
    coloured = picture_that(
        window, "4-error-of-the-noisy-mesh", lambda picture: saturated(picture) > 0.05,
        "the colours of the error")
    assert "faces measured, paired by number" in window.log()

    window.open_menu(SMOOTHING + AFTER_THE_FIRST, DENOISE_ENTRY)
    window.screenshot("5-menu-smoothing")
    window.key("Return")
    dialog = window.wait_for_window("Orthogonal Polynomial Denoising$")
    in_dialog(window, dialog, layout.compare)
    window.screenshot("6-dialog-denoising")

    in_dialog(window, dialog, layout.preview)
    window.wait_for_log("after: mean angle")
    bluer = lambda picture: pure_blue(picture) > pure_blue(coloured) + 0.05  # noqa: E731
    picture_that(window, "7-preview", bluer, "the preview")

    in_dialog(window, dialog, layout.preview)
    picture_that(
        window, "8-preview-off",
        lambda picture: abs(pure_blue(picture) - pure_blue(coloured)) < 0.03, "the preview to go")

    in_dialog(window, dialog, layout.apply)
    picture_that(window, "9-applied", bluer, "the denoised mesh")
    assert window.process.poll() is None


def test_message_for_a_selection_of_nothing(window):
    """An error is a box with our words; MeshLab goes on."""
    layout = LAYOUTS[window.version]
    window.open_menu(SMOOTHING, DENOISE_ENTRY)
    window.key("Return")
    dialog = window.wait_for_window("Orthogonal Polynomial Denoising$")
    # "Affect only selected faces" is the row above the comparison.
    row = 29 if window.version == "2020.09" else 21
    in_dialog(window, dialog, (layout.compare[0], layout.compare[1] + row))
    in_dialog(window, dialog, layout.apply)
    window.wait_for_window("Filter Failure")
    window.screenshot("message")
    assert "none of the 6912 faces is selected" in window.log()
    window.key("Return")
    assert window.process.poll() is None
