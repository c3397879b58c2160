"""Pictures of the paper's study on the page of figures: their captions."""

import importlib.util
import re

import pytest
from support import REPOSITORY

nodes = pytest.importorskip("docutils.nodes", reason="Sphinx is not installed: make docs")

PAGE = (REPOSITORY / "docs" / "figures.md").read_text(encoding="utf-8")
LISTED = [line.split() for line in re.search(r"```{run-figures}\n(.*?)```", PAGE, re.DOTALL)[1].splitlines()]


@pytest.fixture(scope="module")
def run_figures():
    spec = importlib.util.spec_from_file_location("run_figures", REPOSITORY / "docs" / "run_figures.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.mark.parametrize("listed", LISTED, ids=lambda listed: listed[0])
def test_each_picture_has_the_caption_of_the_report(run_figures, listed):
    figure, _, *text = listed
    caption = run_figures.caption(text[0] if text else figure, figure)
    assert len(caption.split()) > 10
    assert not re.search(r"[{}]|None|  ", caption)


def test_captions_tell_the_paper_s_numbers(run_figures):
    assert "P_ML is\n35.5 %" in run_figures.caption("svr", "future_10days_signed")
    assert "training on 40 % of it" in run_figures.caption("partition", "partition_40")
    assert "P_ML" not in run_figures.caption("svr", "future_5days_absolute")


def test_names_in_the_table_lead_to_the_pictures(run_figures):
    name, other, figure = (
        nodes.literal(text="orbit_3d"),
        nodes.literal(text="beyond"),
        nodes.figure(ids=["orbit_3d"]),
    )
    page = nodes.section("", nodes.paragraph("", "", name, other), figure)
    run_figures.link(None, page, "figures")
    (led,) = page.findall(nodes.reference)
    assert (led["refuri"], led.astext()) == ("#orbit_3d", "orbit_3d")


def test_the_table_names_the_files_that_are_shown():
    named = set(re.findall(r"`(\w+)`", PAGE.split("## The paper's figures and ours")[1].split("## ")[0]))
    shown = {figure for figure, *_ in LISTED}
    signed = {name.removesuffix("_absolute") + "_signed" for name in named}
    beyond = {"beyond", "beyond_transfers"}
    assert shown - named - signed - beyond == {"error_distribution_velocity"}
