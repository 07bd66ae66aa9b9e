# SPDX-License-Identifier: GPL-3.0-or-later
"""What users write in their scripts, frozen: names, types, choices, defaults, labels, order.

Where one of these fails, either the change was not meant, or frozen_table.json and the CHANGELOG have
to tell of it."""

import re
import xml.etree.ElementTree as ElementTree

import mlx
import pytest

FILTERS = {entry["name"]: entry for entry in mlx.TABLE["filters"]}
# What MeshLab 2020.09 calls the type of a value.
VALUE_TYPES = {
    "RichBool": "Bool", "RichInt": "Int", "RichFloat": "Float", "RichEnum": "Enum",
    "RichAbsPerc": "AbsPerc", "RichMesh": "Mesh",
}


def default_of(parameter):
    kind, text = parameter.get("type"), parameter.get("value")
    if kind == "RichBool":
        return text == "true"
    if kind == "RichEnum":
        return parameter.get(f"enum_val{text}")
    return float(text)


def test_pymeshlab_has_the_table(pymeshlab, tmp_path, clean_and_noisy):
    saved = tmp_path / "saved.mlx"
    steps = [{"do": "load", "path": clean_and_noisy[0]}, {"do": "load", "path": clean_and_noisy[1]}]
    steps += [{"do": "filter", "name": entry["python_name"]} for entry in FILTERS.values()]
    results, log = pymeshlab.run_steps(tmp_path, [*steps, {"do": "save_script", "path": saved}])
    assert all(result["ok"] for result in results), (results, log)

    found = ElementTree.parse(saved).getroot()
    assert [entry.get("name") for entry in found] == list(FILTERS)
    for entry in found:
        expected = FILTERS[entry.get("name")]["parameters"]
        assert [p.get("name") for p in entry] == [p["name"] for p in expected]
        for parameter, frozen in zip(entry, expected):
            assert parameter.get("type") == frozen["type"], frozen
            assert parameter.get("description") == frozen["label"], frozen
            assert default_of(parameter) == pytest.approx(frozen["default"]), frozen
            assert len(parameter.get("tooltip")) > 30, frozen
            if frozen["type"] == "RichEnum":
                count = int(parameter.get("enum_cardinality"))
                assert [parameter.get(f"enum_val{i}") for i in range(count)] == frozen["choices"]


def test_meshlabserver_has_the_table(server, tmp_path, clean_and_noisy):
    dump = tmp_path / "dump.txt"
    done = server.call("-d", dump, "-i", clean_and_noisy[0])
    assert done.returncode == 0, done.stdout
    sections = re.split(r"\\section f\d+ ", dump.read_text())[1:]
    found = {section.splitlines()[0].strip(): section for section in sections}
    for name, entry in FILTERS.items():
        rows = re.findall(r"<TR><TD> \\c ([\w ]+?)\s+</TD> <TD> (.*?) </TD> <TD><i> (.*?)</i>", found[name])
        expected = [(VALUE_TYPES[p["type"]], p["label"]) for p in entry["parameters"]]
        assert [(kind, label) for kind, label, _ in rows] == expected
        assert all(len(tooltip) > 30 for _, _, tooltip in rows)


def test_names_are_snake_case():
    for entry in FILTERS.values():
        for parameter in entry["parameters"]:
            assert re.fullmatch(r"[a-z]+(_[a-z]+)*", parameter["name"])


def test_same_name_means_same_parameter_in_all_filters():
    seen = {}
    for entry in FILTERS.values():
        for parameter in entry["parameters"]:
            assert seen.setdefault(parameter["name"], parameter) == parameter
