"""docs/tracks.md, labels.md and wildcards.md, followed: commands run, on few days; products are planned."""

import re
import shutil

import numpy as np
import pytest
from following import Reader, blocks, files, page
from support import shared

from opml.tables import read_table

VALUES = {
    "rso": "iss",
    "stations": "eglin",
    "window": "_w24",
    "reading": "_track",
    "label": "_later",
    "train": "days-0-30",
    "learner": "svr",
    "component": "e_y",
    "target": "iss_i50",
    "test": "days-30-40",
    "members": "30",
    "hours": "24",
    "arc": "_l48",
    "memory": "_m30",
    "track": "352",
}
NEED_SETTINGS = "starts/"
"""Products of objects whose files are in the settings."""


@pytest.fixture
def reader(tmp_path):
    return Reader(tmp_path)


TRIMMED = """# trimmed.yaml
duration_days: 4
force_models:
  truth: {degree: 8, order: 8, third_bodies: [sun, moon]}
  assumed: {degree: 4, order: 4, third_bodies: [sun, moon]}
prediction: {max_days: 1}
study:
  cleaning: {fence: 3, fence_days: [0, 3]}
"""


def commands(name):
    """The commands of a page that run Snakemake."""
    found = re.findall(r"^    (snakemake -j2 .*\n)", page(name), re.MULTILINE)
    return [f".venv/bin/{text}" for text in found]


def products():
    """The products of docs/wildcards.md whose wildcards have VALUES, and the examples that it gives."""
    text = page("wildcards")
    table = text.partition("## Products")[2].partition("## Wildcards")[0]
    named = [one for one in re.findall(r"`([a-z_]+/[^` ]+\.[a-z]+)`", table) if "{" in one]
    made = [one for one in named if set(re.findall(r"\{([^}]*)\}", one)) <= set(VALUES)]
    examples = re.findall(r"`([a-z_]+/[^` {<]*iss[^` {<]*\.[a-z]+)`", text)
    return [one.format(**VALUES) for one in made if not one.startswith(NEED_SETTINGS)] + examples


@pytest.mark.dag
def test_laser_ranges(reader):
    for kind in (
        "lageos2_2016-02-14.crd.gz",
        "SLRF2014.snx.gz",
        "ecc_une.snx.gz",
        "lageos2_cpf_160213_5441.sgf",
    ):
        shutil.copy(shared(f"real/crd/{kind}"), reader.folder)
    settings = files(blocks(page("tracks")))["lageos.yaml"]
    reader.save(settings)
    (command,) = commands("tracks")
    reader.run(command)
    dataset = read_table(reader.folder / command.split()[-1], "dataset")
    assert np.abs(dataset["e_x"]).median() < 5.0


def test_labels(reader):
    (settings,) = files(blocks(page("labels"))).values()
    reader.save(settings)
    (command,) = commands("labels")
    assert "Job stats:" in reader.run(command.replace("-j2", "-n", 1))


def test_wildcards(reader):
    (command,) = commands("wildcards")
    command = command.replace("-j2", "-n", 1)
    made = " ".join(f"results/{product}" for product in products())
    weather = "--config environment='{solar_activity: OBSERVED, knowledge: forecast}'"
    assert "Job stats:" in reader.run(f"{command.strip().replace('-n', f'-n {weather} --', 1)} {made}\n")


@pytest.mark.dag
def test_the_command_of_wildcards_makes_its_product(reader):
    reader.save(TRIMMED)
    (command,) = commands("wildcards")
    asked = command.replace("-j2", "-j2 --configfile trimmed.yaml --", 1)
    made = asked.replace("days-0-30", "days-0-3").replace("days-30-40", "days-3-4")
    reader.run(made)
    assert (reader.folder / made.split()[-1]).is_file()
