"""What a correction leaves of held-out errors, by duration, and how much of new ones lies inside."""

import numpy as np
import pandas as pd
import pytest

from opml.constants import DAY
from opml.errors import InputError
from opml.learning import learners, residuals
from opml.tables import SCHEMAS

OPTIONS = {"share": 0.3, "bin_hours": 12.0, "seed": 42}


def rows(estimates=200, each=30):
    """Rows whose along-track error a model knows half of; the rest, and the other errors, grow with time."""
    generator = np.random.default_rng(5)
    count = estimates * each
    duration = generator.uniform(0.0, 3.0 * DAY, count)
    noise = generator.normal(size=(count, 3)) * (duration / DAY)[:, None] * [3.0, 100.0, 5.0]
    known = np.repeat(generator.normal(size=estimates), each) * 3000.0 * (duration / DAY)
    table = pd.DataFrame({"i": np.repeat(np.arange(estimates), each), "duration": duration, "a": 6.8e6})
    table["j"] = np.arange(count)
    e_y = known + noise[:, 1]
    return table.assign(known=known, e_x=noise[:, 0] - e_y**2 / 13.6e6, e_y=e_y, e_z=noise[:, 2])


class Half:
    """A law that knows what is known, and remembers the estimates it was trained on."""

    variables = ("known",)
    trained = ()

    def train(self, training):
        self.trained = set(training["i"])
        return self

    def predict(self, x):
        return x[:, 0]


@pytest.fixture(scope="module")
def found():
    law = Half()
    return law, residuals.build(law.train, rows(), level=0.9, **OPTIONS)


def test_some_estimates_are_held_out(found):
    law, table = found
    assert len(law.trained) == 140
    assert list(table) == SCHEMAS["residuals"].names


def test_deviations_are_those_of_what_is_left(found):
    _, table = found
    days = table["duration"].to_numpy() / DAY
    # A bent path is no radial error, and what the model knows is no along-track one.
    for axis, sigma in (("x", 3.0), ("y", 100.0), ("z", 5.0)):
        np.testing.assert_allclose(table[f"sigma_{axis}"], sigma * days, rtol=0.35)


def test_the_level_of_new_rows_lies_inside(found):
    _, table = found
    new = rows(estimates=201)
    sigma = residuals.sigmas(table, new["duration"].to_numpy())
    inside = np.abs(new["e_y"] - new["known"]) < 1.645 * sigma[:, 1]
    assert inside.mean() == pytest.approx(0.9, abs=0.04)


def test_between_and_beyond_the_durations_of_the_table():
    table = pd.DataFrame({"duration": [1.0, 3.0], "sigma_x": [1.0, 2.0], "sigma_y": 5.0, "sigma_z": 6.0})
    found = residuals.sigmas(table, np.array([0.0, 2.0, 9.0]))
    np.testing.assert_allclose(found, [[1.0, 5.0, 6.0], [1.5, 5.0, 6.0], [2.0, 5.0, 6.0]])


def test_too_few_estimates_are_told():
    with pytest.raises(InputError, match=r"estimates enough to calibrate on for a level of 0\.9, got 3"):
        residuals.build(Half().train, rows(estimates=10), level=0.9, **OPTIONS)


def test_a_learner_that_knows_the_truth_makes_no_ephemeris():
    terms = {"kind": "mechanism", "terms": ["v*cd", "floor"]}
    settings = learners.resolved(terms, component="e_y", variables=[])
    assert learners.tables_asked(settings["variables"]) == ["oracle", "mechanism"]
    with pytest.raises(InputError, match="learner 'knownmodel': expected one that needs no truth to predict"):
        learners.check_without_truth("knownmodel", settings)
    learners.check_without_truth("svr", {"variables": ["duration", "gap"]})
