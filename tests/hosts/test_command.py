# SPDX-License-Identifier: GPL-3.0-or-later
"""`orthopoly` as a person or a script uses it: exit codes, one line on errors, what it prints and writes."""

import json
import os
import pty
import re
import select
import signal
import subprocess

import hosts
import numpy as np
import ply
import pytest

GENERATE = hosts.BUILD / "bin" / "generate_meshes"


def run(*arguments, **options):
    return subprocess.run(
        [str(hosts.COMMAND), *map(str, arguments)],
        capture_output=True, text=True, timeout=hosts.TIMEOUT, **options,
    )


@pytest.fixture(scope="module")
def meshes(tmp_path_factory):
    if not hosts.COMMAND.is_file() or not GENERATE.is_file():
        pytest.skip(f"{hosts.COMMAND} or {GENERATE} was not built")
    folder = tmp_path_factory.mktemp("meshes")
    names = ["height_field", "points_only", "empty", "nan_coordinate", "degenerate_face"]
    subprocess.run([GENERATE, "--out", folder, *names], check=True)
    subprocess.run([GENERATE, "--out", folder, "--size", "4000", "part"], check=True)
    subprocess.run([GENERATE, "--out", folder / "large", "--size", "400000", "part"], check=True)
    for file in ("part.ply", "large/part.ply"):
        noisy = folder / file.replace("part", "noisy")
        assert run("noise", folder / file, noisy, "--sigma", 0.2).returncode == 0
    return folder


def in_terminal(arguments, until=None):
    """Runs the command with a terminal for its error stream, and sends Ctrl-C once `until` is seen
    there. Returns the exit code and both streams."""
    ours, theirs = pty.openpty()
    process = subprocess.Popen(
        [str(hosts.COMMAND), *map(str, arguments)], stdout=subprocess.PIPE, stderr=theirs)
    os.close(theirs)
    seen = b""
    while select.select([ours], [], [], hosts.TIMEOUT)[0]:
        try:
            piece = os.read(ours, 4096)
        except OSError:
            break
        if not piece:
            break
        seen += piece
        if until and until in seen:
            process.send_signal(signal.SIGINT)
            until = None
    os.close(ours)
    out = process.communicate(timeout=hosts.TIMEOUT)[0]
    assert until is None, f"{until} was never seen in {seen}"
    return process.returncode, out, seen


def test_denoise_reports_what_it_did(meshes, tmp_path):
    output = tmp_path / "out.ply"
    done = run(
        "denoise", meshes / "noisy.ply", output, "--method", "paper", "--set", "iterations=2",
        "--set", "cos_threshold=0.7", "--threads", 2, "--reference", meshes / "part.ply", "--json",
    )
    assert done.returncode == 0 and done.stderr == ""
    report = json.loads(done.stdout)
    assert report["status"] == "done"
    assert report["parameters"]["method"] == "paper"
    assert report["parameters"]["iterations"] == 2 == report["iterations_done"]
    assert report["parameters"]["cos_threshold"] == 0.7
    assert "auto" not in (report["parameters"][name] for name in ("structure_ring", "vertex_iterations"))
    assert report["seconds"] > 0
    # The paper's method makes no estimate.
    assert "estimated_noise" not in report
    assert report["result"]["mean_angle"] < report["noisy"]["mean_angle"]
    noisy, result = ply.read(meshes / "noisy.ply"), ply.read(output)
    assert np.array_equal(noisy.faces, result.faces)
    assert report["moved_vertices"] == (noisy.positions != result.positions).any(axis=1).sum()
    again = json.loads(run("measure", meshes / "part.ply", output, "--json").stdout)
    assert again == report["result"]


def test_the_adaptive_method_reports_its_estimate(meshes, tmp_path):
    done = run("denoise", meshes / "noisy.ply", tmp_path / "out.ply", "--json")
    assert done.returncode == 0
    report = json.loads(done.stdout)
    assert 0.07 < report["estimated_noise"] < 0.15
    assert report["parameters"]["noise_level"] > 0
    assert report["parameters"]["noise_type"] == "white"


def test_what_is_far_from_the_reference_is_left_out(meshes, tmp_path):
    def measured(*options):
        done = run("measure", meshes / "part.ply", meshes / "noisy.ply", "--json", *options)
        assert done.returncode == 0, done.stderr
        return json.loads(done.stdout)

    everything = measured()
    assert measured("--max-distance", 0) == everything
    assert measured("--max-distance", 2 * everything["max_distance"]) == everything
    near = measured("--max-distance", 0.5 * everything["max_distance"])
    assert 0 < near["measured_faces"] < everything["measured_faces"]
    assert near["max_distance"] <= 0.5 * everything["max_distance"]


def test_denoise_says_it_in_words(meshes, tmp_path):
    done = run(
        "denoise", meshes / "noisy.ply", tmp_path / "out.off", "--method", "paper",
        "--reference", meshes / "part.ply",
    )
    assert done.returncode == 0 and done.stderr == ""
    for words in ("vertices", "iterations=5", "mean angle", "MSAE", "E_v", "folded faces"):
        assert words in done.stdout
    assert "#" not in done.stdout and "\r" not in done.stdout


def test_threads_do_not_change_the_file(meshes, tmp_path):
    for threads in (1, 2, 3):
        file = tmp_path / f"{threads}.ply"
        done = run("denoise", meshes / "noisy.ply", file, "--method", "paper", "--threads", threads)
        assert done.returncode == 0
    contents = {(tmp_path / f"{threads}.ply").read_bytes() for threads in (1, 2, 3)}
    assert len(contents) == 1


def test_noise_depends_on_its_options_alone(meshes, tmp_path):
    def noise(name, *options):
        file = tmp_path / f"{name}.ply"
        assert run("noise", meshes / "part.ply", file, "--sigma", 0.1, *options).returncode == 0
        return file.read_bytes()

    first = noise("first")
    assert first == noise("second", "--direction", "random", "--impulsive-share", 1, "--seed", 1)
    others = [
        noise("seed", "--seed", 2), noise("normal", "--direction", "normal"),
        noise("isotropic", "--direction", "isotropic"), noise("impulsive", "--impulsive-share", 0.3),
    ]
    assert len({first, *others}) == 5
    # The names these options had before.
    assert noise("kind", "--kind", "normal") == others[1]
    assert noise("impulsive", "--impulsive", 0.3) == others[3]


def test_every_format_in_and_out(meshes, tmp_path):
    source = meshes / "part.ply"
    expected = ply.read(source)
    for ending in ("obj", "off", "stl", "ply"):
        file = tmp_path / f"mesh.{ending}"
        assert run("noise", source, file, "--sigma", 0).returncode == 0
        back = tmp_path / "back.ply"
        assert run("noise", file, back, "--sigma", 0).returncode == 0
        mesh = ply.read(back)
        assert len(mesh.faces) == len(expected.faces)
        corners, expected_corners = mesh.positions[mesh.faces], expected.positions[expected.faces]
        if ending == "stl":
            assert np.allclose(corners, expected_corners, atol=1e-6)
        else:
            assert np.array_equal(corners, expected_corners)
            assert np.array_equal(mesh.faces, expected.faces)


def test_info_counts_defects(meshes):
    def info(name):
        return json.loads(run("info", meshes / name, "--json").stdout)

    part = info("part.ply")
    assert part["components"] == 1 and part["boundary_vertices"] == 0
    assert part["mean_edge_length"] > 0
    assert part["white_noise"] < 0.02 and "unusable" not in part
    # Noise in a random direction has this share of itself along the normal.
    assert 0.07 < info("noisy.ply")["white_noise"] < 0.15
    assert "white_noise" not in info("points_only.ply")
    assert info("degenerate_face.ply")["degenerate_faces"] == 2
    broken = info("nan_coordinate.ply")
    assert broken["not_finite_vertices"] == 1 and "vertex 7" in broken["unusable"]
    far = ply.read(meshes / "part.ply")
    far.positions[5, 0] = 1e70
    ply.write(meshes / "far.ply", far.positions, far.faces, dtype="<f8")
    assert info("far.ply")["components"] == 1
    assert "vertex 5 has a coordinate beyond 1e60" in info("far.ply")["unusable"]
    assert "beyond 1e60" in run("info", meshes / "far.ply").stdout
    assert info("empty.ply")["faces"] == 0
    assert info("height_field.ply")["boundary_vertices"] > 300
    words = run("info", meshes / "part.ply")
    assert words.returncode == 0 and "mean edge length: 0." in words.stdout


@pytest.mark.parametrize("arguments, words", [
    ([], "subcommand"),
    (["polish"], "subcommand"),
    (["denoise", "{noisy}"], "OUT"),
    (["denoise", "{folder}/none.ply", "{out}"], "none.ply: No such file"),
    (["denoise", "{noisy}", "{folder}/none/out.ply"], "there is no folder"),
    (["denoise", "{noisy}", "{folder}/out.xyz"], ".ply, .obj, .off or .stl"),
    (["denoise", "{noisy}", "{out}", "--set", "sigma_s=1"], "there is no parameter 'sigma_s'; there are"),
    (["denoise", "{noisy}", "{out}", "--set", "iterations"], "name=value"),
    (["denoise", "{noisy}", "{out}", "--set", "iterations=0"], "iterations is 0; give"),
    (["denoise", "{noisy}", "{out}", "--set", "iterations=2.5"], "iterations is 2.5"),
    (["denoise", "{noisy}", "{out}", "--set", "sigma_theta=nan"], "sigma_theta is nan"),
    (["denoise", "{noisy}", "{out}", "--method", "median"], "method is 'median'"),
    (["denoise", "{noisy}", "{out}", "--threads", "many"], "threads is 'many'"),
    (["denoise", "{noisy}", "{out}", "--method", "paper", "--set", "guide_ring=5", "--set",
      "structure_ring=2"], "guide_ring is 5, structure_ring is 2"),
    (["denoise", "{folder}/points_only.ply", "{out}"], "218 vertices and no faces"),
    (["denoise", "{folder}/empty.ply", "{out}"], "no faces"),
    (["denoise", "{folder}/nan_coordinate.ply", "{out}"], "vertex 7"),
    (["denoise", "{noisy}", "{out}", "--reference", "{folder}/points_only.ply"], "reference"),
    (["denoise", "{noisy}", "{out}", "--reference", "{folder}/none.ply"], "none.ply"),
    (["noise", "{folder}/part.ply", "{out}"], "--sigma"),
    (["noise", "{folder}/part.ply", "{out}", "--sigma", "-1"], "sigma is -1"),
    (["noise", "{folder}/part.ply", "{out}", "--sigma", "0.1", "--direction", "pink"],
     "direction is 'pink'"),
    (["noise", "{folder}/part.ply", "{out}", "--sigma", "0.1", "--impulsive-share", "2"],
     "impulsive_share is 2"),
    (["measure", "{folder}/points_only.ply", "{noisy}"], "reference"),
    (["measure", "{noisy}", "{folder}/points_only.ply"], "no"),
    (["measure", "{noisy}", "{noisy}", "--max-distance", "-1"], "max_distance is -1"),
    (["measure", "{noisy}", "{noisy}", "--max-distance", "nan"], "max_distance is nan"),
    (["measure", "{noisy}", "{folder}/height_field.ply", "--max-distance", "1e-300"], "--max-distance"),
    (["info", "{folder}"], "must end in"),
])
def test_an_error_is_one_line(meshes, tmp_path, arguments, words):
    places = {"folder": meshes, "noisy": meshes / "noisy.ply", "out": tmp_path / "out.ply"}
    done = run(*(argument.format(**places) for argument in arguments))
    assert done.returncode != 0
    assert done.stdout == ""
    assert done.stderr.count("\n") == 1 and done.stderr.startswith("orthopoly: ")
    assert words in done.stderr
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("words", ["iteration 1 of", "measuring"])
def test_control_c_writes_nothing(meshes, tmp_path, words):
    code, out, seen = in_terminal(
        ["denoise", meshes / "large" / "noisy.ply", tmp_path / "out.ply", "--method", "paper",
         "--reference", meshes / "large" / "part.ply"],
        until=words.encode())
    assert code == 130
    assert out == b"" and seen.endswith(b"orthopoly: cancelled, nothing was written\r\n")
    assert list(tmp_path.iterdir()) == []


def test_control_c_stops_measuring(meshes):
    large = meshes / "large"
    code, out, seen = in_terminal(
        ["measure", large / "part.ply", large / "noisy.ply"], until=b"measuring")
    assert code == 130 and out == b"" and b"cancelled" in seen


def test_a_terminal_sees_a_bar(meshes, tmp_path):
    code, _, seen = in_terminal(
        ["denoise", meshes / "noisy.ply", tmp_path / "out.ply", "--method", "paper",
         "--reference", meshes / "part.ply"])
    assert code == 0
    assert b"[" in seen and b"%" in seen
    assert b"iteration 1 of 5" in seen and b"measuring the distance to the reference" in seen
    percents = [int(word) for word in re.findall(rb"(\d+) %", seen)]
    assert percents == sorted(percents) and percents[-1] >= 95
