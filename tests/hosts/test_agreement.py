# SPDX-License-Identifier: GPL-3.0-or-later
"""The same script on the same mesh gives the same result in every host, and in `orthopoly`."""

import hosts
import mlx
import numpy as np
import ply
import pytest
import shapes

# Of the bounding box diagonal. The hosts keep coordinates in single or double precision.
TOLERANCE = 1e-5

CASES = {
    "adaptive": (mlx.DENOISE, {}),
    "adaptive-scanner": (mlx.DENOISE, {"noise_type": "scanner", "strength": "gentle"}),
    "paper": (mlx.DENOISE, {"method": "paper"}),
    # Numbers that single precision rounds.
    "paper-with-values": (
        mlx.DENOISE,
        {
            "method": "paper", "iterations": 4, "vertex_iterations": 7, "structure_ring": 2,
            "cos_threshold": 0.65, "cos_threshold_increment": 0.07, "sigma_theta": 33.3,
            "order_x": 1, "order_y": 1,
        },
    ),
    "noise": (mlx.NOISE, {"sigma": 0.15, "direction": "isotropic", "impulsive_share": 0.7, "seed": 5}),
}


@pytest.fixture(scope="module")
def available(request, tmp_path_factory):
    """All hosts that are here, and the reasons why others are not."""
    found, missing = [], []
    try:
        display = request.getfixturevalue("display")
        found.append(hosts.MeshLabServer(tmp_path_factory.mktemp("agreement"), display))
    except (hosts.Missing, pytest.skip.Exception) as reason:
        missing.append(str(reason))
    for folder in sorted((hosts.BUILD / "plugins").glob("pymeshlab-*")):
        try:
            found.append(hosts.PyMeshLab(folder.name))
        except hosts.Missing as reason:
            missing.append(str(reason))
    try:
        found.append(hosts.Command())
    except hosts.Missing as reason:
        missing.append(str(reason))
    return found, missing


@pytest.mark.parametrize("case", CASES)
@pytest.mark.parametrize("far_away", [False, True], ids=["at-origin", "far-away"])
def test_hosts_agree(available, tmp_path, script, case, far_away):
    found, missing = available
    name, values = CASES[case]
    positions, faces = shapes.cube()
    positions = shapes.with_noise(positions, 0.03)
    if far_away:
        positions = 25 * positions + [1000, -2000, 500]
    mesh = ply.write(tmp_path / "mesh.ply", positions, faces)
    path = script((name, values))

    results = {}
    for host in found:
        if host.name == "orthopoly":
            if name != mlx.DENOISE:
                continue
            outcome = host.denoise(tmp_path, mesh, **values)
        else:
            outcome = host.run_script(tmp_path, path, [mesh])
        assert outcome.ok, (host.name, outcome.log)
        results[host.name] = outcome.mesh.positions.astype(float)
    if len(results) < 2:
        pytest.skip(f"nothing to compare {list(results)} with: {'; '.join(missing)}")

    first, *others = results
    assert not np.array_equal(results[first], ply.read(mesh).positions)
    diagonal = ply.read(mesh).diagonal
    for other in others:
        difference = np.abs(results[first] - results[other]).max() / diagonal
        assert difference <= TOLERANCE, f"{first} and {other} differ by {difference:.2g} of the diagonal"
    if missing:
        pytest.skip(f"{', '.join(results)} agree; not here: {'; '.join(missing)}")
