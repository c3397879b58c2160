"""The scripts of a workflow's jobs in forks of Snakemake, which has what they import."""

import os
import runpy
import subprocess
import sys
import traceback
from typing import NoReturn

from snakemake.benchmark import benchmarked
from snakemake.script import PythonScript


def fork_scripts() -> None:
    """Have the Snakemake of this process start no Python for a script, of whose time half are imports."""
    PythonScript.execute_script = _execute


def _execute(script: PythonScript, path: str, edit: bool = False) -> None:
    process = os.fork()
    if process == 0:
        _become(path)
    with benchmarked(process, script.bench_record):
        _, status = os.waitpid(process, 0)
    if status != 0:
        raise subprocess.CalledProcessError(os.waitstatus_to_exitcode(status), path)


def _become(path: str) -> NoReturn:
    """Run a script as the main module, and end as Python does after it."""
    code = 1
    try:
        runpy.run_path(path, run_name="__main__")
        code = 0
    except SystemExit as end:
        code = end.code
    except BaseException:
        traceback.print_exc()
    finally:
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(code)
