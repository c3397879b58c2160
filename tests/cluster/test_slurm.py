"""The trimmed case through a real SLURM: the same bytes as on the machine alone. A quarter of an hour.

python -m pytest tests/cluster
"""

import importlib.util
import os
import shutil
import subprocess

import pytest
from project import ROOT, command

from tests.cluster.slurm import Slurm, missing

PLUGIN = "snakemake_executor_plugin_slurm"


def run(folder, environment, *options):
    """Run the trimmed case in a folder; the bytes of its products, but for what holds times."""
    shutil.copytree(ROOT / "config", folder / "config")
    done = subprocess.run(
        command(*options, "--configfile=config/ci.yaml"),
        cwd=folder,
        env=environment,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        timeout=3600,
    )
    assert done.returncode == 0, done.stdout
    results = folder / "results" / "ci"
    return {
        str(path.relative_to(results)): path.read_bytes()
        for path in sorted(results.rglob("*"))
        if path.is_file() and not {"logs", "benchmarks"} & set(path.parts)
    }


@pytest.mark.dag
@pytest.mark.skipif(bool(missing()), reason=f"SLURM is not installed: no {', '.join(missing())}")
@pytest.mark.skipif(importlib.util.find_spec(PLUGIN) is None, reason=f"{PLUGIN} is not installed")
def test_a_cluster_gives_the_bytes_of_one_machine(tmp_path):
    for name in ("alone", "cluster", "slurm"):
        (tmp_path / name).mkdir()
    alone = run(tmp_path / "alone", os.environ, "-j2")
    with Slurm(tmp_path / "slurm") as slurm:
        options = ["--profile", ROOT / "profiles" / "slurm", "--slurm-status-command", "squeue"]
        spread = run(tmp_path / "cluster", slurm.environment, *options)
    assert spread.keys() == alone.keys()
    assert [name for name in alone if spread[name] != alone[name]] == []
