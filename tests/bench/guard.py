#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""This build against another commit's: time, memory and results, on meshes doubling in size.

    guard.py BASE [--max-faces N] [--repeats N] [--tolerance PERCENT]

Builds BASE (a commit, branch or tag) in a worktree under build/guard with the compiler and vcglib of this
build. The two run in turn, so that what slows the machine slows both; compared are the least seconds of
each and the peaks of the whole process. Exit code 1 where this build is slower or larger than BASE by
more than the tolerance. To be run by hand before a merge, on a machine with nothing else to do.

Writes guard.json and guard.md into build/bench.
"""

import argparse
import hashlib
import json
import os
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import tools

LEAST_FACES = 16000
METHODS = ["adaptive", "paper"]
# Below these differences are noise of the measurement itself.
LEAST_SECONDS = 0.05
LEAST_BYTES = 4 * 2**20


def git(*arguments):
	return tools.call("git", "-C", tools.ROOT, *arguments).strip()


def cached(name):
	"""A variable of this build's CMake cache."""
	cache = (tools.BUILD / "CMakeCache.txt").read_text(encoding="utf-8")
	match = re.search(rf"^{name}:[^=]*=(.*)$", cache, re.MULTILINE)
	return match.group(1) if match else ""


def vcglib():
	"""The vcglib of this build's command; where the build chose it, from what it compiled with."""
	if cached("VCGLIB_DIR"):
		return cached("VCGLIB_DIR")
	commands = json.loads((tools.BUILD / "compile_commands.json").read_text(encoding="utf-8"))
	for entry in commands:
		if entry["file"].endswith("vcg_core/mesh_io.cpp") and "orthopoly_vcg.dir" in entry["command"]:
			words = shlex.split(entry["command"])
			for option, folder in zip(words, words[1:]):
				if option == "-isystem" and "vcglib" in folder:
					return folder
	raise tools.BenchError(f"{tools.BUILD} does not say which vcglib it was built with")


def build_base(commit):
	"""The folder that the commit is built in; kept, so that a second comparison starts at once."""
	folder = tools.BUILD / "guard" / commit[:12]
	source, build = folder / "source", folder / "build"
	if not (source / "CMakeLists.txt").is_file():
		shutil.rmtree(source, ignore_errors=True)
		folder.mkdir(parents=True, exist_ok=True)
		git("worktree", "prune")
		git("worktree", "add", "--detach", source, commit)
	options = [
		"-G", "Ninja", f"-DVCGLIB_DIR={vcglib()}", "-DBUILD_TESTING=OFF", "-DORTHOPOLY_WERROR=OFF",
		f"-DCMAKE_BUILD_TYPE={cached('CMAKE_BUILD_TYPE') or 'Release'}",
		f"-DCMAKE_CXX_COMPILER={cached('CMAKE_CXX_COMPILER')}"]
	launcher = cached("CMAKE_CXX_COMPILER_LAUNCHER")
	if launcher:
		options.append(f"-DCMAKE_CXX_COMPILER_LAUNCHER={launcher}")
	print(f"Building {commit[:12]} in {build}", flush=True)
	try:
		tools.call("cmake", "-S", source, "-B", build, *options)
		tools.call("ninja", "-C", build, "orthopoly")
	except tools.BenchError as error:
		raise tools.BenchError(f"{commit[:12]} cannot be built: {error}") from error
	return build


def run_once(program, method, noisy, result, threads):
	"""Seconds of the denoising, peak of the process in bytes, and a hash of the result."""
	with tempfile.TemporaryFile() as out, tempfile.TemporaryFile() as errors:
		process = subprocess.Popen(
			[program, "denoise", noisy, result, "--method", method, "--json", "--threads",
			 str(threads)], stdout=out, stderr=errors)
		_, status, usage = os.wait4(process.pid, 0)
		process.returncode = os.waitstatus_to_exitcode(status)
		if process.returncode != 0:
			errors.seek(0)
			raise tools.BenchError(
				f"{program}: {errors.read().decode(errors='replace').strip() or 'failed'}")
		out.seek(0)
		seconds = json.load(out)["seconds"]
	# Kibibytes on Linux.
	return seconds, 1024 * usage.ru_maxrss, hashlib.sha256(result.read_bytes()).hexdigest()


def compare(programs, method, noisy, folder, arguments):
	"""{"base": ..., "this": ...} of one method on one mesh; they take turns."""
	runs = {name: [] for name in programs}
	# The first of each warms the file cache up and is not counted.
	for repeat in range(arguments.repeats + 1):
		for name, program in programs.items():
			run = run_once(program, method, noisy, folder / "result.ply", arguments.threads)
			if repeat > 0 or arguments.repeats == 0:
				runs[name].append(run)
	return {
		name: {
			"seconds": min(run[0] for run in of),
			"all_seconds": [run[0] for run in of],
			"memory": min(run[1] for run in of),
			"result": of[0][2],
		} for name, of in runs.items()
	}


def verdict(row, tolerance):
	base, this = row["base"], row["this"]
	worse = []
	if this["seconds"] > base["seconds"] * (1 + tolerance) + LEAST_SECONDS:
		worse.append("SLOWER")
	if this["memory"] > base["memory"] * (1 + tolerance) + LEAST_BYTES:
		worse.append("LARGER")
	return " and ".join(worse)


def report(rows, arguments, commit):
	table = tools.table(
		["method", "faces", "seconds before", "now", "ratio", "MiB before", "now", "ratio", "result", ""],
		[[
			row["method"], row["faces"],
			tools.number(row["base"]["seconds"], 3), tools.number(row["this"]["seconds"], 3),
			tools.number(row["this"]["seconds"] / row["base"]["seconds"], 2),
			tools.number(row["base"]["memory"] / 2**20, 0),
			tools.number(row["this"]["memory"] / 2**20, 0),
			tools.number(row["this"]["memory"] / row["base"]["memory"], 2),
			"same bits" if row["base"]["result"] == row["this"]["result"] else "differs",
			row["verdict"],
		] for row in rows])
	note = tools.load_note()
	return (
		f"# {tools.commit()} against {commit[:12]}\n\n{tools.processor()}. The mesh `part`, noise of "
		f"{arguments.sigma:g} mean edge lengths along the normals. The least of {arguments.repeats} runs "
		f"each, taken in turns; memory of the whole process. Tolerance {arguments.tolerance:g} %."
		+ (f" {note}" if note else "") + f"\n\n{table}")


def main():
	parser = argparse.ArgumentParser(
		description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
	parser.add_argument("base", metavar="BASE")
	parser.add_argument("--max-faces", type=int, default=1024000, help="default: 1024000")
	parser.add_argument("--methods", default=",".join(METHODS), help="default: %(default)s")
	parser.add_argument("--repeats", type=int, default=5, help="runs that count (default: 5)")
	parser.add_argument("--threads", type=int, default=0, help="0: one per processor (default)")
	parser.add_argument("--sigma", type=float, default=0.3, help="mean edge lengths (default: 0.3)")
	parser.add_argument(
		"--tolerance", type=float, default=10, metavar="PERCENT", help="default: 10")
	arguments = parser.parse_args()
	if arguments.repeats < 1 or arguments.max_faces < LEAST_FACES:
		parser.error(f"--repeats has to be 1 or more, --max-faces {LEAST_FACES} or more")
	try:
		commit = git("rev-parse", "--verify", f"{arguments.base}^{{commit}}")
	except tools.BenchError as error:
		raise tools.BenchError(f"there is no commit '{arguments.base}'") from error

	programs = {
		"base": tools.program("orthopoly", build_base(commit)), "this": tools.program("orthopoly")}
	rows = []
	with tempfile.TemporaryDirectory() as name:
		folder = Path(name)
		faces = LEAST_FACES
		while faces <= arguments.max_faces:
			clean, = tools.generated_meshes(folder, ["part"], faces)
			noisy = folder / "noisy.ply"
			tools.orthopoly("noise", clean, noisy, "--sigma", arguments.sigma, "--direction", "normal")
			for method in arguments.methods.split(","):
				row = {"method": method, "faces": faces}
				row.update(compare(programs, method, noisy, folder, arguments))
				row["verdict"] = verdict(row, arguments.tolerance / 100)
				rows.append(row)
				print(
					f"{faces} faces, {method}: {row['base']['seconds']:.3f} s before, "
					f"{row['this']['seconds']:.3f} s now {row['verdict']}", flush=True)
			faces *= 2
	text = report(rows, arguments, commit)
	tools.OUT.mkdir(parents=True, exist_ok=True)
	(tools.OUT / "guard.json").write_text(
		json.dumps({"base": commit, "this": tools.commit(), "rows": rows}, indent=1) + "\n",
		encoding="utf-8")
	(tools.OUT / "guard.md").write_text(text, encoding="utf-8")
	print("\n" + text)
	return 1 if any(row["verdict"] for row in rows) else 0


if __name__ == "__main__":
	try:
		sys.exit(main())
	except (tools.BenchError, OSError) as error:
		sys.exit(f"guard: {error}")
