"""What air does to ranges and elevations, against Orekit's values."""

import numpy as np
import pandas as pd
import pytest
from support import EXCERPTS

from opml.catalog.fit import refraction


@pytest.fixture(scope="module")
def orekits():
    return pd.read_csv(EXCERPTS / "orekit_air.csv", comment="#")


def bent(elevation, altitude, *, radio):
    """Bending at an elevation of the straight line."""
    seen = elevation
    for _ in range(20):
        seen = elevation + refraction.bending(seen, altitude, radio=radio)
    return seen - elevation


def test_delays_are_saastamoinens_by_niells_mapping_to_a_percent(orekits, three_stations):
    for station in three_stations:
        rows = orekits[orekits["station"] == station.name]
        zenith = refraction.zenith_delay(station.latitude, station.altitude)
        assert zenith == pytest.approx(rows[["zenith_dry", "zenith_wet"]].iloc[0].sum(), abs=0.005)
        found = refraction.delay(rows["elevation"].to_numpy(), station.latitude, station.altitude)
        np.testing.assert_allclose(found, rows["delay"], rtol=0.01)


def test_light_is_bent_as_saemundsson_has_it_and_radio_as_itu_at_low_elevations(orekits, three_stations):
    for station in three_stations:
        rows = orekits[orekits["station"] == station.name]
        elevation = rows["elevation"].to_numpy()
        light, radio = (bent(elevation, station.altitude, radio=radio) for radio in (False, True))
        np.testing.assert_allclose(light, rows["bent_light"], rtol=0.03)
        # Its formula is fitted to low elevations, where most of the bending is.
        low = elevation < np.radians(15.0)
        np.testing.assert_allclose(radio[low], rows["bent_radio"][low], rtol=0.1)
