"""Settings: the paper's are valid, and each wrong one is told in one line with its file and key."""

import copy
import json
from pathlib import Path

import pytest
from support import setting_keys

from opml import tables
from opml.config import load, read_yaml, with_numbers
from opml.errors import InputError
from opml.learning import splits

ROOT = Path(__file__).parents[2]
SCHEMA = ROOT / "workflow" / "schemas" / "config.schema.yaml"
PAPER = read_yaml(ROOT / "config" / "config.yaml")


@pytest.fixture(autouse=True)
def _in_root(monkeypatch):
    monkeypatch.chdir(ROOT)  # the sheets' paths are relative to it


def edited(key, value):
    values = json.loads(json.dumps(PAPER))  # apart from each other, unlike what YAML's anchors share
    *parents, last = key.split(".") if isinstance(key, str) else key
    place = values
    for name in parents:
        place = place[name]
    place[last] = value
    return values


def message(values, files=("config/config.yaml",)):
    with pytest.raises(InputError) as raised:
        load(values, schema=SCHEMA, files=files)
    assert "\n" not in str(raised.value)
    return str(raised.value)


def test_papers_settings_are_valid():
    settings = load(PAPER, schema=SCHEMA)
    assert settings.values == PAPER
    assert (len(settings.stations), len(settings.rsos)) == (3, 7)


def test_every_setting_of_another_type_is_told_with_its_key():
    for key in setting_keys():
        said = message(edited(key, [[]]))
        assert said.startswith(f"--config: {'.'.join(key)}"), said


def test_learning_variables_are_the_tables_columns():
    schema = read_yaml(SCHEMA)["$defs"]["variable"]["enum"]
    assert set(schema) == {*tables.LEARNING_VARIABLES, "gap"}
    assert PAPER["learning"]["variables"] == list(tables.LEARNING_VARIABLES)


def test_third_bodies_are_the_tables_columns():
    schema = read_yaml(SCHEMA)["$defs"]["force_model"]["properties"]["third_bodies"]["items"]["enum"]
    assert tuple(schema) == tables.BODIES
    assert read_yaml(SCHEMA)["$defs"]["component"]["enum"] == list(tables.COMPONENTS)


def test_splits_are_those_of_the_learning():
    schema = read_yaml(SCHEMA)["$defs"]
    assert schema["train"]["pattern"] == f"^(?:{splits.TRAIN})$"
    assert schema["test"]["pattern"] == f"^(?:{splits.TEST})$"


def objects(schema):
    if isinstance(schema, dict):
        if schema.get("type") == "object":
            yield schema
        for part in schema.values():
            yield from objects(part)


def test_no_object_of_the_schema_takes_unknown_keys():
    # A learner's keys depend on its kind: each kind's own object is closed.
    assert all({"additionalProperties", "allOf"} & set(found) for found in objects(read_yaml(SCHEMA)))


@pytest.mark.parametrize(
    ("key", "value", "expected"),
    [
        ("sed", 1, "sed: unknown key; did you mean seed?"),
        ("tracking.stp_s", 20, "tracking.stp_s: unknown key; did you mean step_s?"),
        ("tracking.step_s", "fast", "tracking.step_s: expected a number above 0, got 'fast'"),
        ("tracking.step_s", 0, "tracking.step_s: expected a number above 0, got 0"),
        ("tracking.step_s", True, "tracking.step_s: expected a number above 0, got True"),
        ("tracking.step_s", float("nan"), "tracking.step_s: expected a finite number, got nan"),
        ("tracking", 20, "tracking: expected a mapping, got 20"),
        ("seed.noise", 1.5, "seed.noise: expected a whole number from 0, got 1.5"),
        ("epoch", "2016-9-28", "epoch: expected UTC text in quotes"),
        (
            "results",
            "a folder",
            "results: expected a folder's path without spaces, braces or a leading ~, got 'a folder'",
        ),
        ("results", "~/runs", "results: expected a folder's path without spaces, braces or a leading ~"),
        ("environment.percentile", 51, "environment.percentile: expected one of 95, 50, 5, got 51"),
        ("environment.gravity_field", 8, "environment.gravity_field: expected text, got 8"),
        ("force_models.truth.order", 41, "force_models.truth.order: expected at most degree, got 41 and 40"),
        (
            "force_models.assumed.third_bodies",
            ["vulcan"],
            "force_models.assumed.third_bodies.0: expected one of sun,",
        ),
        ("integrator.min_step_s", 91, "integrator.min_step_s: expected at most max_step_s, got 91 and 90"),
        ("cleaning.cd_min", 4, "cleaning.cd_min: expected at most cd_max, got 4 and 3.2"),
        (
            "learning.span_days",
            [30, 0],
            "learning.span_days: expected the first day before the last, got 30 and 0",
        ),
        (
            "learning.span_days",
            [30],
            "learning.span_days: expected two numbers, first and last day, got [30]",
        ),
        ("learning.variables", ["a", "a"], "learning.variables: expected no item twice"),
        (
            "learners.svr.kernel_scale",
            "auto",
            "kernel_scale: expected sigest, median, cv or a number above 0",
        ),
        ("learners.a/b", {}, "learners.a/b: expected a name of lower-case letters and digits, got 'a/b'"),
        (
            "experiments.partition.ratios",
            [0],
            "partition.ratios.0: expected a whole percentage from 1 to 99, got 0",
        ),
        (
            "experiments.defaults.learner",
            "forest",
            "defaults.learner: learner 'forest': expected one of svr, svrmedian",
        ),
        (
            "experiments.defaults.stations",
            "eglin-oz",
            "defaults.stations: stations 'eglin-oz': expected names",
        ),
        ("experiments.defaults.rso", "mir", "defaults.rso: RSO 'mir': expected one of iss,"),
        ("experiments.defaults.component", "e_r", "defaults.component: expected one of e_x, e_y"),
        (
            "experiments.orbit.zoom_days",
            [25, 51],
            "orbit.zoom_days: expected ascending days up to duration_days",
        ),
        (
            "experiments.evaluations.future_5days.train",
            "random80",
            "evaluations.future_5days.train: expected random-<percent>, grouped-<percent> or days-<first>",
        ),
        (
            "experiments.evaluations.future_5days.test",
            "days-50-60",
            "future_5days.test: split 'days-50-60': expected ascending days up to duration_days, 50, got 50",
        ),
        (
            "experiments.evaluations.future_5days.test",
            "days-35-30",
            "expected ascending days up to duration_days, 50, got 35 and 30",
        ),
        (
            "experiments.evaluations.future_5days.tst",
            "rest",
            "future_5days.tst: unknown key; did you mean test?",
        ),
        (
            "experiments.evaluations.inclination_50.target",
            "iss_i050",
            "inclination_50.target: RSO 'iss_i050': expected one of iss,",
        ),
        (
            "experiments.evaluations.inclination_50.test",
            "seen",
            "inclination_50.test: expected another split, as seen rows are the RSO's own",
        ),
        (
            "experiments.evaluations",
            {"A b": {}},
            "expected a name of lower-case letters, digits and _, got 'A b'",
        ),
        (
            "experiments.evaluations",
            {"../../x": {}},
            "evaluations.../../x: expected a name of lower-case letters, digits and _, got '../../x'",
        ),
        ("experiments.partition.shown", [45], "partition.shown: expected one of 10, 20, 30"),
        ("experiments.individual.evaluation", "past", "individual.evaluation: expected one of svr_training"),
        ("experiments.grids.rso.rsos", ["mir"], "grids.rso.rsos: RSO 'mir': expected one of iss,"),
        (
            "experiments.curves.inclination.inclinations",
            [181],
            "inclinations.0: expected degrees from 0 to 180",
        ),
        (
            "experiments.curves.semi_major_axis.offsets",
            [-300],
            "offsets: RSO 'iss_a-300': expected a perigee",
        ),
        (
            "experiments.kernel_scale.rules",
            ["auto"],
            "kernel_scale.rules: learner 'auto': expected one of svr",
        ),
        (
            "experiments.kernel_scale.splits",
            [["random-80"]],
            "kernel_scale.splits.0: expected a pair of a training and a test split",
        ),
        ("experiments.components", ["past"], "components: expected one of svr_training_1station"),
        ("experiments.seeds.split", [], "seeds.split: expected a list of seeds, got []"),
        ("experiments.reproduction.fixed", "nothing", "reproduction.fixed: expected one of svr, svrmedian"),
        (
            "experiments.reproduction.fixed",
            "svr",
            "learners.svr.kernel_scale: expected a number, as it stands",
        ),
        (
            "experiments.reproduction.readings.cv_scale.learner",
            "forest",
            "readings.cv_scale.learner: learner 'forest': expected one of",
        ),
        ("learners.svr.without", ["speed"], "learners.svr.without.0: expected one of duration,"),
        ("learners.none", {}, "learners.none.kind: expected a value, got none"),
        ("learners.none", "none", "learners.none: expected a mapping, got 'none'"),
        ("learners.none.kind", "oracle", "learners.none.kind: expected one of svr, none"),
        ("learners.none.c", 1.0, "learners.none.c: unknown key; expected one of kind"),
        ("learners.ridge", {"kind": "ridge"}, "learners.ridge.alpha: expected a value, got none"),
        ("learners.stacked.first.terms", [], "learners.stacked.first.terms: expected a list of products"),
        ("learners.covariance.terms", ["v+cd"], "terms.0: expected a product of variables, such as v*cd"),
        ("mechanism.resonances", [[1, 0]], "resonances.0.1: expected a whole number above 0, got 0"),
        ("intervals.level", 1, "intervals.level: expected a number between 0 and 1, got 1"),
        ("pools.inclinations", ["iss"], "pools.inclinations: expected a list of at least two RSOs"),
        ("pools.inclinations", ["iss", "mir"], "pools.inclinations: RSO 'mir': expected one of iss,"),
        ("experiments.generalisation.learners", ["kriging"], "learner 'kriging': expected one of svr"),
        ("experiments.generalisation.intervals.splits", ["never"], "splits: expected one of random, grouped"),
        (
            "experiments.generalisation.intervals.learners",
            ["longarc", "ridge", "svrcv"],
            "expected one of none,",
        ),
        (
            "experiments.generalisation.budget.split",
            ["random-80", "days-90-95"],
            "split 'days-90-95': expected",
        ),
        ("sheets.rsos", "config/none.tsv", "config/none.tsv: no such file"),
        ("oem", {"mir": "mir.oem"}, "oem.mir: RSO 'mir': expected one of iss,"),
        ("oem", {"iss": ""}, "oem.iss: expected text of at least 1 letter, got ''"),
    ],
)
def test_wrong_setting_is_named(key, value, expected):
    assert expected in message(edited(key, value))


def test_missing_setting_is_named():
    values = copy.deepcopy(PAPER)
    del values["cleaning"]["fence"]
    assert message(values) == "config/config.yaml: cleaning.fence: expected a value, got none"


def test_key_that_is_no_text_is_named():
    assert "3: expected a key that is text" in message(PAPER | {3: 4})


def test_the_file_that_set_the_value_is_named(tmp_path):
    file = tmp_path / "mine.yaml"
    file.write_text("tracking: {step_s: -1}\n")
    values = edited("tracking.step_s", -1)
    assert message(values, ["config/config.yaml", file]).startswith(f"{file}: tracking.step_s")
    assert message(values, ["config/config.yaml"]).startswith("--config: tracking.step_s")


@pytest.mark.parametrize("text", ["a: [", "a: b: c", "\t- x", "!!python/object:os.system {}"])
def test_what_is_no_yaml_is_named_and_nothing_is_run(tmp_path, text):
    file = tmp_path / "broken.yaml"
    file.write_text(text)
    with pytest.raises(InputError, match=r"broken\.yaml: expected YAML"):
        read_yaml(file)


def test_numbers_inside_braces_on_the_command_line_become_numbers():
    given = {"a": {"b": "20", "c": ["0.5", "x"], "d": True}, "e": 0.5}
    assert with_numbers(given) == {"a": {"b": 20, "c": [0.5, "x"], "d": True}, "e": 0.5}
    assert isinstance(with_numbers(given)["a"]["b"], int)
    assert with_numbers(given)["a"]["d"] is True
