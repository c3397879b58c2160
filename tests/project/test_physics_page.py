"""docs/physics.md: what it says to be somewhere is there, and its numbers are those of the code."""

import importlib
import re

import pytest
from support import REPOSITORY

from opml.base import constants
from opml.base.yaml_files import read_yaml

TEXT = (REPOSITORY / "docs" / "physics.md").read_text(encoding="utf-8")
NAMES = sorted(set(re.findall(r"`(opml\.[\w.]+)`", TEXT)))
SHORT = sorted(set(re.findall(r"`(\w+)`", TEXT.split("## Gravity")[0])) - {"ForceModel"})


@pytest.mark.parametrize("name", [*NAMES, *(f"opml.dynamics.kernels.{name}" for name in SHORT)])
def test_each_module_and_function_that_is_named_is_there(name):
    module, _, last = name.rpartition(".")
    try:
        importlib.import_module(name)
    except ModuleNotFoundError:
        assert hasattr(importlib.import_module(module), last)


def test_every_module_of_the_dynamics_is_named():
    found = {path.stem for path in (REPOSITORY / "src/opml/dynamics").rglob("*.py")}
    named = {name.rpartition(".")[2] for name in NAMES} | set(SHORT)
    assert found - {"__init__", "force_model", "lanes", "run_environment", "settings"} <= named


def test_its_numbers_are_those_of_the_settings_and_the_constants():
    settings = read_yaml(REPOSITORY / "config" / "config.yaml")
    integrator, estimation = settings["integrator"], settings["estimation"]
    for model in ("truth", "assumed"):
        assert f"{settings['force_models'][model]['degree']}x" in TEXT
    for phrase in (
        f"$\\tau$ = {integrator['position_tolerance_m']} m",
        f"its step falls below {integrator['min_step_s']} s",
        f"at most {integrator['max_step_s']} s",
        f"every {settings['tracking']['step_s']} s",
        f"in the {estimation['window_hours']} h before",
        f"is below {estimation['convergence']}",
        f"less than {estimation['least_drag_m']} m",
        f"$P_0$ = {constants.SRP_PRESSURE * 1e6:.2f}e-6",
        f"R_sun = {constants.SUN_RADIUS / 1e8:.3f}e8",
    ):
        assert phrase in " ".join(TEXT.split()), phrase
