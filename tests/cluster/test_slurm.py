"""The trimmed case and mornings through a real SLURM: the bytes of one machine. A quarter of an hour.

python -m pytest tests/cluster
"""

import importlib.util
import os
import shutil
import subprocess
import sys

import pytest
from project import ROOT, command

from tests.cluster.slurm import Slurm, missing

PLUGIN = "snakemake_executor_plugin_slurm"


pytestmark = [
    pytest.mark.dag,
    pytest.mark.skipif(bool(missing()), reason=f"SLURM is not installed: no {', '.join(missing())}"),
    pytest.mark.skipif(importlib.util.find_spec(PLUGIN) is None, reason=f"{PLUGIN} is not installed"),
]


def products(folder, line, environment):
    """Run a command in a folder; the bytes of its products, but for what holds times."""
    done = subprocess.run(
        line,
        cwd=folder,
        env=environment,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        timeout=3600,
    )
    assert done.returncode == 0, done.stdout
    results = folder / "results"
    return {
        str(path.relative_to(results)): path.read_bytes()
        for path in sorted(results.rglob("*"))
        if path.is_file() and not {"logs", "benchmarks"} & set(path.parts)
    }


def test_a_cluster_gives_the_bytes_of_one_machine(tmp_path):
    def run(name, environment, *options):
        shutil.copytree(ROOT / "config", tmp_path / name / "config")
        line = command(*options, "--configfile=config/ci.yaml")
        return products(tmp_path / name, line, environment)

    (tmp_path / "slurm").mkdir()
    alone = run("alone", os.environ, "-j2")
    with Slurm(tmp_path / "slurm") as slurm:
        options = ["--profile", ROOT / "profiles" / "slurm", "--slurm-status-command", "squeue"]
        spread = run("cluster", slurm.environment, *options)
    assert spread.keys() == alone.keys()
    assert [name for name in alone if spread[name] != alone[name]] == []


def test_mornings_on_two_workers_leave_the_bytes_of_one(tmp_path):
    def run(name, environment, *options):
        folder = tmp_path / name
        folder.mkdir()
        for entry in ("Snakefile", "workflow", "config"):
            (folder / entry).symlink_to(ROOT / entry)
        shutil.copytree(ROOT / "profiles", folder / "profiles")
        # A SLURM without accounts is asked by another command.
        with (folder / "profiles" / "slurm" / "config.yaml").open("a") as profile:
            profile.write("slurm-status-command: squeue\n")
        shutil.copy(ROOT / "tests" / "faults" / "days.yaml", folder / "mine.yaml")
        shutil.copy(ROOT / "tests" / "reference" / "orekit.tdm", folder / "mine.tdm")
        line = [sys.executable, "-m", "opml", "day", "--date", "2016-10-01", "--configfile", "mine.yaml"]
        return products(folder, [*line, *options], environment)

    (tmp_path / "slurm").mkdir()
    alone = run("alone", os.environ, "-j1")
    with Slurm(tmp_path / "slurm") as slurm:
        spread = run("cluster", slurm.environment, "--profile", "profiles/slurm")
    assert spread == alone
