# SPDX-License-Identifier: GPL-3.0-or-later
"""MeshLab filter scripts, written from the frozen table of parameters."""

import json
import pathlib
from xml.sax.saxutils import quoteattr

TABLE = json.loads((pathlib.Path(__file__).parent / "frozen_table.json").read_text())

DENOISE = "Orthogonal Polynomial Denoising"
ERROR = "Angular Error from Reference Mesh"
NOISE = "Gaussian Noise"

# Filters of MeshLab itself that the tests need. The same names and types in all versions.
SELECT = "Conditional Face Selection"
TRIANGULATE = "Turn into a Pure-Triangular mesh"
OTHERS = {
    TRIANGULATE: [],
    SELECT: [
        {"name": "condSelect", "type": "RichString", "default": "(q < 0)"},
    ],
    "Select None": [
        {"name": "allFaces", "type": "RichBool", "default": True},
        {"name": "allVerts", "type": "RichBool", "default": True},
    ],
}


def parameters_of(filter_name):
    for entry in TABLE["filters"]:
        if entry["name"] == filter_name:
            return entry["parameters"]
    return OTHERS[filter_name]


def _parameter(parameter, value):
    attributes = {"name": parameter["name"], "type": parameter["type"]}
    if parameter["type"] == "RichEnum":
        choices = parameter["choices"]
        value = choices.index(value) if value in choices else value
        attributes["enum_cardinality"] = len(choices)
        attributes.update({f"enum_val{i}": choice for i, choice in enumerate(choices)})
    if parameter["type"] == "RichAbsPerc":
        attributes.update(min=0, max=1)
    attributes["value"] = str(value).lower() if isinstance(value, bool) else value
    return "  <Param " + " ".join(f"{k}={quoteattr(str(v))}" for k, v in attributes.items()) + "/>\n"


def write(path, *steps):
    """Writes a script of (filter name, {parameter: value}) steps; every parameter is listed, as
    MeshLab 2020.09 insists on it."""
    text = "<!DOCTYPE FilterScript>\n<FilterScript>\n"
    for name, values in steps:
        parameters = parameters_of(name)
        unknown = set(values) - {p["name"] for p in parameters}
        assert not unknown, f"{name} has no parameter {unknown}"
        text += f" <filter name={quoteattr(name)}>\n"
        text += "".join(_parameter(p, values.get(p["name"], p["default"])) for p in parameters)
        text += " </filter>\n"
    path.write_text(text + "</FilterScript>\n")
    return path
