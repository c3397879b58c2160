"""Every learner behind the one interface: what it predicts, and that its file is the model."""

import importlib.util
import json
import re
import sys

import numpy as np
import pandas as pd
import pytest
from sklearn.ensemble import HistGradientBoostingRegressor
from sklearn.linear_model import QuantileRegressor
from support import REPOSITORY, paper_source, refusals

from opml.base.errors import InputError
from opml.learning.judge.evaluation import evaluate
from opml.learning.models import boosting, learners, linear_law
from opml.learning.models.training_inputs import Training
from opml.study import checks
from opml.study.settings.json_schema import json_schema
from opml.study.settings.overlay import Source
from opml.tables import write_table

VARIABLES = ["duration", "d_a", "cd", "v_y"]
BOOSTING = {"kind": "boosting", "trees": 40, "leaves": 7, "learning_rate": 0.2, "min_rows": 5}
MECHANISM = {"kind": "linear_law", "terms": ["v", "v*cd"]}
SETTINGS = {
    "none": {"kind": "none"},
    "linear_law": MECHANISM,
    "boosting": BOOSTING,
    "svr": {"kind": "svr", "kernel_scale": "sigest", "c": 1.0, "epsilon": 0.1, "tol": 1e-3},
    "refitted": {"kind": "refitted", "window_hours": 48},
    "running": {"kind": "running", "window_hours": 96, "memory_days": 30},
}
NOTHING_LEARNED = ("none", "refitted", "running")
KINDS = pytest.mark.parametrize("kind", list(SETTINGS))


def sample(count, seed=0):
    """Rows whose error is V (Cd - 2.2) but for noise and, through d_a, something that is no mechanism."""
    rng = np.random.default_rng(seed)
    duration = rng.uniform(3600.0, 6e5, count)
    cd, d_a = rng.normal(2.2, 0.02, count), rng.normal(0.0, 300.0, count)
    v = 5e5 * (duration / 6e5) ** 2
    error = v * (cd - 2.2)
    y = error + 800.0 * np.sin(d_a / 200.0) + 50.0 * rng.standard_t(2, count)
    rows = pd.DataFrame({"duration": duration, "d_a": d_a, "cd": cd, "v_y": v})
    # Arcs whose own Cd is the half of it off, and that know the rest.
    arcs = {"l_arc_y": 0.5 * error, "v_arc_y": v, "cd_arc": 2.2 + 0.5 * (cd - 2.2)}
    return rows.assign(**arcs, cd_past=2.2), y


def resolved(settings, component="e_y", variables=VARIABLES):
    return learners.settings_of(settings).resolved(component=component, variables=variables)


def trained(kind, rows, y, seed=42, changes=None):
    settings = resolved(SETTINGS[kind] | (changes or {}))
    training = Training(rows[settings.variables].to_numpy(), y, settings.variables, seed)
    return learners.fit(training, settings)


def predicted(model, rows):
    return model.predict(rows[list(model.variables)].to_numpy())


@pytest.fixture(scope="module")
def models():
    """A model of each kind."""
    return {kind: trained(kind, *sample(400)) for kind in SETTINGS}


@KINDS
def test_saved_and_loaded_bit_for_bit(tmp_path, models, kind):
    model, (new, _) = models[kind], sample(700, seed=1)
    table, metadata = model.to_table()
    path = tmp_path / "model.parquet"
    write_table(path, table, learners.schema(metadata), metadata=metadata | {"component": "e_y"})
    loaded = learners.read(path)
    assert loaded.variables == model.variables
    np.testing.assert_array_equal(predicted(loaded, new), predicted(model, new))
    again, metadata_again = loaded.to_table()
    pd.testing.assert_frame_equal(again, table, check_exact=True, check_dtype=False)
    assert json.dumps(metadata_again) == json.dumps(metadata)


@KINDS
def test_the_same_rows_and_seed_make_the_same_model(models, kind):
    table, metadata = trained(kind, *sample(400)).to_table()
    expected, metadata_expected = models[kind].to_table()
    pd.testing.assert_frame_equal(table, expected, check_exact=True)
    assert metadata == metadata_expected


@KINDS
def test_predicting_no_rows(models, kind):
    assert predicted(models[kind], sample(3)[0].iloc[:0]).shape == (0,)


@pytest.mark.parametrize("kind", [kind for kind in SETTINGS if kind != "none"])
def test_values_that_are_not_finite_are_refused(models, kind):
    rows, y = sample(60)
    variable = models[kind].variables[-1]
    broken = rows.assign(**{variable: np.where(np.arange(60) == 7, np.nan, rows[variable])})
    with pytest.raises(InputError, match=f"learning variable {variable}: expected finite"):
        predicted(models[kind], broken)
    with pytest.raises(InputError, match=f"learning variable {variable}: expected finite"):
        trained(kind, broken, y)


@pytest.mark.parametrize("kind", [kind for kind in SETTINGS if kind not in NOTHING_LEARNED])
def test_a_target_that_is_not_finite_is_refused(kind):
    rows, y = sample(60)
    with pytest.raises(InputError, match="target: expected 60 finite values, got 59"):
        trained(kind, rows, np.where(np.arange(60) == 3, np.inf, y))


def test_a_variable_that_the_dataset_does_not_have_is_told():
    rows = pd.DataFrame({"i": [0, 1], "e_y": [1.0, 2.0], "cd": [2.1, 2.2]})
    settings = resolved({"kind": "linear_law", "terms": ["v*cd"]}, variables=["cd"])
    with pytest.raises(InputError, match="learning variable v_y: expected it in a dataset"):
        learners.train(rows, component="e_y", settings=settings, seed=1)
    model = learners.train(rows.assign(v_y=1.0), component="e_y", settings=settings, seed=1)
    with pytest.raises(InputError, match="learning variable v_y: expected it in a dataset"):
        evaluate(model, rows, np.ones(2, dtype=bool), component="e_y")


def test_what_each_kind_is_worth_on_what_it_can_learn(models):
    new, y = sample(2000, seed=1)
    error = new["v_y"] * (new["cd"] - 2.2)
    left = {kind: np.abs(y - predicted(model, new)).sum() / np.abs(y).sum() for kind, model in models.items()}
    assert left["none"] == 1.0
    mechanism_leaves = np.abs(y - error).sum() / np.abs(y).sum()
    assert left["linear_law"] == pytest.approx(mechanism_leaves, abs=0.01)
    assert left["running"] == pytest.approx(mechanism_leaves)
    for kind, share in {"refitted": 0.5}.items():
        assert left[kind] == pytest.approx(np.abs(y - share * error).sum() / np.abs(y).sum())
    assert left["linear_law"] < left["boosting"] < 1.0


def test_the_arcs_that_a_learner_asks_for():
    def arc_of(**settings):
        return learners.arc_of(resolved(settings))

    assert arc_of(**SETTINGS["running"]) == (96.0, 30.0)
    assert arc_of(kind="refitted", window_hours=48) == (48.0, 30.0)
    assert arc_of(**MECHANISM) is None
    assert arc_of(**MECHANISM, window_hours=48) is None  # of whose columns it reads none
    law = {"kind": "linear_law", "terms": ["l_arc", "v_arc*cd_arc"], "window_hours": 24, "memory_days": 8}
    assert arc_of(**law) == (24.0, 8.0)
    with pytest.raises(InputError, match="expected window_hours with columns of the arcs"):
        arc_of(kind="linear_law", terms=["l_arc"])


@pytest.mark.parametrize("terms", [["v_y", "v_y*cd"], ["v_y"], ["v_y", "v_y*cd", "duration*duration"]])
def test_the_mechanism_minimises_absolute_deviations(terms):
    rows, y = sample(800)
    x = linear_law.products(rows[VARIABLES].to_numpy(), VARIABLES, terms)
    scale = np.abs(x).mean(axis=0)
    machine = QuantileRegressor(quantile=0.5, alpha=0.0, fit_intercept=False).fit(x / scale, y)
    least = np.abs(y - x / scale @ machine.coef_).sum()
    ours = np.abs(y - x @ linear_law.least_absolute_deviations(x, y)).sum()
    assert ours == pytest.approx(least, rel=1e-6)
    assert ours >= least * (1.0 - 1e-9)


def test_the_mechanisms_coefficients_mean_something(models):
    model = models["linear_law"]
    assert model.terms == ("v_y", "v_y*cd")
    assert model.coefficient[1] == pytest.approx(1.0, abs=0.02)
    assert -model.coefficient[0] / model.coefficient[1] == pytest.approx(2.2, abs=1e-3)


def test_an_exact_law_is_found_and_outliers_do_not_matter():
    rows, _ = sample(60)
    x = linear_law.products(rows[VARIABLES].to_numpy(), VARIABLES, ["v_y", "v_y*cd"])
    y = x @ [-2.2, 1.0]
    np.testing.assert_allclose(linear_law.least_absolute_deviations(x, y), [-2.2, 1.0], rtol=1e-9)
    y[::4] += 1e6
    np.testing.assert_allclose(linear_law.least_absolute_deviations(x, y), [-2.2, 1.0], rtol=1e-3)


def test_a_term_that_vanishes_or_repeats_does_no_harm():
    # An orbit above the drag: Cd was held, so nothing answers to it.
    x = np.array([[1.0, 0.0, 2.0], [2.0, 0.0, 4.0], [-1.0, 0.0, -2.0]])
    b = linear_law.least_absolute_deviations(x, np.array([3.0, 6.0, -3.0]))
    np.testing.assert_allclose(x @ b, [3.0, 6.0, -3.0], rtol=1e-6)
    assert b[1] == 0.0
    assert linear_law.least_absolute_deviations(np.zeros((4, 2)), np.ones(4)).tolist() == [0.0, 0.0]


def test_a_factor_that_is_no_variable_is_named():
    law = linear_law.LawSettings(kind="linear_law", terms=["a*c"])
    with pytest.raises(InputError, match="terms: expected products of a, b, got c"):
        linear_law.fit(Training(np.ones((9, 2)), np.ones(9), ["a", "b"], seed=1), law)


def test_boosting_is_scikit_learns(models):
    rows, y = sample(400)
    new, _ = sample(3000, seed=1)
    machine = HistGradientBoostingRegressor(
        loss="absolute_error",
        max_iter=40,
        max_leaf_nodes=7,
        learning_rate=0.2,
        min_samples_leaf=5,
        early_stopping=False,
        random_state=0,
    ).fit(rows[VARIABLES].to_numpy(), y)
    np.testing.assert_allclose(
        predicted(models["boosting"], new), machine.predict(new[VARIABLES].to_numpy()), rtol=1e-12, atol=1e-9
    )
    # On thresholds too: training rows are what the bins were made of.
    np.testing.assert_allclose(
        predicted(models["boosting"], rows),
        machine.predict(rows[VARIABLES].to_numpy()),
        rtol=1e-12,
        atol=1e-9,
    )


def test_too_few_rows_are_refused():
    with pytest.raises(InputError, match="training rows: expected at least 2, got 1"):
        boosting.fit(Training(np.ones((1, 1)), np.ones(1), ["a"], seed=1), {})


def test_settings_are_resolved_for_a_component():
    known = ["duration", "cd_b"]

    def resolve(settings):
        return resolved(settings, "e_vx", known).of_job()

    assert resolve({"kind": "none"})["variables"] == []
    assert resolve(BOOSTING) == BOOSTING | {"variables": known}
    assert resolve(SETTINGS["svr"] | {"without": ["cd_b"]}) == SETTINGS["svr"] | {"variables": ["duration"]}
    assert resolve(BOOSTING | {"variables": ["v", "cd"]})["variables"] == ["v_vx", "cd"]
    law = {"kind": "linear_law", "terms": ["l", "v_long", "v_long*cd_long", "cos_2_31"]}
    found = resolve(law)
    assert found["terms"] == ["l_vx", "v_long_vx", "v_long_vx*cd_long", "cos_2_31"]
    assert found["variables"] == ["l_vx", "v_long_vx", "cd_long", "cos_2_31"]


def test_an_unknown_kind_is_named():
    with pytest.raises(InputError, match=r"kind: expected svr, .*running, got oracle"):
        learners.settings_of({"kind": "oracle"})
    with pytest.raises(InputError, match="got oracle"):
        learners.schema({"kind": "oracle", "variables": []})
    with pytest.raises(InputError, match="got oracle"):
        learners.description("oracle")


@pytest.mark.parametrize(("settings", "line"), refusals("settings_of_learners_alone"))
def test_settings_that_no_kind_takes_are_told_in_a_line(settings, line):
    with pytest.raises(InputError, match=f"^{line}"):
        learners.settings_of(settings)


def test_every_kind_is_tested_and_described():
    assert set(SETTINGS) == {learner.kind for learner in learners.LEARNERS}
    assert len({learners.description(kind) for kind in SETTINGS}) == len(SETTINGS)


@KINDS
def test_settings_of_a_kind_are_all_needed_and_take_no_other_key(kind):
    settings = SETTINGS[kind]
    assert learners.settings_of(settings).kind == kind
    wrong = [settings | {"speed": 1}, *(settings | {key: [[]]} for key in settings)]
    wrong += [{name: settings[name] for name in settings if name != key} for key in settings]
    for values in wrong:
        with pytest.raises(InputError):
            learners.settings_of(values)


def saved(path, model, changes=None):
    """A model's file, its description changed; returns the path."""
    table, described = model.to_table()
    write_table(path, table, learners.schema(described), metadata=described | (changes or {}))
    return path


def refusal(path):
    """What is told of a model's file that cannot be used; None of one that can."""
    try:
        model = learners.read(path)
    except InputError as error:
        return str(error)
    with np.errstate(all="ignore"):
        assert model.predict(np.ones((3, len(model.variables)))).shape == (3,)
    return None


@KINDS
@pytest.mark.parametrize("value", [None, "x", [], {}, [1, 2], -1, 1e308, True])
def test_a_description_of_someone_elses_is_refused_or_harmless(tmp_path, models, kind, value):
    _, described = models[kind].to_table()
    for key in described:
        path = saved(tmp_path / key, models[kind], {key: value})
        line = refusal(path)
        assert line is None or line.startswith(f"{path}: ")
        assert line or key != "kind"


@pytest.mark.parametrize(("column", "value"), [("left", 0), ("left", -1), ("right", 10**9), ("feature", 4)])
def test_a_tree_whose_branches_lead_nowhere_is_refused(tmp_path, models, column, value):
    table, described = models["boosting"].to_table()
    table.loc[0, column] = value
    path = tmp_path / "tree.parquet"
    write_table(path, table, learners.schema(described), metadata=described)
    with pytest.raises(InputError, match=rf"tree\.parquet: expected a model .*{column}: expected"):
        learners.read(path)


@KINDS
def test_a_model_without_its_description_is_refused(tmp_path, models, kind):
    table, described = models[kind].to_table()
    for key in described:
        path = tmp_path / f"{key}.parquet"
        left = {name: value for name, value in described.items() if name != key}
        write_table(path, table, learners.schema(described), metadata=left)
        assert refusal(path).startswith(f"{path}: ")


@pytest.fixture
def quantile(tmp_path, monkeypatch):
    """The module that CONTRIBUTING.md writes for a new kind, named in the registry as it says."""
    page = (REPOSITORY / "CONTRIBUTING.md").read_text(encoding="utf-8")
    (source,) = re.findall(r"```python\n(.*?)```", page, re.DOTALL)
    path = tmp_path / "quantile.py"
    path.write_text(source, encoding="utf-8")
    spec = importlib.util.spec_from_file_location("opml.learning.quantile", path)
    module = importlib.util.module_from_spec(spec)
    monkeypatch.setitem(sys.modules, spec.name, module)
    spec.loader.exec_module(module)
    assert "`quantile.LEARNER,` in `LEARNERS`" in page
    json_schema.cache_clear()
    monkeypatch.setattr(learners, "LEARNERS", (*learners.LEARNERS, module.LEARNER))
    yield module
    json_schema.cache_clear()


QUANTILE = {"kind": "quantile", "share": 0.25}


def test_the_recipe_for_a_new_kind_gives_a_model_that_is_its_file(quantile, tmp_path):
    rows, y = sample(400)
    rows = rows.assign(e_y=y, i=0)
    found = resolved(QUANTILE)
    model = learners.train(rows, component="e_y", settings=found, seed=42)
    loaded = learners.read(saved(tmp_path / "model.parquet", model))
    np.testing.assert_array_equal(predicted(loaded, rows), predicted(model, rows))
    assert np.mean(y < predicted(loaded, rows)) == 0.25
    assert loaded.to_table()[1] == model.to_table()[1]


def test_the_recipe_for_a_new_kind_makes_its_settings_known(quantile, monkeypatch):
    monkeypatch.chdir(REPOSITORY)  # the sheets' paths are relative to it

    def load(**settings):
        source = paper_source()
        learners_ = source.values["learners"] | {"mine": {"kind": "quantile"} | settings}
        return checks.load_settings(Source(source.values | {"learners": learners_}, source.layers))

    def complaint(**settings):
        with pytest.raises(InputError) as raised:
            load(**settings)
        return str(raised.value).partition("learners.mine.")[2]

    load(**QUANTILE)
    assert complaint(share=2) == "share: expected a number between 0 and 1, got 2"
    assert complaint() == "share: expected a value, got none"
    assert complaint(share=0.5, shares=1) == "shares: unknown key; did you mean share?"


def test_the_recipe_for_a_new_kind_makes_its_words_and_its_table_known(quantile):
    assert learners.description("quantile") == "one quantile of the errors"
    assert learners.schemas()[-1].names == ["value"]
