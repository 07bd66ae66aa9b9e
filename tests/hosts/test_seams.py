# SPDX-License-Identifier: GPL-3.0-or-later
"""Vertices that are there once for every chart, or for every triangle, stay together in every host."""

import mlx
import numpy as np
import ply
import pytest


def in_charts(mesh, charts):
    """The mesh with vertices of its own for each of the charts #F."""
    corners = mesh.faces.reshape(-1) + len(mesh.positions) * np.repeat(charts, 3)
    vertices, faces = np.unique(corners, return_inverse=True)
    return mesh.positions[vertices % len(mesh.positions)], faces.reshape(-1, 3)


@pytest.mark.parametrize("name", [mlx.DENOISE, mlx.NOISE])
@pytest.mark.parametrize("charts", ["halves", "triangles"])
def test_seams_stay_closed(host, tmp_path, script, clean_and_noisy, name, charts):
    whole = ply.read(clean_and_noisy[1])
    numbers = np.arange(len(whole.faces))
    positions, faces = in_charts(whole, numbers // 900 if charts == "halves" else numbers)
    split = ply.write(tmp_path / "split.ply", positions, faces)
    assert len(positions) > len(whole.positions)
    outcome = host.run_script(tmp_path, script((name, {})), [split])
    assert outcome.ok, outcome.log
    result = outcome.mesh
    assert len(result.positions) == len(positions) and np.array_equal(result.faces, faces)
    assert (result.positions != positions).any(axis=1).mean() > 0.9
    together = np.zeros((len(whole.positions), 3), result.positions.dtype)
    together[whole.faces] = result.positions[faces]
    assert np.array_equal(together[whole.faces], result.positions[faces])
    if name == mlx.DENOISE:
        repeated = len(positions) - len(whole.positions)
        assert f"{repeated} vertices along seams" in outcome.log
        # The surface is that of the mesh in one piece.
        alone = host.run_script(tmp_path, script((name, {})), [clean_and_noisy[1]]).mesh
        assert np.abs(alone.positions - together).max() < 1e-5 * whole.diagonal
