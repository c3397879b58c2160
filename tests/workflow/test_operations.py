"""docs/operations.md, followed: an operator with tracks and a sheet, and no truth anywhere in the plan."""

import re
import shutil

import numpy as np
import pytest
from following import Reader, blocks, files, page
from project import ROOT
from weather_files import up_to

from opml.base.constants import DAY
from opml.interop import known_orbits
from opml.tables import read_table

PAGE = page("operations")
BLOCKS = blocks(PAGE)
CHAIN = {"tracking_from_tdm", "first_orbit", "estimation", "labels", "labelled_dataset", "mechanism"}
CHAIN |= {"train", "evaluate", "spread", "replays", "replay", "corrected", "export_corrected"}
CHAIN |= {"study_report", "corrected_figure"}


@pytest.fixture(scope="module")
def plan(tmp_path_factory):
    """What the page's run of its study plans, once its files were saved beside two days of tracks."""
    reader = Reader(tmp_path_factory.mktemp("operations"))
    (reader.folder / "tracks").mkdir()
    shutil.copy(ROOT / "tests" / "reference" / "orekit.tdm", reader.folder / "tracks" / "mine.tdm")
    for kind, text in BLOCKS:
        if kind == "yaml":
            reader.save(text)
    (run,) = (text for kind, text in BLOCKS if kind == "sh" and "--configfile operator.yaml" in text)
    return reader.run(run.replace(" -j2 ", " -n "))


def test_the_operators_whole_chain_knows_no_truth(plan):
    rules = set(re.findall(r"^rule (\w+):|^(\w+) +\d+$", plan, re.MULTILINE))
    planned = {name for pair in rules for name in pair if name}
    assert planned >= CHAIN
    assert not {name for name in planned if "truth" in name or name in ("tracking", "dataset")}


def test_the_study_takes_twelve_lines_at_most():
    (text,) = files(BLOCKS).values()
    assert len(text.splitlines()) <= 12


OPERATOR = """\
results: results
epoch: "2016-09-28T12:09:45"
duration_days: 3.5
tracks: {mine: tracks/mine.tdm}
rsos: {mine: {area_to_mass_m2pkg: 0.05, cd: 2.2, cr: 1.25}}
environment: {solar_activity: weather.csv, knowledge: forecast}
force_models: {assumed: {degree: 8, order: 8, third_bodies: [sun, moon]}}
integrator: {max_step_s: 120}
prediction: {max_days: 1}
uncertainty: {every_hours: 1, futures: 4}
study: {}
"""


@pytest.mark.dag
def test_from_tracks_and_the_weather_up_to_now_comes_an_ephemeris_of_the_days_ahead(project):
    """The weather ends with the tracks; what is known of it, and when, is a forecast from then on."""
    (project.folder / "tracks").mkdir()
    shutil.copy(ROOT / "tests" / "reference" / "orekit.tdm", project.folder / "tracks" / "mine.tdm")
    up_to(project.folder / "weather.csv", 57661)  # 2016-09-30, the day of the last track
    (project.folder / "mine.yaml").write_text(OPERATOR)
    message = "results/corrected/mine/eglin-clear-kaena_later/days-0-2/fit24.oem"
    project.snakemake("-j2", message, "--configfile", "mine.yaml")
    results = project.folder / "results"
    estimates = read_table(results / "estimates" / "mine" / "eglin-clear-kaena.parquet", "estimates")
    assert estimates["converged"].all()
    (segment,) = known_orbits.segments(project.folder / message, epoch="2016-09-28T12:09:45")
    assert segment.t[-1] > estimates["t"].max() + 0.95 * DAY
    assert np.isfinite(segment.states).all()
    assert (np.linalg.eigvalsh(segment.covariances[:, :3, :3]) > 0.0).all()
