"""A study of one's own: its experiments, its report and its figures."""

import re

import numpy as np
import pandas as pd
import pytest
from support import paper_values, study_of

from opml.environment.settings import EnvironmentSettings
from opml.figures import study_models
from opml.report import absurd_fits, document, own_study as report
from opml.report.settings_tables import weather
from opml.study.own_study import MODELS, OwnStudy

EPOCH = "2019-09-03T00:00:00"

DAY = 86400.0


KEY = ("lares", "eglin-clear-kaena")
TRACKS = {"tracks": {"lares": ["a.tdm"]}}


def own_of(given=None, **study):
    """A study of `lares` whose run has settings of its own."""
    values = paper_values() | (given or {})
    values["study"] = {"rsos": ["lares"], "days": {"train": [0, 8], "test": [8, 12]}} | study
    return OwnStudy(study_of(values))


def evaluation(count=400, seed=0):
    """An evaluation of errors of 1000 m per day, of which the correction leaves a tenth."""
    rng = np.random.default_rng(seed)
    duration = rng.uniform(0.1, 7.0, count) * DAY
    true = 1000.0 * duration / DAY * rng.choice([-1.0, 1.0], count)
    return pd.DataFrame(
        {"i": np.arange(count) // 8, "j": np.arange(count), "duration": duration}
        | {"true": true, "predicted": 0.9 * true, "residual": 0.1 * true}
    )


def test_days_make_three_splits():
    own = own_of()
    assert own.splits == {
        "grouped": ("grouped-80", "rest"),
        "later": ("days-0-8", "days-8-12"),
        "unseen": ("days-0-8", "days-8-12-unseen"),
    }
    assert own.shown_split == "unseen"
    assert list(own.study.span_days) == [0, 8]


def test_what_a_study_leaves_out():
    own = own_of()
    assert own.study.station_sets == ["eglin-clear-kaena"]
    assert own.learners == list(MODELS)
    assert own.study.cleaning.cd_bounds is None
    assert own.study.cleaning.fence is None
    assert own.study.defaults == {
        "rso": "lares",
        "stations": "eglin-clear-kaena",
        "learner": "svr",
        "component": "e_y",
    }


def test_every_model_meets_every_split_on_every_dataset():
    own = own_of(rsos=["lares", "iss_i50"], station_sets=["eglin", "clear-kaena"], learners=["none", "svr"])
    assert len(own.experiments) == 2 * 2 * 2 * 3
    one = own.experiments["iss_i50", "clear-kaena", "svr", "unseen"]
    assert (one.rso, one.target, one.stations) == ("iss_i50", "iss_i50", "clear-kaena")
    assert {learner for *_, learner in own.stated} == {"svr"}


@pytest.mark.parametrize(
    ("given", "told", "untold"),
    [
        ({}, "## Truth and assumed model", "These tracks have no true orbit"),
        ({"orbits": {"lares": ["a.sp3"]}}, "The true orbit is that of the files", "truth model"),
        (TRACKS, "These tracks have no true orbit.", "truth model"),
    ],
)
def test_the_report_says_what_flew(given, told, untold):
    text = report_of(own_of(given, learners=["svr"]))
    assert told in text
    assert untold not in text


def test_the_report_says_what_was_known_of_the_weather():
    assert weather(EnvironmentSettings(**paper_values()["environment"])).startswith(
        "Space weather: MSAFE's monthly figures"
    )
    told = {
        "forecast": "up to each estimate, then forecast every 24 h",
        "hindcast": "up to the time predicted to: a hindcast",
        None: "measured values of the days predicted to",
    }
    for knowledge, words in told.items():
        asked = {"knowledge": knowledge} if knowledge else {}
        environment = EnvironmentSettings(
            **paper_values()["environment"] | {"solar_activity": "OBSERVED"} | asked
        )
        assert words in weather(environment)


def test_splits_of_ones_own():
    own = own_of(splits={"past": ["random-50", "rest"]}, learners=["svr"])
    assert own.splits == {"past": ("random-50", "rest")}
    assert own.shown_split == "past"


def test_a_study_without_days_or_splits_asks_for_nothing():
    values = paper_values()
    values["study"] = {"rsos": ["lares"]}
    assert not OwnStudy(study_of(values)).is_asked


@pytest.mark.parametrize(("longest", "marks"), [(7, [1, 2, 4, 7]), (3, [1, 2]), (0.5, [0.5])])
def test_marks_end_with_the_longest_prediction(longest, marks):
    assert own_of({"prediction": {"max_days": longest}}).report.marks == marks


def dataset_of(table):
    """Its dataset, with one prediction more that failed."""
    rows = table[["i", "j"]].assign(e_y=table["true"], keep=True, reason="")
    failed = {"i": [0], "j": [999], "e_y": [np.nan], "keep": [False], "reason": ["no prediction: decayed"]}
    return pd.concat([rows, pd.DataFrame(failed)], ignore_index=True)


def estimates_of(table):
    """Its estimates, of which one did not converge."""
    tracks = np.unique(table["i"])
    cd = {"cd": 2.2, "cov_cd_cd": 0.01}
    return pd.DataFrame({"track": tracks, "converged": tracks != 49} | cd)


SHARES = {"rows": 100, "estimates": 7, "p_ml": 20.0, "p_ml_low": 18.0, "p_ml_high": 23.0, "p_ml_later": 21.0}
SOUND = pd.DataFrame({"cd": [2.2] * 100, "cov_cd_cd": 0.01, "converged": True})
"""Estimates that somebody would fly."""


def report_of(own, table=None, *, evaluations=None):
    """The report of a study; table: the evaluation of all models that have none of their own."""
    table = evaluation() if table is None else table
    held = report.OwnStudyTables(
        metrics=pd.DataFrame([one.columns() | SHARES for one in own.experiments.values()]),
        evaluations=dict.fromkeys(own.stated, table) | (evaluations or {}),
        datasets={KEY: dataset_of(table)},
        estimates={KEY: estimates_of(table)},
        noise={},
    )
    return document.markdown(report.document(own.report, held))


@pytest.fixture
def told():
    """The report of a small study, with tables of everything that it asks for."""
    own, poor = own_of(learners=["none", "running", "svr"]), evaluation()
    poor["predicted"] *= poor["i"] < 25
    poor["residual"] = poor["true"] - poor["predicted"]
    return report_of(own, evaluations={one: poor for one in own.stated if one[-1] == "svr"})


def test_the_report_answers_without_the_papers_notions(told):
    assert "| lares | eglin-clear-kaena | `running` | 20.0 (18.0 to 23.0) |" in told
    assert re.search(r"\| lares \| eglin-clear-kaena \| no correction \| no \| 1\d{3} / 1\d{3} \|", told)
    assert re.search(r"\| lares \| eglin-clear-kaena \| `running` \| no \| \d\d\d? / 1\d\d \|", told)
    assert "| lares | eglin-clear-kaena | 50 | 49 | 401 | 99.8 % | no prediction 0.2 % |" in told
    assert "| `running` | law without a truth" in told
    assert not re.search(r"\bnan\b|Peng|reading of|slip", told)


def test_labels_have_tables_of_their_own():
    own = own_of(learners=["svr"], label="later")
    assert {one.label for one in own.experiments.values()} == {"_later"}
    assert own.panels == ["eglin-clear-kaena_later"]
    text = report_of(own)
    assert "| lares | eglin-clear-kaena | `svr` | 21.0 | 21.0 | 21.0 |" in text
    assert "are against the true orbit. No model knows it" in text
    assert "| gravity field | EGM2008 40x40 | EGM2008 20x20 |" in text


def test_a_study_of_measured_tracks_tells_of_no_truth():
    text = report_of(own_of(TRACKS, learners=["svr"]))
    assert "These tracks have no true orbit." in text
    assert "are against the true orbit" not in text
    assert "## Assumed model\n" in text
    assert "| gravity field | EGM2008 20x20 |" in text
    assert "21.0" not in text  # what later estimates say is P_ML itself


def rows_of(text, heading):
    """Cells of the rows on lares in a section's table, by model."""
    section = next(part for part in text.split("\n## ") if part.startswith(heading))
    rows = (line.strip(" |").split(" | ") for line in section.splitlines() if line.startswith("| lares"))
    return {model: cells for _, _, model, *cells in rows}


def test_the_study_leads_with_the_model_that_errs_least_and_its_skill(told):
    assert told.startswith(
        "# The study of lares\n\n**lares, eglin-clear-kaena.** Of the models that learn, `svr` errs least: "
    )
    assert "Without learning it is `running`: 6" in told
    titles = re.findall("^## (.*)$", told, re.MULTILINE)
    assert titles[:2] == ["Errors and skill: unseen", "The paper's measure: models against splits"]
    assert "no training day touches these predictions" in told
    rows = rows_of(told, "Errors and skill")
    assert {model: cells[0] for model, cells in rows.items()} == {
        "no correction": "no",
        "`running`": "no",
        "`svr`": "yes",
    }
    assert rows["no correction"][-1] == "-900"
    assert rows["`running`"][-1] == "0"
    assert -560 < int(rows["`svr`"][-1]) < -400
    assert f"Skill of `svr`: {rows['`svr`'][-1]} %" in told


def test_the_figure_has_every_model_and_its_head_what_a_random_split_flatters():
    own = own_of(learners=["none", "svr"], station_sets=["eglin", "eglin-clear-kaena"])
    flattery = {"grouped": 1.0, "later": 15.0, "unseen": 110.0}
    rows = [
        experiment.columns() | SHARES | {"split": split, "p_ml": flattery[split] if model == "svr" else 100.0}
        for (*_, model, split), experiment in own.experiments.items()
    ]
    figure = study_models.splits(
        pd.DataFrame(rows),
        panels=own.panels,
        models=dict.fromkeys(own.learners, "a model"),
        splits=list(own.splits),
        component="e_y",
    )
    left, right = figure.axes
    assert [label.get_text() for label in left.get_yticklabels()] == ["none", "svr"]
    assert [line.get_xdata().tolist() for line in right.lines[:3]] == [
        [100.0, p_ml] for p_ml in flattery.values()
    ]
    heads = [text.get_text() for text in figure.texts]
    assert any("= 1 % on grouped rows, 110 % on unseen rows" in head for head in heads)


def test_sizes_are_medians_and_95th_percentiles_near_a_duration(told):
    table = evaluation()
    near = table.loc[(table["duration"] / DAY - 2.0).abs() <= 0.25, "true"].abs()
    cells = rows_of(told, "Errors and skill")["no correction"]
    assert [float(size) for size in cells[2].split(" / ")] == pytest.approx(
        near.quantile([0.5, 0.95]), rel=1e-3
    )


def test_a_split_that_training_days_touch_says_so():
    text = report_of(own_of(splits={"past": ["random-50", "rest"]}, learners=["svr"]))
    assert "training days touch these predictions, which flatters models that learn" in text


@pytest.mark.parametrize(
    ("changed", "symptom"),
    [
        ({"cd": -457.0}, "Of 49 fits that converged, 100 % have a Cd outside 0 to 10; it goes from -457 to"),
        ({"cov_cd_cd": 9.0}, "Its formal sigma is 3 in the median."),
    ],
)
def test_absurd_fits_are_what_a_study_says_first(changed, symptom):
    fits = {KEY: estimates_of(evaluation()).assign(**changed), ("iss", "eglin"): SOUND}
    text = document.markdown(absurd_fits.section(absurd_fits.symptoms(fits), 12))
    assert text.startswith("## Unrealistic fits\n")
    assert symptom in text
    assert "`estimation: {window_hours: 48}`" in text
    assert "`estimation: {cd_sigma: 0.1}`" in text
    assert "iss" not in text


def test_sound_fits_are_no_reason_for_a_warning(told):
    assert "absurd" not in told
    assert absurd_fits.symptoms({("iss", "eglin"): SOUND}) == {}
    few = SOUND.assign(cd=np.where(SOUND.index < 4, 12.0, 2.2))  # 4 of 100
    assert absurd_fits.symptoms({("iss", "eglin"): few}) == {}
    assert not list(absurd_fits.section({}, 12))


def test_a_duration_that_nothing_reaches_has_no_number():
    whole = evaluation()
    text = report_of(own_of(learners=["svr"]), whole[whole["duration"] < 3 * DAY])
    assert rows_of(text, "Errors and skill")["`svr`"][3:5] == ["-", "-"]


def test_a_study_of_no_learner_names_the_best_without():
    text = report_of(own_of(learners=["none", "running"]))
    assert "Without learning `running` errs least" in text
