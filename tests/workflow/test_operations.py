"""docs/operations.md, followed: an operator with tracks and a sheet, and no truth anywhere in the plan."""

import re
import shutil

import pytest
from following import REAL_RUN, Reader, blocks, files, page, plans
from project import ROOT

PAGE = page("operations")
BLOCKS = blocks(PAGE)
CHAIN = {"tracking_from_tdm", "first_orbit", "estimation", "labels", "labelled_dataset", "mechanism"}
CHAIN |= {"train", "evaluate", "rolling", "uncertainty", "calibration", "corrected", "export_corrected"}
CHAIN |= {"study_report", "corrected_figure"}


@pytest.fixture(scope="module")
def told(tmp_path_factory):
    """What the page's dry runs printed, once its files were saved beside two days of tracks."""
    reader = Reader(tmp_path_factory.mktemp("operations"))
    (reader.folder / "tracks").mkdir()
    shutil.copy(ROOT / "tests" / "reference" / "orekit.tdm", reader.folder / "tracks" / "mine.tdm")
    for kind, text in BLOCKS:
        if kind == "yaml":
            reader.save(text)
    return {text: reader.run(text) for kind, text in BLOCKS if kind == "sh" and REAL_RUN not in text}


def test_the_operators_whole_chain_knows_no_truth(told):
    (plan,) = plans(told).values()
    rules = set(re.findall(r"^rule (\w+):|^(\w+) +\d+$", plan, re.MULTILINE))
    planned = {name for pair in rules for name in pair if name}
    assert planned >= CHAIN
    assert not {name for name in planned if "truth" in name or name in ("tracking", "oracle", "dataset")}


def test_the_real_run_is_the_one_that_was_planned(told):
    (planned,) = plans(told)
    assert planned.replace(" -n ", " -j2 ") in [text for _, text in BLOCKS]


def test_the_study_takes_twelve_lines_at_most():
    (text,) = files(BLOCKS).values()
    assert len(text.splitlines()) <= 12
