"""Tables to read: documents, the paper's tables, its numbers beside ours."""

from dataclasses import replace
from html.parser import HTMLParser

import pandas as pd
import pytest
from support import paper_values, rsos, stations, study_of

from opml.dynamics.settings import ForceModels
from opml.environment.settings import EnvironmentSettings
from opml.naming import Experiment
from opml.report import document, paper_claims, reproduction, settings_tables
from opml.report.document import Table, items
from opml.report.results import Results
from opml.study.paper import Paper
from opml.study.settings.model import names
from opml.tables import HOW_TO_CSV

PAPER = paper_values()
ENVIRONMENT = EnvironmentSettings(**PAPER["environment"])
MODELS = ForceModels(**PAPER["force_models"])
BLOCKS = ["# Title", "Say `x < y`.", Table(["a", "b"], [["1", "`2`"], ["3", "4"]])]


def test_markdown():
    assert document.markdown(BLOCKS) == (
        "# Title\n\nSay `x < y`.\n\n| a | b |\n| --- | --- |\n| 1 | `2` |\n| 3 | 4 |\n"
    )


def test_page_is_html_that_needs_nothing_else():
    page = document.html_page(BLOCKS, title="A & B")
    seen = []

    class Parser(HTMLParser):
        def handle_starttag(self, tag, attributes):
            seen.append(tag)
            assert not {"src", "href"} & {name for name, _ in attributes}

    Parser().feed(page)
    assert "<title>A &amp; B</title>" in page
    assert "<p>Say <code>x &lt; y</code>.</p>" in page
    assert seen.count("tr") == 3
    assert seen.count("td") == 4


def test_links_lead_to_headings_and_lists_are_lists():
    blocks = ["## Is it true: e_y?", items(["**why:** [here](figs/a.png)", "`b`"])]
    page = document.html_page(blocks, title="A")
    assert '<h2 id="is-it-true-e_y">' in page
    assert '<li><strong>why:</strong> <a href="figs/a.png">here</a></li>\n<li><code>b</code></li>' in page
    assert document.markdown(blocks).endswith("- **why:** [here](figs/a.png)\n- `b`\n")


@pytest.mark.parametrize("cell", ["616", "-1446", "99.8 %", "616 / 1853", "4.7 (3.2 to 6.6)", "-", "1.2e+04"])
def test_columns_of_numbers_stand_on_the_right(cell):
    page = document.html_page([Table(["model", "size"], [["`a`", cell], ["`b`", "2"]])], title="A")
    assert f'<td class="number">{cell}</td>' in page
    assert '<th>model</th><th class="number">size</th>' in page
    assert 'class="number"' not in document.html_page([Table(["a"], [[cell], ["b 2"]])], title="A")


def test_a_column_of_sentences_is_no_column_of_single_words():
    rows = [["`a`", "its 90 % intervals held 61 % of the last errors"], ["`b`", ""]]
    page = document.html_page([Table(["model", "why"], rows)], title="A")
    assert '<th>model</th><th class="sentence">why</th>' in page
    assert ".sentence{min-width:" in page


def test_bold_words_are_bold_in_the_page():
    assert "<p><strong>iss.</strong> 2 * 3</p>" in document.html_page(["**iss.** 2 * 3"], title="A")


def test_documents_are_written_whole(tmp_path):
    paths = [tmp_path / "new" / f"t.{kind}" for kind in ("md", "tsv", "html")]
    document.write(BLOCKS, *paths)
    assert paths[0].read_text() == document.markdown([*BLOCKS, HOW_TO_CSV])
    assert "<p>Any table as CSV: <code>opml table FILE --csv</code></p>\n</body>" in paths[2].read_text()
    assert paths[1].read_text() == "a\tb\n1\t2\n3\t4\n"
    assert sorted(paths[0].parent.iterdir()) == sorted(paths)


def cells(blocks):
    table = next(block for block in blocks if isinstance(block, Table))
    return {row[0]: list(row[1:]) for row in table.rows}


def test_tables_are_the_papers():
    radars = cells(settings_tables.stations(list(stations().values())))
    assert radars["latitude [deg]"] == ["30.57", "64.29", "21.57"]
    assert radars["maximum range [km]"] == ["13210", "4910", "6380"]
    assert radars["feasible elevation [deg]"] == ["1 to 90", "1 to 90", "0 to 90"]
    assert radars["sigma of azimuth [deg]"] == ["0.0154", "0.0791", "0.0224"]
    assert not [name for name in radars if "rate" in name]
    doppler = replace(stations()["eglin"], name="doppler", sigma_range=None, sigma_range_rate=0.125)
    others = cells(settings_tables.stations([stations()["clear"], doppler]))
    assert others["sigma of range [m]"] == ["62.5", "-"]
    assert others["sigma of range rate [m/s]"] == ["-", "0.125"]
    rso = cells(settings_tables.rsos([rsos()["iss"]], epoch=PAPER["epoch"], title="RSO"))
    assert rso["semi-major axis [km]"] == ["6783.34"]
    assert rso["inclination [deg]"] == ["51.6393"]
    models = cells(settings_tables.models(ENVIRONMENT, MODELS))
    assert models["gravity field"] == ["EGM2008 40x40", "EGM2008 20x20"]
    assert models["third bodies"][1] == "sun, moon, jupiter"


@pytest.fixture(scope="module")
def paper():
    """The paper's study with fewer experiments."""
    values = paper_values()
    values["study"]["seeds"] = {"split": [42, 43], "noise": [42, 43]}
    return Paper(study_of(values))


def metrics(paper, p_ml):
    """A metrics table of everything reported; `p_ml` gives a number by experiment, else it is 50."""
    rows = []
    for one in paper.reported:
        number = p_ml(one)
        p_ml_or_50 = 50.0 if number is None else number
        numbers = {"rows": 10, "estimates": 5, "p_ml": p_ml_or_50, "fraction_reduced": 0.8}
        rows.append(one.columns() | numbers | {"last_before": 48e3, "last_after": 19e3})
    return pd.DataFrame(rows)


def by_name(paper, name):
    return next(one for one in paper.headlines if one.name == name)


def test_comparison_with_the_spread(paper):
    headline = by_name(paper, "svr_testing_1station")
    numbers = {"random-80": 24.0, "random-80_split43": 22.0}

    def p_ml(one):
        if one.stations == "eglin_noise43":
            return 25.0
        return {"svrfixed": 22.6}.get(one.learner, numbers.get(one.train))

    found = reproduction.compare(headline, Results(metrics(paper, p_ml)))
    assert (found.ours, found.over_splits, found.over_noise, found.fixed) == (24, (22, 24), (24, 25), 22.6)
    assert found.difference == pytest.approx(1.4)
    assert found.inside


def test_transfer_has_no_spread_over_noise(paper):
    results = Results(metrics(paper, lambda one: None))
    found = reproduction.compare(by_name(paper, "inclination_50"), results)
    assert found.over_noise is None
    assert not found.inside  # 40.2 is not 50


def test_likeliest_cause_is_the_nearest_run(paper):
    headline = by_name(paper, "svr_testing_1station")

    def p_ml(one):
        return {"_track": 30.0}.get(one.reading, 24.0 if one.learner == "svrfixed" else None)

    results = Results(metrics(paper, p_ml))
    text, run, explains = reproduction.likeliest_cause(reproduction.compare(headline, results), results)
    assert text == "the kernel scale is 1.74, not the default rule's"
    assert run == replace(headline.experiment, learner="svrfixed")
    assert explains


def test_no_cause_is_named_where_none_explains(paper):
    headline = by_name(paper, "svr_testing_1station")
    results = Results(metrics(paper, lambda one: 49.0 if one.reading else None))
    text, run, explains = reproduction.likeliest_cause(reproduction.compare(headline, results), results)
    assert run.reading == "_track"
    assert text == PAPER["study"]["reproduction"]["readings"]["previous_track"]["text"]
    assert not explains


def test_alternatives_change_the_learner_the_reading_or_the_split_only(paper):
    for headline in paper.headlines:
        for _, one in headline.alternatives:
            assert one != headline.experiment
            assert (one.rso, one.target, one.component) == tuple(
                getattr(headline.experiment, part) for part in ("rso", "target", "component")
            )


def test_claims_follow_the_numbers(paper):
    def p_ml(one):
        if one.target.startswith("iss_a+"):
            return 20.0 if one.target == "iss_a+10" else 120.0
        if one.target.startswith("iss_i"):
            return 45.0
        if one.train.startswith("random-") and "-clear" in one.stations:
            return {"random-10": 40.0, "random-80": 10.0, "random-90": 10.0}.get(one.train, 15.0)
        return {"days-30-35": 30.0, "days-30-40": 35.0, "days-30-45": 36.0}.get(one.test)

    results = Results(metrics(paper, p_ml))
    found = {
        said: (ours, holds)
        for said, ours, holds in (paper_claims.judge_claim(one, results) for one in paper.claims)
    }
    assert len(found) == 10
    assert all(holds for _, holds in found.values()), found
    assert found["three stations improve the metric by more than a half"][0] == (
        "50.0 (svr_testing_1station), 10.0 (svr_testing_3stations)"
    )
    assert found["about 80 % of the points have a smaller error"][0] == "80.0 (future_10days)"
    assert found["at 7 days the mean error is reduced from around 50 km to less than 20 km"][0] == (
        "48.0 (km before, future_10days_unfenced), 19.0 (km after, future_10days_unfenced)"
    )


@pytest.mark.parametrize(
    ("holds", "numbers", "limits", "expected"),
    [
        ("below", [10, 49], {"limit": 50}, True),
        ("below", [10, 50], {"limit": 50}, False),
        ("above", [101, 100], {"limit": 100}, False),
        ("ascending", [1, 2, 2], {}, True),
        ("ascending", [1, 3, 2], {}, False),
        ("first_falls", [3, 2, 9], {}, True),
        ("first_falls", [3, 3], {}, False),
        ("last_below_share_of_first", [22.6, 9.6], {"share": 0.5}, True),
        ("last_below_share_of_first", [22.6, 12.0], {"share": 0.5}, False),
        ("falls_and_settles", [40, 15, 10, 9.9], {"share": 0.1}, True),
        ("falls_and_settles", [40, 30, 20, 10], {"share": 0.1}, False),
        ("falls_and_settles", [40, 10, 11, 10], {"share": 0.1}, False),
        ("mean_of_longest_falls", [44, 19], {"start": 50, "share": 0.25, "limit": 20}, True),
        ("mean_of_longest_falls", [44, 21], {"start": 50, "share": 0.25, "limit": 20}, False),
        ("mean_of_longest_falls", [18, 7], {"start": 50, "share": 0.25, "limit": 20}, False),
    ],
)
def test_what_a_claim_may_hold_of(holds, numbers, limits, expected):
    claim = paper_claims.Claim("so it is", holds, {}, **limits)
    assert paper_claims.TESTS[holds](numbers, claim) is expected


def test_counts():
    dataset = pd.DataFrame(
        {
            "t_j": [86400.0, 31 * 86400.0, 2.0, 3.0],
            "keep": [True, True, False, False],
            "reason": ["", "", "no prediction: decayed", "no prediction: not finite"],
        }
    )
    estimates = pd.DataFrame({"converged": [True, True, False]})
    assert reproduction.counts(dataset, estimates, name="iss, eglin", days=[0, 30]) == {
        "dataset": "iss, eglin",
        "tracks": 3,
        "fits converged": 2,
        "pairs": 4,
        "kept": 2,
        "kept to day 30": 1,
        "why dropped": "no prediction 2",
    }


def test_whole_document(paper):
    table = metrics(paper, lambda one: None)
    datasets = pd.DataFrame([{"dataset": "iss, eglin", "tracks": 3}])
    scales = {headline.name: 3.5 for headline in paper.headlines}
    text = document.markdown(reproduction.document(paper.reproduction, table, datasets, scales))
    assert text.startswith("# The paper's numbers and ours\n")
    assert (
        "| `svr_testing_1station` | 22.6 | 50.0 | 50.0 to 50.0 | 50.0 to 50.0 | +27.4 | no | 3.50 "
        "| 50.0 (s chosen for it) |\n"
    ) in text
    assert "metrics/iss/eglin-clear-kaena/days-0-30/svr/e_y/iss_i50/days-30-40.parquet" in text
    assert "| iss, eglin | 3 |" in text
    assert text.endswith(document.markdown([Table(["the paper", "here"], reproduction.open_points())]))


def test_path_is_the_workflows():
    one = Experiment("iss", "eglin", "random-80", "svr", "e_y", "lares", "rest", "_track")
    assert one.path("metrics") == "metrics/iss/eglin_track/random-80/svr/e_y/lares/rest.parquet"


def test_an_experiment_that_did_not_run_is_not_found(paper):
    results = Results(metrics(paper, lambda one: None))
    with pytest.raises(KeyError):
        results.p_ml(Experiment("mir", *[""] * 6))


@pytest.mark.parametrize(
    ("knowledge", "told"),
    [
        ({}, "OBSERVED, percentile 50"),
        ({"knowledge": "hindcast"}, "OBSERVED, percentile 50, as known at each time"),
        (
            {"knowledge": "forecast"},
            "OBSERVED, percentile 50, as known at each estimate, then forecast every 24 h",
        ),
    ],
)
def test_what_the_assumed_model_knows_of_the_weather_is_told(knowledge, told):
    environment = ENVIRONMENT.evolve(solar_activity="OBSERVED", **knowledge)
    rows = settings_tables.force_models(environment, MODELS).rows
    assert next(row for row in rows if row[0] == "solar activity")[1:] == ["OBSERVED, percentile 50", told]


def test_forces_are_told_where_a_model_has_them_switched_on():
    models = MODELS.evolve(truth=MODELS.truth.evolve(forces=["solid_tides"]))
    told, as_ever = (
        [row for row in settings_tables.force_models(ENVIRONMENT, flown).rows if "tides" in row[0]]
        for flown in (models, MODELS)
    )
    assert told == [["tides of the solid Earth", "yes", "no"]]
    assert as_ever == []


def test_settings_name_the_tests_of_claims():
    (tests,) = names.Holds.__metadata__
    assert set(tests.names) == set(paper_claims.TESTS)
