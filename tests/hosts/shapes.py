# SPDX-License-Identifier: GPL-3.0-or-later
"""Small meshes made on the spot, the same on every run."""

import numpy as np


def cube(cells=12):
    """A closed cube of side 2 with cells x cells squares a side: positions #V x 3, faces #F x 3."""
    numbers, positions, faces = {}, [], []

    def vertex(point):
        if point not in numbers:
            numbers[point] = len(positions)
            positions.append([2 * c / cells - 1 for c in point])
        return numbers[point]

    for axis in range(3):
        u, v = (axis + 1) % 3, (axis + 2) % 3
        for side in (0, cells):
            for i in range(cells):
                for j in range(cells):
                    corners = []
                    for di, dj in ((0, 0), (1, 0), (1, 1), (0, 1)):
                        point = [0, 0, 0]
                        point[axis], point[u], point[v] = side, i + di, j + dj
                        corners.append(vertex(tuple(point)))
                    if side == 0:
                        corners.reverse()
                    a, b, c, d = corners
                    faces += [[a, b, c], [a, c, d]]
    return np.array(positions), np.array(faces)


def with_noise(positions, sigma, seed=7):
    """Every vertex moved along a random direction; sigma in the mesh's own unit."""
    generator = np.random.Generator(np.random.PCG64(seed))
    directions = generator.normal(size=positions.shape)
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    return positions + directions * generator.normal(0, sigma, size=(len(positions), 1))


def normals(positions, faces):
    a, b, c = (positions[faces[:, k]].astype(float) for k in range(3))
    cross = np.cross(b - a, c - a)
    return cross / np.linalg.norm(cross, axis=1, keepdims=True)
