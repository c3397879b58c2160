"""Tables that a storage plugin keeps, as in a mounted bucket: the same bytes as on the machine alone.

python -m pytest tests/cluster/test_storage.py
"""

import importlib.util
import shutil
from pathlib import Path

import pytest
from project import ROOT, Project

PLUGIN = "snakemake_storage_plugin_fs"
METRICS = "results/ci/metrics/iss/eglin/random-80/svr/e_y/iss/rest.parquet"
pytestmark = [
    pytest.mark.skipif(importlib.util.find_spec(PLUGIN) is None, reason=f"{PLUGIN} is not installed"),
    pytest.mark.skipif(shutil.which("rsync") is None, reason="rsync is not installed"),
]


def run(folder, *options):
    """Make the metrics of the trimmed case in a folder, under the user's own gravity field."""
    shutil.copy2(ROOT / "src" / "opml" / "data" / "egm2008_70.gfc", folder / "own.gfc")
    settings = ["--configfile=config/ci.yaml", "--config", "environment={gravity_field: own.gfc}"]
    Project(folder).snakemake("-j2", *settings, *options, "--", METRICS)


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
