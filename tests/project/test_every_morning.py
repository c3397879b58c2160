"""The picture of mornings: verdicts as they were kept, burns as they were published."""

import gzip
import json
from datetime import date, timedelta

import pytest

from opml.mornings.outcomes import DO_NOT_USE, GOOD, WIDE
from validation.pictures import every_morning

DAYS = [date(2018, 7, 30) + timedelta(days=k) for k in range(12)]
BEFORE = [DAYS[0] - timedelta(days=k) for k in range(10, 0, -1)]
BURNT = {"Jason-2": [DAYS[1]], "SARAL": []}
WORDS = {"jason2": [GOOD] * 2 + [DO_NOT_USE] * 3 + [GOOD] * 7, "saral": [WIDE] * 11 + [DO_NOT_USE]}


@pytest.fixture
def table(tmp_path):
    for k, day in enumerate(BEFORE + DAYS):
        verdicts = {name: words[max(k - len(BEFORE), 0)] for name, words in WORDS.items()}
        told = [{"date": str(day), "object": name, "verdict": word} for name, word in verdicts.items()]
        folder = tmp_path / "days" / str(day) / "batch_0"
        folder.mkdir(parents=True)
        (folder / "outcomes.json.gz").write_bytes(gzip.compress(json.dumps(told).encode()))
    return every_morning.verdicts(tmp_path, BURNT)


def test_verdicts_are_by_day_and_satellite(table):
    assert table["Jason-2"].tolist() == WORDS["jason2"]
    assert table.index.tolist() == DAYS


def test_burns_are_dates(tmp_path):
    (tmp_path / "Jason-2.yaml").write_text("manoeuvre_timestamps:\n- 2018-07-31 13:14:00\n", encoding="utf-8")
    assert every_morning.burns(tmp_path) == {"Jason-2": [DAYS[1]]}


def test_each_day_has_the_look_of_its_verdict(table):
    figure = every_morning.every_morning(table, BURNT)
    first, second = ([bar for bar in axes.patches if bar.get_x() > 0.0] for axes in figure.axes)
    assert {(bar.get_y(), bar.get_hatch()) for bar in first} == {(-0.4, "/////"), (0.6, ""), (0.6, "xxxxx")}
    assert len(first + second) == 2 * len(DAYS)
    burnt = [point for line in figure.axes[0].lines for point in line.get_ydata()]
    assert burnt == [1.4]


def test_the_headline_counts_what_follows_a_burn(table):
    said = "9 of 24 mornings are good; 3 of 15 others follow a burn within 14 days"
    assert every_morning.headline(table, BURNT) == said
