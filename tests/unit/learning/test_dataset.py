"""The dataset on eight tracks in which every row's fate and values are known beforehand.

| track | day | estimate                         |
| ----- | --- | -------------------------------- |
| 0     | 0   | fine, first                      |
| 1     | 1   | Cd 5, outside                    |
| 2     | 2   | fine, before it the Cd outside   |
| 3     | 3   | not converged                    |
| 4     | 4   | fine, before it the failed one   |
| 5     | 5   | fine                             |
| 6     | 13  | fine, eight days after track 5   |
| 7     | 14  | fine, no track after             |
"""

import numpy as np
import pandas as pd
import pytest
from support import refusal

from opml.base.errors import InputError
from opml.learning.data import dataset
from opml.learning.data.cleaning import Cleaning
from opml.orbits.elements import cartesian_from_coe
from opml.orbits.manoeuvres import Manoeuvre
from opml.tables import LEARNING_VARIABLES, SCHEMAS, SIGMAS, STATE, read_table, write_table

GM = 3.986004418e14
DAY = 86400.0
EPOCHS = DAY * np.array([0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 13.0, 14.0])
CD = np.array([2.2, 5.0, 2.1, 2.2, 2.3, 2.2, 2.0, 2.2])
CLEANING = {"cd_min": 1.2, "cd_max": 3.2, "fence": 1e6, "fence_days": [0, 30], "previous": "kept_estimate"}
E_VELOCITY = ["e_vx", "e_vy", "e_vz"]
E_ALL = ["e_x", "e_y", "e_z", *E_VELOCITY]

# Over the x axis moving up, so that R = x, S = z, W = -y.
UPWARDS = np.array([7e6, 0.0, 0.0, 0.0, 0.0, 7600.0])
# Perigee and node just before and after a full turn.
ELEMENTS = np.array([7e6, 0.01, 0.9, 6.2, 0.1, 0.05])
SHIFTED = np.array([7e6 + 40.0, 0.012, 0.9 - 1e-3, 0.02, 6.25, 0.01])


@pytest.fixture
def estimates():
    states = np.tile(cartesian_from_coe([7.1e6, 0.02, 1.2, 1.0, 2.0, 3.0], GM), (8, 1))
    states[2] = UPWARDS
    states[4] = cartesian_from_coe(ELEMENTS, GM)
    states[3] = 1e300  # no orbit: must neither warn nor spread
    table = pd.DataFrame(states, columns=list(STATE))
    return table.assign(track=range(8), t=EPOCHS, cd=CD, converged=[True, True, True, False, *[True] * 4])


@pytest.fixture
def predictions():
    pairs = [(i, j) for i in range(8) for j in range(i + 1, 8) if EPOCHS[j] - EPOCHS[i] <= 7 * DAY]
    i, j = np.array(pairs).T
    table = pd.DataFrame({"i": i, "j": j, "t_i": EPOCHS[i], "t_j": EPOCHS[j]})
    table[list(STATE)] = cartesian_from_coe([7.1e6, 0.02, 1.2, 1.0, 2.0, 3.1], GM)
    table[[f"{name}_true" for name in STATE]] = 0.0
    table["e_x"], table["e_y"], table["e_z"] = 1.0 * i, 10.0 * i + j, -1.0 * j
    table[E_VELOCITY] = np.outer(i + j, [1e-3, 2e-3, 3e-3])
    table["reason"] = np.where(i == 3, "no estimate", "")
    table = table.set_index(["i", "j"])
    table.loc[(0, 2), list(STATE)] = UPWARDS + np.array([100.0, 20.0, 300.0, 1.0, 2.0, 3.0])
    table.loc[(2, 4), list(STATE)] = cartesian_from_coe(SHIFTED, GM)
    failed = [(2, 5), *((3, j) for j in (4, 5))]
    table.loc[failed, [*STATE, "e_x", "e_y", "e_z", *E_VELOCITY]] = np.nan
    table.loc[(2, 5), "reason"] = "below 120 km"
    return table.reset_index()


@pytest.fixture
def tracking():
    # Three measurements a track by two stations; the second is the highest, and not the last or the first.
    track = np.repeat(np.arange(8), 3)
    return pd.DataFrame(
        {
            "track": track,
            "t": np.repeat(EPOCHS, 3) + np.tile([0.0, 20.0, 20.0], 8),
            "station": ["eglin", "eglin", "clear"] * 8,
            "elevation": np.tile([0.2, 0.5, 0.3], 8) + 0.01 * track,
            "azimuth": np.tile([1.0, 2.0, 3.0], 8) + 0.01 * track,
            "range": np.tile([2e6, 1e6, 3e6], 8) + track,
            "elevation_true": np.tile([0.9, 0.1, 0.1], 8),
        }
    )


def build(estimates, predictions, tracking, *, labels=None, manoeuvres=(), window=0.0, **changes):
    given = {"manoeuvres": manoeuvres, "window": window, "labels": labels}
    cleaning = Cleaning(**CLEANING).evolve(**changes)
    return dataset.build(estimates, predictions, tracking, gm=GM, cleaning=cleaning, **given)


def with_errors(predictions, *e_y):
    """Predictions of which those that survive have these errors."""
    table = predictions.set_index(["i", "j"])
    table.loc[[(2, 3), (2, 4), (4, 5)], "e_y"] = e_y
    return table.reset_index()


@pytest.fixture
def rows(estimates, predictions, tracking):
    return build(estimates, predictions, tracking).set_index(["i", "j"])


def test_every_pair_stays_with_its_reason(rows):
    reasons = rows["reason"].to_dict()
    expected = {(0, j): dataset.NO_PREVIOUS_ESTIMATE for j in range(1, 6)}
    expected |= {(1, j): dataset.CD_OUTSIDE for j in range(2, 6)}
    expected |= {(2, 3): "", (2, 4): "", (2, 5): "no prediction: below 120 km"}
    expected |= {(3, j): dataset.FIT_NOT_CONVERGED for j in (4, 5)}
    expected |= {(4, 5): "", (6, 7): dataset.NO_RELATIVE_ERROR}
    assert reasons == expected
    assert rows["keep"].to_dict() == {pair: reason == "" for pair, reason in expected.items()}


def test_rows_without_a_true_state_are_dropped_with_that_reason(rows, estimates, predictions, tracking):
    """As where tracks were measured; other reasons stand before it, and fences find nothing to hold."""
    errors = [name for name in predictions if name.startswith("e_")]
    found = build(estimates, predictions.assign(**dict.fromkeys(errors, np.nan)), tracking)
    expected = rows["reason"].where(rows["reason"] != "", dataset.NO_TRUE_STATE)
    assert found["reason"].tolist() == expected.tolist()
    assert not found["keep"].any()


def test_previous_kept_estimate_takes_the_place_of_removed_ones(rows):
    b = rows["b"].groupby("i").first()
    assert b.to_dict() == {0: -1, 1: 0, 2: 0, 3: 2, 4: 2, 6: 5}
    assert rows.loc[(4, 5), ["t_b", "gap"]].tolist() == [2 * DAY, 2 * DAY]
    assert rows.loc[(4, 5), ["cd_b", "d_cd"]].tolist() == pytest.approx([2.1, 2.1 - 2.3])
    assert np.isnan(rows.loc[(0, 1), "t_b"])


def test_previous_track_or_none(estimates, predictions, tracking):
    rows = build(estimates, predictions, tracking, previous="track").set_index(["i", "j"])
    assert rows["b"].groupby("i").first().to_dict() == {0: -1, 1: 0, 2: -1, 3: 2, 4: -1, 6: 5}
    # Tracks 2 and 4 follow an estimate that is outside or failed.
    assert rows["reason"].to_dict() == {
        **{(0, j): dataset.NO_PREVIOUS_ESTIMATE for j in range(1, 6)},
        **{(1, j): dataset.CD_OUTSIDE for j in range(2, 6)},
        **{(2, j): dataset.NO_PREVIOUS_ESTIMATE for j in (3, 4)},
        (2, 5): "no prediction: below 120 km",
        **{(3, j): dataset.FIT_NOT_CONVERGED for j in (4, 5)},
        (4, 5): dataset.NO_PREVIOUS_ESTIMATE,
        (6, 7): dataset.NO_RELATIVE_ERROR,
    }


def test_previous_track_serves_when_it_is_fine(estimates, predictions, tracking):
    estimates.loc[1, "cd"] = 2.0
    rows = build(estimates, predictions, tracking, previous="track").set_index(["i", "j"])
    assert rows.loc[(2, 3), ["b", "t_b", "cd_b", "keep"]].tolist() == [1, DAY, 2.0, True]


def test_relative_error_in_rsw_of_the_estimate(rows):
    relative = rows.loc[(2, 4), dataset.RSW_DIFFERENCE].tolist()
    assert relative == pytest.approx([100.0, 300.0, -20.0, 1.0, 3.0, -2.0], abs=1e-8)


def test_relative_error_in_elements_is_wrapped(rows):
    row = rows.loc[(4, 5)]
    turn = 2 * np.pi
    assert row[dataset.COE].tolist() == pytest.approx(ELEMENTS.tolist(), rel=1e-9)
    assert row[dataset.COE_DIFFERENCE].tolist() == pytest.approx(
        [40.0, 0.002, -1e-3, 0.02 - 6.2 + turn, 6.25 - 0.1 - turn, -0.04], rel=1e-6
    )


def test_duration_and_targets_are_the_pairs_own(rows):
    row = rows.loc[(2, 4)]
    assert row[["duration", "t_i", "t_j"]].tolist() == [2 * DAY, 2 * DAY, 4 * DAY]
    assert row[["e_x", "e_y", "e_z", *E_VELOCITY]].tolist() == pytest.approx(
        [2.0, 24.0, -4.0, 6e-3, 12e-3, 18e-3]
    )


def test_highest_noisy_measurement_of_the_track(rows):
    assert rows.loc[(2, 3), dataset.MEASUREMENT].tolist() == pytest.approx([0.52, 2.02, 1e6 + 2])
    assert rows.loc[(6, 7), dataset.MEASUREMENT].tolist() == pytest.approx([0.56, 2.06, 1e6 + 6])


def test_fixes_have_no_highest_measurement(estimates, predictions, tracking):
    rows = build(estimates, predictions, tracking[["track", "t"]])
    by_radars = build(estimates, predictions, tracking)
    assert rows[dataset.MEASUREMENT].isna().all(axis=None)
    rest = [name for name in rows if name not in dataset.MEASUREMENT]
    pd.testing.assert_frame_equal(rows[rest], by_radars[rest], check_exact=True)


def test_kept_rows_have_every_learning_variable(rows):
    assert np.isfinite(rows.loc[rows["keep"], list(LEARNING_VARIABLES)].to_numpy(dtype=float)).all()


def test_fences_drop_what_lies_outside(estimates, predictions, tracking):
    # Surviving e_y: 0, 10 and 1000, so q1 = 2.5, q3 = 752.5 and with 1/4 of the range the upper fence is 940.
    predictions = with_errors(predictions, 0.0, 10.0, 1000.0)
    # Dropped for another reason: neither counted nor renamed.
    predictions.loc[(predictions["i"] == 0) & (predictions["j"] == 1), "e_y"] = -1e9
    rows = build(estimates, predictions, tracking, fence=0.25).set_index(["i", "j"])
    assert rows.loc[(4, 5), "reason"] == dataset.OUTSIDE_FENCES
    assert rows["keep"].sum() == 2
    assert rows.loc[(0, 1), "reason"] == dataset.NO_PREVIOUS_ESTIMATE
    # 0.34 of the range reach 1007.5.
    assert build(estimates, predictions, tracking, fence=0.34)["keep"].sum() == 3


def test_fences_come_from_their_days_and_hold_for_all(estimates, predictions, tracking):
    predictions = with_errors(predictions, 0.0, 10.0, 13.0)
    # From 0 and 10 alone: q1 = 0, q3 = 10, the upper fence 12.
    rows = build(estimates, predictions, tracking, fence=0.2, fence_days=[0, 4]).set_index(["i", "j"])
    assert rows.loc[(4, 5), "reason"] == dataset.OUTSIDE_FENCES
    assert rows["keep"].sum() == 2


def test_fence_days_without_a_row(estimates, predictions, tracking):
    with pytest.raises(InputError, match="Tukey"):
        build(estimates, predictions, tracking, fence_days=[20, 30])


def test_fences_of_no_days_come_from_all_rows(estimates, predictions, tracking):
    predictions = with_errors(predictions, 0.0, 10.0, 1000.0)
    # q1 = 2.5 and q3 = 752.5 of all three, the upper fence 1007.5; 0 and 10 alone would put it at 13.4.
    assert build(estimates, predictions, tracking, fence=0.34, fence_days=None)["keep"].sum() == 3
    assert build(estimates, predictions, tracking, fence=0.34, fence_days=[0, 4])["keep"].sum() == 2


def test_no_cleaning_drops_only_what_lacks_something(estimates, predictions, tracking):
    predictions.loc[predictions["i"] == 4, "e_y"] = 1e12
    rows = dataset.build(estimates, predictions, tracking, gm=GM, cleaning=Cleaning()).set_index(["i", "j"])
    assert rows["b"].groupby("i").first().to_dict() == {0: -1, 1: 0, 2: 1, 3: 2, 4: 2, 6: 5}
    expected = {(0, j): dataset.NO_PREVIOUS_ESTIMATE for j in range(1, 6)}
    expected |= {(1, j): "" for j in range(2, 6)}  # Cd 5 is an estimate as any other
    expected |= {(2, 3): "", (2, 4): "", (2, 5): "no prediction: below 120 km"}
    expected |= {(3, j): dataset.FIT_NOT_CONVERGED for j in (4, 5)}
    expected |= {(4, 5): "", (6, 7): dataset.NO_RELATIVE_ERROR}
    assert rows["reason"].to_dict() == expected


def test_rows_that_cross_a_manoeuvre_are_dropped_with_that_reason(estimates, predictions, tracking):
    before = build(estimates, predictions, tracking)
    t = float(before["t_i"].iloc[len(before) // 2])
    after = build(estimates, predictions, tracking, manoeuvres=[Manoeuvre(t + 1.0)], window=100.0)
    begin = before[["t_b", "t_i"]].min(axis=1) - 100.0
    crossing = (begin < t + 1.0) & (t + 1.0 <= before["t_j"])
    assert crossing.any()
    assert not crossing.all()
    assert (after["reason"] == dataset.CROSSES_MANOEUVRE).equals(crossing)
    assert not after.loc[crossing, "keep"].any()
    pd.testing.assert_frame_equal(after[~crossing], before[~crossing])


def test_a_burn_that_tracks_showed_counts_once_it_was_found(estimates, predictions, tracking):
    """One between tracks 4 and 5, which track 5 shows: errors that were known before have no part in it."""
    burn, found = 4.5 * DAY, EPOCHS[5]
    shown = estimates.assign(burn_t=np.where(estimates["t"] == found, burn, np.nan))
    rows, before = build(shown, predictions, tracking), build(estimates, predictions, tracking)
    begin = before[["t_b", "t_i"]].min(axis=1)
    behind = before["t_i"] > burn
    since = before["t_i"].where(behind, before["t_j"]) >= found
    crossing = (begin < burn) & (burn <= before["t_j"]) & since
    assert (rows["reason"] == dataset.CROSSES_MANOEUVRE).equals(crossing)
    assert set(before.loc[crossing, "i"]) >= {2, 4}
    later = shown.assign(burn_t=np.where(estimates["t"] == EPOCHS[6], burn, np.nan))
    assert not (build(later, predictions, tracking)["reason"] == dataset.CROSSES_MANOEUVRE).any()
    pd.testing.assert_frame_equal(rows[~crossing], before[~crossing])


def test_no_ephemeris_departs_whose_last_estimate_is_before_a_burn_that_was_found(
    estimates, predictions, tracking
):
    def may_depart(found):
        shown = estimates.assign(burn_t=np.where(estimates["track"] == found, 4.5 * DAY, np.nan))
        at = dataset.of_estimates(shown, predictions, tracking, gm=GM, cleaning=Cleaning(**CLEANING))
        return dataset.may_depart(shown, at)[5]

    assert may_depart(found=6)
    assert not may_depart(found=5)


def test_a_manoeuvre_changes_no_row_whose_error_was_known_before_it_was_found(
    estimates, predictions, tracking
):
    def dropped(known):
        manoeuvres = [Manoeuvre(3.5 * DAY, known)]
        rows = build(estimates, predictions, tracking, manoeuvres=manoeuvres, window=0.1 * DAY)
        return rows["reason"] == dataset.CROSSES_MANOEUVRE

    rows, always = build(estimates, predictions, tracking), dropped(-np.inf)
    found = dropped(4.5 * DAY)
    departed, over = rows["t_i"] < 3.5 * DAY, rows["t_j"] < 4.5 * DAY
    assert (always & departed & over).any()
    assert (always & ~departed & (rows["t_i"] < 4.5 * DAY)).any()
    assert not found[over].any()
    # Predictions that departed unknowingly, after the burn and before it was found, were issued and count.
    assert found.equals(always & ~over & (departed | (rows["t_i"] >= 4.5 * DAY)))


def test_all_estimates_outside_leave_no_row_and_no_error(estimates, predictions, tracking):
    rows = build(estimates.assign(cd=9.0), predictions, tracking)
    assert not rows["keep"].any()
    assert len(rows) == len(predictions)


def labels_of(predictions):
    """Labels 1 m above the true errors and known a day after t_j; that of (2, 4) is none."""
    labels = predictions[["i", "j", "reason"]].assign(t_known=predictions["t_j"] + DAY)
    labels[E_ALL] = predictions[E_ALL] + 1.0
    labels[SIGMAS] = 0.5
    lost = (labels["i"] == 2) & (labels["j"] == 4)
    labels.loc[lost, "reason"] = "later estimate: not converged"
    labels.loc[lost, [*E_ALL, *SIGMAS]] = np.nan
    return labels


def test_labels_take_the_place_of_the_true_errors(tmp_path, estimates, predictions, tracking):
    truth = build(estimates, predictions, tracking)
    measured = predictions.assign(**dict.fromkeys(E_ALL, np.nan))  # what has no truth has no true errors
    rows = build(estimates, measured, tracking, labels=labels_of(predictions))
    assert rows.columns.tolist() == SCHEMAS["labelled"].names
    lost = ((rows["i"] == 2) & (rows["j"] == 4)).to_numpy()
    assert truth.loc[lost, "keep"].all()
    assert rows.loc[lost, "reason"].tolist() == ["no label: later estimate: not converged"]
    assert rows.loc[~lost, "reason"].tolist() == truth.loc[~lost, "reason"].tolist()
    kept = rows["keep"]
    pd.testing.assert_frame_equal(rows.loc[kept, E_ALL], truth.loc[kept, E_ALL] + 1.0)
    variables = list(LEARNING_VARIABLES)
    pd.testing.assert_frame_equal(rows[variables], truth[variables])
    write_table(tmp_path / "d.parquet", rows, "labelled", metadata={})
    pd.testing.assert_frame_equal(dataset.read(tmp_path / "d.parquet"), rows, check_dtype=False)


def test_a_manoeuvre_before_the_label_is_known_drops_the_row(estimates, predictions, tracking):
    def dropped(labels):
        rows = build(estimates, predictions, tracking, manoeuvres=[Manoeuvre(5.5 * DAY)], labels=labels)
        return set(rows.loc[rows["reason"] == dataset.CROSSES_MANOEUVRE, "j"])

    assert 5 not in dropped(None)
    assert 5 in dropped(labels_of(predictions))


def test_fences_come_from_labels_that_were_known(estimates, predictions, tracking):
    labels = labels_of(predictions)
    labels.loc[labels["j"] == 5, "e_y"] = 1e9
    kept = []
    for days in ([0, 5.5], [0, 7]):
        rows = build(estimates, predictions, tracking, labels=labels, fence=3.0, fence_days=days)
        kept.append(rows.set_index(["i", "j"]).loc[(4, 5), "keep"])
    assert kept == [False, True]


def test_row_order_of_the_tables_does_not_matter(estimates, predictions, tracking):
    shuffled = (table.sample(frac=1.0, random_state=3) for table in (estimates, predictions, tracking))
    pd.testing.assert_frame_equal(build(*shuffled), build(estimates, predictions, tracking))


def test_inputs_are_left_alone(estimates, predictions, tracking):
    copies = [table.copy(deep=True) for table in (estimates, predictions, tracking)]
    build(estimates, predictions, tracking)
    for table, copy in zip((estimates, predictions, tracking), copies, strict=True):
        pd.testing.assert_frame_equal(table, copy)


def test_table_fits_its_schema(tmp_path, estimates, predictions, tracking):
    rows = build(estimates, predictions, tracking)
    assert rows.columns.tolist() == SCHEMAS["dataset"].names
    write_table(tmp_path / "d.parquet", rows, "dataset", metadata={})
    pd.testing.assert_frame_equal(read_table(tmp_path / "d.parquet", "dataset"), rows, check_dtype=False)


def test_tables_that_do_not_belong_together(estimates, predictions, tracking):
    assert "an estimate, got 2" in refusal(build, estimates[estimates["track"] != 2], predictions, tracking)
    assert "none of 6" in refusal(build, estimates, predictions, tracking[tracking["track"] != 6])


def pairs(**columns):
    return pd.DataFrame({"i": [0, 0, 1], "j": [1, 2, 2]} | columns)


def test_columns_of_another_table_of_the_same_pairs_come_beside():
    rows = pairs(keep=[True, True, False], reason=["", "", "why"], e_y=[1.0, 2.0, 3.0])
    other = pairs(v_y=[10.0, np.nan, np.nan]).iloc[::-1]
    found = dataset.join_table(rows, other)
    assert list(found["v_y"].fillna(0.0)) == [10.0, 0.0, 0.0]
    assert list(found["keep"]) == [True, False, False]
    assert list(found["reason"]) == ["", dataset.NO_NUMBERS, "why"]


def test_a_table_that_lacks_a_pair_is_told():
    rows = pairs(keep=True, reason="", e_y=0.0)
    with pytest.raises(InputError, match="expected every pair of the dataset, got none of 1, 2"):
        dataset.join_table(rows, pairs(v_y=0.0).iloc[:2])
