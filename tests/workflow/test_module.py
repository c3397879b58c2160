"""The workflow for those who do not clone it: a module of another project, or read by a plain Snakemake."""

import os
import shlex
import sys

import pytest
from project import ROOT, forked, jobs, started

AROUND = f"""
configfile: "orbits.yaml"

module opml:
    snakefile: "{ROOT}/workflow/Snakefile"
    config: config["orbits"]

use rule * from opml as opml_*

rule around:
    default_target: True
    input: rules.opml_study.input
    run: assert config["around"] == "kept"
"""
HANDED = """
around: kept
orbits:
  results: orbits
  study:
    rsos: [iss]
    station_sets: [eglin]
    days: {train: [0, 8], test: [8, 12]}
"""


@pytest.fixture
def around(tmp_path):
    """Start Snakemake in a project that holds two files, neither of them of this workflow."""
    (tmp_path / "Snakefile").write_text(AROUND)
    (tmp_path / "orbits.yaml").write_text(HANDED)

    def start(*arguments, by=forked, path=ROOT / "src", **environment):
        env = os.environ | {"PYTHONPATH": str(path), "NO_COLOR": "1"} | environment
        return by(["--cores", "1", *arguments], cwd=tmp_path, env=env)

    return start


def test_an_empty_project_uses_it_as_a_module(around):
    code, output = around("-n")
    assert code == 0, output
    plan = jobs(output)
    assert plan["around"] == plan["opml_truth"] == plan["opml_study_report"] == 1
    assert "orbits/study.md" in output
    assert "results/" not in output


def test_a_plan_does_not_wait_for_the_compiled_kernels(around, tmp_path):
    with (tmp_path / "Snakefile").open("a") as file:
        file.write('import sys\nassert "numba" not in sys.modules\n')
    code, output = around("-n", by=started)  # a forked process has them
    assert code == 0, output


def test_a_job_of_the_module_runs(around, tmp_path):
    code, output = around("orbits/environment/gravity_field.parquet")
    assert code == 0, output
    assert (tmp_path / "orbits" / "environment" / "gravity_field.parquet").is_file()


def test_what_is_handed_over_is_checked(around, tmp_path):
    (tmp_path / "orbits.yaml").write_text(HANDED.replace("results", "result"))
    code, output = around("-n")
    assert code != 0
    assert "opml: config: result: unknown key; did you mean results?" in output
    assert "Traceback" not in output


INSTALL = "opml: expected the package with Snakemake, got none: pip install 'opml-orbits[workflow]'"


@pytest.fixture
def absent(tmp_path):
    """A folder on whose path there is no package."""
    folder = tmp_path / "absent"
    folder.mkdir()
    (folder / "opml.py").write_text("raise ModuleNotFoundError\n")
    return folder


def test_a_plain_snakemake_reads_it_and_tells_how_to_install(around, absent):
    plain = ["--snakefile", ROOT / "workflow" / "Snakefile"]
    code, output = around(*map(str, plain), by=started, path=absent)
    assert code != 0
    assert output.startswith(INSTALL)
    assert output.count(f"\n{INSTALL}") == 1  # from the job, which found no other environment
    assert "Traceback" not in output


def test_it_starts_again_where_the_package_is(around, absent, tmp_path):
    """A `python` on the path that has the package stands for the environment that conda would make."""
    python = tmp_path / "bin" / "python"
    python.parent.mkdir()
    package, program = shlex.quote(str(ROOT / "src")), shlex.quote(sys.executable)
    python.write_text(f'#!/bin/sh\nPYTHONPATH={package} exec {program} "$@"\n')
    python.chmod(0o755)
    (tmp_path / "Snakefile").write_text(AROUND.partition("rule around")[0].replace(" as opml_*", ""))
    where = f"{python.parent}:{os.environ['PATH']}"
    code, output = around("--config", "orbits={result: mine}", by=started, path=absent, PATH=where)
    assert code != 0
    assert "opml: config: result: unknown key; did you mean results?" in output
