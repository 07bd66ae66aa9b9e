#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The paper's method on the models of the paper's Table 2, with Table 2's parameters.

    table2.py FOLDER [--seeds N] [--set NAME=VALUE]... [--build DIR] [--json FILE]

FOLDER holds the clean models cube.ply, fandisk.ply, cad.ply and octaflower.ply. Each gets Table 2's
noise (a Gaussian amplitude along a random direction) N times, is denoised by build/bin/orthopoly and
measured against the clean model. Printed is a Markdown table: median and range over the seeds, beside
what the noisy input measures and what the paper prints. Exit code 1 where a median misses its aim.
"""

import argparse
import json
import pathlib
import statistics
import sys
import tempfile
from dataclasses import dataclass, field

import tools


@dataclass
class Model:
	name: str
	sigma: float            # mean edge lengths
	cos_threshold: float
	increment: float
	iterations: int
	vertex_iterations: int
	printed: tuple          # MSAE x 1e-2, E_v x 1e-3 in Table 2
	aims: dict              # measure -> upper bound, in the same units
	scale: float = 1.0      # of the paper's model over this one
	vertices: int = 0
	runs: list = field(default_factory=list)

	def settings(self):
		return [
			f"cos_threshold={self.cos_threshold}",
			f"cos_threshold_increment={self.increment}",
			f"iterations={self.iterations}",
			f"vertex_iterations={self.vertex_iterations}",
		]


def table2():
	return [
		Model("cube", 0.2, 0.7, 0.05, 6, 20, (0.075, 1.224), {"unfolded": 0.075, "E_v": 1.224}),
		Model("fandisk", 0.4, 0.65, 0.08, 5, 10, (10.349, 5.983), {"MSAE": 12.0, "E_v": 8.0}),
		Model("cad", 0.3, 0.75, 0.05, 5, 10, (0.640, 218.55), {"E_v": 219.0}),
		Model(
			"octaflower", 0.1, 0.85, 0.05, 5, 10, (3.744, 1.781), {"E_v": 2.8}, scale=0.0306),
	]


def in_table_units(model, measures):
	return {
		"MSAE": 100 * measures["msae"],
		"unfolded": 100 * measures["msae_without_folded"],
		"folded": measures["folded_faces"],
		"E_v": 1000 * model.scale * measures["vertex_error"],
		"angle": measures["mean_angle"],
	}


def run_model(program, model, arguments, folder):
	clean = arguments.folder / f"{model.name}.ply"
	for seed in range(1, arguments.seeds + 1):
		noisy, result = folder / "noisy.ply", folder / "result.ply"
		tools.call(
			program, "noise", clean, noisy, "--direction", "random", "--sigma", model.sigma,
			"--seed", seed)
		settings = [word for s in model.settings() + arguments.set for word in ("--set", s)]
		report = json.loads(tools.call(
			program, "denoise", noisy, result, "--method", "paper", "--json",
			"--reference", clean, *settings))
		model.runs.append({
			"seed": seed,
			"seconds": report["seconds"],
			"noisy": in_table_units(model, report["noisy"]),
			"result": in_table_units(model, report["result"]),
		})


def median(model, which, measure):
	return statistics.median(run[which][measure] for run in model.runs)


def spread(model, which, measure, digits):
	return tools.spread([run[which][measure] for run in model.runs], digits)


def print_table(models):
	print("Median (range). MSAE x 1e-2 in radians squared, E_v x 1e-3, mean angle in degrees.\n")
	print("| model | V | noisy MSAE | noisy E_v | MSAE | without folded | folded faces | mean angle"
		  " | E_v | paper's MSAE | paper's E_v | aims |")
	print("|" + "---|" * 12)
	for m in models:
		aims = ", ".join(
			f"{name} <= {bound:g}: {'met' if median(m, 'result', name) <= bound else 'MISSED'}"
			for name, bound in m.aims.items())
		cells = [
			m.name,
			str(m.vertices),
			spread(m, "noisy", "MSAE", 2),
			spread(m, "noisy", "E_v", 2),
			spread(m, "result", "MSAE", 3),
			spread(m, "result", "unfolded", 3),
			spread(m, "result", "folded", 0),
			spread(m, "result", "angle", 2),
			spread(m, "result", "E_v", 3),
			f"{m.printed[0]:g}",
			f"{m.printed[1]:g}",
			aims,
		]
		print("| " + " | ".join(cells) + " |")
	seconds = sum(run["seconds"] for m in models for run in m.runs)
	print(f"\n{sum(len(m.runs) for m in models)} runs, {seconds:.1f} s of denoising.")


def arguments_of_the_command_line():
	parser = argparse.ArgumentParser(
		description="The paper's method on the models of Table 2, with Table 2's parameters.")
	parser.add_argument(
		"folder", type=pathlib.Path, nargs="?",
		help="folder with cube.ply, fandisk.ply, cad.ply and octaflower.ply")
	parser.add_argument("--seeds", type=int, default=5, help="noises a model (default: 5)")
	parser.add_argument(
		"--set", action="append", default=[], metavar="NAME=VALUE",
		help="another parameter for all four models")
	parser.add_argument(
		"--build", type=pathlib.Path, default=tools.BUILD, help="build folder (default: build/)")
	parser.add_argument("--json", type=pathlib.Path, help="write every run to this file too")
	arguments = parser.parse_args()
	if arguments.folder is None:
		parser.error(
			"name the folder with the clean models of Table 2; they are not part of this project")
	missing = [m.name for m in table2() if not (arguments.folder / f"{m.name}.ply").is_file()]
	if missing:
		parser.error(f"{arguments.folder} has no " + ", ".join(f"{name}.ply" for name in missing))
	if arguments.seeds < 1:
		parser.error("--seeds has to be 1 or more")
	return arguments


def main():
	arguments = arguments_of_the_command_line()
	program = tools.program("orthopoly", arguments.build)
	models = table2()
	with tempfile.TemporaryDirectory() as folder:
		for model in models:
			clean = arguments.folder / f"{model.name}.ply"
			model.vertices = json.loads(tools.call(program, "info", clean, "--json"))["vertices"]
			run_model(program, model, arguments, pathlib.Path(folder))
	print_table(models)
	if arguments.json:
		arguments.json.write_text(
			json.dumps({m.name: m.runs for m in models}, indent=2) + "\n", encoding="utf-8")
	missed = any(median(m, "result", name) > bound for m in models for name, bound in m.aims.items())
	return 1 if missed else 0


if __name__ == "__main__":
	try:
		sys.exit(main())
	except (tools.BenchError, OSError) as error:
		sys.exit(f"table2: {error}")
