"""Splits: which rows they choose, how they nest, and which names they refuse."""

from itertools import pairwise

import numpy as np
import pandas as pd
import pytest
from support import refusal

from opml.base.errors import InputError
from opml.learning.data import splits
from opml.learning.data.cleaning import OUTSIDE_FENCES

DAY = 86400.0
SPAN = [0, 30]


@pytest.fixture
def table():
    # A row every hour of 50 days; every seventh was dropped by the cleaning.
    t_j = 3600.0 * np.arange(1, 1201)
    # Each estimate serves 24 rows, the first of them two hours after it.
    i = np.arange(1200) // 24
    t_i = 3600.0 * (24 * i - 1)
    return pd.DataFrame({"i": i, "t_i": t_i, "t_j": t_j, "keep": np.arange(1200) % 7 != 3})


def train(table, name, seed=42):
    return splits.training_rows(table, name, span_days=SPAN, seed=seed)


def to_test(table, name, trained=None):
    return splits.test_rows(table, name, span_days=SPAN, trained=trained)


def candidates(table):
    return (table["keep"] & (table["t_j"] <= 30 * DAY)).to_numpy()


def test_random_split_takes_its_share_of_kept_rows_in_the_span(table):
    rows = train(table, "random-80")
    assert rows.sum() == round(0.8 * candidates(table).sum())
    assert not (rows & ~candidates(table)).any()


@pytest.mark.parametrize("name", ["random-100", "grouped-100", "days-10-30"])
def test_labels_that_are_not_known_yet_are_not_trained_on(table, name):
    late = table.assign(t_known=table["t_j"] + 0.5 * DAY)
    rows = train(late, name)
    assert (rows == train(table, name) & (table["t_j"] <= 29.5 * DAY)).all()
    assert rows.sum() == (train(table, name) & (table["t_j"] <= 29.5 * DAY)).sum() > 0


def test_rows_learned_from_under_labels_are_not_tested_on(table):
    late = table.assign(t_known=table["t_j"] + 0.5 * DAY, keep=table["keep"] & (table["i"] % 3 > 0))
    trained = train(late, "random-80")
    rest = to_test(table, "rest", trained)
    assert (rest == candidates(table) & ~trained).all()
    seen = to_test(table, "seen", trained)
    assert (seen == trained).all()


def test_random_split_is_random_and_repeatable(table):
    rows = train(table, "random-50")
    assert (rows == train(table, "random-50")).all()
    assert (rows != train(table, "random-50", seed=43)).any()
    first, second = rows[candidates(table)][:300].mean(), rows[candidates(table)][-300:].mean()
    assert 0.4 < first < 0.6
    assert 0.4 < second < 0.6


def test_smaller_shares_nest_in_larger_ones(table):
    shares = [train(table, f"random-{percent}") for percent in range(10, 100, 10)]
    for small, large in pairwise(shares):
        assert (large | ~small).all()
        assert large.sum() > small.sum()


def test_later_days_do_not_move_the_draw(table):
    short = table[table["t_j"] <= 30 * DAY]
    assert (train(short, "random-40") == train(table, "random-40")[: len(short)]).all()


def test_rest_and_seen_are_complements_in_the_span(table):
    trained = train(table, "random-80")
    seen, rest = (to_test(table, name, trained) for name in ("seen", "rest"))
    assert (seen == trained).all()
    assert not (seen & rest).any()
    assert ((seen | rest) == candidates(table)).all()


def test_windows_are_half_open_and_adjoin(table):
    trained = train(table, "days-0-30")
    tested = to_test(table, "days-30-40", trained)
    t_j = table["t_j"].to_numpy()
    assert (trained == (table["keep"] & (t_j <= 30 * DAY))).all()
    assert (tested == (table["keep"] & (t_j > 30 * DAY) & (t_j <= 40 * DAY))).all()
    assert t_j[trained].max() == 30 * DAY  # the row on the border is trained on, and only that


def test_window_leaves_trained_rows_out(table):
    trained = train(table, "days-0-30")
    tested = to_test(table, "days-20-40", trained)
    assert table["t_j"][tested].min() > 30 * DAY


def test_another_rso_has_no_trained_rows(table):
    rest = to_test(table, "rest")
    assert (rest == candidates(table)).all()
    with pytest.raises(InputError, match="'seen': expected at least one kept row"):
        to_test(table, "seen")


def test_untrained_window_is_open_at_its_first_day(table):
    first = table["t_j"][to_test(table, "days-30-40")].min()
    assert first == 30 * DAY + 3600.0


def test_windows_take_decimal_days(table):
    assert table["t_j"][train(table, "days-0.5-1.25")].between(0.5 * DAY, 1.25 * DAY).all()


def test_splits_without_rows(table):
    assert "'days-60-70': expected at least one kept row" in refusal(train, table, "days-60-70")
    with pytest.raises(InputError, match="'rest': expected at least one kept row"):
        to_test(table, "rest", train(table, "days-0-30"))
    with pytest.raises(InputError, match="'random-80': expected at least one kept row"):
        train(table.assign(keep=False), "random-80")


def test_grouped_split_takes_all_rows_of_its_share_of_the_estimates(table):
    rows = train(table, "grouped-80")
    inside = candidates(table)
    chosen = table["i"][rows].unique()
    assert len(chosen) == round(0.8 * table["i"][inside].nunique())
    assert (rows == (inside & table["i"].isin(chosen).to_numpy())).all()
    assert (rows == train(table, "grouped-80")).all()
    assert (rows != train(table, "grouped-80", seed=43)).any()


def test_smaller_grouped_shares_nest_in_larger_ones(table):
    small, large = train(table, "grouped-20"), train(table, "grouped-60")
    assert (large | ~small).all()
    assert large.sum() > small.sum()


def test_unseen_window_leaves_out_estimates_from_before_it(table):
    trained = train(table, "days-0-30")
    window = to_test(table, "days-30-40", trained)
    unseen = to_test(table, "days-30-40-unseen", trained)
    assert (window | ~unseen).all()
    assert (table["t_i"][unseen] > 30 * DAY).all()
    assert (table["t_i"][window & ~unseen] <= 30 * DAY).all()
    assert (window & ~unseen).any()


def test_a_test_without_fences_takes_what_only_they_dropped(table):
    fenced = np.arange(len(table)) % 7 == 3
    reasons = np.where(
        fenced, np.where(np.arange(len(table)) % 2, OUTSIDE_FENCES, "no prediction: decayed"), ""
    )
    errors = np.where(fenced, 1e5, np.arange(len(table)) % 11)
    table = table.assign(reason=reasons, e_y=errors)
    kept, free, refenced = (to_test(table, f"days-30-40{fence}") for fence in ("", "-unfenced", "-fence3"))
    assert set(table["reason"][free & ~kept]) == {OUTSIDE_FENCES}
    assert (free | ~kept).all()
    assert (refenced == kept).all()  # their errors are far outside of the others'
    wide = to_test(table, "days-30-40-fence1000000")
    assert (wide == free).all()
