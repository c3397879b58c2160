"""Numbers in YAML are those that a reader of the file takes them for."""

import math

import pytest

from opml.base.yaml_files import read_yaml

VALUES = {
    "8": 8,
    "-12": -12,
    "0": 0,
    "1_602": 1602,
    "0.5": 0.5,
    "-.5": -0.5,
    "1.5e-3": 1.5e-3,
    ".inf": math.inf,
    "010": "010",
    "07646": "07646",
    "2:10": "2:10",
    "-1:30.5": "-1:30.5",
    "0x1F": "0x1F",
    "0b11": "0b11",
    "08": "08",
}


@pytest.mark.parametrize("text", VALUES)
def test_numbers_are_in_tens(tmp_path, text):
    (tmp_path / "a.yaml").write_text(f"a: {text}\n")
    assert read_yaml(tmp_path / "a.yaml") == {"a": VALUES[text]}
