"""Runs that are killed, starved and damaged at random moments end with the bytes of an undisturbed one.

Not part of `make test`: `make faults` takes about half an hour. The moments come from a fixed seed.
"""

import os
import shutil
import signal
import subprocess
import time

import numpy as np
import psutil
import pyarrow.parquet as pq
import pytest
from project import ROOT, command

from opml.base.errors import InputError
from opml.tables import read_metadata

TARGETS = ["results/ci/figs/partition_curve.pdf", "results/ci/figs/error_distribution_position.pdf"]
COMMAND = command("-j2", "--configfile=config/ci.yaml", *TARGETS)
MOMENTS = 50
SEED = 42


def begin(folder):
    """Start the run in a folder, in a session of its own."""
    if not (folder / "config").exists():
        shutil.copytree(ROOT / "config", folder / "config")
    environment = os.environ | {"PYTHONPATH": str(ROOT / "src"), "NO_COLOR": "1"}
    with (folder / "log.txt").open("w") as log:
        return subprocess.Popen(
            COMMAND, cwd=folder, env=environment, start_new_session=True, stdout=log, stderr=subprocess.STDOUT
        )


def complete(folder):
    """Run to the end; returns what was said."""
    run = begin(folder)
    assert run.wait(timeout=900) == 0, (folder / "log.txt").read_text()
    return (folder / "log.txt").read_text()


def finals(folder):
    """Path -> bytes of what the run leaves but logs and benchmarks, which hold times."""
    results = folder / "results"
    return {
        str(path.relative_to(results)): path.read_bytes()
        for path in sorted(results.rglob("*"))
        if path.is_file() and not {"logs", "benchmarks"} & set(path.parts) and not path.name.endswith(".tmp")
    }


@pytest.fixture(scope="session")
def undisturbed(tmp_path_factory):
    """(the results of a run that nothing happened to, how long it took [s])."""
    folder = tmp_path_factory.mktemp("undisturbed")
    started = time.monotonic()
    complete(folder)
    return finals(folder), time.monotonic() - started


def kill_scheduler(run, folder, rng):
    """SIGKILL to the scheduler alone; its jobs are orphans."""
    os.kill(run.pid, signal.SIGKILL)


def kill_all(run, folder, rng):
    """SIGKILL to the scheduler and all its jobs, as a machine that goes down."""
    os.killpg(run.pid, signal.SIGKILL)


def kill_job(run, folder, rng):
    """SIGKILL to one job's process; the scheduler sees it fail."""
    jobs = psutil.Process(run.pid).children(recursive=True)
    if jobs:
        jobs[rng.integers(len(jobs))].kill()


def terminate(run, folder, rng):
    """SIGTERM to the scheduler."""
    run.terminate()


def truncate(run, folder, rng):
    """Everything is killed, and a table is cut short."""
    kill_all(run, folder, rng)
    path, content = _some_table(folder, rng)
    if path:
        path.write_bytes(content[: rng.integers(len(content))])


def flip(run, folder, rng):
    """Everything is killed, and a bit of a table is flipped."""
    kill_all(run, folder, rng)
    path, content = _some_table(folder, rng)
    if path:
        damaged = bytearray(content)
        damaged[rng.integers(len(damaged))] ^= 1 << rng.integers(8)
        path.write_bytes(damaged)


def set_clock_back(run, folder, rng):
    """Everything is killed, and what is there has times of tomorrow: the clock was set back."""
    kill_all(run, folder, rng)
    tomorrow = time.time() + 86400.0
    for path in sorted((folder / "results").rglob("*.parquet")):
        os.utime(path, (tomorrow, tomorrow))


def _some_table(folder, rng):
    tables = sorted((folder / "results").rglob("[!.]*.parquet"))
    if not tables:
        return None, b""
    path = tables[rng.integers(len(tables))]
    return path, path.read_bytes()


FAULTS = (kill_scheduler, kill_all, kill_job, terminate, truncate, flip, set_clock_back)


def end(run):
    """Wait until the run and every process it started are gone."""
    try:
        run.wait(timeout=120)
    except subprocess.TimeoutExpired:
        os.killpg(run.pid, signal.SIGKILL)
        run.wait()
    while any(_session(process) == run.pid for process in psutil.process_iter()):
        time.sleep(0.1)


def _session(process):
    try:
        return os.getsid(process.pid)
    except (ProcessLookupError, PermissionError):
        return None


def read(path):
    """Read a table with every check there is on its bytes."""
    read_metadata(path)
    pq.read_table(path, page_checksum_verification=True)


def heal(folder, damaged):
    """Carry on to the end; a damaged table is told by its name, and is taken away as a user would."""
    run = begin(folder)
    if run.wait(timeout=900) != 0:
        said = (folder / "log.txt").read_text()
        assert damaged, said
        assert f"opml: {damaged[0].relative_to(folder)}: " in said, said
        assert "Traceback" not in said, said
    elif damaged and damaged[0].exists():
        # No job was left to read it: the next reader tells.
        with pytest.raises((InputError, OSError)):
            read(damaged[0])
    for path in damaged:
        path.unlink(missing_ok=True)
    complete(folder)


def test_faults_at_random_moments_change_no_byte(undisturbed, tmp_path):
    expected, seconds = undisturbed
    rng = np.random.default_rng(SEED)
    for moment in range(MOMENTS):
        fault = FAULTS[moment % len(FAULTS)]
        folder = tmp_path / f"{moment:02d}-{fault.__name__}"
        folder.mkdir()
        before = {}
        run = begin(folder)
        time.sleep(rng.uniform(0.05, 0.95) * seconds)
        if run.poll() is None:
            fault(run, folder, rng)
        end(run)
        before = finals(folder) if (folder / "results").exists() else {}
        damaged = [
            folder / "results" / name
            for name, content in before.items()
            if content != expected.get(name, b"")
        ]
        assert len(damaged) <= 1, damaged
        heal(folder, damaged)
        found = finals(folder)
        # What was taken away as damaged is not made again where all that follows from it is there.
        absent = expected.keys() - found.keys() if damaged else set()
        assert not any(name.startswith("ci/figs/") for name in absent), (fault.__name__, absent)
        whole = {name: content for name, content in expected.items() if name not in absent}
        assert found.keys() == whole.keys(), fault.__name__
        assert [name for name in found if found[name] != whole[name]] == [], fault.__name__
        shutil.rmtree(folder)


def test_a_full_disk_leaves_nothing_half_written(undisturbed, tmp_path):
    expected, _ = undisturbed
    disk = tmp_path / "disk"
    disk.mkdir()
    size = sum(map(len, expected.values())) // 2
    mounted = subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={size}", "tmpfs", str(disk)], check=False)
    if mounted.returncode != 0:
        pytest.skip("needs the right to mount a small tmpfs")
    try:
        run = begin(disk)
        assert run.wait(timeout=900) != 0
        end(run)
        for name, content in finals(disk).items():
            assert content == expected[name], f"{name} is half written"
        subprocess.run(["mount", "-o", "remount,size=500m", str(disk)], check=True)
        complete(disk)
        assert finals(disk) == expected
    finally:
        subprocess.run(["umount", str(disk)], check=True)
