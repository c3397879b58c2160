"""Numbers in sentences are those of the tables of the same page, or of the page that they are from."""

import csv
import re

import pytest
from support import REPOSITORY

from opml.catalog.fit.first import first_orbit
from opml.conjunctions import screening
from opml.element_sets import catalogue as catalogue_of_sets, features, improved_sizes, prediction, weighting
from opml.interop.curves import orbit_breaks
from opml.mornings import days, verdicts
from validation.pictures import every_week, where_learning_helps
from validation.pictures.page_tables import catalogue, rows, tsv

WEATHER = (REPOSITORY / "src" / "opml" / "data" / "space_weather.csv").read_text(encoding="utf-8")
LOWEST, HIGHEST = (f"{edge / 1e3:.0f}" for edge in features.BANDS[[0, -1]])  # of corrected heights [km]


def page(name):
    return (REPOSITORY / f"{name}.md").read_text(encoding="utf-8")


def sentences(name):
    return " ".join(page(name).split())


@pytest.fixture(scope="module")
def improved():
    """Cells of improved sets by the first word of the season."""
    return {season.split()[0]: cells for (season, way), cells in catalogue().items() if way == "improved"}


def test_errors_by_the_age_of_a_set_are_those_of_the_notes():
    table = {
        cells[0]: cells for cells in rows("notes/element_sets", "## Errors by the age of the newest set")
    }
    young, old = table["0.25 to 0.5"], table["1 to 1.5"]
    said = f"half a day old {young[1]} after one day and {young[4]} after seven; one to 1.5 days old "
    assert f"{said}{old[1]} and {old[4]}" in sentences("docs/learning")


def test_the_share_of_sgp4_s_error_is_that_of_the_catalogue(improved):
    week = [cells[-1][0] for cells in improved.values()]
    assert f"after a week to {min(week[:3])} to {max(week[:3])} %" in sentences("docs/reality")
    assert f"at solar minimum they do not ({week[3]} %)" in sentences("docs/reality")


def test_each_median_of_improved_sets_is_inside_its_interval(improved):
    assert len(improved) == 5
    for median, low, high in (cell for cells in improved.values() for cell in cells):
        assert low <= median <= high


def test_the_first_table_of_learning_is_that_of_the_improved_sets(improved):
    first = [[re.findall(r"\d+", cell) for cell in cells] for _, *cells in rows("docs/learning")[2:7]]
    assert [[list(map(int, cell)) for cell in cells] for cells in first] == list(improved.values())
    week = [cells[-1][0] for cells in improved.values()]
    assert f"after a week by {100 - max(week[:3])} to {100 - min(week[:3])} %" in sentences("docs/learning")


def test_what_predict_leaves_of_the_sets_task_is_the_board_s():
    with (REPOSITORY / "benchmark" / "board.tsv").open(encoding="utf-8") as file:
        lines = list(csv.DictReader(file, delimiter="\t"))
    columns = [f"{axis}{day} d [m]" for axis, day in (("R at ", 7), ("", 1), ("", 7))]
    sgp4, ours = (
        [int(line[column].split()[0]) for column in columns]
        for tool in ("sgp4", "predict")
        for line in lines
        if line["task"] == "altimetry" and line["tool"].endswith(f": {tool}")
    )
    metres = "is {} m off along the track after a day and {} m after seven, SGP4 {} and {} m"
    assert metres.format(*ours[1:], *sgp4[1:]) in sentences("docs/benchmark")
    shares = [round(100.0 * own / published) for own, published in zip(ours, sgp4, strict=True)]
    said = "of `predict` is {} % of SGP4's radially, {} % along the track after a day and {} % after seven"
    assert said.format(*shares) in sentences("docs/benchmark")


def test_trees_relative_to_density_are_those_of_the_columns():
    table = catalogue()
    for season, ratios in where_learning_helps.from_catalogue().items():
        for (ratio, *_), trees, scaled in zip(
            ratios, table[season, "trees"], table[season, "density"], strict=True
        ):
            assert ratio == pytest.approx(100.0 * trees[0] / scaled[0], abs=2.0)


def test_the_worst_weeks_are_those_of_their_table():
    table = tsv("weeks")
    summer = sorted(-float(row["3 d [%]"]) for row in table if row["season"] == "summer of 2026")
    assert summer[1] < -100.0 <= summer[2]
    worst, *_ = every_week.worst([row for row in table if row["season"] == "storms of 2025"])
    said = "nine weeks of summer improved sets were worse than SGP4 after three days ({:.0f} and {:.0f} %)"
    assert said.format(-summer[0], -summer[1]) in sentences("docs/learning")
    assert f"of the storms after seven ({worst:.0f} %)" in sentences("docs/learning")
    assert [len(axes.lines[0].get_xdata()) for axes in every_week.every_week(table).axes] == [9, 28, 12]


def test_the_orbit_inside_leaves_least():
    least = {}
    for row in tsv("true_errors"):
        share = int(row["other objects, later [%]"].split()[0])
        least[row["component"]] = min(least.get(row["component"], (100, "")), (share, row["method"]))
    assert [method.split()[0] for _, method in least.values()] == 3 * ["orbit"]


def test_what_learning_costs_a_satellite_is_the_skill_of_its_table():
    table = {first: cells for first, *cells in rows("docs/reality", "## Swarm A")}
    skill = int(table["`mechanism`, the best that learned"][-1])
    assert f"retrained each morning it is {-skill} % worse than the best" in sentences("docs/reality")
    errors = where_learning_helps.from_own_past()
    assert errors["Swarm A"] == 100.0 - skill
    assert min(errors.values()) > 100.0
    assert "No model that learned from one satellite's own past did better" in sentences("docs/reality")


def test_what_a_coarser_field_costs_is_in_the_notes():
    (chosen,) = [cells for cells in rows("notes/reality", "## Swarm A") if cells[0] == "chosen by the past"]
    day, _, four, week = (cell.split(" / ")[0] for cell in chosen[1:5])
    assert f"errors of {day}, {four} and {week} m after 1, 4 and 7 days" in sentences("docs/reality")


@pytest.fixture(scope="module")
def noted():
    """Alarms / collisions flagged [%] at 1, 3, 5 and 7 days by the first three cells of the notes' rows."""
    table = rows("notes/conjunctions", "## What objects share")
    pairs = {tuple(cells[:-4]): [cell.split(" / ") for cell in cells[-4:]] for cells in table}
    return {key: [(float(a), float(b)) for a, b in row] for key, row in pairs.items() if len(row[0]) == 2}


def test_corrected_ephemerides_raise_a_tenth_of_the_alarms(noted):
    fits, selected = (
        noted[f"Swarm A, {way}", "any"] for way in ("12-hour fits, their own covariance", "selected each day")
    )
    assert selected[0][0] / fits[0][0] == pytest.approx(0.1, abs=0.02)
    said = f"own covariances: {selected[0][0]:.0f} per collision, not {fits[0][0]:.0f}"
    assert said in sentences("docs/conjunctions")
    assert (selected[-1][1], fits[-1][1] < 50) == (100, True)


def test_alarms_of_public_sets_are_those_of_the_notes(noted):
    improved = "improved, shared"
    shown = {
        "SGP4": ("all", "SGP4, independent", "any"),
        "improved, `correlated`": ("all", improved, "any"),
        "below 450 km": ("300 to 450 km", improved, "any"),
        "above 600 km": ("600 to 1000 km", improved, "any"),
    }
    stated = [
        cells for cells in rows("docs/conjunctions", "## How much corrections help") if cells[0] in shown
    ]
    for (name, *alarms), (same, *shares) in zip(stated[:4], stated[4:], strict=True):
        assert name == same
        assert list(zip(map(float, alarms), map(float, shares), strict=True)) == noted[shown[name]]
    low, high = (noted["all", improved, angle][1][1] for angle in ("below 60", "over 120"))
    said = f"After three days {low:.0f} % are flagged at crossings below 60 deg, {high:.0f} % above 120"
    assert said in sentences("docs/conjunctions")


def test_every_conjunction_of_cara_is_counted_once():
    inside, all_of_them = re.search(
        r"Of (\d+) conjunctions of NASA's CARA (\d+) are within", sentences("docs/conjunctions")
    ).groups()[::-1]
    assert int(inside) + len(
        re.findall(r"one is 2 % low|one 12 % high", sentences("docs/conjunctions"))
    ) == int(all_of_them)
    assert f"the probabilities of {all_of_them} real conjunctions" in sentences("docs/conjunctions")


@pytest.mark.parametrize(
    ("name", "phrase"),
    [
        ("day", f"at least {100.0 * verdicts.LEAST_INSIDE:.0f} % of the last two weeks' errors, "),
        ("day", f"errors, {100.0 * verdicts.LEAST_OF_DAY:.0f} % on each day ahead"),
        ("day", f"its last {days.STRIP} verdicts"),
        ("improve", f"scaled by the errors of the object's last {improved_sizes.ALONG_MORNINGS} mornings"),
        ("improve", f"(a/{improved_sizes.STORM:.0f})^2"),
        ("improve", f"the errors of its last {improved_sizes.MORNINGS} mornings"),
        ("improve", f"errors across burns of the last {prediction.BURNED:.0f} days"),
        ("improve", f"below {prediction.LOW / 1e3:.0f} km those of objects with a negative B*"),
        ("improve", f"after its epoch ({24.0 * catalogue_of_sets.LATENCY:.0f} with `--date`)"),
        ("improve", f"from {LOWEST} to {HIGHEST} km and an eccentricity below {features.MOST_ECCENTRICITY}"),
        (
            "limits",
            f"at {LOWEST} to {HIGHEST} km mean height and eccentricities below {features.MOST_ECCENTRICITY}",
        ),
        ("conjunctions", f"near-circular objects from {LOWEST} to {HIGHEST} km"),
        ("conjunctions", f"the span is `--days` ({screening.DAYS:.0f}) from the newest set"),
        ("learning", f"weighted by their likelihood in its last {weighting.PAST} mornings"),
        (
            "learning",
            f"{100.0 * min(features.LASTING.values()):.0f} to {100.0 * max(features.LASTING.values()):.0f} %",
        ),
        ("orbits", f"differ by more than {1e3 * orbit_breaks.LEAST_JUMP} mm/s"),
        ("orbits", f"step if above {1e2 * orbit_breaks.LEAST_SEAM:.0f} cm"),
        ("tracks", f"five measurements over {first_orbit.SHORTEST:.0f} s"),
        ("tracks", f"tracks over {first_orbit.FARTHEST / 1e3:.0f} km from the orbit"),
    ],
)
def test_limits_on_pages_are_those_of_the_code(name, phrase):
    assert phrase in sentences(f"docs/{name}")


@pytest.mark.parametrize(
    ("name", "phrase", "source", "row"),
    [
        ("beyond", "74 % with the SVR", "docs/beyond", "3, `svr`"),
        ("beyond", "to 6 % with the law", "docs/beyond", "3, `mechanism`"),
        ("comparison", "22 times faster than heyoka", "docs/performance", "heyoka"),
        ("comparison", "375 times faster than Orekit", "docs/performance", "Orekit"),
        ("howto", "reduces them to 16 %", "docs/howto", "`mechanism`"),
        ("improve", "contained 88, 94, 97 and 97 % of along-track errors", "notes/uncertainty", "all, own"),
        ("orbits", "error of 0.0004 m rms with velocities, 0.004 m without", "notes/orbits", "every 300 s"),
    ],
)
def test_numbers_in_a_sentence_are_those_of_a_row(name, phrase, source, row):
    assert phrase in sentences(f"docs/{name}")
    (cells,) = (", ".join(cells) for cells in rows(source) if ", ".join(cells).startswith(row))
    for number in re.findall(r"\d+(?:\.\d+)?", phrase):
        assert re.search(rf"(?<![\d.]){re.escape(number)}(?!\d)", cells), number


def test_the_paper_s_numbers_are_those_of_the_pages(improved):
    text = sentences("docs/paper")
    _, sgp4, ours = rows("docs/inside")[2]
    assert f"{ours} m (radial, along-track, cross-track), SGP4's is {sgp4} m" in text
    week, low, high = improved["summer"][-1]
    assert f"to {week} % (95 % interval {low} to {high}) in the summer of 2026" in text
    assert re.search(rf"\*\*{week} %\*\* [^.]+ \(95 % interval {low} to {high}\)", sentences("README"))
    assert f"to {improved['solar'][-1][0]} % at solar minimum" in text
    three = {cells[1]: cells for cells in rows("docs/beyond", "## Results") if cells[0] == "3"}
    random, grouped, _, unseen = (cell.split()[0] for cell in three["`svr`"][2:])
    assert f"machine {random} % of the error remain on rows drawn at random, {grouped} % on estimates" in text
    assert f"and {unseen} % on those of later days" in text
    assert f"the causes {three['`mechanism`'][-1].split()[0]} %" in text


def test_burns_that_are_found_are_those_of_the_satellites_that_set_no_limit():
    held_out = [list(map(float, cells[1:])) for cells in rows("notes/burns", "## Eight histories")[6:]]
    shares = [round(100.0 * found / published) for published, found, *_ in held_out]
    late, false = ([cells[k] for cells in held_out] for k in (2, 3))
    ranges = [f"{min(numbers)} to {max(numbers)}" for numbers in (shares, late, false)]
    assert "{} %, {} days late, with {} false alarms".format(*ranges) in sentences("docs/elements")
    assert len(held_out) == 4


def test_sentences_on_the_paper_are_those_of_the_table_of_interpretations():
    *_, future, other, higher = rows("docs/reproduction", "## Interpretations")
    for said in (
        f"{future[2]} becomes {future[3].strip('*')} with both and the prior",
        f"nothing is corrected ({other[2]}). Without the orientation P_ML is {other[3]}",
        f"joint gives {float(higher[-1]):.0f} % instead of {float(higher[1]):.0f} %",
    ):
        assert said in sentences("docs/reproduction")


def test_interpretations_are_bold_where_they_are_within_three_points_of_the_paper():
    _, _, _, *numbers = rows("docs/reproduction", "## Interpretations")
    paper = [float(cells[1]) for cells in numbers]
    for target, (_, _, *cells) in zip(paper, numbers, strict=True):
        near = [abs(float(cell.strip("*")) - target) <= 3.0 for cell in cells]
        assert [cell.startswith("**") for cell in cells] == near
    split, _, _, said = re.search(
        r"three stations is (\d+) (%), (not) ([\d.]+)", sentences("docs/reproduction")
    ).groups()
    (svr,) = [cells for cells in rows("docs/beyond", "## Results") if cells[:2] == ["3", "`svr`"]]
    assert (svr[3].split()[0], f"{paper[2]:g}") == (split, said)
