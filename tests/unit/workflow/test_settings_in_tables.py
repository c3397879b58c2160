"""Tables that tell the settings that made them, and the plan that believes them."""

from pathlib import Path
from types import SimpleNamespace

import pandas as pd
import pytest

from opml.tables import TRUTH_GROUPS, write_table
from opml.workflow.jobs import metadata_of_each
from opml.workflow.settings_in_tables import tables_of_other_settings

EPOCH = {"epoch": "2016-09-28T12:09:45"}
NONE, FIT, OTHER = (
    {"kind": "none"},
    {"kind": "refitted", "window_hours": 24.0},
    {"kind": "refitted", "window_hours": 48.0},
)


@pytest.fixture
def paths(tmp_path):
    """Tables that one job made for two learners."""
    made = EPOCH | {"learners": [NONE, FIT]}
    table = pd.DataFrame({"rso": ["iss"]})
    paths = [str(tmp_path / f"{learner['kind']}.parquet") for learner in made["learners"]]
    for path, metadata in zip(paths, metadata_of_each(made), strict=True):
        write_table(path, table, TRUTH_GROUPS, metadata=metadata)
    return paths


def found(output, learners):
    job = SimpleNamespace(params={"settings": EPOCH | {"learners": learners}}, output=output)
    return tables_of_other_settings(job)


def test_tables_made_together_are_those_of_each_alone(paths):
    none, fit = paths
    assert found(paths, [NONE, FIT]) == found([none], [NONE]) == found([fit], [FIT]) == set()
    assert found([*paths, "later.parquet"], [NONE, FIT, OTHER]) == set()  # that it lacks one, Snakemake sees


def test_a_learner_with_other_settings_is_found(paths):
    _, fit = paths
    assert found(paths, [NONE, OTHER]) == {fit}
    assert found([fit], [OTHER]) == {fit}


def test_a_damaged_table_counts_as_one_of_other_settings(paths):
    none, _ = paths
    Path(none).write_bytes(b"no table")
    assert found(paths, [NONE, FIT]) == {none}
