#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures of meshes beside each other, drawn without a display or a graphics card.

    render.py OUT.png MESH[:TITLE]... [--error-range DEG] [--view AZIMUTH,ELEVATION]

All meshes are seen from the same side at the same scale, flat shaded, so that a face that stands
out is seen to. A mesh with face colours keeps them. With --error-range a bar tells how many degrees
of angular error a colour means: DEG has to be the colour range that the filter was given.
"""

import argparse
import pathlib
import sys

import matplotlib
import numpy as np
import pymeshlab

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
from matplotlib.colors import LinearSegmentedColormap, Normalize  # noqa: E402

# The colours of the filters' error maps, from no error to the end of their range.
ERROR_COLOURS = LinearSegmentedColormap.from_list(
	"angular error", [(0, 0, 1), (0, 1, 1), (0, 1, 0), (1, 1, 0), (1, 0, 0)])
PLAIN = np.array([0.80, 0.81, 0.84])
OVERSAMPLING = 2


class Mesh:
	def __init__(self, path, title):
		meshes = pymeshlab.MeshSet()
		meshes.load_new_mesh(str(path))
		mesh = meshes.current_mesh()
		self.title = title
		self.vertices = np.asarray(mesh.vertex_matrix(), dtype=float)
		self.faces = np.asarray(mesh.face_matrix(), dtype=int)
		self.colours = None
		if mesh.has_face_color():
			self.colours = np.asarray(mesh.face_color_matrix(), dtype=float)[:, :3]


def rotation(azimuth, elevation):
	"""World to camera: x to the right, y up, z towards the eye."""
	a, e = np.radians([azimuth, elevation])
	around = np.array([[np.cos(a), np.sin(a), 0], [-np.sin(a), np.cos(a), 0], [0, 0, 1]])
	up = np.array([[1, 0, 0], [0, np.sin(e), np.cos(e)], [0, -np.cos(e), np.sin(e)]])
	return up @ around


def draw(mesh, turn, centre, scale, size):
	"""A size x size x 3 picture, by a depth buffer and one pass over the faces."""
	points = (mesh.vertices - centre) @ turn.T
	corners = points[mesh.faces]
	normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
	lengths = np.linalg.norm(normals, axis=1)
	seen = lengths > 0
	normals[seen] /= lengths[seen, None]
	# A face seen from behind is drawn too, darker: a folded one has to show.
	light = np.array([-0.35, 0.45, 0.82]) / np.linalg.norm([-0.35, 0.45, 0.82])
	lit = normals @ light
	behind = normals[:, 2] < 0
	shade = 0.30 + 0.70 * np.clip(np.where(behind, 0.35 * np.abs(lit), lit), 0, 1)
	colours = mesh.colours if mesh.colours is not None else np.tile(PLAIN, (len(mesh.faces), 1))
	shaded = np.clip(colours * shade[:, None], 0, 1)

	picture = np.ones((size, size, 3))
	depth = np.full((size, size), -np.inf)
	xy = corners[:, :, :2] * scale * [1, -1] + size / 2
	low = np.maximum(np.floor(xy.min(axis=1)).astype(int), 0)
	high = np.minimum(np.ceil(xy.max(axis=1)).astype(int) + 1, size)
	a, b, c = xy[:, 0], xy[:, 1], xy[:, 2]
	area = (b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) - (b[:, 1] - a[:, 1]) * (c[:, 0] - a[:, 0])
	for face in np.flatnonzero(seen & (area != 0) & (low < high).all(axis=1)):
		x = np.arange(low[face, 0], high[face, 0]) + 0.5
		y = np.arange(low[face, 1], high[face, 1])[:, None] + 0.5
		(ax, ay), (bx, by), (cx, cy) = xy[face]
		v = ((x - ax) * (cy - ay) - (y - ay) * (cx - ax)) / area[face]
		w = ((bx - ax) * (y - ay) - (by - ay) * (x - ax)) / area[face]
		u = 1 - v - w
		z = u * corners[face, 0, 2] + v * corners[face, 1, 2] + w * corners[face, 2, 2]
		window = np.s_[low[face, 1] : high[face, 1], low[face, 0] : high[face, 0]]
		nearer = (u >= 0) & (v >= 0) & (w >= 0) & (z > depth[window])
		depth[window][nearer] = z[nearer]
		picture[window][nearer] = shaded[face]
	shape = (size // OVERSAMPLING, OVERSAMPLING, size // OVERSAMPLING, OVERSAMPLING, 3)
	return picture.reshape(shape).mean(axis=(1, 3))


def render(out, meshes, error_range=None, view=(-50.0, 25.0), pixels=640):
	"""Writes the picture of the meshes (a list of Mesh) to the file `out`."""
	turn = rotation(*view)
	low = np.min([(m.vertices @ turn.T).min(axis=0) for m in meshes], axis=0)
	high = np.max([(m.vertices @ turn.T).max(axis=0) for m in meshes], axis=0)
	centre = turn.T @ ((low + high) / 2)
	size = pixels * OVERSAMPLING
	scale = 0.96 * size / max((high - low)[:2].max(), 1e-300)

	figure, axes = plt.subplots(
		1, len(meshes), figsize=(4 * len(meshes), 4.3 if error_range is None else 4.8),
		dpi=pixels / 4, squeeze=False)
	top = 0.93
	bottom = 0.01 if error_range is None else 0.12
	figure.subplots_adjust(left=0.01, right=0.99, top=top, bottom=bottom, wspace=0.02)
	for axis, mesh in zip(axes[0], meshes):
		axis.imshow(draw(mesh, turn, centre, scale, size))
		axis.set_title(mesh.title, fontsize=11)
		axis.axis("off")
	if error_range is not None:
		bar = figure.add_axes([0.3, 0.075, 0.4, 0.025])
		mappable = plt.cm.ScalarMappable(Normalize(0, error_range), ERROR_COLOURS)
		figure.colorbar(mappable, cax=bar, orientation="horizontal")
		bar.set_title("angular error, degrees", fontsize=9, pad=3)
		bar.tick_params(labelsize=8)
	figure.savefig(out)
	plt.close(figure)


def main():
	parser = argparse.ArgumentParser(
		description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
	parser.add_argument("out", type=pathlib.Path)
	parser.add_argument("meshes", nargs="+", metavar="MESH[:TITLE]")
	parser.add_argument("--error-range", type=float, metavar="DEG")
	parser.add_argument("--view", default="-50,25", metavar="AZIMUTH,ELEVATION")
	arguments = parser.parse_args()
	meshes = []
	for argument in arguments.meshes:
		path, _, title = argument.partition(":")
		meshes.append(Mesh(path, title or pathlib.Path(path).stem))
	view = tuple(float(angle) for angle in arguments.view.split(","))
	render(arguments.out, meshes, arguments.error_range, view)


if __name__ == "__main__":
	main()
