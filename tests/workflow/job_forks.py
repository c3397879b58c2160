"""The scripts of a workflow's jobs, and Snakemake itself, in forks of a process that has what they import."""

import os
import runpy
import subprocess
import sys
import traceback
from collections.abc import Callable
from typing import NoReturn

from snakemake import cli
from snakemake.benchmark import benchmarked
from snakemake.script import PythonScript

from opml.workflow import day_command


def fork_scripts() -> None:
    """Have the Snakemake of this process start no Python for a script, of whose time half are imports."""
    PythonScript.execute_script = _execute


def fork_snakemake() -> None:
    """Have the `opml day` of this process start no Python for Snakemake, nor this one any for its scripts."""
    day_command._exit_code = _run_snakemake
    fork_scripts()


def _run_snakemake(command: list[str]) -> int:
    sys.stdout.flush()
    process = os.fork()
    if process == 0:
        sys.argv = command[2:]
        _become(cli.main)
    _, status = os.waitpid(process, 0)
    return os.waitstatus_to_exitcode(status)


def _execute(script: PythonScript, path: str, edit: bool = False) -> None:
    process = os.fork()
    if process == 0:
        _become(lambda: runpy.run_path(path, run_name="__main__"))
    with benchmarked(process, script.bench_record):
        _, status = os.waitpid(process, 0)
    if status != 0:
        raise subprocess.CalledProcessError(os.waitstatus_to_exitcode(status), path)


def _become(main: Callable[[], object]) -> NoReturn:
    """Do what a program does, and end as Python does after it."""
    code = 1
    try:
        main()
        code = 0
    except SystemExit as end:
        code = end.code
    except BaseException:
        traceback.print_exc()
    finally:
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(code)
