"""Settings of jobs: what a rule gives is what its script declares, before any job starts."""

import json
import os
import shutil

import pytest
from project import ROOT, forked

ISS = "iss/eglin-clear-kaena"
FORECAST = "environment={knowledge: forecast, solar_activity: OBSERVED}"
STUDY = "study={rsos: [iss], days: {train: [0, 30], test: [30, 40]}}"
PLANS = {
    "the paper's": ["default", "study", "--configfile", "config/ci.yaml"],
    "a study's": ["study", "--config", FORECAST, STUDY],
    "messages": [f"results/exports/{path}" for path in ("truth/iss.oem", f"tracking/{ISS}.tdm")],
}


@pytest.mark.parametrize("arguments", PLANS.values(), ids=PLANS)
def test_each_job_is_given_what_its_script_declares(tmp_path, arguments):
    shutil.copytree(ROOT / "config", tmp_path / "config")
    command = ["-n", "--snakefile", str(ROOT / "Snakefile"), *arguments]
    code, output = forked(command, cwd=tmp_path, env=dict(os.environ), program="planned_settings")
    assert code == 0, output
    refused = json.loads(next(line for line in output.splitlines() if line.startswith('{"')))
    assert len(refused) > 4
    assert {name: why for name, why in refused.items() if why} == {}
