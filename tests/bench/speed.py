#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Seconds and memory of the denoisers, side by side on the same meshes, doubling in size.

    speed.py [--max-faces N | --faces N,...] [--methods NAME,...] [--repeats N] [--limit SECONDS]

For one tool at one size: speed.py --methods meshdenoiser --faces 1000000 --limit 3600.

The mesh is `part` of generate_meshes with noise along its normals. Every denoiser runs once to warm up
and is timed then: the median of --repeats runs, without reading and writing files. Memory is the peak
while denoising beyond what the process held with the mesh loaded. A run that would take longer than
--limit, going by the smaller meshes, is left out, and the table says so.

Writes speed.json, speed.md and speed.png into build/bench.
"""

import argparse
import ctypes
import json
import math
import os
import pathlib
import re
import shutil
import statistics
import subprocess
import sys
import time
from dataclasses import dataclass

import tools

LEAST_FACES = 16000
# The growth exponent is fitted from here on: smaller meshes fit into the caches.
GROWTH_FROM = 125000


# ---------------------------------------------------------------------------------------------
# Memory of a process

def memory_of(process, name):
	"""A line of /proc/PROCESS/status in bytes, or None."""
	try:
		text = pathlib.Path(f"/proc/{process}/status").read_text(encoding="utf-8")
	except OSError:
		return None
	match = re.search(rf"^{name}:\s*(\d+) kB", text, re.MULTILINE)
	return 1024 * int(match.group(1)) if match else None


def reset_peak(process):
	"""Starts the process's peak anew, where the system can."""
	try:
		pathlib.Path(f"/proc/{process}/clear_refs").write_text("5", encoding="utf-8")
	except OSError:
		return False
	return True


# ---------------------------------------------------------------------------------------------
# One denoiser on one mesh: {"seconds": [...], "memory": bytes or None, ...}

def run_orthopoly(method, mesh, threads, arguments):
	return json.loads(tools.call(
		tools.program("denoise_timer"), mesh, method, threads, arguments.repeats, arguments.budget))


def run_mesh_denoiser(_, mesh, threads, arguments):
	"""Processes of their own; the program itself says how long denoising took."""
	options, result = tools.MeshDenoiser.write_options(), mesh.with_name("result.ply")
	seconds, memory = [], None
	started = time.monotonic()
	while len(seconds) < arguments.repeats:
		if seconds and time.monotonic() - started > arguments.budget:
			break
		environment = {**os.environ, "OMP_NUM_THREADS": str(threads)}
		with subprocess.Popen(
				["MeshDenoiser", options, mesh, result], stdout=subprocess.PIPE,
				stderr=subprocess.STDOUT, text=True, env=environment) as process:
			before = peak = timing = None
			for line in process.stdout:
				if line.startswith("Denoising started"):
					before = memory_of(process.pid, "VmRSS") if reset_peak(process.pid) else None
				elif line.startswith("Denoising completed"):
					peak = memory_of(process.pid, "VmHWM")
					timing = float(line.rpartition(":")[2])
		if process.returncode != 0 or timing is None:
			raise tools.BenchError("MeshDenoiser gave up on it")
		seconds.append(timing)
		if memory is None and before and peak:
			memory = peak - before
	result.unlink(missing_ok=True)
	return {"seconds": seconds, "memory": memory}


def run_meshlab(filter_name, mesh, _, arguments, reference=""):
	said = tools.call(
		sys.executable, __file__, "--meshlab-filter", filter_name, mesh, arguments.repeats,
		arguments.budget, reference)
	result = json.loads(next(line for line in said.splitlines() if line.startswith('{"seconds"')))
	# Our filter says how long it took without the layer's share; the first run is not counted.
	core = [float(word) for word in re.findall(r"denoised in (\S+) seconds", said)][1:]
	if core:
		result["core"] = core
	return result


def run_meshlab_compared(filter_name, mesh, _, arguments):
	return run_meshlab(filter_name, mesh, _, arguments, mesh.with_name("clean.ply"))


def time_meshlab_filter(filter_name, path, repeats, budget, reference):
	"""What run_meshlab calls in a process of its own. Every run gets the noisy mesh anew."""
	import pymeshlab

	# Filters log to standard error; it is wanted with the rest.
	os.dup2(1, 2)
	given = {"compare_with_reference": True, "reference": 1} if reference else {}
	if filter_name.startswith("apply_coord_orthogonal"):
		pymeshlab.load_plugin(str(tools.newest_plugin()))
	meshes = pymeshlab.MeshSet()
	meshes.load_new_mesh(path)
	vertices, faces = meshes.current_mesh().vertex_matrix(), meshes.current_mesh().face_matrix()
	seconds, memory = [], None
	started = time.monotonic()
	while len(seconds) <= repeats:
		if len(seconds) > 1 and time.monotonic() - started > budget:
			break
		meshes = pymeshlab.MeshSet(verbose=True)
		meshes.add_mesh(pymeshlab.Mesh(vertices, faces))
		if reference:
			meshes.load_new_mesh(reference)
			meshes.set_current_mesh(0)
		try:
			# Memory that loading gave back is not the filter's to use unseen.
			ctypes.CDLL(None).malloc_trim(0)
		except AttributeError:
			pass
		measurable = reset_peak("self")
		before = memory_of("self", "VmRSS")
		start = time.perf_counter()
		meshes.apply_filter(filter_name, **given)
		seconds.append(time.perf_counter() - start)
		if len(seconds) == 1 and measurable and before:
			memory = memory_of("self", "VmHWM") - before
	print("\n" + json.dumps({"seconds": seconds[1:], "first": seconds[0], "memory": memory}))


@dataclass
class Contender:
	title: str
	run: object
	argument: str
	# Whether it can be told how many threads to take.
	threaded: bool
	package: str = ""


CONTENDERS = {
	"adaptive": Contender("orthopoly, adaptive", run_orthopoly, "adaptive", True),
	"paper": Contender("orthopoly, paper's method", run_orthopoly, "paper", True),
	"meshdenoiser": Contender("MeshDenoiser", run_mesh_denoiser, "", True, "meshdenoiser"),
	"taubin": Contender(
		"MeshLab Taubin", run_meshlab, "apply_coord_taubin_smoothing", False, "taubin"),
	"twostep": Contender(
		"MeshLab Two Step", run_meshlab, "apply_coord_two_steps_smoothing", False, "twostep"),
	"plugin": Contender(
		"orthopoly in pymeshlab", run_meshlab, "apply_coord_orthogonal_polynomial_denoising", False,
		"taubin"),
	"compared": Contender(
		"orthopoly in pymeshlab, compared with a reference", run_meshlab_compared,
		"apply_coord_orthogonal_polynomial_denoising", False, "taubin"),
}
METHODS = ["adaptive", "paper", "meshdenoiser", "taubin", "twostep", "plugin", "compared"]


# ---------------------------------------------------------------------------------------------
# What the numbers say

def growth(points):
	"""The exponent of time over size by least squares; None for fewer than two sizes."""
	points = [point for point in points if point[0] >= GROWTH_FROM] or points
	if len(points) < 2:
		return None
	x = [math.log(faces) for faces, _ in points]
	y = [math.log(seconds) for _, seconds in points]
	mean_x, mean_y = statistics.fmean(x), statistics.fmean(y)
	return sum((a - mean_x) * (b - mean_y) for a, b in zip(x, y)) / sum((a - mean_x) ** 2 for a in x)


def expected_seconds(points, faces):
	"""What a larger mesh will take, going by the last two sizes; 0 where nothing is known."""
	if not points:
		return 0
	last_faces, last_seconds = points[-1]
	exponent = 1.0
	if len(points) > 1:
		before_faces, before_seconds = points[-2]
		exponent = math.log(last_seconds / before_seconds) / math.log(last_faces / before_faces)
		exponent = min(max(exponent, 1.0), 2.5)
	return last_seconds * (faces / last_faces) ** exponent


def done(results, name, threads):
	"""(faces, seconds) of what ran."""
	return [
		(r["faces"], r["median"]) for r in results
		if r["method"] == name and r["threads"] == threads and "median" in r]


def label(result):
	title = CONTENDERS[result["method"]].title
	if not CONTENDERS[result["method"]].threaded:
		return title
	return f"{title}, {result['threads']} thread{'s' if result['threads'] > 1 else ''}"


def size(faces):
	return f"{faces / 1e6:.2f} M" if faces >= 1e6 else f"{faces / 1e3:.0f} K"


def results_table(results, reference):
	"""Every run; how many times as long as the reference (the first method) on all threads."""
	base = {r["faces"]: r["median"] for r in results
		if "median" in r and (r["method"], r["threads"]) == reference}
	rows = []
	for r in results:
		if "median" not in r:
			rows.append([size(r["faces"]), label(r), r["skipped"]] + [""] * 5)
			continue
		ratio = r["median"] / base[r["faces"]] if r["faces"] in base else None
		rows.append([
			size(r["faces"]), label(r),
			tools.spread(r["seconds"], 3), len(r["seconds"]),
			tools.number(1e6 * r["median"] / r["faces"], 2), tools.number(ratio, 2),
			tools.number(r["memory"] / 2**20 if r["memory"] is not None else None, 0),
			tools.number(r["memory"] / r["faces"] if r["memory"] is not None else None, 0)])
	return tools.table(
		["faces", "method", "seconds (range)", "runs", "us a face", "times the first", "MiB beyond mesh",
		 "bytes a face"], rows)


def growth_table(results):
	rows = []
	for name, threads in sorted({(r["method"], r["threads"]) for r in results}):
		points = done(results, name, threads)
		exponent = growth(points)
		if exponent is not None:
			fitted = [p for p in points if p[0] >= GROWTH_FROM] or points
			rows.append([
				label({"method": name, "threads": threads}), tools.number(exponent, 3),
				f"{size(fitted[0][0])} to {size(fitted[-1][0])}"])
	return tools.table(["method", "growth exponent", "sizes"], rows)


def threads_table(results, threads):
	rows = []
	for name in dict.fromkeys(r["method"] for r in results):
		one = dict(done(results, name, 1))
		for many in threads:
			if many == 1:
				continue
			for faces, seconds in done(results, name, many):
				if faces in one:
					rows.append([
						CONTENDERS[name].title, size(faces), many, tools.number(one[faces], 3),
						tools.number(seconds, 3), tools.number(one[faces] / seconds, 2)])
	return tools.table(
		["method", "faces", "threads", "seconds on one", "seconds on these", "times as fast"], rows)


def shares_table(results):
	"""Of the largest mesh: what part of the time each step takes, as the progress names them."""
	rows = []
	for name in ("adaptive", "paper"):
		runs = [r for r in results if r["method"] == name and r.get("shares")]
		if not runs:
			continue
		largest = max(runs, key=lambda r: (r["faces"], r["threads"]))
		for step, share in sorted(largest["shares"].items(), key=lambda item: -item[1]):
			rows.append([
				label(largest), size(largest["faces"]), step, f"{100 * share:.1f} %",
				tools.number(1e6 * share * largest["median"] / largest["faces"], 2)])
	return tools.table(["method", "faces", "step", "share", "us a face"], rows)


def plugin_table(results):
	"""What the filter takes in the host beyond the denoising: reading the layer and writing it back,
	normals, and where there is a reference, measuring against it twice and the colours."""
	rows = []
	for r in results:
		if not r.get("core"):
			continue
		beyond = [whole - core for whole, core in zip(r["seconds"], r["core"])]
		shares = [100 * rest / whole for rest, whole in zip(beyond, r["seconds"])]
		rows.append([
			label(r), size(r["faces"]), tools.number(r["median"], 3),
			tools.number(statistics.median(r["core"]), 3),
			tools.number(statistics.median(beyond), 3), f"{statistics.median(shares):.1f} %"])
	return tools.table(
		["filter", "faces", "seconds", "denoising", "beyond it", "share beyond it"], rows)


def plot(results, target):
	import matplotlib

	matplotlib.use("Agg")
	import matplotlib.pyplot as plt

	figure, (left, right) = plt.subplots(1, 2, figsize=(12, 5), dpi=120)
	most = max(r["threads"] for r in results)
	names = list(dict.fromkeys(r["method"] for r in results))
	for name, threads in sorted({(r["method"], r["threads"]) for r in results}):
		colour = f"C{names.index(name)}"
		whole = threads == most or not CONTENDERS[name].threaded
		points = done(results, name, threads)
		text = label({"method": name, "threads": threads})
		left.loglog(*zip(*points), "o-" if whole else "o--", color=colour, label=text, markersize=4) \
			if points else None
		memory = [
			(r["faces"], r["memory"] / r["faces"]) for r in results
			if (r["method"], r["threads"]) == (name, threads) and r.get("memory")]
		if memory and whole:
			right.loglog(*zip(*memory), "o-", color=colour, label=text, markersize=4)
	left.set_xlabel("faces")
	left.set_ylabel("seconds")
	right.set_xlabel("faces")
	right.set_ylabel("bytes a face beyond the mesh")
	for axis in (left, right):
		axis.grid(True, which="both", alpha=0.25)
		axis.legend(fontsize=8)
	figure.tight_layout()
	figure.savefig(target)
	plt.close(figure)


# ---------------------------------------------------------------------------------------------

def make_mesh(folder, faces, arguments):
	"""A noisy mesh of about so many faces, and how many it really has."""
	clean, = tools.generated_meshes(folder, ["part"], faces)
	noisy = folder / f"part_{faces}.ply"
	tools.orthopoly(
		"noise", clean, noisy, "--sigma", arguments.sigma, "--direction", arguments.direction,
		"--seed", 1)
	clean.replace(folder / "clean.ply")
	with noisy.open("rb") as file:
		header = file.read(2000)
	return noisy, int(re.search(rb"element face (\d+)", header).group(1))


def run_all(arguments, methods):
	folder = tools.OUT / "speed"
	shutil.rmtree(folder, ignore_errors=True)
	folder.mkdir(parents=True)
	results = []
	for target in arguments.faces:
		mesh, faces = make_mesh(folder, target, arguments)
		for name in methods:
			contender = CONTENDERS[name]
			for threads in arguments.threads if contender.threaded else [1]:
				result = {"method": name, "threads": threads, "faces": faces}
				expected = expected_seconds(done(results, name, threads), faces)
				stopped = any(
					"skipped" in r for r in results if (r["method"], r["threads"]) == (name, threads))
				if expected > arguments.limit or stopped:
					result["skipped"] = "left out: a smaller mesh failed or was left out" if stopped \
						else f"left out: about {expected:.0f} s a run"
				else:
					try:
						result.update(contender.run(contender.argument, mesh, threads, arguments))
						result["faces"] = faces
						result["median"] = statistics.median(result["seconds"])
					except tools.BenchError as error:
						result["skipped"] = f"failed: {error}"
				results.append(result)
				print(
					f"{size(faces)}: {label(result)}: "
					+ (f"{result['median']:.3f} s" if "median" in result else result["skipped"]),
					flush=True)
		mesh.unlink()
	return results


def arguments_of_the_command_line():
	parser = argparse.ArgumentParser(
		description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
	parser.add_argument("--max-faces", type=int, default=4096000, help="default: 4096000")
	parser.add_argument(
		"--faces", metavar="N,...",
		help=f"exactly these sizes instead of {LEAST_FACES} and its doubles")
	parser.add_argument(
		"--methods", default=",".join(METHODS),
		help=f"of {', '.join(CONTENDERS)}; the first is compared with; default: %(default)s")
	parser.add_argument(
		"--threads", default="1,2", help="for what can be told (default: %(default)s)")
	parser.add_argument("--repeats", type=int, default=5, help="timed runs (default: 5)")
	parser.add_argument(
		"--limit", type=float, default=120,
		help="leave out what would take longer, seconds a run (default: 120)")
	parser.add_argument(
		"--budget", type=float, default=300,
		help="no further repeat once they have taken so many seconds (default: 300)")
	parser.add_argument("--sigma", type=float, default=0.3, help="mean edge lengths (default: 0.3)")
	parser.add_argument("--direction", default="normal", help="of the noise (default: normal)")
	arguments = parser.parse_args()
	arguments.threads = [int(word) for word in arguments.threads.split(",")]
	if arguments.repeats < 1 or min(arguments.threads) < 1:
		parser.error("--repeats and --threads have to be 1 or more")
	if arguments.max_faces < LEAST_FACES:
		parser.error(f"--max-faces has to be {LEAST_FACES} or more")
	if arguments.faces:
		arguments.faces = sorted(int(word) for word in arguments.faces.split(","))
		if arguments.faces[0] < 1:
			parser.error("--faces have to be 1 or more")
	else:
		doublings = int(math.log2(arguments.max_faces / LEAST_FACES))
		arguments.faces = [LEAST_FACES << i for i in range(doublings + 1)]
	return arguments


def main():
	if sys.argv[1:2] == ["--meshlab-filter"]:
		name, path, repeats, budget, reference = sys.argv[2:]
		time_meshlab_filter(name, path, int(repeats), float(budget), reference)
		return
	arguments = arguments_of_the_command_line()
	notes, methods = [note for note in [tools.load_note()] if note], []
	for name in arguments.methods.split(","):
		if name not in CONTENDERS:
			raise tools.BenchError(f"there is no method '{name}'; there are {', '.join(CONTENDERS)}")
		package = CONTENDERS[name].package
		reason = tools.DENOISERS[package].missing() if package else None
		if reason:
			notes.append(f"left out: {CONTENDERS[name].title}: {reason}")
			print(notes[-1])
		else:
			methods.append(name)
	if not methods:
		raise tools.BenchError("there is no method to run")

	results = run_all(arguments, methods)
	reference = (
		methods[0], max(arguments.threads) if CONTENDERS[methods[0]].threaded else 1)
	text = "\n".join([
		f"# Speed\n\nCommit {tools.commit()}; {tools.processor()}. The mesh `part`, noise of "
		f"{arguments.sigma:g} mean edge lengths, {arguments.direction}. Median of {arguments.repeats} runs "
		"after one to warm up (MeshDenoiser: processes of their own, by its own clock), fewer where they "
		f"took {arguments.budget:g} s; without reading and writing files. Memory: peak beyond the process "
		"with the mesh loaded. 'Times the first': seconds over those of "
		f"{label({'method': reference[0], 'threads': reference[1]})}.\n"
		+ "".join(f"\n{note}\n" for note in notes),
		results_table(results, reference),
		"## Growth: seconds go with this power of the number of faces\n\n" + growth_table(results),
		"## Threads\n\n" + threads_table(results, arguments.threads),
		"## Steps\n\n" + shares_table(results),
		"## The filter in its host, and what it takes beyond the denoising\n\n"
		+ plugin_table(results),
	])
	(tools.OUT / "speed.json").write_text(
		json.dumps({"commit": tools.commit(), "results": results}, indent=1) + "\n", encoding="utf-8")
	(tools.OUT / "speed.md").write_text(text, encoding="utf-8")
	plot(results, tools.OUT / "speed.png")
	print("\n" + text)
	for ending in ("md", "json", "png"):
		print(tools.OUT / f"speed.{ending}")


if __name__ == "__main__":
	try:
		main()
	except (tools.BenchError, OSError) as error:
		sys.exit(f"speed: {error}")
