"""Runs that are killed, starved and damaged at random moments end with the bytes of undisturbed ones.

Not part of `make test`: `make faults` takes twenty minutes. The moments come from fixed seeds. Snakemake and
its jobs are processes of their own, but forked from one that has imported all: nearly all moments meet a job
at work.
"""

import os
import re
import shutil
import signal
import subprocess
import time
from pathlib import Path

import numpy as np
import psutil
import pytest
from project import ROOT, SNAKEMAKE, apart, command

from opml.base.errors import InputError
from opml.tables.parquet import read_schema, read_table

HERE = Path(__file__).parent
SEEDS = (42, 43, 44)
MOMENTS = 200
FAULTS_IN_A_RUN = 10

OF_FIT24 = "mine/eglin-clear-kaena_later/days-0-2/fit24/e_y/mine/days-2-3"
RUNS = {
    "simulated": (
        ROOT / "config" / "ci.yaml",
        ["results/ci/figs/partition_curve.pdf", "results/ci/figs/error_distribution_position.pdf"],
    ),
    "orbit": (HERE / "orbit.yaml", ["study"]),
    "tracks": (HERE / "tracks.yaml", [f"results/tracks/evaluation/{OF_FIT24}.parquet"]),
}
"""Settings and targets of the runs that are disturbed: each kind of study in a small case."""

MORNINGS = {"mornings": (HERE / "days.yaml", ["results/days/days/2016-10-01/day.html"])}
"""The same of mornings, whose records are no products of a rule: what is damaged of them, a user removes."""


class Run:
    """One kind of run, in a folder of its own; `orbit` is the OEM file that a study of an orbit reads."""

    def __init__(self, kind, folder, orbit):
        settings, targets = (RUNS | MORNINGS)[kind]
        self.folder = folder
        self.arguments = command("-j2", "--configfile=mine.yaml", "--", *targets)[len(SNAKEMAKE) :]
        folder.mkdir(parents=True)
        shutil.copytree(ROOT / "config", folder / "config")
        shutil.copy(settings, folder / "mine.yaml")
        shutil.copy(ROOT / "tests" / "reference" / "orekit.tdm", folder / "mine.tdm")
        shutil.copy(orbit, folder / "mine.oem")
        self.process = None

    def begin(self):
        """Start the run, in a session of its own."""
        environment = os.environ | {"PYTHONPATH": str(ROOT / "src"), "NO_COLOR": "1"}
        log = self.folder / "log.txt"
        log.write_text("")
        self.process = apart(self.arguments, cwd=self.folder, env=environment, output=log)

    def code(self, within):
        """The exit code of the run, None where it goes on for longer than so many seconds."""
        self.process.join(within)
        return self.process.exitcode

    def log(self):
        """What the run printed since it began."""
        return (self.folder / "log.txt").read_text()

    def complete(self):
        """Run to the end."""
        self.begin()
        assert self.code(within=900) == 0, self.log()

    def end(self):
        """Wait until the run and every process it started are gone."""
        if self.code(within=120) is None:
            os.killpg(self.process.pid, signal.SIGKILL)
        while any(_session(process) == self.process.pid for process in psutil.process_iter()):
            time.sleep(0.1)

    def tables(self):
        """Paths of the tables that have their final name."""
        return sorted((self.folder / "results").rglob("[!.]*.parquet"))

    def finals(self):
        """Path -> bytes of what the run leaves but logs and benchmarks, which hold times."""
        results = self.folder / "results"
        return {
            str(path.relative_to(results)): path.read_bytes()
            for path in sorted(results.rglob("*"))
            if path.is_file()
            and not {"logs", "benchmarks"} & set(path.parts)
            and not path.name.endswith(".tmp")
        }


def _session(process):
    try:
        return os.getsid(process.pid)
    except (ProcessLookupError, PermissionError):
        return None


@pytest.fixture(scope="session")
def orbit(tmp_path_factory):
    """An OEM file of three and a half days, written by a run of the trimmed case."""
    folder = tmp_path_factory.mktemp("orbit")
    shutil.copytree(ROOT / "config", folder / "config")
    message = "results/ci/exports/truth/iss.oem"
    settings = ["--config", "duration_days=3.5", "study={}"]
    line = command("-j2", message, "--configfile=config/ci.yaml", *settings)
    subprocess.run(line, cwd=folder, env=os.environ | {"PYTHONPATH": str(ROOT / "src")}, check=True)
    return folder / message


@pytest.fixture(scope="session")
def undisturbed(tmp_path_factory, orbit):
    """Kind -> (the results of a run that nothing happened to, how long it took [s])."""
    runs = {}
    for kind in RUNS:
        run = Run(kind, tmp_path_factory.mktemp("undisturbed") / kind, orbit)
        started = time.monotonic()
        run.complete()
        runs[kind] = run.finals(), time.monotonic() - started
    return runs


def kill_scheduler(run, rng):
    """SIGKILL to the scheduler alone; its jobs are orphans."""
    os.kill(run.process.pid, signal.SIGKILL)


def kill_all(run, rng):
    """SIGKILL to the scheduler and all its jobs, as a machine that goes down."""
    os.killpg(run.process.pid, signal.SIGKILL)


def kill_job(run, rng):
    """SIGKILL to one job's process; the scheduler sees it fail."""
    jobs = psutil.Process(run.process.pid).children(recursive=True)
    if jobs:
        jobs[rng.integers(len(jobs))].kill()


def terminate(run, rng):
    """SIGTERM to the scheduler."""
    run.process.terminate()


def set_clock_back(run, rng):
    """Everything is killed, and what is there has times of tomorrow: the clock was set back."""
    kill_all(run, rng)
    tomorrow = time.time() + 86400.0
    for path in run.tables():
        os.utime(path, (tomorrow, tomorrow))


def truncate(run, rng):
    """Everything is killed, and a table is cut short."""
    kill_all(run, rng)
    path, content = _some_table(run, rng)
    if path:
        path.write_bytes(content[: rng.integers(len(content))])


def flip(run, rng):
    """Everything is killed, and a bit of a table is flipped."""
    kill_all(run, rng)
    path, content = _some_table(run, rng)
    if path:
        damaged = bytearray(content)
        damaged[rng.integers(len(damaged))] ^= 1 << rng.integers(8)
        path.write_bytes(damaged)


def _some_table(run, rng):
    tables = run.tables()
    if not tables:
        return None, b""
    path = tables[rng.integers(len(tables))]
    return path, path.read_bytes()


FAILED = re.compile(r"^Error in rule .*?^    output: (.*?)$", re.MULTILINE | re.DOTALL)
"""What a failed job would have made, as Snakemake tells it."""

KILLS = (kill_scheduler, kill_all, kill_job, terminate, set_clock_back)
DAMAGES = (truncate, flip)


def read(path):
    """Read a table with every check there is on its bytes."""
    read_table(path, read_schema(path))


def strike(run, fault, seconds, rng):
    """Carry a run on for some seconds, and let a fault happen unless it is at its end before."""
    run.begin()
    code = run.code(within=seconds)
    assert code in (None, 0), run.log()
    if code is None:
        fault(run, rng)
    run.end()


def heal(run, expected):
    """Carry on to the end; returns the products that must be there then.

    A damaged table is made anew, or told by its name and taken away as a user would. The job that told it
    leaves no table. Where all that follows from these is there, no job reads them and none makes them anew.
    """
    damaged = [path for path in run.tables() if path.read_bytes() != expected[_name(run, path)]]
    assert len(damaged) <= 1, damaged
    for path in damaged:
        with pytest.raises((InputError, OSError)):
            read(path)
    unread = list(damaged)
    run.begin()
    if run.code(within=900) != 0:
        assert damaged, run.log()
        assert f"opml: {damaged[0].relative_to(run.folder)}: " in run.log(), run.log()
        assert "Traceback" not in run.log(), run.log()
        unread += [run.folder / name for line in FAILED.findall(run.log()) for name in line.split(", ")]
        damaged[0].unlink()
        run.complete()
    lost = {_name(run, path) for path in unread if not _is_whole(run, path, expected)}
    return {name: content for name, content in expected.items() if name not in lost}


def _is_whole(run, path, expected):
    return path.exists() and path.read_bytes() == expected[_name(run, path)]


def _name(run, path):
    return str(path.relative_to(run.folder / "results"))


@pytest.mark.parametrize("seed", SEEDS)
def test_faults_at_random_moments_change_no_byte(undisturbed, orbit, tmp_path, seed):
    """Several faults strike each run; the last of them may damage a table."""
    rng = np.random.default_rng(seed)
    kinds = list(RUNS)
    for number in range(MOMENTS // FAULTS_IN_A_RUN):
        expected, duration = undisturbed[kinds[number % len(kinds)]]
        run = Run(kinds[number % len(kinds)], tmp_path / f"{number:02d}", orbit)
        faults = [*rng.choice(KILLS, FAULTS_IN_A_RUN - 1), rng.choice(DAMAGES)]
        for fault in faults:
            strike(run, fault, rng.uniform(0.05, 0.18) * duration, rng)
        whole, products = heal(run, expected), run.finals()
        names = [fault.__name__ for fault in faults]
        assert whole.keys() <= products.keys() <= expected.keys(), names
        assert [name for name in whole if products[name] != whole[name]] == [], names
        print(f"seed {seed}: {(number + 1) * FAULTS_IN_A_RUN} moments", flush=True)
        shutil.rmtree(run.folder)


@pytest.fixture(scope="module")
def mornings(orbit, tmp_path_factory):
    """Mornings that nothing disturbed: what they leave, and how long they took [s]."""
    run = Run("mornings", tmp_path_factory.mktemp("mornings") / "run", orbit)
    started = time.monotonic()
    run.complete()
    return run.finals(), time.monotonic() - started


def fill_up(kind, expected, orbit, folder, *, stage=""):
    """Run on a disk that holds but half of what a stage writes, and again on one that holds all of it."""
    disk = folder / "disk"
    disk.mkdir()
    lacking = sum(len(content) for name, content in expected.items() if name.startswith(stage)) // 2
    size = orbit.stat().st_size + sum(map(len, expected.values())) - lacking
    mounted = subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={size}", "tmpfs", str(disk)], check=False)
    if mounted.returncode != 0:
        pytest.skip("needs the right to mount a small tmpfs")
    try:
        run = Run(kind, disk / "run", orbit)
        run.begin()
        assert run.code(within=900) != 0
        run.end()
        for name, content in run.finals().items():
            assert content == expected[name], f"{name} is half written"
        subprocess.run(["mount", "-o", "remount,size=500m", str(disk)], check=True)
        run.complete()
        assert run.finals() == expected
    finally:
        subprocess.run(["umount", str(disk)], check=True)


def test_a_full_disk_leaves_nothing_half_written(undisturbed, orbit, tmp_path):
    expected, _ = undisturbed["simulated"]
    fill_up("simulated", expected, orbit, tmp_path)


def test_a_full_disk_loses_no_morning(mornings, orbit, tmp_path):
    expected, _ = mornings
    fill_up("mornings", expected, orbit, tmp_path, stage="days/")


def test_kills_at_random_moments_lose_no_morning(mornings, orbit, tmp_path):
    """Each run is killed several times on its way."""
    expected, duration = mornings
    rng = np.random.default_rng(SEEDS[0])
    for number in range(50 // FAULTS_IN_A_RUN):
        run = Run("mornings", tmp_path / f"{number:02d}", orbit)
        faults = rng.choice(KILLS, FAULTS_IN_A_RUN)
        for fault in faults:
            strike(run, fault, rng.uniform(0.05, 0.5) * duration, rng)
        run.complete()
        products = run.finals()
        names = [fault.__name__ for fault in faults]
        assert products.keys() == expected.keys(), names
        assert [name for name in expected if products[name] != expected[name]] == [], names
        shutil.rmtree(run.folder)
