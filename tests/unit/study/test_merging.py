"""Settings laid over each other: what lies under those of a user."""

import pytest
import yaml

from opml.study.settings.merging import merged
from opml.study.settings.overlay import COMMAND_LINE, Layer


def assumed(tmp_path, **settings):
    """The assumed force model of a run under a user's settings."""
    path = tmp_path / "mine.yaml"
    path.write_text(yaml.safe_dump(settings))
    return merged(["config/config.yaml", path]).values["force_models"]["assumed"]


@pytest.mark.parametrize("kind", ["orbits", "tracks", "fixes", "ranges"])
def test_real_satellites_fly_under_what_a_catalogue_has(tmp_path, kind):
    model = assumed(tmp_path, **{kind: {"mine": "a.file"}})
    assert (model["degree"], model["order"], len(model["third_bodies"])) == (70, 70, 10)
    assert model["forces"] == ["solid_tides", "relativity"]


def test_laser_ranges_are_flown_to_a_tenth_of_a_millimetre_and_fitted_over_days(tmp_path):
    path = tmp_path / "mine.yaml"
    path.write_text("ranges: {mine: a.crd}\nestimation: {max_iterations: 7}")
    values = merged(["config/config.yaml", path]).values
    assert values["integrator"] | {"position_tolerance_m": 1e-4, "max_step_s": 75} == values["integrator"]
    assert values["estimation"] | {"window_hours": 96, "max_iterations": 7} == values["estimation"]


def test_what_a_user_says_lies_above_it(tmp_path):
    model = assumed(tmp_path, orbits={"mine": "a.file"}, force_models={"assumed": {"degree": 8, "order": 8}})
    assert (model["degree"], model["forces"][0]) == (8, "solid_tides")


def test_simulated_rsos_keep_the_assumed_model_of_the_paper(tmp_path):
    paper = merged(["config/config.yaml"]).values["force_models"]["assumed"]
    assert assumed(tmp_path, orbits={}, duration_days=3) == paper
    assert paper == {"degree": 20, "order": 20, "third_bodies": ["sun", "moon", "jupiter"]}


def test_orbits_on_the_command_line_count_too():
    on_top = Layer(COMMAND_LINE, {"orbits": {"mine": "a.file"}})
    assert merged(["config/config.yaml"], on_top).values["force_models"]["assumed"]["degree"] == 70
