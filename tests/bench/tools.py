# SPDX-License-Identifier: GPL-3.0-or-later
"""What the benchmarks share: the denoisers they compare, and Markdown tables.

Every denoiser runs with one setting for all meshes. Seconds are those of the denoising alone, without
reading and writing files.
"""

import json
import os
import pathlib
import re
import shutil
import statistics
import subprocess
import tarfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
BUILD = pathlib.Path(os.environ.get("ORTHOPOLY_BUILD_DIR", ROOT / "build")).resolve()
OUT = BUILD / "bench"


class BenchError(Exception):
	"""Something that one case, or the whole benchmark, cannot do without."""


def program(name, folder=None):
	path = (folder or BUILD) / "bin" / name
	if not path.is_file():
		raise BenchError(f"{path} is not there: build it first (./run build)")
	return path


def call(*command, **options):
	"""The standard output of a command."""
	done = subprocess.run(
		[str(word) for word in command], capture_output=True, text=True, check=False, **options)
	if done.returncode != 0:
		said = (done.stderr.strip() or done.stdout.strip()).splitlines()
		raise BenchError(said[-1] if said else f"{command[0]} ended with code {done.returncode}")
	return done.stdout


def orthopoly(*arguments):
	return call(program("orthopoly"), *arguments)


def newest_plugin():
	"""That of the newest pymeshlab which one was built for: 2025.10 comes after 2025.7."""
	plugins = (BUILD / "plugins").glob("pymeshlab-*/libfilter_orthopoly.so")
	return max(plugins, key=lambda path: [int(word) for word in re.findall(r"\d+", path.parent.name)])


def measure(reference, result):
	return json.loads(orthopoly("measure", "--json", reference, result))


# ---------------------------------------------------------------------------------------------
# Denoisers

# The options that its usual comparisons are made with; the rest are the program's defaults.
MESH_DENOISER_OPTIONS = """\
OuterIterations 5
Lambda 2
Eta 1.5
Mu 1.5
Nu 0.3
MeshUpdateClosenessWeight 0.001
MeshUpdateIterations 20
"""


class Orthopoly:
	def __init__(self, title, *arguments):
		self.title = title
		self.arguments = arguments

	def missing(self):
		return None

	def denoise(self, noisy, result):
		"""Seconds, and what there is to say about the run."""
		report = json.loads(orthopoly("denoise", noisy, result, "--json", *self.arguments))
		report.pop("input", None)
		return report.pop("seconds"), report


class MeshDenoiser:
	"""Static/dynamic filtering (Zhang et al. 2018), of Debian's meshsdfilter-tools."""

	title = "MeshDenoiser"

	def missing(self):
		if shutil.which("MeshDenoiser"):
			return None
		return "there is no MeshDenoiser here (Debian package meshsdfilter-tools)"

	@staticmethod
	def write_options():
		OUT.mkdir(parents=True, exist_ok=True)
		options = OUT / "mesh_denoiser_options.txt"
		if not options.is_file() or options.read_text(encoding="utf-8") != MESH_DENOISER_OPTIONS:
			options.write_text(MESH_DENOISER_OPTIONS, encoding="utf-8")
		return options

	def denoise(self, noisy, result):
		result.unlink(missing_ok=True)
		log = call("MeshDenoiser", self.write_options(), noisy, result)
		timing = re.search(r"Denoising completed, timing: ([\d.e+-]+)", log)
		if not timing or not result.is_file():
			raise BenchError("MeshDenoiser gave up on it")
		return float(timing.group(1)), {}


class MeshLabFilter:
	"""A filter of MeshLab with its own defaults, through pymeshlab."""

	def __init__(self, title, name):
		self.title = title
		self.name = name

	def missing(self):
		try:
			import pymeshlab  # noqa: F401
		except ImportError:
			return "there is no pymeshlab in this Python"
		return None

	def denoise(self, noisy, result):
		# A process of its own: a crash in a filter takes no benchmark with it.
		import sys

		report = json.loads(call(sys.executable, __file__, self.name, noisy, result).splitlines()[-1])
		return report["seconds"], {}


DENOISERS = {
	"adaptive": Orthopoly("adaptive", "--method", "adaptive"),
	"paper": Orthopoly("paper's method", "--method", "paper"),
	"scanner": Orthopoly("adaptive, scanner", "--method", "adaptive", "--set", "noise_type=scanner"),
	"meshdenoiser": MeshDenoiser(),
	"taubin": MeshLabFilter("MeshLab Taubin", "apply_coord_taubin_smoothing"),
	"twostep": MeshLabFilter("MeshLab Two Step", "apply_coord_two_steps_smoothing"),
}


def usable(names, say):
	"""Those of the denoisers that are there; the others are named with the reason."""
	there = []
	for name in names:
		if name not in DENOISERS:
			raise BenchError(f"there is no method '{name}'; there are {', '.join(DENOISERS)}")
		reason = DENOISERS[name].missing()
		if reason:
			say(f"left out: {DENOISERS[name].title}: {reason}")
		else:
			there.append(name)
	return there


# ---------------------------------------------------------------------------------------------
# Meshes

def cgal_meshes(names):
	"""Triangle meshes out of Debian's libcgal-demo, fetched once; a list of OFF files."""
	folder = OUT / "libcgal-demo"
	if not (folder / "complete").is_file():
		if not shutil.which("apt-get") or not shutil.which("dpkg-deb"):
			raise BenchError("libcgal-demo is a Debian package, and this is no Debian system")
		shutil.rmtree(folder, ignore_errors=True)
		folder.mkdir(parents=True)
		call("apt-get", "-q", "download", "libcgal-demo", cwd=folder)
		package = next(folder.glob("libcgal-demo_*.deb"))
		call("dpkg-deb", "-x", package, folder / "package")
		archive = next((folder / "package").rglob("data.tar.gz"))
		with tarfile.open(archive) as data:
			for member in data.getmembers():
				if member.isfile() and member.name.endswith(".off"):
					target = folder / pathlib.PurePosixPath(member.name).name
					if not target.exists():
						target.write_bytes(data.extractfile(member).read())
		shutil.rmtree(folder / "package")
		package.unlink()
		(folder / "complete").touch()
	return [folder / f"{name}.off" for name in names if (folder / f"{name}.off").is_file()]


def generated_meshes(folder, names, faces=0):
	"""Meshes of our own; one of a given size is in a folder of that size."""
	command = [program("generate_meshes"), "--out", folder]
	if faces:
		command += ["--size", faces]
	call(*command, *names)
	return [folder / f"{name}.ply" for name in names]


# ---------------------------------------------------------------------------------------------
# Tables

def number(value, digits):
	"""Rounded to so many decimals, or as a format says; empty for none."""
	if value is None:
		return ""
	return format(value, digits if isinstance(digits, str) else f".{digits}f")


def spread(values, digits):
	"""Median, with the range behind it where there is more than one value."""
	values = [value for value in values if value is not None]
	if not values:
		return ""
	middle = number(statistics.median(values), digits)
	if len(values) == 1:
		return middle
	return f"{middle} ({number(min(values), digits)}-{number(max(values), digits)})"


def table(head, rows):
	lines = ["| " + " | ".join(head) + " |", "|" + "---|" * len(head)]
	lines += ["| " + " | ".join(str(cell) for cell in row) + " |" for row in rows]
	return "\n".join(lines) + "\n"


def processor():
	try:
		text = pathlib.Path("/proc/cpuinfo").read_text(encoding="utf-8")
		name = re.search(r"model name\s*:\s*(.*)", text).group(1)
	except (OSError, AttributeError):
		name = "unknown processor"
	return f"{name}, {os.cpu_count()} processors"


def load_note():
	"""A word where something else is keeping the processors busy; empty where nothing is."""
	load = os.getloadavg()[0]
	if load < 0.7:
		return ""
	return f"Other work was going on at the start (load average {load:.1f}): the seconds are too long."


def commit():
	try:
		text = call("git", "-C", ROOT, "describe", "--always", "--dirty")
	except (BenchError, OSError):
		return "unknown"
	return text.strip()


def run_meshlab_filter(name, noisy, result):
	import time

	import pymeshlab

	meshes = pymeshlab.MeshSet()
	meshes.load_new_mesh(noisy)
	start = time.perf_counter()
	meshes.apply_filter(name)
	seconds = time.perf_counter() - start
	# Doubles, and no quality, colours or normals.
	meshes.save_current_mesh(
		result, save_vertex_quality=False, save_vertex_color=False, save_vertex_normal=False,
		save_face_color=False)
	print(json.dumps({"seconds": seconds}))


if __name__ == "__main__":
	import sys

	run_meshlab_filter(*sys.argv[1:])
