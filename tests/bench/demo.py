#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Noise on a mesh of ours, taken away again by the plugin in a real MeshLab, measured and drawn.

Called by ./run demo, with a display where meshlabserver is to be used. Writes into build/demo the
three meshes, the filter script and a picture.
"""

import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

import pymeshlab
import render
import tools

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "hosts"))
import hosts  # noqa: E402
import mlx  # noqa: E402

SIGMA = 0.3
ERROR_RANGE = 30
OUT = hosts.BUILD / "demo"


def orthopoly(*arguments):
	done = subprocess.run([hosts.COMMAND, *map(str, arguments)], capture_output=True, text=True, check=False)
	if done.returncode != 0:
		sys.exit(f"orthopoly {arguments[0]}: {done.stderr.strip()}")
	return done.stdout


def in_meshlabserver(folder, filter_name, values, out):
	"""Applies a filter to the noisy layer over the reference, by a filter script."""
	script = mlx.write(OUT / f"{out.stem}.mlx", (filter_name, values))
	server = hosts.MeshLabServer(folder, os.environ["DISPLAY"])
	result = server.run_script(folder, script, [OUT / "reference.ply", OUT / "noise.ply"])
	if not result.ok:
		sys.exit(f"meshlabserver failed:\n{result.log}")
	shutil.copy(folder / f"{server.name}.ply", out)
	# What the filter wrote to the log, but for the output values that are for scripts.
	lines = re.findall(r"^LOG: 2 (.*)$", result.log, re.MULTILINE)
	return [line for line in lines if not line.startswith("output values")]


def in_pymeshlab(_, filter_name, values, out):
	"""The same in the Python that runs this; it shows no log, but returns the output values."""
	python_name = next(f["python_name"] for f in mlx.TABLE["filters"] if f["name"] == filter_name)
	meshes = pymeshlab.MeshSet()
	meshes.load_new_mesh(str(OUT / "reference.ply"))
	meshes.load_new_mesh(str(OUT / "noise.ply"))
	outputs = meshes.apply_filter(python_name, reference=0, **values)
	meshes.save_current_mesh(str(out), save_face_color=True, save_face_quality=True)
	return [f"{name} = {value}" for name, value in outputs.items()]


def table(rows):
	"""The measures of orthopoly, one column a mesh."""
	names = list(next(iter(rows.values())))
	width = max(len(name) for name in names)
	print(" " * (width + 3) + "".join(f"{title:>14}" for title in rows))
	for name in names:
		cells = "".join(
			f"{value:>14.5g}" if isinstance(value, (int, float)) and not isinstance(value, bool)
			else f"{str(value):>14}" for value in (row[name] for row in rows.values()))
		print(f"   {name:<{width}}{cells}")


def main():
	shutil.rmtree(OUT, ignore_errors=True)
	OUT.mkdir(parents=True)
	shutil.copy(hosts.BUILD / "meshes" / "part.ply", OUT / "reference.ply")
	orthopoly("noise", OUT / "reference.ply", OUT / "noise.ply", "--sigma", SIGMA,
		"--direction", "random", "--seed", 1)
	print(f"   build/meshes/part.ply with noise of {SIGMA} mean edge lengths in random directions")

	legacy = (hosts.BUILD / "plugins" / "meshlab-2020.09").is_dir() and shutil.which("meshlabserver")
	apply = in_meshlabserver if legacy and os.environ.get("DISPLAY") else in_pymeshlab
	if apply is in_pymeshlab:
		pymeshlab.load_plugin(str(tools.newest_plugin()))
	with tempfile.TemporaryDirectory() as folder:
		apply(pathlib.Path(folder), mlx.ERROR, {"max_angle": ERROR_RANGE}, OUT / "noisy.ply")
	with tempfile.TemporaryDirectory() as folder:
		said = apply(
			pathlib.Path(folder), mlx.DENOISE,
			{"compare_with_reference": True, "max_angle": ERROR_RANGE}, OUT / "denoised.ply")
	host = "meshlabserver 2020.09" if apply is in_meshlabserver else "pymeshlab"
	print(f"\n   {mlx.DENOISE} in {host} says:")
	for line in said:
		print(f"     {line}")

	print("\n   measured by orthopoly measure:")
	table({
		name: json.loads(orthopoly("measure", "--json", OUT / "reference.ply", OUT / f"{name}.ply"))
		for name in ("noisy", "denoised")
	})

	# The noisy and the denoised mesh without colours, then what is left of the error.
	meshes = [
		render.Mesh(OUT / "noise.ply", "noisy"),
		render.Mesh(OUT / "denoised.ply", "denoised"),
		render.Mesh(OUT / "noisy.ply", "noisy, error"),
		render.Mesh(OUT / "denoised.ply", "denoised, error"),
	]
	meshes[0].colours = meshes[1].colours = None
	render.render(OUT / "demo.png", meshes, ERROR_RANGE)
	print(f"\n   {OUT / 'denoised.ply'}\n   {OUT / 'demo.png'}")


if __name__ == "__main__":
	main()
