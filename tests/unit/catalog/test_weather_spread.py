"""How far drag and the weather take predictions, by arcs under the Earth's flattening."""

import numpy as np
import pandas as pd
import pytest
from support import force_model
from weather_files import outlook

from opml.base.constants import DAY, HOUR
from opml.catalog.predict import weather_spread
from opml.catalog.predict.weather_spread import Weathers
from opml.catalog.propagator import Propagator
from opml.catalog.simulate.truth import initial_state
from opml.dynamics.forces import with_outlooks
from opml.orbits.elements import in_rsw
from opml.tables import PARAMETER_COVARIANCES, PARAMETERS, SPREAD, STATE


@pytest.fixture(scope="module")
def estimates(iss):
    """One estimate whose Cd is known well, another that says nothing of it."""
    model = force_model(2)
    state = dict(zip(STATE, initial_state(iss, model.gm), strict=True))
    fit = dict.fromkeys(PARAMETER_COVARIANCES, 0.0) | {f"cov_{name}_{name}": 1.0 for name in PARAMETERS}
    table = pd.DataFrame({"track": [0, 1], "t": [0.0, HOUR], "converged": True, **state, **fit})
    return table.assign(cd=[2.2, 900.0], cov_cd_cd=[1e-6, 1e6])


@pytest.fixture(scope="module")
def pairs():
    return pd.DataFrame({"i": [0, 0, 1], "j": [3, 4, 4], "t_i": [0.0, 0.0, HOUR], "t_j": [DAY, 2 * DAY, DAY]})


def built(iss, estimates, pairs, futures=None, model=None):
    model = model or force_model(2)
    return weather_spread.build(
        Propagator(model, iss), estimates, pairs, weathers=Weathers.of(model, futures)
    )


def test_a_tenth_more_drag_takes_it_as_far_as_under_all_forces(iss, estimates, pairs, assumed_model):
    found = built(iss, estimates, pairs)
    assert list(found.columns) == ["i", "j", *SPREAD]
    started = estimates[STATE].to_numpy()
    plain, more = (
        Propagator(assumed_model, iss).propagate_pairs(pairs, started, cd=cd * np.ones(2))[0]
        for cd in (2.2, 2.42)
    )
    expected = np.abs(in_rsw(more - plain, plain)[:, :3])
    np.testing.assert_allclose(found["drag_y"], expected[:, 1], rtol=0.03)
    assert (found[["weather_x", "weather_y", "weather_z"]] == 0.0).all(axis=None)


def test_distances_are_those_of_short_steps(iss, estimates, pairs, monkeypatch):
    found = built(iss, estimates, pairs)
    monkeypatch.setattr(weather_spread, "LONGEST_STEP", 100.0)
    monkeypatch.setattr(weather_spread, "TOLERANCE", 0.1)
    np.testing.assert_allclose(found["drag_y"], built(iss, estimates, pairs)["drag_y"], rtol=1e-3)


def test_a_wild_cd_is_that_of_its_past(iss, estimates, pairs):
    found = built(iss, estimates, pairs)
    assert found["drag_y"][2] == pytest.approx(found["drag_y"][0], rel=0.2)


def test_the_weather_counts_as_far_as_its_futures_lie(iss, estimates, pairs):
    known = outlook(80, days=2)
    stormy = known.assign(kp_3h=known["kp_3h"] + 3.0, kp_24h=known["kp_24h"] + 3.0)
    futures = pd.concat([known.assign(member=0), stormy.assign(member=1)], ignore_index=True)
    model = with_outlooks(force_model(2), known)
    both, worst = (
        built(iss, estimates, pairs, one, model) for one in (futures, futures[futures["member"] == 1])
    )
    assert (worst["weather_y"] > 100.0).all()
    np.testing.assert_allclose(both["weather_y"], worst["weather_y"] / np.sqrt(2.0), rtol=1e-9)
    np.testing.assert_array_equal(both["drag_y"], worst["drag_y"])
    assert (both[SPREAD] >= 0.0).all(axis=None)
