"""Tables that a storage plugin keeps, as in a mounted bucket: the same bytes as on the machine alone.

python -m pytest tests/cluster/test_storage.py
"""

import importlib.util
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from tests.cluster.test_slurm import ROOT

PLUGIN = "snakemake_storage_plugin_fs"
METRICS = "results/ci/metrics/iss/eglin/random-80/svr/e_y/iss/rest.parquet"
pytestmark = [
    pytest.mark.skipif(importlib.util.find_spec(PLUGIN) is None, reason=f"{PLUGIN} is not installed"),
    pytest.mark.skipif(shutil.which("rsync") is None, reason="rsync is not installed"),
]


def run(folder, *options):
    """Make the metrics of the trimmed case in a folder, under the user's own gravity field."""
    shutil.copytree(ROOT / "config", folder / "config")
    shutil.copy2(ROOT / "src" / "opml" / "data" / "egm2008_70.gfc", folder / "own.gfc")
    command = [sys.executable, "-m", "snakemake", "--snakefile", str(ROOT / "Snakefile"), "-j2"]
    command += ["--configfile=config/ci.yaml", "--config", "environment={gravity_field: own.gfc}"]
    done = subprocess.run(
        [*command, *options, "--", METRICS],
        cwd=folder,
        env=os.environ | {"PYTHONPATH": str(ROOT / "src")},
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        timeout=900,
    )
    assert done.returncode == 0, done.stdout


def tables(folder: Path):
    return {str(path.relative_to(folder)): path.read_bytes() for path in folder.rglob("*.parquet")}


def test_a_storage_plugin_gives_the_bytes_of_one_machine(tmp_path):
    alone, stored, bucket = (tmp_path / name for name in ("alone", "stored", "bucket"))
    for folder in (alone, stored, bucket):
        folder.mkdir()
    run(alone)
    storage = ["--default-storage-provider", "fs", "--default-storage-prefix", f"{bucket}/opml"]
    shared = ["--shared-fs-usage", "persistence", "software-deployment", "sources", "source-cache"]
    run(stored, *storage, *shared)
    assert tables(bucket / "opml" / "results") == tables(alone / "results")
    assert not (stored / "results").exists()
