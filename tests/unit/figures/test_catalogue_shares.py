"""The figure of a catalogue's test: a panel per band, marks of each learner beside the unlearned ones."""

import pandas as pd

from opml.element_sets import corrector_scores
from opml.figures.catalogue.residual_shares import every_season, shares

SEASONS = {"train": ["2026-03-15", "2026-05-07"], "test": ["2026-05-31", "2026-07-31"]}


def scores():
    """Scores of two bands and two leads by two learners."""
    rows = [
        {"learner": learner, "band": band, "lead": lead}
        for learner in ("trees", "svr")
        for band in (corrector_scores.ALL, 2)
        for lead in (1, 3)
    ]
    medians = {"scaled": 80.0, "learned": 80.0, "improved": 60.0}
    shares = {f"{way}_{part}": one for way, one in medians.items() for part in ("low", "median", "high")}
    table = pd.DataFrame(rows).assign(**shares | {"learned_low": 70.0, "scaled_high": 95.0}, objects=7)
    return table.assign(learned_median=table["learned_median"] + 5.0 * (table["band"] == 2))


def test_panels_are_bands_and_marks_are_learners():
    figure = shares(scores(), SEASONS, name="summer")
    assert [axes.get_title("left") for axes in figure.axes] == [
        "all heights, 7 objects",
        "450 to 500 km, 7 objects",
    ]
    handles, labels = figure.axes[1].get_legend_handles_labels()
    assert labels == [
        "SGP4",
        "density-scaled, without learning",
        "learned by trees",
        "learned by the paper's SVR",
    ]
    (learned,) = (handle for handle, label in zip(handles, labels, strict=True) if label.endswith("trees"))
    assert learned.lines[0].get_ydata().tolist() == [85.0, 85.0]
    ends = [segment[:, 1].tolist() for segment in learned.lines[2][0].get_segments()]
    assert ends == [[70.0, 85.0]] * 2


def test_headline_names_the_heights_of_its_shares_and_the_note_both_seasons():
    figure = shares(scores(), SEASONS, name="summer")
    assert figure.get_suptitle().strip() == (
        "Learned corrections: 80 to 80 % of SGP4's median error over all heights, 85 to 85 % by band"
    )
    (note,) = figure.texts[-1:]
    assert " ".join(note.get_text().split()) == (
        "summer: trained on half, 2026-03-15 to 2026-05-07; tested on the others, 2026-05-31 to 2026-07-31; "
        "bars: 95 % over weeks and objects"
    )


def test_every_test_has_a_panel_with_its_dates():
    tests = pd.concat([scores().assign(test=name) for name in ("summer", "rise")])
    figure = every_season(tests, {"summer": "2026-05-31 on", "rise": "2022-11-01 on"})
    assert [axes.get_title("left") for axes in figure.axes] == ["2026-05-31 on", "2022-11-01 on"]
    for axes in figure.axes:
        (told,) = axes.texts
        assert told.get_text() == "7 objects"
        handles, labels = axes.get_legend_handles_labels()
        assert (
            handles[labels.index("sets improved by opml improve")].lines[0].get_ydata().tolist() == [60.0] * 2
        )


def test_no_test_lies_outside_its_panel():
    """The second one is worse than SGP4; a bar wider than the axis is cut."""
    summer = scores().assign(test="summer")
    storm = summer.assign(test="storm", improved_median=180.0, improved_high=220.0)
    figure = every_season(pd.concat([summer, storm]), {"summer": "", "storm": ""})
    assert figure.get_suptitle().strip() == (
        "Improved sets: 60 to 180 % of SGP4's median error; 2 of 4 bars are below it"
    )
    for axes in figure.axes:
        low, high = axes.get_ylim()
        assert low == 0.0
        assert 180.0 < high < 220.0
