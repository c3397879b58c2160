"""Run the real command line in a folder of its own."""

import importlib
import multiprocessing
import multiprocessing.forkserver
import os
import re
import shutil
import subprocess
import sys
import tempfile
import warnings
from collections import Counter
from multiprocessing.process import BaseProcess
from pathlib import Path
from unittest import mock

ROOT = Path(__file__).parents[2]
SNAKEMAKE = [sys.executable, "-m", "snakemake"]
HUNG = 1800.0
"""Seconds after which what a test started hangs, however slow or loaded the machine is."""


def command(*arguments, source: Path = ROOT) -> list[str]:
    """The command that starts the workflow of a tree."""
    parts = [*SNAKEMAKE, "--snakefile", source / "Snakefile", *arguments]
    return [str(part) for part in parts]


# Most of the tests start Snakemake to see it refuse or plan, and half of such a start are imports. Processes
# that are forked from one that has them begin at the first line of Snakemake's own main.
_STARTS = multiprocessing.get_context("forkserver")


def _warm_up() -> None:
    """Begin the process that the others fork from, once; it finds modules by its environment alone."""
    _STARTS.set_forkserver_preload(["warm"])
    path = os.pathsep.join(map(str, (Path(__file__).parent, ROOT / "tests", ROOT / "src")))
    with mock.patch.dict(os.environ, PYTHONPATH=path, OMP_NUM_THREADS="1"):
        multiprocessing.forkserver.ensure_running()


def _start(folder: Path, environment: dict[str, str], command: list[str], output: str, package: Path) -> None:
    """What a forked process does: the `main` of a module in a folder, both streams into a file."""
    if package != ROOT / "src":
        _forget_opml()
        sys.path.insert(0, str(package))
    os.chdir(folder)
    os.environ.clear()
    os.environ.update(environment)
    with open(output, "wb") as file:
        for stream in (1, 2):
            os.dup2(file.fileno(), stream)
    sys.argv = command
    warnings.simplefilter("error")  # in the jobs, too, which are forks of it
    warnings.simplefilter("ignore", ResourceWarning)  # Snakemake leaves folders to their finalizers
    warnings.simplefilter("ignore", PendingDeprecationWarning)  # its report names docutils' writers as of old
    import job_forks

    job_forks.fork_snakemake()
    sys.exit(importlib.import_module(command[0]).main())


def _start_apart(*given) -> None:
    """Do the same at the head of a session, as a shell starts it: all that it starts can be told by it."""
    os.setsid()
    _start(*given)


def _forget_opml() -> None:
    """Have the package imported anew, from wherever it is found first."""
    for name in [name for name in sys.modules if name.partition(".")[0] == "opml"]:
        del sys.modules[name]


def forked(
    arguments: list[str],
    *,
    cwd: Path,
    env: dict[str, str],
    package: Path = ROOT / "src",
    program: str = "snakemake.cli",
) -> tuple[int, str]:
    """Exit code and output of a program in a forked process, which finds opml in the folder `package`."""
    _warm_up()
    with tempfile.NamedTemporaryFile() as output:
        command = [program, *arguments]
        process = _STARTS.Process(target=_start, args=(cwd, env, command, output.name, package))
        process.start()
        process.join(HUNG)
        if process.exitcode is None:
            process.kill()
            raise subprocess.TimeoutExpired(arguments, HUNG)
        return process.exitcode, Path(output.name).read_text()


def apart(arguments: list[str], *, cwd: Path, env: dict[str, str], output: Path) -> BaseProcess:
    """Snakemake in a forked process that has begun, and heads a session; both streams go to a file."""
    _warm_up()
    command = ["snakemake.cli", *arguments]
    process = _STARTS.Process(target=_start_apart, args=(cwd, env, command, str(output), ROOT / "src"))
    process.start()
    return process


def started(arguments: list[str], *, cwd: Path, env: dict[str, str]) -> tuple[int, str]:
    """Exit code and output of Snakemake in a process of its own."""
    done = subprocess.run(
        [*SNAKEMAKE, *arguments],
        cwd=cwd,
        env=env,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        timeout=HUNG,
    )
    return done.returncode, done.stdout


def jobs(output):
    """Rule -> number of jobs, from Snakemake's table; each group of truths is a rule, numbered."""
    table = output.split("Job stats:")[1].split("total")[0]
    found = Counter()
    for name, count in re.findall(r"^(\w+?)(?:_\d+)? +(\d+)$", table, re.MULTILINE):
        found[name] += int(count)
    return dict(found)


class Project:
    """A folder with the project's config, run by the workflow of `source` (by default this tree)."""

    def __init__(self, folder: Path, source: Path = ROOT):
        self.folder, self.source = folder, source
        if not (folder / "config").exists():
            shutil.copytree(ROOT / "config", folder / "config")

    def snakemake(self, *arguments, check=True):
        """Run snakemake here; its output, both streams together, is in `.stdout`."""
        line, package = command(*arguments, source=self.source), self.source / "src"
        env = os.environ | {"PYTHONPATH": str(package), "NO_COLOR": "1"}
        code, output = forked(line[len(SNAKEMAKE) :], cwd=self.folder, env=env, package=package)
        if check:
            assert code == 0, output
        return subprocess.CompletedProcess(line, code, output)

    def products(self):
        """Path -> bytes of all results but logs and benchmarks, which hold times."""
        results = self.folder / "results"
        return {
            str(path.relative_to(results)): path.read_bytes()
            for path in sorted(results.rglob("*"))
            if path.is_file() and not {"logs", "benchmarks"} & set(path.parts)
        }
