"""The catalogue as a thermometer: what it finds, what it must not know, and what it makes of predictions."""

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from support import REPOSITORY

from opml.base.constants import DAY, HOUR
from opml.catalog.predict import thermometer
from opml.catalog.predict.thermometer import Reading, Thermometer
from opml.orbits import random_sheet
from opml.orbits.sheets import read_rsos
from opml.tables import SCHEMAS, STATE

SETTINGS = Thermometer(
    window_hours=24.0,
    step_hours=12.0,
    decay_days=3.0,
    factor_sigma=0.2,
    body_sigma=0.5,
    drift_sigma=0.005,
    noise_sigma=0.03,
)
STEPS, BODIES = 60, 12


def factors():
    """A factor of the density that wanders as the settings say, one per step."""
    random, x = np.random.default_rng(5), [0.0]
    for _ in range(STEPS - 1):
        kick = SETTINGS.factor_sigma * np.sqrt(1.0 - SETTINGS.memory**2)
        x.append(SETTINGS.memory * x[-1] + kick * random.normal())
    return np.array(x)


def estimates(seed, factor, spread=0.03):
    """Fits of one body every five hours: its Cd times the factor as the window saw it."""
    random = np.random.default_rng(seed)
    t = np.arange(DAY, STEPS * SETTINGS.step, 5.0 * HOUR)
    shares = np.array([thermometer.seen(one, t, SETTINGS).shares for one in t])
    shared = (shares * factor[SETTINGS.step_of(t)[:, None] - np.arange(SETTINGS.lags)]).sum(axis=1)
    cd = np.exp(np.log(2.2) + 0.4 * random.normal() + shared + spread * random.normal(size=len(t)))
    return pd.DataFrame(
        {"track": np.arange(len(t)), "t": t, "cd": cd, "cov_cd_cd": (0.01 * cd) ** 2, "converged": True}
    )


FACTORS = factors()
CATALOGUE = [estimates(seed, FACTORS) for seed in range(BODIES)]


def believed(catalogue, settings=SETTINGS):
    """What is believed at the end of each step, of the factor and a body that is left out."""
    return list(thermometer.beliefs(catalogue, settings.step * np.arange(1, STEPS), None, settings))


def test_the_factor_of_a_catalogue_is_found():
    # What is believed of a step at its end is in the first lag of the next step, and better in the second.
    found = np.array([belief.mean[2] for belief in believed(CATALOGUE)])[10:]
    true = FACTORS[: STEPS - 2][9:]
    assert np.corrcoef(found, true)[0, 1] > 0.9
    # But for a constant, which bodies that are all alike would have, too.
    assert np.std(found - true) < 0.5 * np.std(true)


def test_an_error_that_lasts_is_the_level_and_not_the_factor():
    alike = replace(SETTINGS, body_sigma=0.1)
    lasting = replace(alike, level_sigma=0.5)
    high = [table.assign(cd=1.5 * table["cd"]) for table in CATALOGUE]

    def bias(settings):
        return np.mean([b.mean[2] - FACTORS[k - 1] for k, b in enumerate(believed(high, settings)) if k > 3])

    assert abs(bias(lasting)) < 0.5 * abs(bias(alike))
    level = believed(high, lasting)[-1].mean[SETTINGS.lags]
    assert 0.1 < level < 0.6
    assert believed(high)[-1].mean[SETTINGS.lags] == 0.0


def test_stated_uncertainty_is_that_of_the_factor():
    told = believed(CATALOGUE)[10:]
    error = [belief.mean[2] - FACTORS[k + 9] for k, belief in enumerate(told)]
    sigma = [np.sqrt(belief.covariance[2, 2]) for belief in told]
    assert 0.5 < np.sqrt(np.mean(np.square(error)) / np.mean(np.square(sigma))) < 1.6


def test_many_bodies_tell_more_than_one():
    def variance(count):
        return believed(CATALOGUE[:count])[-1].covariance[2, 2]

    assert variance(BODIES) < 0.65 * variance(1)


@pytest.mark.parametrize("member", [3, None])
def test_nothing_estimated_after_t_i_is_known(member):
    when = 14.3 * DAY

    def told(catalogue, own):
        own = own[own["t"] <= when]
        readings = thermometer.read(own, catalogue, member, SETTINGS).values()
        return b"".join(np.append(one.factors, one.cd_window).tobytes() for one in readings)

    def changed(table):
        return table.assign(cd=np.where(table["t"] > when, 1.7 * table["cd"], table["cd"]))

    own = CATALOGUE[3] if member is not None else estimates(77, FACTORS)
    assert told(list(map(changed, CATALOGUE)), changed(own)) == told(CATALOGUE, own)
    # The test can fail: what came before does count.
    earlier = [
        table.assign(cd=np.where(table["t"] < DAY * 9, 1.7 * table["cd"], table["cd"])) for table in CATALOGUE
    ]
    assert told(earlier, own) != told(CATALOGUE, own)


def test_fits_of_others_at_t_i_are_not_known():
    own = CATALOGUE[0][:60]
    earlier = CATALOGUE[1][CATALOGUE[1]["t"] < own["t"].iloc[-1]]
    one, two = (
        thermometer.read(own, [own, table], 0, SETTINGS)[59].cd_window for table in (CATALOGUE[1], earlier)
    )
    assert one == two


def test_of_an_rso_left_out_only_the_fit_at_t_i_counts():
    own = estimates(77, FACTORS)
    others = own.assign(cd=np.where(own["track"] == 100, own["cd"], 1.7 * own["cd"]))
    alone, among = (thermometer.read(table, CATALOGUE, None, SETTINGS)[100] for table in (own, others))
    assert alone.cd_window == among.cd_window
    assert abs(np.log(alone.cd_window / own["cd"][100])) < 0.05


def test_a_fit_errs_by_the_excess_of_its_formal_error():
    own = estimates(77, FACTORS)
    vague = replace(SETTINGS, excess=30.0)
    moved = [
        abs(np.log(thermometer.read(own, CATALOGUE, None, settings)[100].cd_window / own["cd"][100]))
        for settings in (SETTINGS, vague)
    ]
    assert moved[1] > 3.0 * moved[0]


def test_fits_that_say_nothing_change_nothing():
    own = CATALOGUE[0]
    wild = own.assign(cd=9.0, converged=False)
    vague = own.assign(cd=9.0, cov_cd_cd=100.0)
    held = own.assign(cd=9.0, cov_cd_cd=0.0)
    told = [
        next(thermometer.beliefs([one, *CATALOGUE[1:]], np.array([20.0 * DAY]), 0, SETTINGS))
        for one in (wild, vague, held)
    ]
    for belief in told[1:]:
        np.testing.assert_array_equal(belief.mean, told[0].mean)
    assert told[0].mean[-1] == pytest.approx(np.log(thermometer.COMMON_CD))


def test_what_a_fit_saw_is_the_parabola_through_its_tracks():
    random = np.random.default_rng(3)
    t, step = 10.3 * DAY, SETTINGS.step
    tracks = np.sort(random.uniform(t - SETTINGS.window, t, 20))
    drag = random.normal(size=40)

    def moved(at):
        """Displacement by the drag of each step since the oldest track, by a sum of small pieces."""
        since = tracks[0] + (np.arange(100_000) + 0.5) / 100_000 * (at - tracks[0])
        return (drag[SETTINGS.step_of(since)] * (at - since)).mean() * (at - tracks[0])

    fit = np.polynomial.Polynomial.fit(tracks - t, [moved(at) for at in tracks], 2).convert()
    found = thermometer.seen(t, tracks, SETTINGS)
    x = drag[int(t // step) - np.arange(SETTINGS.lags)]
    assert found.shares.sum() == pytest.approx(1.0)
    assert found.shares @ x == pytest.approx(2.0 * fit.coef[2], rel=1e-4)
    # Behind t_i nothing but what is in the window, so that the whole error is that of the state and Cd.
    drag[int(t // step) + 1 :] = 0.0
    duration = 2.0 * DAY
    rest = (int(t // step) + 1) * step - t
    ahead = x[0] * (duration**2 - (duration - rest) ** 2) / duration**2
    error = (fit(duration) - moved(t + duration)) / (0.5 * duration**2)
    within = found.within(np.array([duration / SETTINGS.window]))
    assert (within @ x)[0] - ahead == pytest.approx(error, rel=1e-3)
    assert within.sum() == pytest.approx(1.0)


def test_factor_ahead_is_its_decay_weighted_by_what_is_left_of_the_prediction():
    duration = 5.0 * DAY
    since = (np.arange(200_000) + 0.5) / 200_000 * duration
    weight = duration - since
    expected = (weight * np.exp(-since / (3.0 * DAY))).sum() / weight.sum()
    assert SETTINGS.ahead(np.array([duration])) == pytest.approx(expected, rel=1e-6)
    assert SETTINGS.ahead(np.array([0.0])) == pytest.approx(1.0, abs=1e-4)


def test_correction_is_the_arcs_where_all_agree():
    pairs = pd.DataFrame({"i": [1, 1], "j": [2, 3], "t_i": 0.0, "t_j": [DAY, 2.0 * DAY]})
    answers = {f"l_arc_{axis}": [3.0, 4.0] for axis in STATE} | {
        f"v_arc_{axis}": [5.0, 6.0] for axis in STATE
    }
    arcs = pd.DataFrame(answers | {"cd_arc": 2.0})
    sensitivities = pd.DataFrame({f"s_{axis}": [7.0, 8.0] for axis in STATE})
    saw = thermometer.seen(10.0 * DAY, np.arange(9.0, 10.01, 0.1) * DAY, SETTINGS)
    calm = Reading(np.zeros(SETTINGS.lags), 2.0, saw)
    found = thermometer.corrections(pairs, {1: calm}, arcs, sensitivities, SETTINGS)
    assert list(found.columns) == SCHEMAS["thermometer"].names
    assert found["thermo_y"].tolist() == pytest.approx([3.0, 4.0])
    # A factor that lasts is in the window and ahead; one that decays only in the window.
    warm = replace(calm, factors=np.full(SETTINGS.lags, 0.1), cd_window=2.2)
    lasting = replace(SETTINGS, decay_days=1e6)
    moved = thermometer.corrections(pairs, {1: warm}, arcs, sensitivities, lasting)["thermo_y"]
    assert moved.tolist() == pytest.approx([3.0 - 5.0 * 0.2, 4.0 - 6.0 * 0.2], rel=1e-4)
    decayed = thermometer.corrections(pairs, {1: warm}, arcs, sensitivities, SETTINGS)
    assert (decayed["cd_ahead"] < decayed["cd_window"]).all()
    assert (decayed["thermo_y"] > moved).all()


def test_catalogue_is_what_its_remark_says():
    expected = random_sheet.sheet("sky", 40, 7)
    path = REPOSITORY / "config" / "catalogue.tsv"
    assert path.read_text(encoding="utf-8") == expected
    assert len(read_rsos(path)) == 40
    assert random_sheet.sheet("sky", 3, 7) == "".join(expected.splitlines(keepends=True)[:4])
