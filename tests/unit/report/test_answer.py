"""The answer that a study's report begins with."""

import dataclasses
import re

import numpy as np
import pandas as pd
import pytest
from mornings import replays
from support import paper_values, study_of

from opml.learning.judge.model_choice import Mornings
from opml.report import answer, document, mornings
from opml.report.answer import Sources
from opml.report.document import Picture
from opml.study.own_study import OwnStudy
from opml.tables import SIGMA_STATE

DAY = 86400.0

KEY = ("lares", "eglin")

FOUND = Sources(
    files={name: f"results/corrected/lares/eglin/days-0-25/{name}.oem" for name in ("running", "law")},
    day=25.0,
    end=30.0,
    manoeuvres="named in `manoeuvres`: 2",
    figures={answer.ALL_MODELS: "figs/all.png", "rows": "figs/rows.png"},
)


def mornings_of(laws=("law",), days=25, **sizes):
    """Replays of models that leave so many times 100 m a day, with covariances that suit the first."""
    table = replays(days=days)
    sigma = dict(zip(SIGMA_STATE, (10.0, 400.0, 30.0, 1.0, 1.0, 1.0), strict=True))
    scaled = {name: table.assign(e_y=table["e_y"] * size, **sigma) for name, size in sizes.items()}
    return Mornings.from_replays(scaled, laws, seed=1)


def answered(found, pictures=None, absurd=(), source=FOUND):
    """The section, as Markdown; found: None without replays."""
    blocks = answer.section(
        {} if found is None else {KEY: found},
        {KEY: source},
        pictures or {},
        laws=["law"],
        marks=[1, 2, 4, 7],
        durations=[1.0, 7.0],
        absurd=absurd,
        proof=["Every morning"],
    )
    return document.markdown(list(blocks))


def test_the_answer_is_the_model_its_errors_and_what_the_others_would_have_left():
    found = mornings_of(running=1.0, fit48=2.0, law=1.5)
    text = answered(found)
    own = found.tables["running"]
    near = own[(own["duration"] / DAY - 1.0).abs() < 0.25]["e_y"].abs()
    begin = f"Use `running`: {near.median():.2g} m after a day ({len(near)} predictions), "
    assert text.startswith(f"## Which model to use\n\n**lares, eglin.** {begin}")
    assert " predictions), median along-track error on 24 mornings, selected on 24 of them." in text
    assert "against the models selected each morning, `running`, the best" in text
    assert "`running`, the best without learning, would have had the same error" in text
    assert "`law`, the best with learning, would have had 50 % more error" in text
    assert "[Every morning](#every-morning)" in text
    assert "nan" not in text


def test_errors_are_those_of_the_model_that_is_named():
    """What another model left on mornings when the past chose that says nothing of this one."""
    found = mornings_of(running=1.0, fit48=2.0)
    flown = found.selected.assign(e_y=1e6)
    changed = dataclasses.replace(found, selected=flown)
    assert (
        answered(changed).split(".** ")[1].split(", median")[0]
        == (answered(found).split(".** ")[1].split(", median")[0])
    )


def test_durations_with_fewer_than_ten_predictions_are_not_told():
    found = mornings_of(running=1.0)
    own = found.tables["running"]
    longest = own["duration"] > 6.5 * DAY
    few = own[~longest | (longest.cumsum() < 10)]
    text = answered(Mornings.from_replays({"running": few}, [], seed=1))
    assert "after a week" not in text
    assert "after 4 days (" in text
    short = dataclasses.replace(found, tables={"running": own.head(5)})
    assert "Use `running`: no lead time has 10 predictions to state errors, on 24 mornings" in answered(short)


def test_the_file_of_the_chosen_model_stands_with_its_command():
    text = answered(mornings_of(running=1.0, law=1.5))
    assert "`snakemake -j2 --configfile FILE -- results/corrected/lares/eglin/days-0-25/running.oem`" in text
    assert "before day 25. It ends with the run, on day 30." in text


def test_a_model_that_learns_is_trained_each_morning_any_other_never():
    assert "**Train again:** never, as `running` learns nothing." in answered(
        mornings_of(running=1.0, law=1.5)
    )
    learned = answered(mornings_of(running=1.0, law=0.1))
    assert "Use `law`" in learned
    assert "**Train again** each morning" in learned


def test_what_is_to_watch_is_what_was_found():
    text = answered(mornings_of(running=1.0, law=1.5), absurd=[KEY])
    assert "[Unrealistic fits](#unrealistic-fits)" in text
    assert "the 90 % ellipsoid contains" in text
    assert "named in `manoeuvres`: 2" in text
    calm = answered(mornings_of(running=1.0, law=1.5))
    assert "absurd" not in calm


def test_without_replayed_mornings_no_model_is_named():
    text = answered(None)
    assert "No morning was replayed, so no model can be recommended." in text
    assert "snakemake" not in text


def test_the_figure_of_all_models_is_in_the_page_and_a_link_in_markdown(tmp_path):
    (tmp_path / "all.png").write_bytes(b"PNG")
    assert "![Errors of lares by eglin" in answered(None, {KEY: tmp_path / "all.png"})
    page = document.html_page([Picture(tmp_path / "all.png", "figs/all.png", "errors")], title="A")
    assert '<img alt="errors" src="data:image/png;base64,UE5H">' in page


@pytest.mark.parametrize(
    ("metres", "words"), [(7.42, "7.4 m"), (474.0, "470 m"), (998.0, "1 km"), (12345.0, "12 km")]
)
def test_lengths_have_two_digits(metres, words):
    assert answer._distance(metres) == words


def test_days_within_a_kilometre_are_those_before_nine_tenths_pass_it():
    duration = np.repeat(np.arange(1, 15) * 0.5, 10) * DAY
    rows = pd.DataFrame({"duration": duration, "e_y": 300.0 * duration / DAY})
    assert mornings.days_within(rows) == "90 % stay within 1 km for 3 days."
    assert "for the whole prediction" in mornings.days_within(rows[rows["e_y"] < 900.0])
    assert mornings.days_within(rows[rows["e_y"] > 1100.0]).startswith("More than 10 % exceed 1 km")
    soon = rows.assign(duration=duration - 0.5 * DAY, e_y=3000.0 * (duration / DAY - 0.5))
    assert mornings.days_within(soon).startswith("More than 10 % exceed 1 km")


def own_of(**changed):
    values = paper_values() | {"results": "results/operator"} | changed
    values["study"] = {"rsos": ["lares"], "days": {"train": [0, 20], "test": [20, 28]}}
    return OwnStudy(study_of(values)).report.sources["lares", "eglin-clear-kaena"]


def test_the_file_is_the_one_of_the_page_on_operations():
    measured = own_of(tracks={"lares": ["a.tdm"]}, manoeuvres={"lares": ["2016-10-12T08:00:00"]})
    assert measured.files["running"] == (
        "results/operator/corrected/lares/eglin-clear-kaena_later/days-0-28/running.oem"
    )
    assert measured.day == 28
    assert measured.manoeuvres == "named in `manoeuvres`: 1"
    simulated = own_of()
    assert simulated.manoeuvres == ""
    assert "orbit's files" in own_of(orbits={"lares": ["a.sp3"]}).manoeuvres


def test_without_a_past_for_covariances_none_is_judged():
    found = mornings_of(running=1.0)
    unstated = Mornings.from_replays(
        {"running": found.tables["running"].assign(**dict.fromkeys(SIGMA_STATE, np.nan))}, [], seed=1
    )
    text = answered(unstated)
    assert "No morning had a past that was long enough to state a covariance from." in text
    assert "ellipsoid" not in text


@pytest.mark.parametrize(
    ("law", "told"),
    [
        (1.5, "No learned model was used: on no morning did past results show that it would be better."),
        (0.1, r"A learned model was used on \d+ of 24 mornings."),
    ],
    ids=["helped not", "helped"],
)
def test_it_says_whether_anything_learned_was_flown(law, told):
    assert re.search(told, answered(mornings_of(running=1.0, law=law)))


@pytest.mark.parametrize(("days", "is_told"), [(10, True), (25, False)], ids=["a week", "three weeks"])
def test_it_says_that_few_mornings_choose_poorly(days, is_told):
    assert ("So few mornings select poorly" in answered(mornings_of(days=days, running=1.0))) is is_told
