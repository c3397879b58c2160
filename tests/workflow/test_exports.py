"""Messages out of a run, and one into the next."""

import shutil

import pytest
from project import ROOT

from opml.tables import read_table

TRIMMED = "--configfile=config/ci.yaml"


@pytest.mark.parametrize(
    ("target", "rule"),
    [("truth/iss_a+50.oem", "export_truth"), ("tracking/iss/eglin-kaena.tdm", "export_tracking")],
)
def test_a_message_is_named_as_its_table(project, target, rule):
    assert f"\n{rule} " in project.snakemake("-n", f"results/exports/{target}").stdout


@pytest.mark.dag
def test_an_exported_truth_stands_in_for_the_simulated_one(project):
    truth, message = "results/ci/truth/iss.parquet", "results/ci/exports/truth/iss.oem"
    project.snakemake("-j1", TRIMMED, message)
    simulated = read_table(project.folder / truth, "truth")
    told = (project.folder / message).read_text().replace("OBJECT_ID = iss", "OBJECT_ID = 1998-067A")
    (project.folder / "iss.oem").write_text(told)
    (project.folder / message).unlink()
    (project.folder / truth).unlink()

    # Beside it tracks that were measured, of an RSO without any truth.
    tracked = "results/ci/predictions/mine/eglin-clear-kaena.parquet"
    shutil.copy(ROOT / "tests" / "reference" / "orekit.tdm", project.folder)
    body = "{mine: {area_to_mass_m2pkg: 0.05, cd: 2.2, cr: 1.25}}"
    settings = ["orbits={iss: iss.oem}", "tracks={mine: orekit.tdm}", f"rsos={body}"]
    done = project.snakemake("-j1", TRIMMED, truth, message, tracked, "--config", *settings)
    assert "Truth: the orbit of iss from iss.oem" in done.stdout
    assert "Truth dynamic model" not in done.stdout
    assert read_table(project.folder / truth, "truth").equals(simulated)
    assert (project.folder / message).read_text() == told

    predictions = read_table(project.folder / tracked, "predictions")
    assert (predictions["reason"] == "").mean() > 0.9
    assert predictions["e_y"].isna().all()
    assert not (project.folder / "results" / "ci" / "truth" / "mine.parquet").exists()


@pytest.mark.dag
def test_an_unfit_message_is_told_in_one_line(project):
    (project.folder / "iss.oem").write_text("CCSDS_OEM_VERS = 2.0\nORIGINATOR\n")
    truth = "results/ci/truth/iss.parquet"
    done = project.snakemake("-j1", TRIMMED, truth, "--config", "orbits={iss: iss.oem}", check=False)
    assert done.returncode != 0
    assert "opml: --config: orbits.iss: iss.oem: line 2: expected KEY = value, got ORIGINATOR" in done.stdout
    assert "Traceback" not in done.stdout
    assert not (project.folder / "results" / "ci" / "truth" / "iss.parquet").exists()


@pytest.mark.dag
def test_unfit_tracks_are_told_in_one_line(project):
    whole = (ROOT / "tests" / "reference" / "orekit.tdm").read_text()
    (project.folder / "cut.tdm").write_text(whole[: len(whole) // 2])
    body = "{mine: {area_to_mass_m2pkg: 0.05, cd: 2.2, cr: 1.25}}"
    target = "results/ci/tracking/mine/eglin.parquet"
    settings = ["tracks={mine: cut.tdm}", f"rsos={body}"]
    done = project.snakemake("-j1", TRIMMED, target, "--config", *settings, check=False)
    assert done.returncode != 0
    assert "opml: --config: tracks.mine: cut.tdm: line " in done.stdout
    assert "Traceback" not in done.stdout
    assert not (project.folder / "results").exists()
