"""A study of one's own: its experiments, its report and its figures."""

import re

import numpy as np
import pandas as pd
import pytest
from mornings import replays
from support import paper_values, study_of

from opml.environment.settings import EnvironmentSettings
from opml.figures import own_study as figures
from opml.figures.style import MUTED
from opml.learning.judge.errors_by_duration import at_days
from opml.learning.judge.model_choice import Mornings
from opml.report import absurd_fits, document
from opml.report import own_study as report
from opml.report.settings_tables import weather
from opml.study.own_study import MODELS, REPLAYED, OwnStudy
from opml.tables import SIGMA_STATE

EPOCH = "2019-09-03T00:00:00"

DAY = 86400.0


KEY = ("lares", "eglin-clear-kaena")
TRACKS = {"tracks": {"lares": ["a.tdm"]}}
JUDGED = TRACKS | {"orbits": {"lares": ["an.orbit"]}}


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


def test_mornings_are_replayed_of_models_that_are_quick_to_train():
    own = own_of(days={"train": [0, 18], "test": [18, 27]})
    assert [learner for *_, learner in own.replayed] == list(REPLAYED)
    assert own.laws == ["covariance", "mechanism", "twoarcs"]
    parts = own.mornings("lares", "eglin-clear-kaena")["mechanism"]
    assert parts == own.replayed["lares", "eglin-clear-kaena", "mechanism"]
    assert (parts["train"], parts["label"]) == ("days-0-18", "")
    assert own.mornings("lares", "eglin") == {}
    assert own.replayed_datasets == [("lares", "eglin-clear-kaena")]
    named = own_of(days={"train": [0, 18], "test": [18, 27]}, replayed=["running"], label="later")
    assert [parts["label"] for parts in named.replayed.values()] == ["_later"]


@pytest.mark.parametrize(
    ("given", "study", "judged"),
    [
        ({}, {}, []),
        ({}, {"label": "later"}, [KEY]),
        (TRACKS, {}, []),
        (JUDGED, {}, [KEY]),
    ],
)
def test_what_is_learned_from_labels_is_judged_by_the_truth_where_there_is_one(given, study, judged):
    assert own_of(given, **study).datasets_with_truth == judged


def test_manoeuvres_of_what_was_measured_are_those_named_even_where_an_orbit_judges():
    told = own_of(JUDGED | {"manoeuvres": {"lares": ["2016-10-01T00:00:00"]}}).report
    assert told.sources[KEY].manoeuvres == "named in `manoeuvres`: 1"
    assert (told.truths, told.label) == (["files"], "later")


def test_models_that_a_short_run_has_no_morning_of_are_left_out():
    own = own_of(days={"train": [0, 3], "test": [3, 5]})
    own.study.settings.values["duration_days"] = 6
    # Fits of four days would begin on day 4, laws when half of the training is over.
    assert [name for *_, name in own.replayed] == [
        *("none", "fit48", "running24m3", "running24", "running48m3", "running"),
        *("covariance", "mechanism", "twoarcs"),
    ]


def test_without_days_to_train_on_no_morning_is_replayed():
    own = own_of(splits={"past": ["random-50", "rest"]})
    assert own.replayed == {}
    assert own.replayed_datasets == []
    assert own.laws == []


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


def test_marks_end_with_the_longest_prediction():
    values = paper_values()
    values["prediction"]["max_days"] = 3
    assert OwnStudy(study_of(values)).marks == [1, 2]
    values["prediction"]["max_days"] = 0.5
    assert OwnStudy(study_of(values)).marks == [0.5]


def test_growth_states_medians_and_95th_percentiles():
    table = evaluation()
    found = at_days(table, [1, 2, 4, 9]).set_index("day")
    assert found.index.tolist() == [1, 2, 4]
    for day in (1, 2, 4):
        near = table[(table["duration"] / DAY - day).abs() <= 0.25]
        assert found.loc[day, "rows"] == len(near)
        assert found.loc[day, "before_50"] == pytest.approx(near["true"].abs().median())
        assert found.loc[day, "after_95"] == pytest.approx(np.quantile(near["residual"].abs(), 0.95))


def dataset_of(table):
    """Its dataset, with one prediction more that failed."""
    rows = table[["i", "j"]].assign(e_y=table["true"], keep=True, reason="")
    failed = {"i": [0], "j": [999], "e_y": [np.nan], "keep": [False], "reason": ["no prediction: decayed"]}
    return pd.concat([rows, pd.DataFrame(failed)], ignore_index=True)


def estimates_of(table):
    """Its estimates, of which those from the 25th on have a Cd that the paper drops."""
    tracks = np.unique(table["i"])
    cd = {"cd": np.where(tracks < 25, 2.2, 4.0), "cov_cd_cd": 0.01}
    return pd.DataFrame({"track": tracks, "converged": tracks != 49} | cd)


SHARES = {"rows": 100, "estimates": 7, "p_ml": 20.0, "p_ml_low": 18.0, "p_ml_high": 23.0, "p_ml_later": 21.0}
SOUND = pd.DataFrame({"cd": [2.2] * 100, "cov_cd_cd": 0.01, "converged": True})
"""Estimates that somebody would fly."""


def report_of(own, table=None, *, evaluations=None, **more):
    """The report of a study; table: the evaluation of all models that have none of their own."""
    table = evaluation() if table is None else table
    held = report.OwnStudyTables(
        metrics=pd.DataFrame([one.columns() | SHARES for one in own.experiments.values()]),
        evaluations=dict.fromkeys(own.stated, table) | (evaluations or {}),
        datasets={KEY: dataset_of(table)},
        estimates={KEY: estimates_of(table)},
        truths=dict.fromkeys(own.datasets_with_truth, dataset_of(table)),
        **{name: {} for name in ("noise", "replays", "pictures")} | more,
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
    assert "| lares | eglin-clear-kaena | 50 | 49 | 401 | 99.8 % | 49.9 % | no prediction 0.2 % |" in told
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


def test_the_share_left_is_stated_for_the_papers_rows_too(told):
    left = rows_of(told, "The paper's measure")
    assert left["`none`"][-1] == "100.0"
    assert left["`running`"][-1] == "10.0"
    assert left["`svr`"][-1] == "10.0"
    assert (
        "is the paper's measure: the summed error after correction, relative to that of the 12-hour fit"
        in told
    )


def test_the_study_leads_with_metres_and_skill_against_the_best_without_learning(told):
    titles = re.findall("^## (.*)$", told, re.MULTILINE)
    assert titles[:2] == ["Which model to use", "Errors and skill: unseen"]
    assert told.startswith("# The study of lares\n")
    assert titles.index("The paper's measure: models against splits") > 0
    assert "no training day touches these predictions" in told
    assert (
        "Skill is relative to `running`, the best model without learning, which is known in hindsight" in told
    )
    rows = rows_of(told, "Errors and skill")
    assert {model: cells[0] for model, cells in rows.items()} == {
        "no correction": "no",
        "`running`": "no",
        "`svr`": "yes",
    }
    assert rows["no correction"][-1] == "-900"
    assert rows["`running`"][-1] == "0"
    assert -560 < int(rows["`svr`"][-1]) < -400


def test_a_split_that_training_days_touch_says_so():
    text = report_of(own_of(splits={"past": ["random-50", "rest"]}, learners=["svr"]))
    assert "training days touch these predictions, which flatters models that learn" in text
    assert "Skill is relative to no correction, the best model without learning" in text


def test_the_best_without_learning_is_the_pasts_where_mornings_were_replayed():
    own, poor = own_of(learners=["running", "fit96", "mechanism"]), evaluation()
    poor["residual"] = 0.2 * poor["true"]
    replays = {(*KEY, name): table for name, table in mornings_of(*own.learners).tables.items()}
    # On the days tested fit96 is better, in the past running was.
    text = report_of(
        own, evaluations={one: poor for one in own.stated if one[-1] == "running"}, replays=replays
    )
    assert (
        "Skill is relative to `running`, the best model without training on this object over the mornings up"
        in text
    )
    assert rows_of(text, "Errors and skill")["`mechanism`"][-1] == "50"


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
    assert "| 1 d | 2 d |" in text
    assert "| 4 d |" not in text


def mornings_of(*names):
    """Replayed mornings of models that leave a tenth, two tenths, ... of 50 times 100 m a day."""
    table = replays(days=25)
    scaled = {
        name: table.assign(e_y=table["e_y"] * (k + 1), **dict.fromkeys(SIGMA_STATE, 1.0))
        for k, name in enumerate(names)
    }
    return Mornings.from_replays(scaled, [], seed=1)


def test_figure_of_residuals_has_bands_of_what_was_flown_and_lines_of_the_models():
    figure = figures.residuals(mornings_of("running", "fit96"), laws=["fit96"], note="lares")
    (axes,) = figure.axes
    assert axes.get_yscale() == "log"
    assert axes.get_ylabel() == "along-track error $|e_{y}|$"
    assert {text.get_text() for text in axes.texts} == {"running", "fit96"}
    looks = {line.get_label(): line for line in axes.lines}
    before, after = looks["no correction"], looks["model selected each day"]
    assert np.median(after.get_ydata()) == pytest.approx(0.02 * np.median(before.get_ydata()))
    assert looks["learned"].get_linestyle() == "--"
    assert looks["without learning"].get_linestyle() == "-"
    assert len(axes.collections) == 4  # the middle 50 and 90 % of both
    assert figure.get_suptitle().strip() == "After 6.9 d: median 510 m, uncorrected 25 km"
    assert figure.texts[-1].get_text().startswith("lares\n")


def test_lines_that_do_not_matter_are_grey_and_have_no_name():
    (axes,) = figures.residuals(mornings_of("running", "fit24", "fit48", "law", "svr"), laws=["law"]).axes
    assert {text.get_text() for text in axes.texts} == {"running", "law", "the paper's SVR"}
    colors = [line.get_color() for line in axes.lines]
    assert colors.count(MUTED) == 2
    assert colors.count(figures.BASELINE) == 3


def test_names_of_lines_do_not_overlap():
    names = [f"model{number}" for number in range(4)]
    (axes,) = figures.residuals(mornings_of(*names, "svr"), laws=["model1"]).axes
    heights = sorted(np.log10(text.get_position()[1]) for text in axes.texts)
    low, high = np.log10(axes.get_ylim())
    assert len(heights) == 3
    assert (np.diff(heights) > 0.04 * (high - low)).all()


def test_percentiles_of_sizes_by_duration():
    found = figures.sizes(evaluation(), "true")
    by_hand = evaluation()
    first = by_hand[by_hand["duration"] / DAY <= figures.BIN_DAYS]
    if len(first) >= figures.LEAST_ROWS:
        assert found["50"].iloc[0] == pytest.approx(first["true"].abs().median())
    assert (found["5"] <= found["25"]).all()
    assert (found["75"] <= found["95"]).all()
    assert found.index.is_monotonic_increasing
    assert found["50"].is_monotonic_increasing


def test_errors_of_a_few_predictions_have_a_size_each():
    few = evaluation().iloc[:6].assign(duration=DAY * np.arange(1.0, 7.0))
    np.testing.assert_allclose(figures.sizes(few, "true")["50"], few["true"].abs())


def test_windows_of_the_fits_that_models_ask_for():
    own = own_of(learners=["svr", "fit96", "running", "fit48"])
    assert own.windows == {"12-hour fits": "", "48-hour fits": "_w48", "96-hour fits": "_w96"}
