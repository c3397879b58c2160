"""What stations measure with light time, against Orekit's values of the same states."""

import numpy as np
import pandas as pd
import pytest
from support import EPOCH, EXCERPTS, environment

from opml.catalog.simulate.observing import OBSERVABLES, StationStates, difference, predicted
from opml.interop import tdm
from opml.tables import STATE

ARCSECOND = np.radians(1.0 / 3600.0)
BOUNDS = {"range": 1e-3, "range_rate": 1e-5}
"""[m, m/s]; angles agree to a ten thousandth of an arcsecond."""


@pytest.fixture(scope="module")
def orekits():
    return pd.read_csv(EXCERPTS / "orekit_observables.csv", comment="#")


def seen(rows, stations, *, light_time, two_way=None):
    names = {station.name: k for k, station in enumerate(stations)}
    number = rows["station"].map(names).to_numpy()
    t, turned = rows["t"].to_numpy(), environment()["earth_orientation"]
    stands = StationStates.at(t, stations, number, turned, two_way=two_way)
    states = rows[STATE].to_numpy().reshape(-1, 2, 3)
    positions, velocities = (np.einsum("nij,nj->ni", stands.from_gcrf, states[:, k]) for k in (0, 1))
    return predicted(OBSERVABLES, positions, velocities, stands, light_time=light_time)


@pytest.mark.parametrize("suffix", ["", "_two_way"])
def test_measurements_with_light_time_are_orekits(orekits, three_stations, suffix):
    two_way = np.full(len(orekits), bool(suffix))
    found = seen(orekits, three_stations, light_time=True, two_way=two_way)
    columns = [f"{name}{suffix}" if name in BOUNDS else name for name in OBSERVABLES]
    apart = np.abs(difference(found, orekits[columns].to_numpy(), OBSERVABLES))
    # An azimuth and a right ascension near the pole are as uncertain as it is near.
    apart[:, 0] *= np.cos(orekits["elevation"])
    apart[:, 4] *= np.cos(orekits["declination"])
    for k, name in enumerate(OBSERVABLES):
        assert apart[:, k].max() < BOUNDS.get(name, 1e-4 * ARCSECOND), name


def test_both_ways_are_not_one(orekits):
    """By metres and centimetres per second, so that the ways are told apart above."""
    for name, bound in (("range", 5.0), ("range_rate", 1e-2)):
        assert np.abs(orekits[name] - orekits[f"{name}_two_way"]).max() > bound


def test_a_message_of_orekits_has_its_range_rates(three_stations):
    found = tdm.measurements([EXCERPTS / "orekit.tdm"], epoch=EPOCH)
    found["station"] = found["station"].str.lower()
    orbit = pd.read_csv(EXCERPTS / "orekit_tdm_orbit.csv", comment="#")
    both = found.assign(t=found["t"].round(3)).merge(orbit.assign(t=orbit["t"].round(3)), on="t")
    assert len(both) == len(found) > 100
    rates = seen(both, three_stations, light_time=False)[:, OBSERVABLES.index("range_rate")]
    np.testing.assert_allclose(both["range_rate"], rates, rtol=0.0, atol=2e-5)
