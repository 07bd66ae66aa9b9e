# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads and writes PLY files of triangles with numpy: what the tests need and no more."""

from dataclasses import dataclass

import numpy as np

TYPES = {
    "char": "i1", "int8": "i1", "uchar": "u1", "uint8": "u1",
    "short": "<i2", "int16": "<i2", "ushort": "<u2", "uint16": "<u2",
    "int": "<i4", "int32": "<i4", "uint": "<u4", "uint32": "<u4",
    "float": "<f4", "float32": "<f4", "double": "<f8", "float64": "<f8",
}


@dataclass
class Mesh:
    """Positions #V x 3 in the file's own precision, faces #F x 3, and what else there is or None."""

    positions: np.ndarray
    faces: np.ndarray
    face_colors: np.ndarray = None
    face_quality: np.ndarray = None
    vertex_quality: np.ndarray = None

    @property
    def diagonal(self):
        return float(np.linalg.norm(np.ptp(self.positions.astype(float), axis=0)))


def write(path, positions, faces, dtype="<f4"):
    """Writes a binary PLY; faces may be an array #F x 3 or a list of polygons."""
    positions = np.asarray(positions, dtype=dtype)
    name = {"<f4": "float", "<f8": "double"}[dtype]
    header = (
        "ply\nformat binary_little_endian 1.0\n"
        f"element vertex {len(positions)}\n"
        f"property {name} x\nproperty {name} y\nproperty {name} z\n"
        f"element face {len(faces)}\nproperty list uchar int vertex_indices\nend_header\n"
    )
    with open(path, "wb") as file:
        file.write(header.encode("ascii"))
        file.write(positions.tobytes())
        for face in faces:
            file.write(np.uint8(len(face)).tobytes() + np.asarray(face, "<i4").tobytes())
    return path


def read(path):
    """Reads a PLY of triangles, binary or ASCII."""
    with open(path, "rb") as file:
        lines = []
        while not lines or lines[-1] != "end_header":
            lines.append(file.readline().decode("ascii").strip())
        body = file.read()
    binary = "format binary_little_endian 1.0" in lines
    if not binary and "format ascii 1.0" not in lines:
        raise ValueError(f"{path}: {lines[1]} is not read here")
    elements = []
    for line in lines:
        words = line.split()
        if words[0] == "element":
            elements.append((words[1], int(words[2]), []))
        elif words[0] == "property" and words[1] == "list":
            elements[-1][2].append((words[4], [("count", TYPES[words[2]]), ("values", TYPES[words[3]], 3)]))
        elif words[0] == "property":
            elements[-1][2].append((words[2], TYPES[words[1]]))
    tables = {}
    words = None if binary else iter(body.split())
    for name, count, fields in elements:
        kind = np.dtype([(field, np.dtype(t) if isinstance(t, list) else t) for field, t in fields])
        if binary:
            tables[name] = np.frombuffer(body[: count * kind.itemsize], kind)
            body = body[count * kind.itemsize :]
        else:
            tables[name] = np.array([_row(words, fields) for _ in range(count)], kind)
    vertex, face = tables["vertex"], tables["face"]
    indices = next(n for n in face.dtype.names if n.startswith("vertex_ind"))
    if len(face) and not (face[indices]["count"] == 3).all():
        raise ValueError(f"{path} has polygons that are no triangles")
    mesh = Mesh(
        np.stack([vertex[axis] for axis in "xyz"], axis=1),
        face[indices]["values"].reshape(-1, 3).copy(),
    )
    if "red" in face.dtype.names:
        mesh.face_colors = np.stack([face[c] for c in ("red", "green", "blue")], axis=1)
    if "quality" in face.dtype.names:
        mesh.face_quality = face["quality"].copy()
    if "quality" in vertex.dtype.names:
        mesh.vertex_quality = vertex["quality"].copy()
    return mesh


def _row(words, fields):
    row = []
    for _, kind in fields:
        if isinstance(kind, list):
            count = int(next(words))
            row.append((count, [int(next(words)) for _ in range(count)]))
        else:
            row.append(float(next(words)))
    return tuple(row)
