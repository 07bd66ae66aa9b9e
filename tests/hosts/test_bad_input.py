# SPDX-License-Identifier: GPL-3.0-or-later
"""What a filter cannot work on, in every host: a message that names the problem and the cure, the
host alive, the mesh as it was."""

import json

import mlx
import numpy as np
import ply
import pytest
import shapes

NAN = float("nan")

# Parameters, and what the message has to name: the problem with its figure, and the cure.
REFUSED_VALUES = [
    (mlx.DENOISE, {"iterations": 0}, ["iterations is 0", "from 1 to 50"]),
    (mlx.DENOISE, {"iterations": -7}, ["iterations is -7", "-1 for automatic"]),
    (mlx.DENOISE, {"structure_ring": 11}, ["structure_ring is 11", "from 1 to 10"]),
    (mlx.DENOISE, {"noise_level": 2.5}, ["noise_level is 2.5", "from 0 to 2"]),
    (mlx.DENOISE, {"noise_level": NAN}, ["noise_level is nan", "from 0 to 2"]),
    (mlx.DENOISE, {"cos_threshold": float("inf")}, ["cos_threshold is inf"]),
    (mlx.DENOISE, {"threads": -1}, ["threads is -1", "from 0 to 256"]),
    (
        mlx.DENOISE,
        {"method": "paper", "guide_ring": 4, "structure_ring": 2},
        ["guide_ring is 4", "structure_ring is 2", "raise structure_ring"],
    ),
    (mlx.DENOISE, {"only_selected": True}, ["none of the 1728 faces", "turn only_selected off"]),
    (
        mlx.DENOISE,
        {"compare_with_reference": True, "reference": 1},
        ["the current layer", "choose another layer"],
    ),
    (
        mlx.DENOISE,
        {"compare_with_reference": True, "reference": 0, "max_angle": 0},
        ["max_angle is 0", "from 0.1 to 180"],
    ),
    (mlx.ERROR, {"reference": 1}, ["the current layer", "choose another layer"]),
    (mlx.ERROR, {"max_angle": NAN}, ["max_angle is nan", "from 0.1 to 180"]),
    (mlx.ERROR, {"max_distance": -1}, ["max_distance is -1"]),
    (mlx.ERROR, {"max_distance": 1e-9}, ["none of the 1728 faces", "raise max_distance"]),
    (mlx.NOISE, {"sigma": -0.5}, ["sigma is -0.5", "from 0 to 10"]),
    (mlx.NOISE, {"sigma": NAN}, ["sigma is nan"]),
    (mlx.NOISE, {"impulsive_share": 1.5}, ["impulsive_share is 1.5", "from 0 to 1"]),
    (mlx.NOISE, {"only_selected": True}, ["none of the 1728 faces", "turn only_selected off"]),
]


def check_refused(host, folder, script, meshes, wanted):
    before = [mesh.read_bytes() for mesh in meshes]
    outcome = host.run_script(folder, script, meshes)
    assert not outcome.ok
    for words in wanted:
        assert words in outcome.log, outcome.log
    assert [mesh.read_bytes() for mesh in meshes] == before
    # meshlabserver saves nothing after a failed script; a pymeshlab still has its document.
    if outcome.mesh is not None:
        assert np.array_equal(
            outcome.mesh.positions, read_positions(meshes[-1]), equal_nan=True
        )
        assert outcome.mesh.face_quality is None or (outcome.mesh.face_quality == 0).all()


def read_positions(path):
    return ply.read(path).positions


@pytest.mark.parametrize(
    "name, values, wanted",
    REFUSED_VALUES,
    ids=[f"{name.split()[0]}-{'-'.join(values)}-{i}" for i, (name, values, _) in enumerate(REFUSED_VALUES)],
)
def test_value_is_refused(host, tmp_path, script, clean_and_noisy, name, values, wanted):
    check_refused(host, tmp_path, script((name, values)), list(clean_and_noisy), wanted)



@pytest.mark.parametrize("name", [mlx.DENOISE, mlx.ERROR, mlx.NOISE])
def test_points_only(host, tmp_path, script, clean_and_noisy, name):
    points = ply.write(tmp_path / "points.ply", np.eye(3)[[0, 1, 2, 0, 1]], [])
    check_refused(
        host, tmp_path, script((name, {})), [clean_and_noisy[0], points],
        ["5 vertices and no faces", "reconstruct"],
    )


@pytest.mark.parametrize("name", [mlx.DENOISE, mlx.ERROR, mlx.NOISE])
def test_polygons(host, tmp_path, script, clean_and_noisy, name):
    corners = [[0, 0, 0], [1, 0, 0], [2, 0, 0], [0, 1, 0], [1, 1, 0], [2, 1, 0], [3, 0.5, 0]]
    quads = ply.write(tmp_path / "quads.ply", corners, [[0, 1, 4, 3], [1, 2, 5, 4], [2, 6, 5]])
    outcome = host.run_script(tmp_path, script((name, {})), [clean_and_noisy[0], quads])
    assert not outcome.ok
    assert "2 polygons" in outcome.log and f"'{mlx.TRIANGULATE}'" in outcome.log
    if outcome.mesh is not None:
        assert np.array_equal(outcome.mesh.positions, np.array(corners))
    # The cure is a filter of this host under the name that the message has for it.
    cured = host.run_script(
        tmp_path, script((mlx.TRIANGULATE, {}), (name, {})), [clean_and_noisy[0], quads])
    assert cured.ok, cured.log
    assert len(cured.mesh.faces) == 5


def test_polygons_from_arrays(pymeshlab, tmp_path):
    corners = [[0, 0, 0], [1, 0, 0], [2, 0, 0], [0, 1, 0], [1, 1, 0], [2, 1, 0], [3, 0.5, 0]]
    for name, faces in (("triangles", [[0, 1, 4], [0, 4, 3]]), ("quads", [[0, 1, 4, 3], [1, 2, 5, 4]])):
        (tmp_path / f"{name}.json").write_text(json.dumps({"positions": corners, "faces": faces}))
    steps = [
        {"do": "add_polygons", "path": tmp_path / "triangles.json"},
        {"do": "filter", "name": "apply_coord_gaussian_noise"},
        {"do": "add_polygons", "path": tmp_path / "quads.json"},
    ]
    check_polygons(pymeshlab, tmp_path, steps, "2 polygons", corners)


def test_polygons_of_a_subdivision(pymeshlab, tmp_path):
    """In 2025.07 such layers do not carry the mark that polygons else have."""
    positions, faces = shapes.cube(2)
    np.savez(tmp_path / "cube.npz", positions=positions, faces=faces)
    steps = [
        {"do": "add", "path": tmp_path / "cube.npz"},
        {"do": "filter", "name": "meshing_surface_subdivision_loop"},
        {"do": "filter", "name": "apply_coord_gaussian_noise"},
        {"do": "add", "path": tmp_path / "cube.npz"},
        {"do": "filter", "name": "meshing_surface_subdivision_catmull_clark"},
        {"do": "save", "path": tmp_path / "before.npz"},
    ]
    check_polygons(pymeshlab, tmp_path, steps, "polygons")


def check_polygons(pymeshlab, folder, steps, words, positions=None):
    """All filters refuse what the steps have made, leave it alone and take it once it is cured."""
    refused = [{"do": "filter", "name": entry["python_name"]} for entry in mlx.TABLE["filters"]]
    cured = [
        {"do": "save", "path": folder / "after.npz"},
        {"do": "filter", "name": "meshing_poly_to_tri"},
        {"do": "filter", "name": "apply_coord_gaussian_noise"},
    ]
    results, log = pymeshlab.run_steps(folder, [*steps, *refused, *cured])
    first, last = len(steps), len(steps) + len(refused)
    assert all(result["ok"] for result in results[:first] + results[last:]), log
    for result in results[first:last]:
        assert not result["ok"] and words in result["error"], log
    before = np.load(folder / "before.npz")["positions"] if positions is None else positions
    assert np.array_equal(np.load(folder / "after.npz")["positions"], before)


def test_reference_without_faces(host, tmp_path, script, clean_and_noisy):
    points = ply.write(tmp_path / "points.ply", np.eye(3), [])
    for name, values in (
        (mlx.ERROR, {"reference": 0}),
        (mlx.DENOISE, {"reference": 0, "compare_with_reference": True}),
    ):
        check_refused(
            host, tmp_path, script((name, values)), [points, clean_and_noisy[1]],
            ["the reference", "3 vertices and no faces"],
        )


def test_mesh_without_area(host, tmp_path, script):
    line = ply.write(tmp_path / "line.ply", [[0, 0, 0], [1, 0, 0], [2, 0, 0]], [[0, 1, 2]])
    check_refused(
        host, tmp_path, script((mlx.DENOISE, {})), [line], ["none of the 1 faces has an area"]
    )


@pytest.mark.parametrize(
    "name, arguments",
    [
        ("apply_coord_orthogonal_polynomial_denoising", {}),
        ("apply_coord_gaussian_noise", {}),
        ("compute_scalar_by_angular_error_per_face", {"reference": 0}),
    ],
)
def test_coordinate_that_is_no_number(pymeshlab, tmp_path, name, arguments):
    """The hosts' importers drop such vertices, so it has to come from elsewhere."""
    positions, faces = shapes.cube(4)
    np.savez(tmp_path / "clean.npz", positions=positions, faces=faces)
    positions[17, 1] = np.nan
    np.savez(tmp_path / "broken.npz", positions=positions, faces=faces)
    steps = [
        {"do": "add", "path": tmp_path / "clean.npz"},
        {"do": "add", "path": tmp_path / "broken.npz"},
        {"do": "filter", "name": name, "arguments": arguments},
        {"do": "save", "path": tmp_path / "after.npz"},
    ]
    results, log = pymeshlab.run_steps(tmp_path, steps)
    assert results[1]["ok"] and not results[2]["ok"], log
    assert "vertex 17" in results[2]["error"] and "not a finite number" in results[2]["error"]
    after = np.load(tmp_path / "after.npz")["positions"]
    assert np.array_equal(after, positions, equal_nan=True)


def test_layer_that_is_not_there(pymeshlab, tmp_path, clean_and_noisy):
    steps = [
        {"do": "load", "path": clean_and_noisy[0]},
        {
            "do": "filter", "name": "compute_scalar_by_angular_error_per_face",
            "arguments": {"reference": 5},
        },
    ]
    results, _ = pymeshlab.run_steps(tmp_path, steps)
    assert not results[1]["ok"]
    assert "layer that is not there" in results[1]["error"] and "0 'clean.ply'" in results[1]["error"]


def test_selection_too_small_to_move_anything(host, tmp_path, script, clean_and_noisy):
    steps = [(mlx.SELECT, {"condSelect": "(fi == 3)"}), (mlx.DENOISE, {"only_selected": True})]
    outcome = host.run_script(tmp_path, script(*steps), [clean_and_noisy[1]])
    assert not outcome.ok
    assert "no vertex has all its faces among the 1 selected of 1728" in outcome.log
