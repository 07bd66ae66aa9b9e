# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs in a pymeshlab's own Python: reads a job as JSON from standard input, does its steps on one
document, writes what came of each as JSON to the file named last and the current layer beside it."""

import json
import pathlib
import sys

import numpy as np
import pymeshlab

Percentage = getattr(pymeshlab, "PercentageValue", None) or pymeshlab.Percentage
Absolute = getattr(pymeshlab, "PureValue", None) or pymeshlab.AbsoluteValue


def value(given):
    """Arguments that JSON has no word for come as {"percentage": 5} and the like."""
    if isinstance(given, dict):
        ((kind, number),) = given.items()
        return {"percentage": Percentage, "absolute": Absolute, "float": float}[kind](number)
    return given


def arrays(mesh):
    result = {"positions": mesh.vertex_matrix(), "faces": mesh.face_matrix()}
    for name, method in {
        "vertex_quality": "vertex_scalar_array",
        "face_quality": "face_scalar_array",
        "face_colors": "face_color_matrix",
        "vertex_normals": "vertex_normal_matrix",
    }.items():
        try:
            result[name] = getattr(mesh, method)()
        except pymeshlab.MissingComponentException:
            pass
    return result


def run(step, meshes):
    kind = step["do"]
    if kind == "load":
        meshes.load_new_mesh(step["path"])
    elif kind == "add":
        data = np.load(step["path"])
        meshes.add_mesh(pymeshlab.Mesh(data["positions"], data["faces"]) if len(data["faces"])
                        else pymeshlab.Mesh(data["positions"]))
    elif kind == "add_polygons":
        data = json.loads(pathlib.Path(step["path"]).read_text())
        meshes.add_mesh(pymeshlab.Mesh(
            vertex_matrix=np.array(data["positions"], dtype=float),
            face_list_of_indices=[np.array(face, dtype=np.uint32) for face in data["faces"]]))
    elif kind == "current":
        meshes.set_current_mesh(step["id"])
    elif kind == "script":
        meshes.load_filter_script(step["path"])
        return meshes.apply_filter_script()
    elif kind == "filter":
        arguments = {name: value(given) for name, given in step.get("arguments", {}).items()}
        return meshes.apply_filter(step["name"], **arguments)
    elif kind == "method":
        # Methods bound to the class exist for plugins that were there at the import.
        return getattr(meshes, step["name"])(**step.get("arguments", {}))
    elif kind == "save":
        np.savez(step["path"], **arrays(meshes.current_mesh()))
    elif kind == "save_script":
        meshes.save_filter_script(step["path"])
    else:
        raise ValueError(kind)
    return None


def main():
    job = json.load(sys.stdin)
    pymeshlab.load_plugin(job["plugin"])
    meshes = pymeshlab.MeshSet(verbose=True)
    results = []
    for step in job["steps"]:
        try:
            outputs = run(step, meshes)
            results.append({"ok": True, "outputs": outputs if isinstance(outputs, dict) else {}})
        except Exception as error:  # the message is what the tests look at
            results.append({"ok": False, "error": str(error), "type": type(error).__name__})
    pathlib.Path(sys.argv[1]).write_text(json.dumps(results))


main()
