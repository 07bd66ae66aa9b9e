# SPDX-License-Identifier: GPL-3.0-or-later
"""What is particular to Python: keyword arguments, enum names, percentages, the dictionary of output
values, layers in any order."""

import math

import mlx
import numpy as np
import ply
import pytest
import shapes

DENOISE = "apply_coord_orthogonal_polynomial_denoising"
ERROR = "compute_scalar_by_angular_error_per_face"
NOISE = "apply_coord_gaussian_noise"

# Names that scripts may rely on, and their types.
DENOISE_OUTPUTS = {
    "nothing_to_do": bool, "iterations_done": int, "degenerate_faces": int,
    "non_manifold_edges": int, "seam_vertices": int, "folded_faces_before": int, "folded_faces_after": int,
    "moved_vertices": int, "mean_displacement": float, "max_displacement": float,
}
ERROR_OUTPUTS = {
    "mean_angle": float, "max_angle": float, "msae": float,
    "msae_without_folded": float, "vertex_error": float,
    "relative_vertex_error": float, "max_distance": float, "folded_faces": int,
    "folded_in_reference": int, "measured_faces": int,
}
KINDS_OF_NOISE = next(
    p["choices"] for p in mlx.TABLE["filters"][0]["parameters"] if p["name"] == "noise_type")


def load(*paths):
    return [{"do": "load", "path": path} for path in paths]


def apply(name, **arguments):
    return {"do": "filter", "name": name, "arguments": arguments}


def outputs_of(pymeshlab, folder, steps):
    results, log = pymeshlab.run_steps(folder, steps)
    for step, result in zip(steps, results):
        assert result["ok"], (step, result, log)
    return [result["outputs"] for step, result in zip(steps, results) if step["do"] == "filter"]


def check_types(outputs, expected):
    for name, kind in expected.items():
        assert type(outputs[name]) is kind, (name, outputs[name])
    assert all(math.isfinite(value) for value in outputs.values())


def test_denoising_returns_what_it_did(pymeshlab, tmp_path, clean_and_noisy):
    (outputs,) = outputs_of(pymeshlab, tmp_path, load(clean_and_noisy[1]) + [apply(DENOISE)])
    check_types(
        outputs,
        {**DENOISE_OUTPUTS, "estimated_noise": float, "estimated_noise_low": float,
         "estimated_noise_high": float, "spikes": int, "resolved_noise_level": float,
         "resolved_noise_type": int})
    assert outputs["resolved_noise_type"] == KINDS_OF_NOISE.index("white")
    assert 0.05 < outputs["estimated_noise"] < 0.3
    assert 0 < outputs["moved_vertices"] <= 866
    assert 0 < outputs["mean_displacement"] < outputs["max_displacement"] < 1
    assert "mean_angle" not in outputs
    assert outputs["resolved_iterations"] == outputs["iterations_done"] > 0


def test_comparison_returns_the_measures_before_and_after(pymeshlab, tmp_path, clean_and_noisy):
    before, outputs, after = outputs_of(
        pymeshlab, tmp_path,
        load(*clean_and_noisy)
        + [
            apply(ERROR, reference=0),
            apply(DENOISE, method="paper", compare_with_reference=True, reference=0),
            apply(ERROR, reference=0),
        ],
    )
    check_types(before, {**ERROR_OUTPUTS, "paired_by_index": bool})
    check_types(outputs, {**DENOISE_OUTPUTS, **ERROR_OUTPUTS})
    assert before["paired_by_index"] is True
    for name in ERROR_OUTPUTS:
        assert outputs["noisy_" + name] == pytest.approx(before[name])
        assert outputs[name] == pytest.approx(after[name], rel=1e-6)
    assert outputs["mean_angle"] < 0.5 * outputs["noisy_mean_angle"]


def test_choices_go_by_name_or_number(pymeshlab, tmp_path, clean_and_noisy):
    by_name, by_number, other = outputs_of(
        pymeshlab, tmp_path,
        load(clean_and_noisy[0])
        + [apply(NOISE, direction="isotropic")]
        + load(clean_and_noisy[0])
        + [apply(NOISE, direction=2)]
        + load(clean_and_noisy[0])
        + [apply(NOISE, direction="random")],
    )
    assert by_name == by_number != other


def test_unknown_choice_is_refused_with_the_names_there_are(pymeshlab, tmp_path, clean_and_noisy):
    steps = load(clean_and_noisy[0]) + [apply(DENOISE, method="bilateral")]
    results, _ = pymeshlab.run_steps(tmp_path, steps)
    assert not results[1]["ok"]
    assert "adaptive" in results[1]["error"] and "paper" in results[1]["error"]


def test_unknown_parameter_is_refused(pymeshlab, tmp_path, clean_and_noisy):
    steps = load(clean_and_noisy[0]) + [apply(DENOISE, sigma=3)]
    results, _ = pymeshlab.run_steps(tmp_path, steps)
    assert not results[1]["ok"] and "sigma" in results[1]["error"]


def test_percentage_is_of_the_bounding_box_diagonal(pymeshlab, tmp_path, clean_and_noisy):
    positions, faces = shapes.cube()
    half = faces[(positions[faces][:, :, 0] <= 0).all(axis=1)]
    partial = ply.write(tmp_path / "partial.ply", positions, half)
    diagonal = 2 * math.sqrt(3)
    everything, percentage, absolute = outputs_of(
        pymeshlab, tmp_path,
        load(partial, clean_and_noisy[0])
        + [
            apply(ERROR, reference=0),
            apply(ERROR, reference=0, max_distance={"percentage": 5}),
            apply(ERROR, reference=0, max_distance={"absolute": 0.05 * diagonal}),
        ],
    )
    assert everything["measured_faces"] == 1728
    assert percentage["measured_faces"] == absolute["measured_faces"] < 1728


def test_layers_in_any_order(pymeshlab, tmp_path, clean_and_noisy):
    clean, noisy = clean_and_noisy
    first, second = outputs_of(
        pymeshlab, tmp_path,
        load(clean, noisy)
        + [apply(ERROR, reference=0)]
        + load(clean)
        + [{"do": "current", "id": 1}, apply(ERROR, reference=2)],
    )
    assert first == second
    # The current layer first, the reference after it.
    (third,) = outputs_of(
        pymeshlab, tmp_path,
        load(noisy, clean) + [{"do": "current", "id": 0}, apply(ERROR, reference=1)],
    )
    assert third == first


def test_default_reference_is_the_first_other_layer(pymeshlab, tmp_path, clean_and_noisy):
    clean, noisy = clean_and_noisy
    given, default = outputs_of(
        pymeshlab, tmp_path,
        load(noisy, clean)
        + [{"do": "current", "id": 0}, apply(ERROR, reference=1), apply(ERROR)],
    )
    assert given == default


def test_no_reference_is_needed_and_none_is_touched(pymeshlab, tmp_path, clean_and_noisy):
    clean, noisy = clean_and_noisy
    saved = tmp_path / "after.npz"
    outputs_of(
        pymeshlab, tmp_path,
        load(clean, noisy)
        + [
            apply(DENOISE, method="paper", compare_with_reference=True, reference=0),
            {"do": "current", "id": 0},
            {"do": "save", "path": saved},
        ],
    )
    after = np.load(saved)
    assert np.array_equal(after["positions"], ply.read(clean).positions)
    assert "face_quality" not in after and "face_colors" not in after


def test_normals_follow_the_new_positions(pymeshlab, tmp_path, clean_and_noisy):
    saved = tmp_path / "after.npz"
    steps = load(clean_and_noisy[1]) + [apply(DENOISE, method="paper"), {"do": "save", "path": saved}]
    outputs_of(pymeshlab, tmp_path, steps)
    after = np.load(saved)
    # Inside a side of the cube the normal of a vertex is that of the faces around it.
    weights = np.zeros_like(after["positions"])
    face_normals = shapes.normals(after["positions"], after["faces"])
    for corner in range(3):
        np.add.at(weights, after["faces"][:, corner], face_normals)
    weights /= np.linalg.norm(weights, axis=1, keepdims=True)
    assert (weights * after["vertex_normals"]).sum(axis=1).min() > 0.97


def test_a_clean_mesh_is_told_so(pymeshlab, tmp_path, clean_and_noisy):
    results, log = pymeshlab.run_steps(
        tmp_path, load(clean_and_noisy[0]) + [apply(DENOISE), {"do": "save", "path": tmp_path / "a.npz"}]
    )
    assert results[1]["ok"] and results[1]["outputs"]["nothing_to_do"] is True
    assert results[1]["outputs"]["moved_vertices"] == 0
    assert "no noise worth removing" in log
    after = np.load(tmp_path / "a.npz")["positions"]
    assert np.array_equal(after, ply.read(clean_and_noisy[0]).positions)


def test_a_surface_reconstructed_from_noisy_points_is_denoised(pymeshlab, tmp_path):
    """From points to a mesh with MeshLab's filters: the noise that is left ripples over several edges."""
    random = np.random.default_rng(7)
    directions = random.standard_normal((8000, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    apart = math.sqrt(4 * math.pi / len(directions))
    points = directions * (1 + 0.5 * apart * random.standard_normal((len(directions), 1)))
    with open(tmp_path / "points.ply", "w") as file:
        properties = "".join(f"property float {name}\n" for name in ("x", "y", "z", "nx", "ny", "nz"))
        file.write(f"ply\nformat ascii 1.0\nelement vertex {len(points)}\n{properties}end_header\n")
        np.savetxt(file, np.hstack([points, directions]), "%.6f")
    _, outputs = outputs_of(
        pymeshlab, tmp_path,
        load(tmp_path / "points.ply")
        + [
            apply("generate_surface_reconstruction_screened_poisson", depth=6),
            {"do": "save", "path": tmp_path / "before.npz"},
            apply(DENOISE),
            {"do": "save", "path": tmp_path / "after.npz"},
        ],
    )
    assert KINDS_OF_NOISE[outputs["resolved_noise_type"]] == "scanner"
    before, after = (np.load(tmp_path / f"{name}.npz") for name in ("before", "after"))
    assert np.array_equal(before["faces"], after["faces"])

    def angles(mesh):
        normals = shapes.normals(mesh["positions"], mesh["faces"])
        out = mesh["positions"][mesh["faces"]].mean(axis=1)
        out /= np.linalg.norm(out, axis=1, keepdims=True)
        return np.degrees(np.arccos(np.clip((normals * out).sum(axis=1), -1, 1)))

    assert angles(after).mean() < 0.4 * angles(before).mean()


def test_what_is_said_of_a_level_that_leaves_nothing(pymeshlab, tmp_path, clean_and_noisy):
    """Who has set noise_level is not told to set it."""
    results, log = pymeshlab.run_steps(
        tmp_path, load(clean_and_noisy[1]) + [apply(DENOISE, noise_level=0)])
    outputs = results[1]["outputs"]
    assert outputs["nothing_to_do"] is True and outputs["moved_vertices"] == 0
    assert "noise_level is 0" in log and "set noise_level" not in log


def test_choices_of_the_method_are_told_and_can_be_given(pymeshlab, tmp_path, clean_and_noisy):
    steps = load(clean_and_noisy[1]) + [apply(DENOISE)]
    results, log = pymeshlab.run_steps(tmp_path, steps)
    outputs = results[1]["outputs"]
    kind = KINDS_OF_NOISE[outputs["resolved_noise_type"]]
    assert f"chosen: noise_type = {kind}, noise_level = " in log
    given = {"noise_type": outputs["resolved_noise_type"]}
    assert outputs_of(
        pymeshlab, tmp_path, load(clean_and_noisy[1]) + [apply(DENOISE, **given)]) == [outputs]
    # What is given is not said to be chosen, and the paper's method chooses no such thing.
    for arguments in (given, {"method": "paper"}):
        steps = load(clean_and_noisy[1]) + [apply(DENOISE, **arguments)]
        assert "noise_type = " not in pymeshlab.run_steps(tmp_path, steps)[1]


def test_progress_has_words_and_never_falls(pymeshlab, tmp_path, clean_and_noisy):
    _, log = pymeshlab.run_steps(tmp_path, load(clean_and_noisy[1]) + [apply(DENOISE, method="paper")])
    start = log.index(DENOISE) if DENOISE in log else 0
    percents = [
        int(line.rsplit("[", 1)[1].split("%")[0])
        for line in log[start:].splitlines()
        if "iteration" in line and line.rstrip().endswith("]")
    ]
    assert len(percents) >= 3 and percents == sorted(percents)


@pytest.mark.parametrize("filter_name", [entry["name"] for entry in mlx.TABLE["filters"]])
def test_a_document_without_layers_is_refused(pymeshlab, tmp_path, filter_name):
    python_name = next(e["python_name"] for e in mlx.TABLE["filters"] if e["name"] == filter_name)
    results, _ = pymeshlab.run_steps(tmp_path, [apply(python_name)])
    assert not results[0]["ok"] and "mesh" in results[0]["error"]


# A value other than the default for every parameter, and what has to be set beside it to matter.
CHANGES = {
    DENOISE: [
        ("method", "paper", {}),
        ("strength", "strong", {}),
        ("noise_type", "scanner", {}),
        ("noise_level", 0.5, {}),
        ("iterations", 7, {"method": "paper"}),
        ("keep_boundary", True, {"method": "paper"}),
        ("only_selected", True, {"method": "paper"}),
        ("compare_with_reference", True, {}),
        ("reference", 1, {"compare_with_reference": True}),
        ("max_angle", 90, {"compare_with_reference": True}),
        ("vertex_iterations", 25, {"method": "paper"}),
        ("structure_ring", 5, {"method": "paper"}),
        ("cos_threshold", 0.9, {"method": "paper"}),
        ("cos_threshold_increment", 0.2, {"method": "paper"}),
        ("guide_ring", 3, {"method": "paper"}),
        ("sigma_theta", 10, {"method": "paper"}),
        ("order_x", 4, {"method": "paper"}),
        ("order_y", 3, {"method": "paper"}),
    ],
    ERROR: [("reference", 1, {}), ("max_angle", 90, {}), ("max_distance", {"absolute": 0.01}, {})],
    NOISE: [
        ("sigma", 0.1, {}),
        ("direction", "normal", {}),
        ("impulsive_share", 0.5, {}),
        ("seed", 2, {}),
        ("only_selected", True, {}),
    ],
}
# The one that must not.
WITHOUT_EFFECT = {"threads"}


@pytest.fixture
def half_open(tmp_path):
    """Two references and a noisy mesh with an open boundary, its first faces selected by the caller."""
    positions, faces = shapes.cube()
    faces = faces[: len(faces) * 5 // 6]
    return [
        ply.write(tmp_path / "clean.ply", positions, faces),
        ply.write(tmp_path / "other.ply", shapes.with_noise(positions, 0.01, seed=8), faces),
        ply.write(tmp_path / "noisy.ply", shapes.with_noise(positions, 0.03), faces),
    ]


@pytest.mark.parametrize("entry", mlx.TABLE["filters"], ids=lambda entry: entry["python_name"])
def test_every_parameter_changes_the_result(pymeshlab, tmp_path, script, half_open, entry):
    name = entry["python_name"]
    changes = CHANGES[name]
    assert {p["name"] for p in entry["parameters"]} == {c[0] for c in changes} | (
        WITHOUT_EFFECT & {p["name"] for p in entry["parameters"]}
    )
    select = script((mlx.SELECT, {"condSelect": "(fi < 700)"}))
    steps, pairs = [], []

    def run(arguments):
        path = tmp_path / f"{len(pairs)}-{len(steps)}.npz"
        # The layers are loaded anew each time, so ids count on.
        first = 3 * sum(step["do"] == "save" for step in steps)
        given = {"only_selected": False, **arguments} if name != ERROR else dict(arguments)
        if any(p["name"] == "reference" for p in entry["parameters"]):
            given["reference"] = first + given.get("reference", 0)
        steps.extend(load(*half_open) + [{"do": "script", "path": select}, apply(name, **given)])
        steps.append({"do": "save", "path": path})
        return path

    for parameter, value, beside in changes:
        pairs.append((parameter, run(beside), run({**beside, parameter: value})))
    outputs_of(pymeshlab, tmp_path, steps)
    unchanged = [name for name, *paths in pairs if same(*map(np.load, paths))]
    assert not unchanged


def same(a, b):
    return a.files == b.files and all(np.array_equal(a[name], b[name]) for name in a.files)


def test_threads_do_not_change_the_result(pymeshlab, tmp_path, clean_and_noisy):
    saved = [tmp_path / f"{threads}.npz" for threads in (1, 2, 4)]
    steps = []
    for threads, path in zip((1, 2, 4), saved):
        steps += load(clean_and_noisy[1])
        steps += [apply(DENOISE, threads=threads), {"do": "save", "path": path}]
    outputs_of(pymeshlab, tmp_path, steps)
    one, two, four = (np.load(path) for path in saved)
    assert same(one, two) and same(one, four)
