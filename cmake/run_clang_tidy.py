#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs clang-tidy over vcg_core and filter_orthopoly, each source once, and fails on any finding.

A source is compiled several times in a build (each host, each vcglib); here the newest host of single
precision stands for all. The build folder has to be configured without unity builds, and need not be
built. What was found clean is remembered there until a header, the source, its command or .clang-tidy
changes.
"""

import argparse
import concurrent.futures
import hashlib
import json
import pathlib
import re
import subprocess
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent
ROOMS = ("vcg_core", "filter_orthopoly")


def preference(entry):
	"""Newest host first, single precision before double."""
	version = re.search(r"-DMESHLAB_VERSION=([0-9.]+)(d?)", entry["command"])
	return (version.group(2) == "", version.group(1)) if version else (True, "9999")


def chosen_commands(build):
	best = {}
	for entry in json.loads((build / "compile_commands.json").read_text()):
		source = pathlib.Path(entry["file"])
		if not source.is_relative_to(ROOT) or source.relative_to(ROOT).parts[0] not in ROOMS:
			continue
		if source not in best or preference(entry) > preference(best[source]):
			best[source] = entry
	return best


def digest_of_headers():
	digest = hashlib.sha256((ROOT / ".clang-tidy").read_bytes())
	for room in ROOMS:
		for header in sorted((ROOT / room).rglob("*.h")):
			digest.update(header.read_bytes())
	return digest


def main():
	parser = argparse.ArgumentParser(description=__doc__)
	parser.add_argument("--build", type=pathlib.Path, required=True)
	parser.add_argument("--jobs", type=int, default=2)
	arguments = parser.parse_args()

	commands = chosen_commands(arguments.build)
	if not commands:
		sys.exit("no source of " + " or ".join(ROOMS) + " in compile_commands.json")
	folder = arguments.build / "chosen"
	clean = folder / "clean"
	clean.mkdir(parents=True, exist_ok=True)
	(folder / "compile_commands.json").write_text(json.dumps(list(commands.values()), indent=1))
	headers = digest_of_headers()

	def check(source):
		digest = headers.copy()
		digest.update(commands[source]["command"].encode() + source.read_bytes())
		stamp = clean / digest.hexdigest()
		if stamp.exists():
			stamp.touch()
			return source, 0, "", True
		run = subprocess.run(
			["clang-tidy", "--quiet", "-p", str(folder), str(source)],
			capture_output=True, text=True, check=False)
		if run.returncode == 0:
			stamp.touch()
		return source, run.returncode, run.stdout + (run.stderr if run.returncode else ""), False

	started = time.time()
	failed = known = 0
	with concurrent.futures.ThreadPoolExecutor(arguments.jobs) as pool:
		for source, code, output, was_known in pool.map(check, sorted(commands)):
			known += was_known
			if code != 0:
				failed += 1
				print(output, flush=True)
				print(f"clang-tidy: findings in {source.relative_to(ROOT)}", flush=True)
	for stamp in clean.iterdir():
		if stamp.stat().st_mtime < started - 30 * 24 * 3600:
			stamp.unlink()
	print(f"clang-tidy: {len(commands)} sources, {failed} with findings, "
		f"{known} unchanged since they were found clean")
	return 1 if failed else 0


if __name__ == "__main__":
	sys.exit(main())
