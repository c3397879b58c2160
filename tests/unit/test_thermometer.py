"""The catalogue as a thermometer: what it finds, what it must not know, and what it makes of predictions."""

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from support import REPOSITORY

from opml.catalog import drawn, thermometer
from opml.catalog.thermometer import Thermometer
from opml.constants import DAY, HOUR
from opml.sheets import read_rsos
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
    """Fits of one body every five hours: its Cd times the mean factor over the window."""
    random = np.random.default_rng(seed)
    t = np.arange(DAY, STEPS * SETTINGS.step, 5.0 * HOUR)
    step = np.floor(t / SETTINGS.step).astype(int)
    shared = (SETTINGS.shares(t) * factor[step[:, None] - np.arange(SETTINGS.lags)]).sum(axis=1)
    cd = np.exp(np.log(2.2) + 0.4 * random.normal() + shared + spread * random.normal(size=len(t)))
    return pd.DataFrame(
        {"track": np.arange(len(t)), "t": t, "cd": cd, "cov_cd_cd": (0.01 * cd) ** 2, "converged": True}
    )


FACTORS = factors()
CATALOGUE = [estimates(seed, FACTORS) for seed in range(BODIES)]


def test_the_factor_of_a_catalogue_is_found():
    told = thermometer.beliefs(CATALOGUE, SETTINGS)
    # What is believed of a step at its end is in the first lag of the next step.
    found = np.array([belief.mean[1] for belief in told[1:]])[10:]
    true = FACTORS[: len(told) - 1][10:]
    assert np.corrcoef(found, true)[0, 1] > 0.9
    # But for a constant, which bodies that are all alike would have, too.
    assert np.std(found - true) < 0.5 * np.std(true)


def test_an_error_that_lasts_is_the_level_and_not_the_factor():
    lasting = replace(SETTINGS, level_sigma=0.5)
    high = [table.assign(cd=1.5 * table["cd"]) for table in CATALOGUE]
    body = [
        thermometer.read(high[0], thermometer.beliefs(high, s), 0, s)["body"] for s in (SETTINGS, lasting)
    ]
    true = np.log(high[0]["cd"]).mean() - FACTORS.mean()
    assert abs(body[1][20:60].mean() - true) < 0.6 * abs(body[0][20:60].mean() - true)
    level = thermometer.beliefs(high, lasting)[-1].mean[SETTINGS.lags]
    assert 0.1 < level < 0.6
    assert thermometer.beliefs(high, SETTINGS)[-1].mean[SETTINGS.lags] == 0.0


def test_stated_uncertainty_is_that_of_the_factor():
    told = thermometer.beliefs(CATALOGUE, SETTINGS)[10:]
    error = [belief.mean[1] - FACTORS[k + 9] for k, belief in enumerate(told)]
    sigma = [np.sqrt(belief.covariance[1, 1]) for belief in told]
    assert 0.5 < np.sqrt(np.mean(np.square(error)) / np.mean(np.square(sigma))) < 1.6


def test_many_bodies_tell_more_than_one():
    def change(count):
        covariance = thermometer.beliefs(CATALOGUE[:count], SETTINGS)[-1].covariance
        return covariance[1, 1] + covariance[2, 2] - 2.0 * covariance[1, 2]

    assert change(BODIES) < 0.65 * change(1)


@pytest.mark.parametrize("member", [3, None])
def test_nothing_estimated_after_t_i_is_known(member):
    when = 14.3 * DAY

    def told(catalogue, own):
        beliefs = thermometer.beliefs(catalogue, SETTINGS)
        table = thermometer.read(own, beliefs, member, SETTINGS)
        return table[table["t"] <= when].to_numpy().tobytes()

    def changed(table):
        return table.assign(cd=np.where(table["t"] > when, 1.7 * table["cd"], table["cd"]))

    own = CATALOGUE[3] if member is not None else estimates(77, FACTORS)
    assert told(list(map(changed, CATALOGUE)), changed(own)) == told(CATALOGUE, own)
    # The test can fail: what came before does count.
    earlier = [
        table.assign(cd=np.where(table["t"] < DAY * 9, 1.7 * table["cd"], table["cd"])) for table in CATALOGUE
    ]
    assert told(earlier, own) != told(CATALOGUE, own)


def test_of_an_rso_left_out_only_the_fit_at_t_i_counts():
    told, own = thermometer.beliefs(CATALOGUE, SETTINGS), estimates(77, FACTORS)
    one = own["track"] == 100
    alone = thermometer.read(own[one], told, None, SETTINGS)
    among = thermometer.read(own, told, None, SETTINGS)
    pd.testing.assert_frame_equal(alone, among[one.to_numpy()].reset_index(drop=True))
    assert abs(np.log(alone["cd_window"].item() / own.loc[one, "cd"].item())) < 0.05


def test_fits_that_say_nothing_change_nothing():
    own = CATALOGUE[0]
    wild = own.assign(cd=9.0, converged=False)
    vague = own.assign(cd=9.0, cov_cd_cd=100.0)
    held = own.assign(cd=9.0, cov_cd_cd=0.0)
    told = [thermometer.beliefs([*CATALOGUE[1:], one], SETTINGS) for one in (wild, vague, held)]
    for beliefs in told[1:]:
        np.testing.assert_array_equal(beliefs[-1].mean, told[0][-1].mean)
    assert told[0][-1].mean[-1] == pytest.approx(np.log(thermometer.COMMON_CD))


def test_shares_of_a_window_add_up_and_are_those_by_hand():
    assert SETTINGS.shares(np.array([6.0 * HOUR])) == pytest.approx(np.array([[0.25, 0.5, 0.25]]))
    assert SETTINGS.shares(np.arange(0.0, 9.0 * DAY, 1234.5)).sum(axis=1) == pytest.approx(1.0)


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
    told = pd.DataFrame({"track": [1], "t": 0.0, "body": np.log(2.0), "factor": 0.0, "cd_window": 2.0})
    found = thermometer.corrections(pairs, told, arcs, sensitivities, SETTINGS)
    assert list(found.columns) == SCHEMAS["thermometer"].names
    assert found["thermo_y"].tolist() == pytest.approx([3.0, 4.0])
    # A factor that lasts is in the window and ahead; one that decays only in the window.
    warm = told.assign(factor=0.1, cd_window=2.0 * np.exp(0.1))
    lasting = replace(SETTINGS, decay_days=1e6)
    moved = thermometer.corrections(pairs, warm, arcs, sensitivities, lasting)["thermo_y"]
    assert moved.tolist() == pytest.approx([3.0 - 5.0 * 0.21034, 4.0 - 6.0 * 0.21034], rel=1e-4)
    decayed = thermometer.corrections(pairs, warm, arcs, sensitivities, SETTINGS)
    assert (decayed["cd_ahead"] < decayed["cd_window"]).all()
    assert (decayed["thermo_y"] > moved).all()


def test_catalogue_is_what_its_remark_says():
    expected = drawn.sheet("sky", 40, 7)
    path = REPOSITORY / "config" / "catalogue.tsv"
    assert path.read_text(encoding="utf-8") == expected
    assert len(read_rsos(path)) == 40
    assert drawn.sheet("sky", 3, 7) == "".join(expected.splitlines(keepends=True)[:4])
