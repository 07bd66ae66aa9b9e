#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""How far denoised meshes are from their ground truth, beside the noisy ones and other denoisers.

    accuracy.py [FOLDER] [--methods NAME,...] [--only TEXT] [--seeds N] [--pictures [N]] [--jobs N]

FOLDER holds ground truths X.ply with noisy versions X_n1.ply, X_n2.ply, X_n3.ply, X_noisy.ply, in
subfolders or not. A noisy mesh without a ground truth is denoised and reported; every ground truth is
denoised as it is too, which should leave it alone. Without FOLDER the meshes of this project and some of
Debian's libcgal-demo get noise of all kinds. No method gets a setting for a mesh.

Writes accuracy.json and accuracy.md (and pictures) into build/bench.
"""

import argparse
import concurrent.futures
import hashlib
import json
import os
import pathlib
import re
import statistics
import sys
import tempfile
import threading
import time
from dataclasses import asdict, dataclass

import tools

METHODS = ["paper", "adaptive", "taubin", "twostep", "meshdenoiser"]
NOISY_NAME = re.compile(r"(.+)_(n\d+|noisy)$")
# Scans are noisy all over in a way that the user has to tell the adaptive method about.
SCAN_FOLDER = "scan"
# What --seeds puts on the ground truths that are called so: the noise of the paper's Table 2.
TABLE2 = {"cube": 0.2, "fandisk": 0.4, "cad": 0.3, "octaflower": 0.1}
NOT_RENEWED = 0

OWN_MESHES = ["cube", "sphere", "torus", "part", "thin_plate", "height_field"]
# And those of long thin triangles, which the means over the others leave out.
LONG_MESHES = ["scan_lines"]
# Those of many small faces, as dense scans have them, whose edges are no longer than the noise.
FINE_MESHES = ["sphere", "torus", "part"]
FINE_FACES = 100000
CGAL_MESHES = ["fandisk", "anchor_dense", "blade", "bones", "elephant", "armadillo", "bear", "knot2"]
# Kind and sigma in mean edge lengths. Random is Table 2's, normal that of the usual test sets. Uneven
# is none at one end of the mesh and twice sigma at the other, view along one axis, as scanners have it.
# Volume is in the values of one that the mesh is extracted from anew, sigma in its cubes. Simplified is
# on four times the faces, in their mean edge lengths, and simplified to the mesh's own number by MeshLab.
# Points is on points of the surface, in the mean distance between them, that MeshLab reconstructs it from;
# decimated the same with every other face of the reconstruction. Smoothed is normal, and smoothed a little;
# rippled the same, and smoothed more, which leaves ripples.
# Rounded has no draws: sigma is the step that coordinates are rounded to.
NOISES = [
	("normal", 0.1), ("normal", 0.2), ("normal", 0.3), ("normal", 0.6),
	("random", 0.2), ("random", 0.4), ("isotropic", 0.3), ("impulsive", 0.5),
	("uneven", 0.2), ("view", 0.3), ("volume", 0.3),
	("simplified", 0.3), ("points", 0.1), ("points", 0.5), ("decimated", 0.5), ("smoothed", 0.3),
	("rippled", 0.3), ("rounded", 0.6),
]
FINE_NOISES = [("normal", 0.6), ("normal", 1.0), ("normal", 1.5)]
# What `orthopoly noise` makes them of.
DIRECTIONS = {
	"impulsive": "random", "uneven": "normal", "view": "isotropic", "simplified": "normal",
	"smoothed": "normal", "rippled": "normal",
}
# Cubes of a volume along the longest side of the mesh, those around it, and how far from the surface
# it has distances; open meshes have no inside to measure them from.
VOLUME_CUBES = 80
VOLUME_MARGIN = 4
VOLUME_BAND = 3
OPEN_MESHES = ["height_field", "scan_lines", "blade"]
# The least number of points that a surface is reconstructed from.
FEWEST_POINTS = 20000
# Steps of MeshLab's Taubin smoothing that noise was smoothed by.
SMOOTHING_STEPS = {"smoothed": 3, "rippled": 10}
# The share of the vertices that impulsive noise moves.
IMPULSIVE_SHARE = 0.2

# An estimate this close to the truth is right: a share of it, or mean edge lengths.
ESTIMATE_SHARE = 0.15
ESTIMATE_LENGTH = 0.02
# A clean mesh may be turned by degrees and moved by mean edge lengths up to these.
CLEAN_ANGLE = 1.0
CLEAN_MOVE = 0.01


@dataclass
class Case:
	group: str
	model: str
	level: str
	truth: str | None = None
	# None: the noise has to be made.
	noisy: str | None = None
	kind: str = ""
	sigma: float = 0
	seed: int = NOT_RENEWED

	@property
	def name(self):
		return f"{self.model}_{self.level}"

	@property
	def key(self):
		return f"{self.group}/{self.name}" + (f"#{self.seed}" if self.seed else "")


# ---------------------------------------------------------------------------------------------
# Which cases there are

def cases_of_folder(folder, seeds):
	cases = []
	for path in sorted(folder.rglob("*.ply")):
		group = path.parent.relative_to(folder).as_posix()
		group = folder.name if group == "." else group
		match = NOISY_NAME.match(path.stem)
		truth = path.with_name(f"{match.group(1)}.ply") if match else path
		if match and not truth.is_file():
			cases.append(Case(group, match.group(1), match.group(2), None, str(path)))
		elif match and seeds and match.group(1) in TABLE2:
			# Made anew, below.
			continue
		elif match:
			cases.append(Case(group, match.group(1), match.group(2), str(truth), str(path)))
		else:
			cases.append(Case(group, path.stem, "clean", str(path), str(path)))
			for seed in range(1, seeds + 1) if path.stem in TABLE2 else []:
				sigma = TABLE2[path.stem]
				cases.append(Case(
					group, path.stem, "noisy", str(path), None, "random", sigma, seed))
	return cases


def cases_of_our_own(seeds, say):
	meshes = tools.OUT / "meshes"
	groups = {
		"own": tools.generated_meshes(meshes, OWN_MESHES),
		"long-triangles": tools.generated_meshes(meshes, LONG_MESHES),
		"fine": tools.generated_meshes(meshes / f"{FINE_FACES}", FINE_MESHES, FINE_FACES),
	}
	try:
		groups["libcgal-demo"] = tools.cgal_meshes(CGAL_MESHES)
	except (tools.BenchError, StopIteration) as error:
		say(f"left out: the meshes of libcgal-demo: {error}")
	cases = []
	for group, paths in groups.items():
		for path in paths:
			cases.append(Case(group, path.stem, "clean", str(path), str(path)))
			for kind, sigma in FINE_NOISES if group == "fine" else NOISES:
				if kind in NEW_SURFACES and path.stem in OPEN_MESHES:
					continue
				for seed in range(1, max(seeds, 1) + 1):
					cases.append(Case(
						group, path.stem, f"{kind}_{sigma:g}", str(path), None, kind, sigma, seed))
	return cases


# ---------------------------------------------------------------------------------------------
# Running one

LOADING = threading.Lock()


def load(path):
	import pymeshlab

	# It changes the working directory meanwhile, and --jobs runs cases side by side.
	with LOADING:
		meshes = pymeshlab.MeshSet()
		meshes.load_new_mesh(str(path))
		mesh = meshes.current_mesh()
		return mesh.vertex_matrix(), mesh.face_matrix()


def save(positions, faces, path):
	import pymeshlab

	with LOADING:
		meshes = pymeshlab.MeshSet()
		meshes.add_mesh(pymeshlab.Mesh(positions, faces))
		meshes.save_current_mesh(str(path))


def noise_along_normals(truth, noisy):
	"""Root mean square of the noise along the vertex normals of the ground truth, in its mean edge
	lengths; None where the two do not correspond."""
	import numpy as np

	clean, faces = load(truth)
	positions, noisy_faces = load(noisy)
	if clean.shape != positions.shape or not np.array_equal(faces, noisy_faces):
		return None
	corners = clean[faces]
	# Twice the area as weight.
	face_normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
	normals = np.zeros_like(clean)
	for corner in range(3):
		np.add.at(normals, faces[:, corner], face_normals)
	lengths = np.linalg.norm(normals, axis=1)
	used = lengths > 0
	along = np.einsum("ij,ij->i", positions - clean, normals)[used] / lengths[used]
	edge = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).mean()
	return float(np.sqrt(np.mean(along**2)) / edge)


def of_scan(row):
	return row["group"].split("/")[-1] == SCAN_FOLDER


def keep_part_of_noise(case, target):
	"""Makes even noise uneven."""
	import numpy as np

	clean, faces = load(case.truth)
	noise = load(target)[0] - clean
	if case.kind == "view":
		noise[:, :2] = 0
	else:
		extent = np.ptp(clean, axis=0)
		along = clean[:, np.argmax(extent)]
		noise *= 2 * ((along - along.min()) / extent.max())[:, None]
	save(clean + noise, faces, target)


def extract_from_volume(case, seed, target):
	"""Marching cubes of the distances from the mesh, with noise in them."""
	import igl
	import numpy as np

	clean, faces = load(case.truth)
	lowest = clean.min(axis=0)
	cube = np.ptp(clean, axis=0).max() / VOLUME_CUBES
	counts = np.ceil(np.ptp(clean, axis=0) / cube).astype(int) + 1 + 2 * VOLUME_MARGIN
	# The first coordinate runs fastest.
	steps = np.indices(counts[::-1]).reshape(3, -1)[::-1].T
	corners = lowest + cube * (steps - VOLUME_MARGIN)
	distances = igl.signed_distance(
		corners, clean, faces.astype(np.int64),
		igl.SignedDistanceType.SIGNED_DISTANCE_TYPE_FAST_WINDING_NUMBER)[0] / cube
	noise = case.sigma * np.random.default_rng(seed).standard_normal(len(distances))
	values = np.clip(distances, -VOLUME_BAND, VOLUME_BAND) + noise
	positions, triangles = igl.marching_cubes(values, corners, *counts.tolist())[:2]
	# Without the bubbles that noise makes beside the surface.
	parts = igl.facet_components(triangles)[1]
	largest = triangles[parts == np.bincount(parts).argmax()]
	save(*igl.remove_unreferenced(positions, largest)[:2], target)


def reconstruct_from_points(case, seed, target):
	"""Screened Poisson reconstruction of noisy points of the surface, cubes as wide as these are apart."""
	import numpy as np
	import pymeshlab

	clean, faces = load(case.truth)
	random = np.random.default_rng(seed)
	count = max(len(clean), FEWEST_POINTS)
	corners = clean[faces]
	cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
	areas = np.linalg.norm(cross, axis=1)
	chosen = random.choice(len(faces), count, p=areas / areas.sum())
	root, share = np.sqrt(random.random((count, 1))), random.random((count, 1))
	weights = np.hstack([1 - root, root * (1 - share), root * share])
	normals = cross[chosen] / areas[chosen, None]
	apart = np.sqrt(areas.sum() / 2 / count)
	noise = case.sigma * apart * random.standard_normal((count, 1))
	points = np.einsum("ij,ijk->ik", weights, corners[chosen]) + noise * normals
	depth = round(np.log2(1.1 * np.ptp(points, axis=0).max() / apart))
	with LOADING:
		meshes = pymeshlab.MeshSet()
		meshes.add_mesh(pymeshlab.Mesh(points))
		meshes.apply_filter("compute_normal_for_point_clouds", k=16)
		# Which side is out, a scanner knows.
		found = meshes.current_mesh().vertex_normal_matrix()
		found *= np.sign(np.einsum("ij,ij->i", found, normals))[:, None]
		meshes = pymeshlab.MeshSet()
		meshes.add_mesh(pymeshlab.Mesh(points, v_normals_matrix=found))
		meshes.apply_filter("generate_surface_reconstruction_screened_poisson", depth=depth, preclean=True)
		meshes.save_current_mesh(str(target), save_vertex_normal=False)


def round_coordinates(case, target):
	import igl
	import numpy as np

	clean, faces = load(case.truth)
	step = case.sigma * igl.avg_edge_length(clean, faces.astype(np.int64))
	save(step * np.round(clean / step), faces, target)


def apply_meshlab(source, target, name, **parameters):
	"""Writes what a filter of MeshLab makes of a mesh."""
	import pymeshlab

	with LOADING:
		meshes = pymeshlab.MeshSet()
		meshes.load_new_mesh(str(source))
		meshes.apply_filter(name, **parameters)
		meshes.save_current_mesh(str(target))


def simplify(path, face_count):
	apply_meshlab(path, path, "meshing_decimation_quadric_edge_collapse", targetfacenum=face_count)


def simplify_finer(case, kind, target):
	"""Noise on four faces of each, simplified to as many as before."""
	import pymeshlab

	apply_meshlab(
		case.truth, target, "meshing_surface_subdivision_midpoint",
		iterations=1, threshold=pymeshlab.PercentageValue(0))
	tools.orthopoly("noise", target, target, "--sigma", case.sigma, *kind)
	simplify(target, len(load(case.truth)[1]))


def decimate_reconstruction(case, seed, target):
	reconstruct_from_points(case, seed, target)
	simplify(target, len(load(target)[1]) // 2)


# Kinds of noise that come with a mesh of their own.
NEW_SURFACES = {
	"volume": extract_from_volume, "points": reconstruct_from_points,
	"decimated": decimate_reconstruction,
}


def make_noise(case, target):
	kind = ["--direction", DIRECTIONS.get(case.kind, case.kind)]
	if case.kind == "impulsive":
		kind += ["--impulsive-share", IMPULSIVE_SHARE]
	# Meshes get draws of their own even with one seed.
	seed = int(hashlib.sha256(f"{case.model} {case.seed}".encode()).hexdigest()[:7], 16)
	if case.kind in NEW_SURFACES:
		NEW_SURFACES[case.kind](case, seed, target)
		return
	if case.kind == "rounded":
		round_coordinates(case, target)
		return
	kind += ["--seed", seed]
	if case.kind == "simplified":
		simplify_finer(case, kind, target)
		return
	tools.orthopoly("noise", case.truth, target, "--sigma", case.sigma, *kind)
	if case.kind in ("uneven", "view"):
		keep_part_of_noise(case, target)
	elif case.kind in SMOOTHING_STEPS:
		apply_meshlab(
			target, target, "apply_coord_taubin_smoothing",
			stepsmoothnum=SMOOTHING_STEPS[case.kind])


def figures(report):
	"""Of `orthopoly measure --json`, those that are compared; MSAE x 1e-2 as it is printed."""
	return {
		"angle": report["mean_angle"],
		"msae": 100 * report["msae"],
		"msae_without_folded": 100 * report["msae_without_folded"],
		"vertex_error": report["vertex_error"],
		"relative_vertex_error": report["relative_vertex_error"],
		"folded_faces": report["folded_faces"],
		"folded_in_truth": report["folded_in_reference"],
		"faces": report["measured_faces"],
	}


def run_case(case, methods, keep=None):
	"""One row: what the noisy mesh measures, and each method's result or why there is none."""
	row = {**asdict(case), "name": case.name, "key": case.key, "methods": {}}
	if of_scan(row) and "adaptive" in methods and case.level != "clean":
		methods = [*methods, "scanner"]
	with tempfile.TemporaryDirectory() as name:
		folder = pathlib.Path(keep or name)
		folder.mkdir(parents=True, exist_ok=True)
		noisy = folder / "noisy.ply"
		if case.noisy is None:
			make_noise(case, noisy)
		elif pathlib.Path(case.noisy).suffix == ".ply":
			noisy = pathlib.Path(case.noisy)
		else:
			# Not every tool reads every format; no noise is a copy.
			tools.orthopoly("noise", case.noisy, noisy, "--sigma", 0)
		if case.truth:
			row["noisy_figures"] = figures(tools.measure(case.truth, noisy))
			row["true_noise"] = noise_along_normals(case.truth, noisy)
		for method in methods:
			result = folder / f"{method}.ply"
			try:
				seconds, report = tools.DENOISERS[method].denoise(noisy, result)
				entry = {"seconds": seconds}
				if case.truth:
					entry.update(figures(tools.measure(case.truth, result)))
				if report:
					entry["report"] = report
			except tools.BenchError as error:
				entry = {"error": str(error)}
			row["methods"][method] = entry
	return row


# ---------------------------------------------------------------------------------------------
# Saying what came out

def good(row, method):
	return "angle" in row["methods"].get(method, {})


def grouped(rows, key):
	groups = {}
	for row in rows:
		groups.setdefault(key(row), []).append(row)
	return groups


def title(method):
	return tools.DENOISERS[method].title


def measure_cells(entries):
	def values(name):
		return [entry[name] for entry in entries]

	return [
		tools.spread(values("angle"), 2),
		tools.spread(values("msae"), 3),
		tools.spread(values("vertex_error"), ".4g"),
		tools.spread(values("relative_vertex_error"), 4),
		tools.spread(values("folded_faces"), 0),
	]


def case_table(rows, methods):
	"""Every case with every method; the seeds of a case become a median with the range."""
	out = []
	for (group, name), same in grouped(rows, lambda row: (row["group"], row["name"])).items():
		out.append([group, name, "noisy", *measure_cells([r["noisy_figures"] for r in same]), ""])
		for method in methods:
			entries = [r["methods"][method] for r in same if good(r, method)]
			if entries:
				seconds = tools.spread([entry["seconds"] for entry in entries], 2)
				out.append(["", "", title(method), *measure_cells(entries), seconds])
			for row in same:
				error = row["methods"].get(method, {}).get("error")
				if error:
					out.append(["", "", title(method), f"failed: {error}"] + [""] * 5)
					break
	return tools.table(
		["group", "case", "mesh", "angle", "MSAE", "E_v", "E_v / l_e", "folded", "seconds"], out)


def means_table(rows, methods):
	"""Means over the cases of a level, of those that every method came through."""
	out = []
	for (group, level), same in grouped(rows, lambda row: (row["group"], row["level"])).items():
		present = [m for m in methods if any(good(row, m) for row in same)]
		common = [row for row in same if all(good(row, m) for m in present)]
		if not common:
			continue

		def add(label, entries, seconds):
			mean = {
				name: statistics.fmean(entry[name] for entry in entries)
				for name in ("angle", "msae", "relative_vertex_error", "folded_faces")
			}
			out.append([
				group, level, len(common), label, tools.number(mean["angle"], 3),
				tools.number(mean["msae"], 3), tools.number(mean["relative_vertex_error"], 4),
				tools.number(mean["folded_faces"], 1), tools.number(seconds, 2)])

		add("noisy", [row["noisy_figures"] for row in common], None)
		for method in present:
			entries = [row["methods"][method] for row in common]
			add(title(method), entries, statistics.fmean(entry["seconds"] for entry in entries))
	return tools.table(
		["group", "level", "cases", "mesh", "angle", "MSAE", "E_v / l_e", "folded", "seconds"], out)


def estimate_of(row, method="adaptive"):
	"""None for a method that estimates nothing."""
	return row["methods"].get(method, {}).get("report", {}).get("estimated_noise")


def estimate_is_right(row):
	error = abs(estimate_of(row) - row["true_noise"])
	return error <= max(ESTIMATE_SHARE * row["true_noise"], ESTIMATE_LENGTH)


def estimated(rows):
	return [
		row for row in rows if row.get("true_noise") is not None and estimate_of(row) is not None]


def estimates_table(rows):
	out = []
	for (group, name), same in grouped(
			estimated(rows), lambda row: (row["group"], row["name"])).items():
		true = [row["true_noise"] for row in same]
		found = [estimate_of(row) for row in same]
		off = [100 * (e / t - 1) if t else None for e, t in zip(found, true)]
		out.append([
			group, name, tools.spread(true, 4), tools.spread(found, 4), tools.spread(off, 0),
			"yes" if all(estimate_is_right(row) for row in same) else "no"])
	within = f"within {100 * ESTIMATE_SHARE:.0f} % or {ESTIMATE_LENGTH}"
	return tools.table(["group", "case", "true", "estimated", "off by %", within], out)


def clean_table(rows, methods):
	out = []
	for row in rows:
		for method in methods:
			entry = row["methods"].get(method, {})
			if "angle" in entry:
				out.append([
					row["group"], row["model"], title(method), tools.number(entry["angle"], 3),
					tools.number(entry["relative_vertex_error"], 5),
					tools.number(estimate_of(row, method), 4),
					entry.get("report", {}).get("status", "")])
			elif entry:
				out.append([
					row["group"], row["model"], title(method), f"failed: {entry['error']}", "", "", ""])
	return tools.table(
		["group", "model", "method", "angle moved", "E_v / l_e", "estimated noise", "status"], out)


def without_truth_table(rows, methods):
	out = []
	for row in rows:
		for method in methods:
			entry = row["methods"].get(method, {})
			if not entry:
				continue
			report = entry.get("report", {})
			out.append([
				row["group"], row["name"], title(method),
				entry.get("error") or tools.number(entry["seconds"], 2),
				tools.number(estimate_of(row, method), 3),
				report.get("folded_faces_before", ""), report.get("folded_faces_after", ""),
				tools.number(report.get("mean_displacement"), 6)])
	return tools.table(
		["group", "case", "method", "seconds", "estimated noise", "folded before", "folded after",
		 "mean displacement"], out)


def published_table(rows, methods, published):
	"""Cases with a published figure: it, and each method's, in its units; a cross where it is worse."""
	measures = [
		("angle", "angle", 2), ("msae", "MSAE", 3), ("vertex_error", "E_v", 3),
		("relative_vertex_error", "E_v / l_e", 4)]
	out = []
	met = {method: [0, 0] for method in methods}
	for (_, name), same in grouped(rows, lambda row: (row["group"], row["name"])).items():
		known = published["cases"].get(name)
		if not known:
			continue
		for measure, label, digits in measures:
			if measure not in known:
				continue
			factor = 1000 * known.get("scale", 1) if measure == "vertex_error" else 1
			cells = []
			for method in methods:
				values = [r["methods"][method][measure] for r in same if good(r, method)]
				if not values:
					cells.append("")
					continue
				value = factor * statistics.median(values)
				# Published figures are rounded.
				better = round(value, digits) <= known[measure]
				met[method][0] += better
				met[method][1] += 1
				cells.append(f"{value:.{digits}f}" + ("" if better else " x"))
			source = known["source"] + (f", {known['tool']}" if "tool" in known else "")
			out.append([name, label, known[measure], source, *cells])
	if not out:
		return None, {}
	counts = {method: f"{a} of {b}" for method, (a, b) in met.items() if b}
	text = tools.table(["case", "measure", "published", "source", *map(title, methods)], out)
	text += "\nAt or below the published figure: " + ", ".join(
		f"{title(method)} in {count}" for method, count in counts.items()) + ".\n\n"
	text += "".join(f"- {key}: {words}\n" for key, words in published["sources"].items())
	return text, counts


def verdicts(rows, clean):
	"""What should hold of the adaptive method in every case, and the cases where it does not."""
	checked = [row for row in rows if good(row, "adaptive")]
	result = lambda row: row["methods"]["adaptive"]  # noqa: E731
	mild = lambda row: row.get("true_noise") is None or row["true_noise"] <= 0.4  # noqa: E731
	no_worse = {
		f"{label} below the noisy mesh's": [
			row["key"] for row in checked
			if result(row)[name] >= row["noisy_figures"][name] and row["noisy_figures"]["angle"] > 0]
		for label, name in (("angle", "angle"), ("MSAE", "msae"), ("E_v", "vertex_error"))
	}
	# Impulsive noise has no one level, and that of scans and of terraces is correlated.
	white = [
		row for row in estimated(rows)
		if row["kind"] not in ("impulsive", "rounded") and not of_scan(row)]
	# Those of the truth are not the method's.
	folded = lambda row: result(row)["folded_faces"] - result(row)["folded_in_truth"]  # noqa: E731
	found = {
		**no_worse,
		"no folded face but the truth's, noise up to 0.4": [
			f"{row['key']} ({folded(row)})" for row in checked if mild(row) and folded(row) > 0],
		"folded faces but the truth's under 0.1 %, more noise": [
			f"{row['key']} ({folded(row)})" for row in checked
			if not mild(row) and folded(row) >= 0.001 * result(row)["faces"]],
		f"estimated noise within {100 * ESTIMATE_SHARE:.0f} % or {ESTIMATE_LENGTH} (white noise)": [
			f"{row['key']} ({estimate_of(row):.3f} for {row['true_noise']:.3f})"
			for row in white if not estimate_is_right(row)],
		f"clean meshes turned by less than {CLEAN_ANGLE:g} degree, E_v / l_e below {CLEAN_MOVE}": [
			row["key"] for row in clean if good(row, "adaptive") and (
				result(row)["angle"] >= CLEAN_ANGLE
				or result(row)["relative_vertex_error"] >= CLEAN_MOVE)],
	}
	failed = [row["key"] for row in rows + clean if "error" in row["methods"].get("adaptive", {})]
	return {"came to an end": failed, **found} if checked or failed else {}


def report(rows, methods, heading):
	clean = [row for row in rows if row["level"] == "clean"]
	noisy = [row for row in rows if row["level"] != "clean" and row["truth"]]
	alone = [row for row in rows if not row["truth"]]
	shown = methods + ["scanner"] if any("scanner" in row["methods"] for row in rows) else methods
	parts = [heading]
	published = json.loads(
		(pathlib.Path(__file__).parent / "published.json").read_text(encoding="utf-8"))
	checks = verdicts(noisy, clean)
	if checks:
		parts.append("## What should hold of the adaptive method\n\n" + "".join(
			f"- {what}: " + ("holds\n" if not where else f"**not in {len(where)}**: "
				+ ", ".join(where) + "\n") for what, where in checks.items()))
	if noisy:
		parts.append("## Means of each level\n\n" + means_table(noisy, shown))
		text, _ = published_table(noisy, shown, published)
		if text:
			parts.append("## Beside published figures (x: worse than published)\n\n" + text)
	if estimated(noisy):
		parts.append(
			"## Noise along the normal, true and estimated, in mean edge lengths\n\n"
			+ estimates_table(noisy))
	if clean:
		parts.append("## Clean meshes denoised\n\n" + clean_table(clean, methods))
	if alone:
		parts.append("## Without a ground truth\n\n" + without_truth_table(alone, shown))
	if noisy:
		parts.append("## Every case\n\n" + case_table(noisy, shown))
	return "\n".join(parts)


# ---------------------------------------------------------------------------------------------
# Pictures

def coloured_by_error(path, title_, truth, limit):
	"""The mesh with a colour a face for its angle to the ground truth's."""
	import numpy as np
	import render

	mesh, clean = render.Mesh(path, title_), render.Mesh(truth, "")

	def normals(of):
		corners = of.vertices[of.faces]
		cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
		return cross / np.maximum(np.linalg.norm(cross, axis=1), 1e-300)[:, None]

	paired = normals(clean)
	if not np.array_equal(mesh.faces, clean.faces):
		import igl

		centroids = mesh.vertices[mesh.faces].mean(axis=1)
		_, nearest, _ = igl.point_mesh_squared_distance(
			centroids, clean.vertices, clean.faces.astype(np.int64))
		paired = paired[nearest]
	cosines = np.einsum("ij,ij->i", normals(mesh), paired).clip(-1, 1)
	mesh.colours = render.ERROR_COLOURS(np.degrees(np.arccos(cosines)) / limit)[:, :3]
	return mesh


def view_of(mesh):
	"""From where most is seen of an open mesh; a closed one is the same from everywhere."""
	import numpy as np

	corners = mesh.vertices[mesh.faces]
	cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
	x, y, z = cross.sum(axis=0) / max(np.linalg.norm(cross, axis=1).sum(), 1e-300)
	length = np.sqrt(x * x + y * y + z * z)
	if length < 0.2:
		return -50.0, 25.0
	# A little from the side: an edge seen straight on does not show.
	return np.degrees(np.arctan2(x, -y)) - 20, np.degrees(np.arcsin(z / length)) * 0.8


def draw(case, method, target, limit=30):
	"""Ground truth, noisy, result, and the last two coloured by their error."""
	import render

	with tempfile.TemporaryDirectory() as name:
		folder = pathlib.Path(name)
		row = run_case(case, [method], folder)
		noisy = folder / "noisy.ply"
		if not noisy.is_file():
			noisy = pathlib.Path(case.noisy)
		entry = row["methods"][method]
		if "error" in entry:
			raise tools.BenchError(entry["error"])
		result = folder / f"{method}.ply"
		meshes = [render.Mesh(noisy, f"{case.name}"), render.Mesh(result, title(method))]
		if case.truth:
			meshes.insert(0, render.Mesh(case.truth, "ground truth"))
			meshes += [
				coloured_by_error(
					noisy, f"noisy: {row['noisy_figures']['angle']:.1f} degrees", case.truth, limit),
				coloured_by_error(result, f"result: {entry['angle']:.2f} degrees", case.truth, limit),
			]
		# What a file brought with it says nothing here.
		for mesh in meshes[: 3 if case.truth else 2]:
			mesh.colours = None
		render.render(target, meshes, limit if case.truth else None, view_of(meshes[0]))


def picture_cases(cases, count):
	"""The strongest noise of each model, spread over what there is."""
	last = {}
	for case in cases:
		if case.level != "clean" and case.seed <= 1:
			last[case.group, case.model] = case
	chosen = list(last.values())
	step = max(len(chosen) / count, 1) if count else 1
	return [chosen[int(i * step)] for i in range(min(count, len(chosen)))]


# ---------------------------------------------------------------------------------------------

def arguments_of_the_command_line():
	parser = argparse.ArgumentParser(
		description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
	parser.add_argument("folder", nargs="?", type=pathlib.Path)
	parser.add_argument(
		"--methods", default=",".join(METHODS), help=f"of {', '.join(tools.DENOISERS)}; "
		"default: %(default)s (scanner comes along for scans)")
	parser.add_argument(
		"--only", action="append", default=[], metavar="TEXT",
		help="only cases with TEXT in group/model_level; may be repeated")
	parser.add_argument(
		"--seeds", type=int, default=0, metavar="N",
		help="in a folder: N noises anew for the models of Table 2 (" + ", ".join(
			f"{name} {sigma}" for name, sigma in TABLE2.items()) + "); without: N noises of each kind")
	parser.add_argument(
		"--pictures", nargs="?", type=int, const=6, default=0, metavar="N",
		help="draw N cases (default: 6)")
	parser.add_argument(
		"--jobs", type=int, default=1, help="cases at a time; more than 1 spoils the seconds")
	parser.add_argument("--out", type=pathlib.Path, default=tools.OUT, help="default: build/bench")
	arguments = parser.parse_args()
	if arguments.folder and not arguments.folder.is_dir():
		parser.error(f"{arguments.folder} is no folder")
	if arguments.seeds < 0 or arguments.jobs < 1 or arguments.pictures < 0:
		parser.error("--seeds and --pictures have to be 0 or more, --jobs 1 or more")
	return arguments


def guarded(case, methods):
	"""A case that cannot even be set up is a row with errors, not the end of the benchmark."""
	try:
		return run_case(case, methods)
	except tools.BenchError as error:
		return {
			**asdict(case), "name": case.name, "key": case.key, "truth": None,
			"methods": {method: {"error": str(error)} for method in methods}}


def one_line(row):
	cells = []
	if "noisy_figures" in row:
		cells.append(f"noisy {row['noisy_figures']['angle']:.2f}")
	for method, entry in row["methods"].items():
		if "error" in entry:
			cells.append(f"{method} failed: {entry['error']}")
		elif "angle" in entry:
			cells.append(f"{method} {entry['angle']:.2f} ({entry['seconds']:.1f} s)")
		else:
			cells.append(f"{method} ({entry['seconds']:.1f} s)")
	return f"{row['key']}: " + ", ".join(cells)


def main():
	arguments = arguments_of_the_command_line()
	notes = []

	def say(text):
		notes.append(text)
		print(text, flush=True)

	if tools.load_note():
		say(tools.load_note())
	methods = tools.usable([name for name in arguments.methods.split(",") if name], say)
	if not methods:
		raise tools.BenchError("there is no method to run")
	if arguments.folder:
		cases = cases_of_folder(arguments.folder.resolve(), arguments.seeds)
	else:
		cases = cases_of_our_own(arguments.seeds, say)
	if arguments.only:
		cases = [case for case in cases if any(text in case.key for text in arguments.only)]
	if not cases:
		raise tools.BenchError("there is no case to run")

	arguments.out.mkdir(parents=True, exist_ok=True)
	started = time.time()
	rows = []
	with concurrent.futures.ThreadPoolExecutor(arguments.jobs) as pool:
		for row in pool.map(lambda case: guarded(case, methods), cases):
			rows.append(row)
			print(one_line(row), flush=True)
	what = arguments.folder.name if arguments.folder else "meshes of our own and of libcgal-demo"
	heading = (
		f"# Accuracy: {what}\n\n"
		f"Commit {tools.commit()}; {tools.processor()}; {len(cases)} cases in "
		f"{time.time() - started:.0f} s. Angle: mean over the faces, degrees. MSAE x 1e-2, radians "
		"squared. E_v in mesh units, l_e: mean edge length of the ground truth. Folded: faces more than "
		"90 degrees off. Seconds without reading and writing files. Where a case has several noises: "
		"median (range). Every method with one setting for all; MeshLab's filters with their defaults.\n"
		+ "".join(f"\n{note}\n" for note in notes))
	text = report(rows, methods, heading)
	(arguments.out / "accuracy.json").write_text(
		json.dumps({"methods": methods, "commit": tools.commit(), "cases": rows}, indent=1) + "\n",
		encoding="utf-8")
	(arguments.out / "accuracy.md").write_text(text, encoding="utf-8")
	print("\n" + text)
	for case in picture_cases(cases, arguments.pictures):
		target = arguments.out / f"{case.group.replace('/', '_')}_{case.name}.png"
		method = "adaptive" if "adaptive" in methods else methods[0]
		try:
			draw(case, method, target)
			print(target)
		except tools.BenchError as error:
			print(f"no picture of {case.key}: {error}")
	print(f"{arguments.out / 'accuracy.md'}\n{arguments.out / 'accuracy.json'}")


if __name__ == "__main__":
	try:
		main()
	except (tools.BenchError, OSError) as error:
		sys.exit(f"accuracy: {error}")
	# Everything is written. MeshLab's libraries abort now and then when they are unloaded.
	sys.stdout.flush()
	os._exit(0)
