"""What would run, before anything does: the plan and the names."""

import re
import shutil

import laser_files
import pytest
from element_histories import history, tle_text
from laser_files import RANGING
from project import ROOT, Project, jobs

ONCE = ["earth_orientation", "ephemerides", "gravity_field", "solar_activity"]
CHAIN = ["truths", "tracking", "estimation", "prediction", "dataset"]
LABELLED = ["labels", "labelled_dataset"]
DRAWN_ONCE = [
    *("estimation_window", "orbit", "error_distribution", "partition_curve", "individual", "rso_grid"),
    *("tables", "reproduction"),
]


@pytest.fixture(scope="module")
def papers_plan(tmp_path_factory):
    """What a dry run of the paper tells."""
    return Project(tmp_path_factory.mktemp("paper")).snakemake("-n").stdout


def test_default_target_is_every_figure_and_table(papers_plan):
    plan = jobs(papers_plan)
    assert plan.items() >= dict.fromkeys([*ONCE, *DRAWN_ONCE, "default"], 1).items()
    # ISS, six other RSOs, four inclinations, ten offsets; ISS with one station too, and both with four more
    # noises.
    groups = [rsos.split(", ") for rsos in re.findall("the true orbits of (.+)", papers_plan)]
    assert plan["truths"] == len(groups) == 2
    assert len({rso for group in groups for rso in group}) == 21
    assert "truth" not in plan
    assert plan["tracking"] == plan["estimation"] == plan["prediction"] == 21 + 1 + 8
    assert plan["dataset"] == 30 + 4  # the other reading of t_b, for two transfers too
    assert (plan["svr"], plan["partition"], plan["transfer_curve"]) == (9, 2, 2)


FIGURES = {
    "svr_testing_1station_absolute.pdf": "errors before and after the correction, svr_testing_1station",
    "svr_training_1station_signed.png": "errors before and after the correction, svr_training_1station",
    "future_15days_absolute.pdf": "errors before and after the correction, future_15days",
    "semi_major_axis_50_signed.pdf": "errors before and after the correction, semi_major_axis_50",
    "partition_40.pdf": "errors after training on 40 % of the dataset",
    "individual_distribution.pdf": "individual performance metric p_ML",
    "orbit_3d.pdf": "orbit in 3D with observations, osculating elements",
    "error_distribution_velocity.pdf": "true prediction error against the prediction duration",
}


def test_figures_by_their_names(project):
    told = project.snakemake("-n", *(f"results/figs/{name}" for name in FIGURES)).stdout
    assert sorted(re.findall(r"^Job \d+: Figures?: (.+)$", told, re.MULTILINE)) == sorted(FIGURES.values())
    drawn = ("svr", "partition", "individual", "orbit", "error_distribution")
    assert [jobs(told)[rule] for rule in drawn] == [4, 1, 1, 1, 1]


def test_an_experiment_is_one_line(project):
    (project.folder / "mine.yaml").write_text(
        "study:\n"
        "  extends: [paper]\n"
        "  evaluations: {mine: {train: days-0-30, test: days-30-33, target: lares_i50}}\n"
    )
    plan = project.snakemake("-n", "results/figs/mine_signed.pdf", "--configfile", "mine.yaml").stdout
    assert jobs(plan)["svr"] == 1
    assert "P_ML of e_y for lares_i50, days-30-33 after days-0-30" in plan


def test_another_component_is_one_setting(project):
    plan = project.snakemake("-n", "--config", "study={extends: paper, defaults: {component: e_x}}").stdout
    assert "Train svr on e_x of iss, eglin-clear-kaena, random-40" in plan


def test_plan_speaks_the_papers_words(papers_plan):
    for text in (
        "Truth dynamic model: the true orbits of iss, ",
        "Measurement models: tracks of iss as eglin-clear-kaena measure it",
        "Estimation models: state and drag coefficient of iss",
        "Orbit prediction: each estimate of iss",
        "Dataset: learning variables and true errors of iss",
        "Train svr on e_y of iss, eglin-clear-kaena, random-40",
        "Figure: performance metric P_ML against the size of the training data",
        "Reproduction: the paper's numbers and ours",
    ):
        assert text in papers_plan


def test_trimmed_case_has_the_same_rules(project, papers_plan):
    trimmed = project.snakemake("-n", "--configfile", "config/ci.yaml").stdout
    assert jobs(trimmed).keys() == jobs(papers_plan).keys()


OBSERVED = "environment={solar_activity: OBSERVED, knowledge: forecast}"
PLANNED = [  # products and settings, and what has to run but for the tables of the environment
    (
        ["figs/partition_curve.pdf"],
        dict.fromkeys([*CHAIN, "partition_curve"], 1) | {"train": 9, "evaluate": 9},
    ),
    (["truth/lares_i50_a+0.5.parquet"], {"truth": 1}),
    (["truth/iss.parquet", "study={}"], {"truth": 1}),
    (["dataset/lageos1/clear-kaena.parquet"], dict.fromkeys(CHAIN, 1)),
    # A run that is too short for the default study makes any other product.
    (["dataset/lares/eglin.parquet", "duration_days=27"], dict.fromkeys(CHAIN, 1)),
    (
        ["metrics/iss/eglin/days-0-30/svr/e_vz/iss_i50/days-30-40.parquet"],
        {**dict.fromkeys(CHAIN, 2), "truths": 1, "train": 1, "evaluate": 1},
    ),
    (
        ["metrics/iss/clear_noise7_track/grouped-60_split3/svrnocd/e_x/iss/rest.parquet"],
        {**dict.fromkeys(CHAIN, 1), "train": 1, "evaluate": 1},
    ),
    (
        ["metrics/iss/eglin_later/days-0-30/svr/e_y/iss/days-30-40.parquet"],
        {**dict.fromkeys([*CHAIN, *LABELLED], 1), "train": 1, "evaluate": 1},
    ),
    (
        ["metrics/iss/eglin_w24/days-0-30/svr/e_y/iss_i50/days-30-40-unfenced.parquet"],
        {**dict.fromkeys(CHAIN, 2), "truths": 1, "train": 1, "evaluate": 1},
    ),
    # Outlooks of every three hours for the fit, of every day for the prediction; the truth has neither.
    (
        ["predictions/iss/eglin_w24.parquet", OBSERVED],
        dict.fromkeys(["hindcast", *CHAIN[:-1]], 1) | {"outlooks": 2},
    ),
    (
        ["models/iss/eglin/days-0-20/running/e_y.parquet"],
        dict.fromkeys([*CHAIN, "arcs", "cd_past", "train"], 1) | {"estimation": 2, "prediction": 2},
    ),
]


@pytest.mark.parametrize(("asked", "expected"), PLANNED, ids=[asked[0] for asked, _ in PLANNED])
def test_name_of_a_target_is_enough(project, asked, expected):
    settings = [one for one in asked if "=" in one]
    targets = [f"results/{one}" for one in asked if one not in settings]
    options = ["--config", *settings] if settings else []
    found = jobs(project.snakemake("-n", *targets, *options).stdout)
    assert found == {**dict.fromkeys(ONCE, 1), **expected}


OWN = """
results: results/mine
duration_days: 12
rsos:
  mine:
    {a_km: 6900, e: 0.001, i_deg: 97.5, argp_deg: 0, raan_deg: 120, mean_anomaly_deg: 0,
     area_to_mass_m2pkg: 0.02, cd: 2.2, cr: 1.25}
study:
  rsos: [mine]
  station_sets: [eglin-kaena]
  days: {train: [0, 8], test: [8, 12]}
"""


def test_a_study_of_ones_own_names_all_its_products(project):
    (project.folder / "mine.yaml").write_text(OWN)
    plan = project.snakemake("-n", "study", "--configfile", "mine.yaml").stdout
    for name in ("study.md", "study.html", "figs/study/mine/models.pdf"):
        assert f"results/mine/{name}" in plan
    once = dict.fromkeys(["truth", "dataset", "study_report", "study_models"], 1)
    # Estimates have the windows of fit24, fit48 and fit96 beside the study's own.
    assert jobs(plan).items() >= (once | {"estimation": 4}).items()
    assert jobs(plan).keys() & {"svr", "partition", "reproduction"} == set()


def test_a_study_of_ones_own_is_what_a_plain_run_makes(project):
    (project.folder / "mine.yaml").write_text(OWN)
    plain = jobs(project.snakemake("-n", "--configfile", "mine.yaml").stdout)
    named = jobs(project.snakemake("-n", "study", "--configfile", "mine.yaml").stdout)
    assert plain.pop("default") == named.pop("study") == 1
    assert plain == named


TRACKED = """
tracks: {mine: orekit.tdm}
rsos: {mine: {area_to_mass_m2pkg: 0.05, cd: 2.2, cr: 1.25}}
"""


def test_tracks_that_were_measured_need_no_truth(project):
    (project.folder / "mine.yaml").write_text(TRACKED)
    shutil.copy(ROOT / "tests" / "reference" / "orekit.tdm", project.folder)
    where = "mine/eglin-clear-kaena"
    targets = [f"results/{kind}/{where}.parquet" for kind in ("predictions", "mechanism", "dataset")]
    targets += [f"results/arcs/{where}_l48.parquet"]
    plan = jobs(project.snakemake("-n", *targets, "--configfile", "mine.yaml").stdout)
    assert plan == {
        **dict.fromkeys(ONCE, 1),
        **dict.fromkeys(["tracking_from_tdm", "first_orbit", "arcs", "dataset", "mechanism"], 1),
        **dict.fromkeys(["estimation", "prediction"], 3),  # the windows of 24 and 48 hours, too
        "sensitivities": 2,
    }
    # A truth is not simulated in its place: what needs one is refused.
    done = project.snakemake("-n", "results/truth/mine.parquet", "--configfile", "mine.yaml", check=False)
    assert "opml: truth of 'mine': expected an RSO without own measurements" in done.stdout


def test_fixes_need_no_truth_and_no_station(project):
    (project.folder / "mine.yaml").write_text(
        TRACKED.replace("tracks: {mine: orekit.tdm}", "fixes: {mine: a.csv}")
    )
    points = ("2016-09-28T12:10:00,7000,0,0", "2016-09-28T12:11:00,6985,450,0")
    (project.folder / "a.csv").write_text("\n".join(["utc,x_gcrf_km,y_gcrf_km,z_gcrf_km", *points]))
    targets = [f"results/{kind}/mine/fixes.parquet" for kind in ("mechanism", "dataset")]
    plan = jobs(project.snakemake("-n", *targets, "--configfile", "mine.yaml").stdout)
    assert plan == {
        **dict.fromkeys(ONCE, 1),
        **dict.fromkeys(["fixes_from_files", "first_orbit", "dataset", "mechanism"], 1),
        **dict.fromkeys(["estimation", "prediction", "sensitivities"], 2),  # the window of 24 hours, too
    }


def test_laser_ranges_need_no_truth_and_bring_their_stations(project):
    laser_files.write(project.folder)
    ranges = f"ranges: {{mine: lageos.crd}}\nranging: {{mine: {RANGING}}}\nstarts: {{mine: mine.tle}}"
    (project.folder / "mine.yaml").write_text(TRACKED.replace("tracks: {mine: orekit.tdm}", ranges))
    (project.folder / "mine.tle").write_text(tle_text(history([1.0])))
    targets = ["dataset/mine/ranges.parquet", "models/mine/ranges_later/days-0-20/fit48/e_y.parquet"]
    names = [f"results/{target}" for target in targets]
    plan = jobs(project.snakemake("-n", *names, "--configfile", "mine.yaml").stdout)
    once = ("ranges_from_files", "first_orbit", "labels", "dataset", "train")
    assert plan.items() >= dict.fromkeys(once, 1).items()
    assert not {"truth", "tracking"} & set(plan)


def test_a_new_station_needs_one_line(project):
    with (project.folder / "config" / "stations.tsv").open("a") as sheet:
        sheet.write("shemya\t52.72\t174.1\t80\t5000\t1\t90\t50\t0.02\t0.02\n")
    plan = project.snakemake("-n", "results/tracking/iss/kaena-shemya.parquet").stdout
    assert jobs(plan)["tracking"] == 1
