"""docs/howto.md, followed from top to bottom in one folder: its files, and its commands but the real runs."""

import re
import shutil

import numpy as np
import pytest
from following import REAL_RUN, Reader, blocks, files, page, plans
from project import ROOT

from opml.interop import oem
from opml.interop.ephemeris import Ephemeris

PAGE = page("howto")
BLOCKS = blocks(PAGE)
FILES = files(BLOCKS)


def write_orbit(path):
    """The message that the page's run of 18 days would export, but of a circle."""
    t = np.arange(0.0, 18 * 86400.0 + 1.0, 300.0)
    a, speed = 6.9e6, 7600.0
    turn, still = t * speed / a, 0.0 * t
    place = [a * np.cos(turn), a * np.sin(turn), still]
    states = np.stack([*place, -speed * np.sin(turn), speed * np.cos(turn), still], axis=1)
    oem.write(path, [Ephemeris("mine", t, states)], epoch="2016-09-28T12:09:45")


@pytest.fixture(scope="module")
def told(tmp_path_factory):
    """What each block of commands printed after all that stands above it was done; real runs left out."""
    reader = Reader(tmp_path_factory.mktemp("howto"))
    write_orbit(reader.folder / "mine.oem")
    shutil.copy(ROOT / "tests" / "reference" / "orekit.tdm", reader.folder / "mine.tdm")
    printed = {}
    for kind, text in BLOCKS:
        if kind == "yaml":
            reader.save(text)
        elif REAL_RUN not in text:
            printed[text] = reader.run(text)
    return printed


def test_the_page_can_be_followed_in_its_order(told):
    assert plans(told)
    assert all("Job stats:" in plan for plan in plans(told).values())


def test_the_page_tells_how_many_jobs_a_study_has(told):
    (said,) = re.findall(r"Some (\d+) jobs take", PAGE)
    plan, *_ = (printed for text, printed in plans(told).items() if "-n study --configfile mine.yaml" in text)
    (total,) = set(re.findall(r"^total +(\d+)$", plan, re.MULTILINE))
    assert abs(int(said) - int(total)) <= 2


def test_every_file_is_used_by_a_dry_run(told):
    assert FILES
    for name in FILES:
        assert any(name in text for text in plans(told)), name


def test_a_study_of_ones_own_takes_twelve_lines_at_most():
    assert len(FILES["mine.yaml"].splitlines()) <= 12


def test_the_products_that_the_page_names_are_planned(told):
    plan = next(plan for text, plan in plans(told).items() if "--configfile mine.yaml\n" in text)
    for name in re.findall(r"^\| `(study\.md|figs/\S+)`", PAGE, re.MULTILINE):
        assert f"results/mine/{name}" in plan


@pytest.mark.parametrize(
    ("file", "planned"),
    [
        ("radar.yaml", "tracks of mine as eglin-kaena-shemya measure it"),
        ("flown.yaml", "the orbit of mine from mine.oem"),
        ("tracked.yaml", "what eglin-kaena measured of seen, from mine.tdm"),
        ("more.yaml", "before and after the correction, future_20days"),
        ("small.yaml", "Train svrsmall on e_y of mine"),
    ],
)
def test_a_file_changes_the_plan_as_the_page_says(told, file, planned):
    assert any(planned in plan for text, plan in plans(told).items() if file in text)
