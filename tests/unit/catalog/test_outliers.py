"""Fits that leave outliers out: single numbers, and tracks of another object."""

import numpy as np
import pandas as pd
import pytest
from support import BOUNDED_ESTIMATION as SETTINGS

from opml.catalog.simulate import tracking
from opml.catalog.simulate.observing import QUANTITIES, sigmas, wrapped
from opml.tables import SCHEMAS, read_table, write_table

EDITING = SETTINGS.evolve(reject_sigma=5.0)


@pytest.fixture(scope="module")
def clean(known_rows, fits_to):
    return fits_to(known_rows, SETTINGS)


def test_clean_measurements_all_count(known_rows, fits_to, clean):
    found = fits_to(known_rows, EDITING)
    assert "rejected" not in clean
    assert found["rejected"].sum() == found["rejected_of_track"].sum() == 0
    np.testing.assert_allclose(found["off"], clean["off"], atol=0.5)
    np.testing.assert_allclose(found["weighted_rms"], clean["weighted_rms"], rtol=1e-3)


def test_single_numbers_are_left_out(known_rows, fits_to, clean, three_stations, tmp_path):
    spread = {station.name: sigmas(station, QUANTITIES) for station in three_stations}
    sigma = np.array([spread[name] for name in known_rows["station"]])
    generator = np.random.default_rng(7)
    hit = generator.random(sigma.shape) < 0.05
    size = 10.0 ** generator.uniform(1.0, 3.0, sigma.shape) * generator.choice([-1.0, 1.0], sigma.shape)
    values = wrapped(known_rows[QUANTITIES].to_numpy() + hit * size * sigma, QUANTITIES)
    spoilt = known_rows.assign(**dict(zip(QUANTITIES, values.T, strict=True)))
    found = fits_to(spoilt, EDITING)
    by_track = known_rows.assign(hit=hit.sum(axis=1)).groupby("track")["hit"].sum()
    assert found["rejected_of_track"].tolist() == by_track.tolist()
    assert (found["rejected"] >= found["rejected_of_track"]).all()
    late = clean["tracks_used"] >= 3
    assert found["converged"].all()
    assert found["off"][late].median() < 1.5 * clean["off"][late].median()
    assert fits_to(spoilt, SETTINGS)["off"][late].median() > 10.0 * clean["off"][late].median()
    table = found.drop(columns="off")
    write_table(tmp_path / "estimates", table, "estimates", metadata={})
    names = [*SCHEMAS["estimates"].names, "rejected", "rejected_of_track"]
    assert list(read_table(tmp_path / "estimates", "estimates")) == names


def test_a_track_of_another_object_is_left_out_whole(
    known_rows, fits_to, clean, known_orbit, earth_orientation, three_stations
):
    """One that passes a minute later, three hundred kilometres behind."""
    late = known_orbit.assign(t=known_orbit["t"] + 60.0)
    other = tracking.simulate(late, earth_orientation, three_stations, rso="other", seed=2)
    track = int(clean["track"].iloc[-4])
    where = pd.MultiIndex.from_frame(known_rows[["t", "station"]])
    theirs = other.set_index(["t", "station"])[QUANTITIES].reindex(where).to_numpy()
    of_track, seen = (known_rows["track"] == track).to_numpy(), np.isfinite(theirs).all(axis=1)
    foreign = known_rows.copy()
    foreign.loc[of_track, QUANTITIES] = theirs[of_track]
    assert (of_track & seen).sum() > 10
    found = fits_to(foreign[~of_track | seen].reset_index(drop=True), EDITING)
    left_out = found.set_index("track")["rejected_of_track"]
    assert left_out[track] >= 2 * (of_track & seen).sum()
    assert left_out.drop(track).sum() <= 2
    assert found["converged"].all()
    assert found["off"].iloc[-4:].max() < 300.0
