# SPDX-License-Identifier: GPL-3.0-or-later
"""The same .mlx in every host: meshlabserver 2020.09 and both pymeshlabs."""

import mlx
import numpy as np
import ply
import pytest
import shapes


def angles_to(mesh, clean):
    """Degrees between the face normals of two meshes with the same faces."""
    reference = ply.read(clean)
    a = shapes.normals(mesh.positions, mesh.faces)
    b = shapes.normals(reference.positions, reference.faces)
    return np.degrees(np.arctan2(np.linalg.norm(np.cross(a, b), axis=1), (a * b).sum(axis=1)))


@pytest.mark.parametrize("method", ["adaptive", "paper"])
def test_denoising_removes_noise(host, tmp_path, script, clean_and_noisy, method):
    clean, noisy = clean_and_noisy
    outcome = host.run_script(tmp_path, script((mlx.DENOISE, {"method": method})), [noisy])
    assert outcome.ok, outcome.log
    before = angles_to(ply.read(noisy), clean).mean()
    after = angles_to(outcome.mesh, clean).mean()
    assert after < 0.5 * before
    assert (outcome.mesh.faces == ply.read(noisy).faces).all()
    assert "iteration" in outcome.log and "vertices moved" in outcome.log
    if method == "adaptive":
        assert "mean edge lengths (estimated)" in outcome.log


def test_comparison_colours_faces_and_tells_before_and_after(
    host, tmp_path, script, clean_and_noisy
):
    clean, noisy = clean_and_noisy
    values = {"method": "paper", "compare_with_reference": True, "reference": 0, "max_angle": 20}
    outcome = host.run_script(tmp_path, script((mlx.DENOISE, values)), [clean, noisy])
    assert outcome.ok, outcome.log
    expected = angles_to(outcome.mesh, clean)
    assert outcome.mesh.face_quality == pytest.approx(expected, abs=1e-2)
    # Blue where the angle is small, red from max_angle on.
    red, blue = outcome.mesh.face_colors[:, 0], outcome.mesh.face_colors[:, 2]
    assert (blue[expected < 1] > 200).all() and (red[expected < 1] == 0).all()
    assert (red[expected > 20.1] == 255).all() and (blue[expected > 20.1] == 0).all()
    assert outcome.mesh.vertex_quality.min() >= 0
    assert "before: mean angle" in outcome.log and "after: mean angle" in outcome.log
    assert "paired by number" in outcome.log


def test_error_filter_measures_what_the_files_say(host, tmp_path, script, clean_and_noisy):
    clean, noisy = clean_and_noisy
    outcome = host.run_script(tmp_path, script((mlx.ERROR, {"reference": 0})), [clean, noisy])
    assert outcome.ok, outcome.log
    before = ply.read(noisy)
    assert np.array_equal(outcome.mesh.positions.astype("f4"), before.positions)
    expected = angles_to(before, clean)
    assert outcome.mesh.face_quality == pytest.approx(expected, abs=1e-3)
    assert outcome.mesh.face_colors is not None
    assert f"mean angle {expected.mean():.4g} degrees" in outcome.log


def test_error_filter_without_common_faces_uses_the_closest_point(
    host, tmp_path, script, clean_and_noisy
):
    positions, faces = shapes.cube(cells=6)
    coarse = ply.write(tmp_path / "coarse.ply", positions, faces)
    outcome = host.run_script(
        tmp_path, script((mlx.ERROR, {"reference": 0})), [coarse, clean_and_noisy[0]]
    )
    assert outcome.ok, outcome.log
    assert "closest point" in outcome.log
    assert outcome.mesh.vertex_quality == pytest.approx(0, abs=1e-5)
    assert np.median(outcome.mesh.face_quality) == pytest.approx(0, abs=1e-3)


def test_far_faces_are_not_measured(host, tmp_path, script, clean_and_noisy):
    positions, faces = shapes.cube()
    half = faces[(positions[faces][:, :, 0] <= 0).all(axis=1)]
    partial = ply.write(tmp_path / "partial.ply", positions, half)
    outcome = host.run_script(
        tmp_path,
        script((mlx.ERROR, {"reference": 0, "max_distance": 0.25})),
        [partial, clean_and_noisy[0]],
    )
    assert outcome.ok, outcome.log
    unmeasured = outcome.mesh.face_quality < 0
    assert 0.2 < unmeasured.mean() < 0.6
    assert (outcome.mesh.face_quality[unmeasured] == -1).all()
    assert (outcome.mesh.face_colors[unmeasured] == 160).all()


def test_noise_has_the_size_asked_for(host, tmp_path, script, clean_and_noisy):
    step = (mlx.NOISE, {"sigma": 0.3, "direction": "normal", "seed": 11})
    outcome = host.run_script(tmp_path, script(step), [clean_and_noisy[0]])
    assert outcome.ok, outcome.log
    clean = ply.read(clean_and_noisy[0])
    moved = np.linalg.norm(outcome.mesh.positions - clean.positions, axis=1)
    edge = 2 / 12 * (2 + np.sqrt(2)) / 3
    assert np.sqrt((moved**2).mean()) == pytest.approx(0.3 * edge, rel=0.05)


def test_a_script_of_several_filters_runs_in_one_go(host, tmp_path, script, clean_and_noisy):
    steps = [
        (mlx.NOISE, {"sigma": 0.2, "seed": 4}),
        (mlx.DENOISE, {"method": "paper", "iterations": 2}),
        (mlx.ERROR, {"reference": 0}),
    ]
    outcome = host.run_script(tmp_path, script(*steps), [clean_and_noisy[0]] * 2)
    assert outcome.ok, outcome.log
    assert 0 < outcome.mesh.face_quality.mean() < 15
