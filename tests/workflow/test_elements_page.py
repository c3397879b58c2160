"""docs/elements.md, followed: its file, and its command with the mean elements, on a few days of sets."""

import re

import numpy as np
import pytest
from element_histories import history, tle_text
from following import Reader, blocks, page

from opml.interop import orbit_segments
from opml.interop.element_sets import mean_elements
from opml.interop.object_ids import ObjectId

PAGE = page("elements")
TRIMMED = """\
epoch: "2016-09-28T12:09:45"
duration_days: 6
histories: {mine: {every_s: 3600, reach_hours: 12, sigma_m: [500, 1000, 500]}}
force_models: {assumed: {degree: 4, order: 0, third_bodies: []}}
integrator: {max_step_s: 120}
estimation: {window_hours: 24}
prediction: {max_days: 1}
uncertainty: {every_hours: 3, futures: 2}
learners: {held96: {kind: held, window_hours: 24, memory_days: 2}}
study:
  days: {train: [0, 3], test: [3, 5]}
  learners: [none, held96, learned]
"""
LAST = "days-0-5"


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """The folder of the results, once the page was followed."""
    reader = Reader(tmp_path_factory.mktemp("elements"))
    sets = history(np.arange(0.0, 5.01, 0.25), noise=30.0)
    (reader.folder / "history.tle").write_text(tle_text(sets, launch="98067A"))
    (settings,) = (text for kind, text in blocks(PAGE) if kind == "yaml")
    (reader.folder / "mine.yaml").write_text(settings)
    (reader.folder / "trimmed.yaml").write_text(TRIMMED)
    (command,) = (text for kind, text in blocks(PAGE) if kind == "sh")
    (message,) = re.findall(r"results/\S+/days-0-91/held96\.oem", command)
    assert "`held96.tle` and `.omm`" in " ".join(PAGE.split())
    every = " ".join(message.replace(".oem", f".{kind}") for kind in ("oem", "omm", "tle"))
    command = command.replace(message, every).replace("days-0-91", LAST)
    reader.run(f".venv/bin/{command}".replace("mine.yaml", "mine.yaml trimmed.yaml"))
    return reader.folder / "results" / "mine"


@pytest.mark.dag
def test_the_command_of_the_page_makes_what_the_page_says(made):
    report = (made / "study.html").read_text()
    assert "held96" in report
    assert "SGP4 from the newest set, improved by what a catalogue taught" in report
    (message,) = made.rglob(f"{LAST}/held96.oem")
    (segment,) = orbit_segments.read(message, epoch="2016-09-28T12:09:45")
    for path in (message.with_suffix(".omm"), message.with_suffix(".tle")):
        (one,) = mean_elements.read_sets(path)
        flown = mean_elements.states(one.satellite, epoch="2016-09-28T12:09:45", t=segment.t)
        assert np.linalg.norm((flown - segment.states)[:, :3], axis=1).max() < 200.0
        assert ObjectId.of("", one.designator, str(one.number)) == ObjectId("", "1998-067A", 25544)


@pytest.mark.dag
def test_messages_tell_the_object_of_the_sets(made):
    (message,) = made.rglob(f"{LAST}/held96.oem")
    assert "\nOBJECT_NAME = mine\nOBJECT_ID = 1998-067A\n" in message.read_text()
