"""What rules are made of: products, the plan of a run, and params and inputs by a file's name."""

import os
import re
import time
from types import SimpleNamespace

import pytest
from laser_files import RANGING
from snakemake.io import IOFile, flag
from support import paper_values, refusals

from opml import tables
from opml.base.errors import InputError
from opml.catalog import kinds
from opml.learning.data.dataset import MEASUREMENT
from opml.naming import Experiment
from opml.study.settings.merging import with_sheets
from opml.study.settings.model.whole import RunSettings
from opml.workflow.before_first_job import date_back_to_now, lift_job_rate
from opml.workflow.environment_files import EnvironmentFiles
from opml.workflow.inputs import Inputs, at_window, checks, path_of, paths_of, tables_of, target
from opml.workflow.params import Params
from opml.workflow.plan import Plan
from opml.workflow.product_paths import Product

BODY = {"area_to_mass_m2pkg": 0.05, "cd": 2.2, "cr": 1.25}
STUDY = {
    "rsos": ["lares"],
    "station_sets": ["eglin"],
    "days": {"train": [0, 9], "test": [9, 12]},
    "label": "later",
    "learners": ["none", "fit96", "running", "svr"],
}
USERS = {
    "orbits": {"flown": "flown.sp3", "judged": "judged.sp3"},
    "tracks": {"mine": "mine.tdm", "judged": "judged.tdm"},
    "fixes": {"placed": "gps.csv"},
    "ranges": {"lasered": "a.crd"},
}
ESTIMATES = "estimates/{rso}/{stations}{window}.parquet"
DATASET = "dataset/{rso}/{stations}{window}{reading}.parquet"


class Wildcards(SimpleNamespace):
    """The parts of a file's name, as Snakemake hands them over."""

    def items(self):
        return vars(self).items()


class Pattern(str):
    """The output of a rule."""

    def apply_wildcards(self, wildcards):
        return self.format(**wildcards)


def wildcards(**parts):
    """Wildcards of the ISS seen by Eglin, with other `parts`."""
    plain = {"rso": "iss", "stations": "eglin", "window": "", "reading": "", "label": ""}
    return Wildcards(**plain | parts)


def experiment(**parts):
    """Wildcards of a test on later days, with other `parts`."""
    test = {"train": "days-0-30", "learner": "svr", "component": "e_y", "target": "iss", "test": "days-30-40"}
    return wildcards(**test | parts)


def plan(**changes):
    """The plan of the paper's settings; `changes` replace a setting, or are laid over a mapping of them."""
    values = paper_values()
    for name, change in changes.items():
        values[name] = values.get(name, {}) | change if isinstance(change, dict) else change
    return Plan(with_sheets(values))


def params(**changes):
    return Params(plan(**changes))


def inputs(**changes):
    return Inputs(plan(**changes), params(**changes))


def user_inputs():
    """Inputs of a run where `flown` has an orbit from a file, `mine` measured tracks and `placed` fixes."""
    return inputs(
        rsos=dict.fromkeys(["flown", "mine", "placed", "lasered", "judged"], BODY),
        study={"rsos": ["mine"]},
        ranging={"lasered": RANGING},
        **USERS,
    )


def test_a_product_says_all_its_paths():
    product = Product("results/mine", "estimates/{rso}/{stations}")
    assert product.table == "results/mine/estimates/{rso}/{stations}.parquet"
    assert product.folder == "results/mine/estimates/{rso}/{stations}"
    assert product.file("oem") == "results/mine/estimates/{rso}/{stations}.oem"
    assert product.log == "results/mine/logs/estimates/{rso}/{stations}.log"
    assert product.benchmark == "results/mine/benchmarks/estimates/{rso}/{stations}.tsv"
    assert (product.title, Product("results", "study").title) == ("{stations}", "study")


@pytest.mark.parametrize(
    ("together", "shares"),
    [
        (32, [7]),
        (3, [2, 2, 3]),
        (1, [1] * 7),
        (None, [7]),
        (None, [16, 17]),
        (None, [32] * 4),
        (None, [64] * 5),
    ],
)
def test_objects_of_a_day_are_shared_out_evenly(together, shares):
    """Few objects are one job, some as many as a machine may have cores, and many few large ones."""
    names = [f"sat{k}" for k in range(sum(shares))]
    bodies, tracks = dict.fromkeys(names, BODY), {name: f"{name}.tdm" for name in names}
    jobs = plan(rsos=bodies, tracks=tracks, day={"together": together} if together else {}).watched
    assert [len(objects) for objects in jobs.values()] == shares
    assert [name for objects in jobs.values() for name in objects] == names
    assert plan(rsos=bodies, tracks=tracks).watched == {}


# ---- the tables of the environment


def environment(sources=(), **settings):
    """The tables' files of a run whose environment has other `sources`."""
    values = paper_values() | settings
    return EnvironmentFiles(RunSettings(**values | {"environment": values["environment"] | dict(sources)}))


def table(name):
    return f"results/environment/{name}.parquet"


def test_all_steps_share_the_tables_of_one_environment():
    files = environment()
    everything = {name: table(name) for name in tables.ENVIRONMENT}
    assert files.truth == files.fits == files.predictions == everything
    assert not files.is_forecast


def test_a_hindcast_is_for_all_but_the_truth():
    files = environment({"knowledge": "hindcast"})
    assert files.fits["solar_activity"] == files.predictions["solar_activity"] == table("hindcast")
    assert files.truth["solar_activity"] == table("solar_activity")


def test_fits_have_an_outlook_every_three_hours_and_predictions_one_of_the_run():
    files = environment({"knowledge": "forecast", "issue_hours": 24})
    assert files.is_forecast
    assert files.fits["outlooks"] == table("outlooks_3h")
    assert files.predictions["outlooks"] == table("outlooks_24h")
    assert "outlooks" not in files.truth


def test_the_truth_may_have_another_activity():
    files = environment({"true_solar_activity": "OBSERVED"})
    assert files.true_activity == "true_solar_activity"
    assert files.truth["solar_activity"] == table("true_solar_activity")
    assert files.predictions["solar_activity"] == table("solar_activity")


@pytest.mark.parametrize(("source", "paths"), [("EGM2008", []), ("own/field.gfc", ["own/field.gfc"])])
def test_only_a_path_is_a_file_of_the_users(source, paths):
    assert environment({"gravity_field": source}).source_files("gravity_field") == paths


# ---- the plan


@pytest.mark.parametrize(
    ("wildcard", "right", "wrong"),
    [
        ("rso", ["iss", "iss_i50_a+50"], ["mir", "iss_i050", "inclinations-without-iss", "*", "../../evil"]),
        ("stations", ["eglin", "kaena-eglin", "eglin_noise43"], ["oz", "eglin_noise42", "eglin_noise1.5"]),
        ("window", ["", "_w24"], ["_w12", "_w0", "_b12", "_light"]),
        ("arc", ["_l48"], ["", "_l48_m30"]),
        ("memory", ["_m30"], ["", "_l48"]),
        ("reading", ["", "_track"], ["_kept"]),
        ("label", ["", "_later"], ["_early"]),
        ("train", ["random-80", "days-0-30_split43"], ["random-80_split42", "rest", "random--5"]),
        ("test", ["rest", "days-30-40-unseen"], ["random-80", "rest-zscore"]),
        ("learner", ["svr", "mechanism"], ["svr_s2", "forest"]),
        ("component", ["e_y", "e_vz"], ["e_w"]),
        ("evaluation", ["svr_testing_1station"], ["mine"]),
        ("ratio", ["40"], ["040", "100"]),
    ],
)
def test_constraints_let_canonical_names_pass(wildcard, right, wrong):
    pattern = plan().constraints[wildcard]
    assert [name for name in right if not re.fullmatch(pattern, name)] == []
    assert [name for name in wrong if re.fullmatch(pattern, name)] == []


def test_a_study_without_curves_and_grids_has_no_names_of_them():
    constraints = plan(study={"rsos": ["iss"]}).constraints
    empty = plan(study=None).constraints
    for wildcard in ("evaluation", "grid", "curve"):
        assert not re.fullmatch(empty[wildcard], "inclination")
        assert empty.keys() == constraints.keys()


def test_the_weather_is_a_line_of_a_figure():
    line = plan(environment={"knowledge": "forecast"}).weather
    assert "forecast every" in line
    assert not line.endswith(".")


def test_truths_of_a_study_fly_in_groups(tmp_path):
    groups = plan(results=str(tmp_path)).truth_groups
    assert groups[0][0] == "iss"
    assert sum(map(len, groups)) == 21


# ---- params


def test_an_rso_is_varied_as_its_name_says():
    base, varied = (params().rso(wildcards(rso=name)) for name in ("iss", "iss_a+50"))
    assert varied == base | {"name": "iss_a+50", "a": base["a"] + 50e3}


@pytest.mark.parametrize(("stations", "seed"), [("eglin-kaena", 42), ("eglin-kaena_noise7", 7)])
def test_stations_and_their_noise(stations, seed):
    names = [station["name"] for station in params().stations(wildcards(stations=stations))]
    assert names == ["eglin", "kaena"]
    assert params().noise_seed(wildcards(stations=stations)) == seed


def test_stations_in_another_order_are_refused():
    with pytest.raises(InputError, match="expected 'eglin-kaena'"):
        params().stations(wildcards(stations="kaena-eglin"))


def test_the_suffix_of_estimates_changes_the_fit():
    jobs = params()
    plain = jobs.plan.values["estimation"] | {"cd_bounds": list(jobs.plan.study.cleaning.cd_bounds)}
    assert jobs.estimation(wildcards()) == plain
    assert jobs.estimation(wildcards(window="_w24")) == plain | {"window_hours": 24.0}


def test_a_study_without_bounds_on_cd_has_none():
    assert params(study=None).cd_bounds is None


def test_an_arc_has_a_window_and_a_memory():
    name = wildcards(arc="_l48", memory="_m30")
    assert params().arc(name) == {"window_hours": 48.0}
    assert params().arc_with_past(name) == {"window_hours": 48.0, "memory_days": 30.0}


def test_the_reading_of_t_b_is_the_studys_or_that_of_the_name():
    jobs = params()
    read = [jobs.cleaning(wildcards(reading=suffix)) for suffix in ("", "_track")]
    assert [cleaning["previous"] for cleaning in read] == ["kept_estimate", "track"]
    assert read[0] | {"previous": "track"} == read[1]


def test_a_learner_of_no_component_corrects_along_the_path():
    jobs = params()
    of_path = jobs.learner(experiment(learner="covariance", component="e_y"))
    assert jobs.learner(wildcards(learner="covariance")) == of_path
    assert jobs.learner(experiment(learner="covariance", component="e_x")) != of_path


def test_a_split_has_a_seed():
    assert params().split(wildcards(train="random-80")) == {"train": "random-80", "seed": 42}
    assert params().split(wildcards(train="random-80_split3")) == {"train": "random-80", "seed": 3}


@pytest.mark.parametrize(("read", "name", "message"), refusals("names_in_rules"))
def test_names_that_are_impossible_are_refused(read, name, message):
    with pytest.raises(InputError, match=message):
        getattr(params(), read)(experiment(**name))


def test_an_experiment_is_told_in_the_columns_of_its_metrics():
    columns = params().experiment(experiment(window="_w24", reading="_track", label="_later"))
    assert columns["stations"] == "eglin_w24_track_later"
    assert columns.keys() == {"rso", "stations", "train", "learner", "component", "target", "test"}


def test_what_was_measured_has_no_truth():
    jobs = user_inputs().params
    jobs.check_simulated(wildcards(rso="flown"))
    jobs.check_simulated(wildcards(rso="judged"))
    with pytest.raises(InputError, match="truth of 'mine': expected an RSO without own measurements"):
        jobs.check_simulated(wildcards(rso="mine"))


def test_fixes_have_no_stations_and_learners_none_of_what_these_measure():
    jobs, name = user_inputs().params, experiment(rso="placed", stations="fixes")
    assert re.fullmatch(jobs.plan.constraints["stations"], "fixes")
    assert jobs.stations(name) == []
    assert jobs.options(name) == {"sigma_m": (10.0, 10.0, 10.0), "every_s": 60.0, "stretch_hours": 1.0}
    by_radars = jobs.learner(experiment())["variables"]
    assert jobs.learner(name)["variables"] == [one for one in by_radars if one not in MEASUREMENT]
    assert set(MEASUREMENT) < set(by_radars)


def test_laser_ranges_bring_their_stations_and_learners_have_none_of_what_radars_measure():
    jobs, name = user_inputs().params, experiment(rso="lasered", stations="ranges")
    assert re.fullmatch(jobs.plan.constraints["stations"], "ranges")
    assert jobs.stations(name) == []
    assert jobs.options(name) == {"reflectors_m": 0.25, "sigma_m": 0.02, "without": []}
    assert not set(MEASUREMENT) & set(jobs.learner(name)["variables"])
    settings = jobs.plan.settings
    assert settings.files_of(kinds.RANGES)["lasered"] == ["a.crd"]
    assert settings.companion_files(kinds.RANGES)["lasered"] == ["coordinates.snx", "eccentricities.snx"]


def test_learners_have_nothing_of_radars_beside_telescopes():
    row = {"latitude_deg": 20, "longitude_deg": 0, "altitude_m": 0, "max_range_km": 50000}
    row |= {"min_elevation_deg": 10, "max_elevation_deg": 90, "sigma_declination_deg": 1e-4}
    jobs = inputs(stations={"tenerife": row}).params
    by_radars, both = (experiment(stations=stations) for stations in ("eglin_noise3", "eglin-tenerife"))
    assert set(MEASUREMENT) < set(jobs.learner(by_radars)["variables"])
    assert not set(MEASUREMENT) & set(jobs.learner(both)["variables"])
    radar, telescope = jobs.stations(both)
    assert "sigma_declination" not in radar
    assert telescope["sigma_declination"] == pytest.approx(1.745329e-6)
    assert "sigma_range" not in telescope


def test_a_figure_of_errors_has_the_parts_of_its_experiment():
    one = Experiment(**dict(experiment().items()))
    errors = params().errors(one, published=30.0)
    assert (errors["experiment"], errors["published"]) == (one.names(), 30.0)


# ---- inputs


def test_a_path_keeps_the_flags_of_its_pattern():
    pattern = IOFile(flag("truth/{rso}.parquet", "local"), rule=None)
    path = path_of(pattern, rso="iss")
    assert path == "truth/iss.parquet"
    assert path.flags["local"]


def test_each_experiment_is_read_once():
    one, other = (Experiment(**dict(experiment(target=rso).items())) for rso in ("iss", "lares"))
    pattern = Pattern("metrics/{rso}/{target}.parquet")
    assert paths_of(pattern, one, other, one) == ["metrics/iss/iss.parquet", "metrics/iss/lares.parquet"]
    assert tables_of({"metrics": pattern}, other) == {"metrics": ["metrics/iss/lares.parquet"]}


def test_another_window():
    assert (
        at_window("_w48", Pattern(ESTIMATES))(wildcards(window="_w24")) == "estimates/iss/eglin_w48.parquet"
    )


def test_a_target_without_files_ends_the_plan():
    assert target(["study.md"], "days")(wildcards()) == ["study.md"]
    with pytest.raises(SystemExit, match="opml: study: expected days to train and to test on, got none"):
        target([], "days")(wildcards())


def test_a_wrong_name_ends_the_plan_in_one_line():
    check = checks(params().stations, params().rso)
    assert check(wildcards()) == []
    with pytest.raises(SystemExit, match=r"^opml: stations 'kaena-eglin': expected"):
        check(wildcards(stations="kaena-eglin"))


TRUTH, TRACKING = Pattern("truth/{rso}.parquet"), Pattern("tracking/{rso}/{stations}.parquet")


@pytest.mark.parametrize(
    ("rso", "truth", "truth_or"),
    [
        ("iss", "truth/iss.parquet", "truth/iss.parquet"),
        ("flown", "truth/flown.parquet", "truth/flown.parquet"),
        ("mine", [], "tracking/mine/eglin.parquet"),
        ("placed", [], "tracking/placed/eglin.parquet"),
        ("judged", "truth/judged.parquet", "tracking/judged/eglin.parquet"),
    ],
)
def test_measured_tracks_and_fixes_stand_for_the_truth(rso, truth, truth_or):
    files, name = user_inputs(), wildcards(rso=rso)
    assert files.truth(TRUTH)(name) == truth
    assert files.truth_or(TRUTH, TRACKING)(name) == truth_or


def test_the_activity_of_a_measured_rso_is_the_assumed_one():
    files = user_inputs()
    files.plan.values["environment"] |= {"true_solar_activity": "OBSERVED"}
    assert files.activity(wildcards(rso="mine")) == table("solar_activity")
    assert files.activity(wildcards(rso="iss")) == table("true_solar_activity")


def test_labels_read_later_estimates():
    find = inputs().later_estimates(Pattern(ESTIMATES))
    assert find(wildcards(label="_later")) == "estimates/iss/eglin.parquet"
    assert find(wildcards()) == []


def test_what_was_measured_is_judged_by_an_orbit_beside_it():
    find = user_inputs().true_errors(Pattern(DATASET))
    judged, mine = (experiment(label="_later", rso=rso, target=rso) for rso in ("judged", "mine"))
    assert find(judged) == "dataset/judged/eglin.parquet"
    assert find(mine) == []


@pytest.mark.parametrize(
    ("given", "table"),
    [
        ({"fixes": {"mine": "a.oem"}}, "tracking/mine/fixes"),
        ({"orbits": {"mine": "a.oem"}}, "truth/mine"),
        ({"tracks": {"mine": "a.tdm"}}, "tracking/mine/eglin"),
        ({"tracks": {"mine": "a.tdm"}, "starts": {"mine": "a.tle"}}, "starts/mine/eglin tracking/mine/eglin"),
    ],
    ids=["fixes", "orbits", "tracks", "starts"],
)
def test_what_was_read_tells_the_object_of_what_is_written(given, table):
    files = inputs(rsos={"mine": BODY}, **given)
    assert files.source(experiment(rso="mine")) == [f"results/{one}.parquet" for one in table.split()]
    assert files.source(experiment()) == []


def test_labels_are_judged_by_the_truth_of_the_rso_under_test():
    find = inputs().true_errors(Pattern(DATASET))
    assert find(wildcards(label="_later")) == "dataset/iss/eglin.parquet"
    assert find(experiment(label="_later", target="lares")) == "dataset/lares/eglin.parquet"
    assert find(experiment(target="lares")) == []


@pytest.mark.parametrize(
    ("learner", "files"),
    [
        ("svr", []),
        ("mechanism", ["mechanism/lares/eglin_w24"]),
        ("twoarcs", ["arcs/lares/eglin_w24_l48", "mechanism/lares/eglin_w24"]),
        ("fit48", ["arcs/lares/eglin_w24_l48"]),
        ("running", ["arcs/lares/eglin_w24_l48", "cd_past/lares/eglin_w24_l48_m30"]),
    ],
)
def test_a_learner_reads_the_tables_of_its_variables(learner, files):
    name = experiment(learner=learner, target="lares", window="_w24")
    assert inputs().learner_tables("target")(name) == [f"results/{file}.parquet" for file in files]


def test_arcs_are_made_of_estimates_over_their_window():
    find = inputs().at_arc(Pattern(ESTIMATES))
    assert find(wildcards(arc="_l48")) == "estimates/iss/eglin_w48.parquet"
    assert find(wildcards(arc="_l12")) == "estimates/iss/eglin.parquet"


# ---- before the first job


def test_tables_from_the_future_get_the_present_time(tmp_path):
    paths = [tmp_path / name for name in ("late.parquet", "early.parquet", "late.log")]
    now = time.time()
    for path, seconds in zip(paths, (now + 1e4, now - 1e4, now + 1e4), strict=True):
        path.touch()
        os.utime(path, (seconds, seconds))
    date_back_to_now(tmp_path)
    late, early, log = (path.stat().st_mtime - now for path in paths)
    assert 0.0 <= late < 100.0
    assert (early, log) == pytest.approx((-1e4, 1e4))


@pytest.mark.parametrize(("queue", "limit"), [(True, 100), (False, None)])
def test_jobs_that_run_here_have_no_limit(queue, limit):
    workflow = SimpleNamespace(non_local_exec=queue, scheduler=SimpleNamespace(job_rate_limiter=100))
    lift_job_rate(workflow)
    assert workflow.scheduler.job_rate_limiter == limit


OF_TRACKS = ["fit48", "fit96", "running24m3", "running24", "running", "running96"]


@pytest.mark.parametrize(
    ("files", "expected"),
    [
        ({"elements": {"mine": "sets.tle"}}, []),
        ({"tracks": {"mine": "mine.tdm"}}, OF_TRACKS),
        ({"tracks": {"mine": "mine.tdm"}, "elements": {"other": "sets.tle"}}, OF_TRACKS),
        ({"elements": {"mine": "sets.tle"}, "day": {"models": ["fit48"]}}, ["fit48"]),
    ],
    ids=["sets", "tracks", "both", "named"],
)
def test_mornings_choose_from_models_that_suit_what_was_measured(files, expected):
    objects = {name: BODY for kind in ("tracks", "elements") for name in files.get(kind, ())}
    told = params(**{"day": {"hour": 6}, "rsos": objects} | files)
    assert list(told.mornings_of(wildcards(batch="0", date="2016-10-05"))["models"]) == expected
