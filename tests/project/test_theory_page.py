"""docs/theory.md: modules and functions that it names are there, and its numbers are those of the code."""

import importlib
import math
import re

import pytest
from support import REPOSITORY

from opml.base.yaml_files import read_yaml
from opml.benchmark import scores
from opml.catalog.associate import innovations
from opml.catalog.fit import apriori
from opml.conjunctions import likeliest_collision, long_encounter, probability
from opml.element_sets import corrector, features, weighting
from opml.ephemerides import fit_sizes
from opml.learning.judge import metrics, model_choice
from opml.learning.models import gaussian_kernel, svr

TEXT = (REPOSITORY / "docs" / "theory.md").read_text(encoding="utf-8")
PLAIN = " ".join(TEXT.split())
NAMES = sorted(set(re.findall(r"`(opml\.[\w.]+)`", TEXT)))
SETTINGS = read_yaml(REPOSITORY / "config" / "config.yaml")
CLEANING = read_yaml(REPOSITORY / "config" / "studies" / "paper.yaml")["study"]["cleaning"]


@pytest.mark.parametrize("name", NAMES)
def test_each_module_that_is_named_is_there(name):
    importlib.import_module(name)


def test_the_learning_variables_are_those_of_the_settings():
    table = TEXT.split("## Learning variables")[1].split("**Cleaning**")[0]
    named = set(re.findall(r"`(\w+)`", table))
    variables = SETTINGS["learning"]["variables"]
    assert f"The paper's {len(variables)} variables" in PLAIN
    ranges = {"d_e", "d_i", "d_argp", "d_raan", "eps_y", "eps_z", "eps_vx", "eps_vy"}
    assert set(variables) - ranges <= named


@pytest.mark.parametrize(
    "phrase",
    [
        f"${CLEANING['cd_min']} \\le C_d \\le {CLEANING['cd_max']}$",
        f"fences on $e_y$ with $k = {CLEANING['fence']:g}$",
        f"(q_3 - q_1) / {svr.NORMAL_IQR}",
        f"$C = {SETTINGS['learners']['svr']['c']:g}$ and "
        f"$\\varepsilon = {SETTINGS['learners']['svr']['epsilon']}$",
        f"{gaussian_kernel.QUANTILES['sigest']} quantile of the distances",
        f"in {gaussian_kernel.DISTANCE_ROWS} rows (`sigest`)",
        f"dual differ by {SETTINGS['learners']['svr']['tol']}.",
        f"({innovations.CD_SPREAD}\\,\\bar{{c}})^2",
        f"({apriori.APRIORI_SIGMA}\\,C_0)^2",
        f"e^{{-(t - t_j) / {model_choice.MEMORY_DAYS:g}\\,\\mathrm d}}",
        f"({fit_sizes.WEATHER}\\,w)^2",
        f"0.6 \\sqrt{{{fit_sizes.LONG:g} / h}}$",
        f"({fit_sizes.GIVEN}, of a guessed area to mass {fit_sizes.GUESSED})",
        f"formal error of Cd; at most {fit_sizes.VAGUE:g}.",
        f"({metrics.DRAWS} draws, {metrics.PERCENTILES[0]:g} to {metrics.PERCENTILES[1]:g} %",
        f"{probability.SHORT}\\,P",
        f"{features.FLOOR:g}\\,\\mathrm{{m/d}}",
        f"$j > {corrector.JUMP:g}$",
        f"({max(features.LASTING.values())} to {min(features.LASTING.values())}, by lead time) of the common",
        f"at least $10^{{{math.log10(probability.LEAST_SIGMA):.0f}}} R$",
        f"(in 3D, ${long_encounter.LEAST_SIGMA}\\,R$)",
        f"known to {100.0 * likeliest_collision.STEADY:.0f} % and",
        f"({scores.DRAWS} draws, 2.5 to 97.5 %",
        f"\\frac{{S}}{{{corrector.NORMAL:.3f}}}",
    ],
)
def test_its_numbers_are_those_of_the_code(phrase):
    assert phrase in PLAIN


def test_the_running_mean_has_the_memory_of_the_settings():
    assert f"$T$ is {SETTINGS['learners']['running']['memory_days']} days" in PLAIN
    assert f"({SETTINGS['learners']['running24m3']['memory_days']} in `running24m3`)" in PLAIN


def test_the_ways_of_an_object_are_those_of_the_code():
    assert f"({weighting.UNCHANGED}, {weighting.DENSITY}, {weighting.LEARNED})" in PLAIN


def test_the_terms_of_the_mechanism_are_counted():
    assert len(SETTINGS["learners"]["mechanism"]["terms"]) == 13
    assert "of thirteen coefficients" in PLAIN
    for k, m in SETTINGS["mechanism"]["resonances"]:
        assert f"({k}, {m})" in PLAIN
