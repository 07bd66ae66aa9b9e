# SPDX-License-Identifier: GPL-3.0-or-later
"""What is not selected stays bit for bit, in every host."""

import mlx
import numpy as np
import ply
import pytest


def strictly_selected(faces, selected, count):
    """Vertices whose faces are all selected, as MeshLab's own smoothing filters have it."""
    inside, outside = np.zeros(count, bool), np.zeros(count, bool)
    inside[faces[selected]] = True
    outside[faces[~selected]] = True
    return inside & ~outside


def bits(positions):
    return np.ascontiguousarray(positions.astype("<f4")).view("<u4")


@pytest.mark.parametrize(
    "name, values",
    [
        (mlx.DENOISE, {"method": "adaptive"}),
        (mlx.DENOISE, {"method": "paper"}),
        (mlx.NOISE, {}),
    ],
)
def test_only_the_selection_moves(host, tmp_path, script, clean_and_noisy, name, values):
    before = ply.read(clean_and_noisy[1])
    selected = np.arange(len(before.faces)) < 800
    free = strictly_selected(before.faces, selected, len(before.positions))
    outcome = host.run_script(
        tmp_path,
        script((mlx.SELECT, {"condSelect": "(fi < 800)"}), (name, {**values, "only_selected": True})),
        [clean_and_noisy[1]],
    )
    assert outcome.ok, outcome.log
    assert "restricted to 800 of 1728 faces" in outcome.log
    same = (bits(outcome.mesh.positions) == bits(before.positions)).all(axis=1)
    assert same[~free].all()
    assert (~same[free]).mean() > 0.9


def test_selection_counts_by_default(pymeshlab, tmp_path, script, clean_and_noisy):
    steps = [
        {"do": "load", "path": clean_and_noisy[1]},
        {"do": "script", "path": script((mlx.SELECT, {"condSelect": "(fi < 800)"}))},
        {
            "do": "filter", "name": "apply_coord_orthogonal_polynomial_denoising",
            "arguments": {"method": "paper"},
        },
        {
            "do": "filter", "name": "apply_coord_gaussian_noise",
            "arguments": {"only_selected": False},
        },
    ]
    results, log = pymeshlab.run_steps(tmp_path, steps)
    assert all(result["ok"] for result in results), results
    assert log.count("restricted to 800 of 1728 faces") == 1
    assert results[2]["outputs"]["moved_vertices"] < 866
    assert results[3]["outputs"]["moved_vertices"] == 866


def test_kept_boundary(host, tmp_path, script):
    steps = np.linspace(0, 1, 12)
    x, y = np.meshgrid(steps, steps)
    z = 0.03 * np.sin(40 * x * y + 7 * x)
    corner = (np.arange(11)[:, None] * 12 + np.arange(11)).ravel()
    faces = np.concatenate(
        [np.stack([corner, corner + 1, corner + 13], 1), np.stack([corner, corner + 13, corner + 12], 1)]
    )
    path = ply.write(tmp_path / "sheet.ply", np.stack([x.ravel(), y.ravel(), z.ravel()], 1), faces)
    before = ply.read(path)
    edge = (x.ravel() % 1 == 0) | (y.ravel() % 1 == 0)
    outcome = host.run_script(
        tmp_path, script((mlx.DENOISE, {"method": "paper", "keep_boundary": True})), [path]
    )
    assert outcome.ok, outcome.log
    same = (bits(outcome.mesh.positions) == bits(before.positions)).all(axis=1)
    assert same[edge].all() and not same[~edge].all()
