"""The model that a morning flies: what the past shows, how sure it is, and nothing from after it."""

import numpy as np
import pandas as pd
import pytest
from mornings import replays

from opml.base.constants import DAY
from opml.base.errors import InputError
from opml.learning.judge.model_choice import Mornings, choose
from opml.report import document, mornings, uncertainty
from opml.report.skill import skill
from opml.tables import COMPONENTS, DOUBT, SIGMA_STATE

NOW = 15.0 * DAY


def scaled(table, factor, *, since=0.0):
    """The same errors, so many times as large from a day on."""
    return table.assign(e_y=table["e_y"] * np.where(table["t_i"] >= since * DAY, factor, 1.0))


@pytest.fixture(scope="module")
def errors():
    return replays(days=25)


def test_the_plain_model_that_left_least_is_flown(errors):
    tables = {"fit48": scaled(errors, 2.0), "running": errors, "fit96": scaled(errors, 1.1)}
    assert choose(tables, [], now=NOW, seed=1).chosen == "running"


def test_what_was_best_lately_is_flown(errors):
    tables = {"fit48": errors, "running": scaled(scaled(errors, 0.5), 6.0, since=12.0)}
    assert choose(tables, [], now=12.0 * DAY, seed=1).chosen == "running"
    assert choose(tables, [], now=20.0 * DAY, seed=1).chosen == "fit48"


def test_a_law_is_flown_only_where_the_past_is_sure(errors):
    rng = np.random.default_rng(5)
    noisy = errors.assign(e_y=errors["e_y"] * np.exp(0.9 * rng.normal(size=len(errors)) - 0.42))
    sure = choose({"running": errors, "law": scaled(errors, 0.7)}, ["law"], now=NOW, seed=1)
    assert (sure.chosen, sure.plain, sure.law) == ("law", "running", "law")
    assert sure.high < 1.0
    unsure = choose({"running": errors, "law": noisy}, ["law"], now=NOW, seed=1)
    assert (unsure.chosen, unsure.law) == ("running", "law")
    assert unsure.high >= 1.0
    # Eight days of ended predictions are no evidence, however much better it was on them.
    early = choose({"running": errors, "law": scaled(errors, 0.01)}, ["law"], now=8.9 * DAY, seed=1)
    assert (early.chosen, early.law) == ("running", None)


def test_what_is_known_later_changes_no_choice(errors):
    tables = {"fit48": scaled(errors, 1.2), "running": errors, "law": scaled(errors, 0.8)}
    moved = {
        name: table.assign(e_y=table["e_y"].where(table["t_known"] <= NOW, 1e4 * (len(name) + 1)))
        for name, table in tables.items()
    }
    assert choose(tables, ["law"], now=NOW, seed=1) == choose(moved, ["law"], now=NOW, seed=1)


def test_without_a_past_nothing_is_chosen(errors):
    with pytest.raises(InputError, match=r"choice: expected replays that were over by day 0\.5, got none"):
        choose({"running": errors}, [], now=0.5 * DAY, seed=1)


def stated(table, sigma):
    return table.assign(**dict(zip(SIGMA_STATE, [10.0, sigma, 30.0, 0.02, 0.005, 0.03], strict=True)))


@pytest.fixture(scope="module")
def replayed(errors):
    """Mornings of two plain models and of a law that begins later."""
    table = stated(errors, 400.0)
    law = scaled(table, 0.6)
    return Mornings.from_replays(
        {"fit48": scaled(table, 2.0), "running": table, "law": law[law["t_i"] >= 5.0 * DAY]}, ["law"], seed=1
    )


def test_mornings_hold_the_same_predictions_of_every_model(replayed, errors):
    pairs = [list(zip(table["i"], table["j"], strict=True)) for table in replayed.tables.values()]
    assert pairs[0] == pairs[1] == pairs[2]
    assert min(replayed.choices) == 5.0 * DAY
    assert replayed.earlier == (errors["t_i"] < 5.0 * DAY).sum()
    assert len(replayed.selected) == len(pairs[0])
    flown = [one.chosen for one in replayed.choices.values()]
    assert flown[0] == "running"
    assert flown[-1] == "law"


def test_the_truth_judges_mornings_but_chooses_none(replayed):
    pairs = replayed.tables["running"][["i", "j"]]
    labelled = pairs.assign(**dict.fromkeys(COMPONENTS, 5.0))
    true = labelled.assign(e_x=6.0, e_y=105.0)
    true.loc[3, list(COMPONENTS)] = np.nan
    judged = replayed.against_truth(true, labelled)
    assert judged.choices == replayed.choices
    kept = np.arange(len(pairs)) != 3
    for name, table in judged.tables.items():
        before = replayed.tables[name][kept].reset_index(drop=True)
        for column, shift in (
            ("e_x", 1.0),
            ("e_y", 100.0),
            ("before", 100.0),
            ("e_z", 0.0),
            ("sigma_y", 0.0),
        ):
            np.testing.assert_allclose(table[column], before[column] + shift, atol=1e-9)
        assert (table[DOUBT] == 0.0).all(axis=None)
        assert list(table.columns) == list(before.columns)
    flown = judged.selected.set_index(["i", "j"])["e_y"] - replayed.selected.set_index(["i", "j"])["e_y"]
    np.testing.assert_allclose(flown.dropna(), 100.0)
    assert flown.isna().sum() == 1


def test_models_without_a_morning_in_common_are_told(errors):
    late = errors[errors["t_i"] > 30.0 * DAY]
    with pytest.raises(InputError, match="replays: expected a morning with a past and all models, got none"):
        Mornings.from_replays({"running": errors, "law": late}, ["law"], seed=1)


def test_the_report_leads_with_what_was_flown(replayed):
    key = ("lares", "eglin")
    text = document.markdown(
        [
            *mornings.section({key: replayed}, [1, 7], ["law"]),
            *uncertainty.section({key: replayed}, [1.0, 7.0]),
        ]
    )
    best, least = mornings.best_model(replayed, ["law"])
    assert best == "running"
    gained = round(skill(replayed.selected["e_y"].abs().sum(), least))
    assert 0 < gained < 40
    assert f"have a skill of {gained} % relative to `running`" in text
    assert "| selected each day |" in text
    assert "| no correction |" in text
    assert f"{replayed.earlier} more began before all models" in text
    assert "## Are the covariances realistic?" in text
    assert "90 % ellipsoid of the issued ephemerides contains" in text
    assert "nan" not in text
    unstated = Mornings.from_replays(
        {"running": replayed.tables["running"].assign(sigma_x=np.nan)}, [], seed=1
    )
    short = document.markdown(uncertainty.section({key: unstated}, [1.0]))
    assert uncertainty.TOO_SHORT in short


def test_rows_that_a_burn_spoilt_choose_nothing_once_it_is_known(errors):
    """Across a burn found on day ten the law is far off, as any model would have been."""
    burned = errors["t_i"].between(8.0 * DAY, 10.0 * DAY)
    law = scaled(errors, 0.3)
    law.loc[burned, "e_y"] *= 1e4
    burned_law = law.assign(burn_known=np.where(burned, 10.0 * DAY, np.inf))
    assert choose({"running": errors, "law": law}, ["law"], now=NOW, seed=1).chosen == "running"
    assert choose({"running": errors, "law": burned_law}, ["law"], now=NOW, seed=1).chosen == "law"
    found = Mornings.from_replays({"running": errors, "law": burned_law}, ["law"], seed=1)
    rows = int(np.isfinite(found.selected["burn_known"]).sum())
    assert rows > 0
    text = document.markdown(mornings.section({("lares", "eglin"): found}, [1, 7], ["law"]))
    assert f"{rows} predictions crossed a burn" in text


def test_a_study_without_replays_has_neither_section():
    assert not list(mornings.section({}, [1], []))
    assert not list(uncertainty.section({}, [1.0]))


def test_a_choice_depends_on_its_seed_only(errors):
    tables = {"running": errors, "law": scaled(errors, 0.95)}
    one, again = (choose(tables, ["law"], now=NOW, seed=3) for _ in range(2))
    assert one == again
    assert isinstance(one.high, float)
    shuffled = {name: table.sample(frac=1.0, random_state=1) for name, table in tables.items()}
    assert choose(shuffled, ["law"], now=NOW, seed=3).high == pytest.approx(one.high)
    assert pd.isna(choose({"running": errors}, [], now=NOW, seed=3).high)
