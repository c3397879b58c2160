"""Steps of a run before its first job."""

import os
import time
from pathlib import Path
from typing import Any

from opml.base.errors import InputError
from opml.base.files import FilePath
from opml.workflow import lock
from opml.workflow.plan import end_plan


def hold_results(folder: FilePath) -> None:
    """Hold a folder of results for this run.

    Ends the run in one line where another run holds the folder, or nothing can be written there.
    """
    try:
        lock.hold(Path(folder))
    except InputError as error:
        end_plan(error)
    except OSError as error:
        end_plan(f"{folder}: expected a folder that can be written to, got {error.strerror}")


def project_settings() -> str:
    """Return the path of the project's settings; end the plan where this folder has none."""
    path = "config/config.yaml"
    if not Path(path).exists():
        end_plan(f"{path}: no such file in {Path.cwd()}; --directory names the folder of another project")
    return path


def date_back_to_now(folder: FilePath) -> None:
    """Give tables of a folder that are dated in the future the present time.

    After a clock was set back, Snakemake would refuse what is made from them, as it would be older.
    """
    now = time.time()
    for path in Path(folder).rglob("[!.]*.parquet"):
        if path.stat().st_mtime > now:
            os.utime(path, (now, now))


def lift_job_rate(workflow: Any) -> None:
    """Lift Snakemake's limit of a hundred jobs a second, which is meant for queues, where jobs run here.

    With the limit, each look at the jobs that are ready causes another one a second later, and each job that
    ends causes one more a second, for good. Behind five hundred jobs they take half a core (Snakemake 9.27).
    """
    if not workflow.non_local_exec:
        workflow.scheduler.job_rate_limiter = None
