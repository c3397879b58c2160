"""Scripts of the workflow, run in process as Snakemake runs them."""

import runpy
from types import SimpleNamespace

from snakemake.iocontainers import Namedlist
from support import REPOSITORY


def files(**named):
    """Files of a job, each or several by a name."""
    return Namedlist(fromdict=named)


def run(script, read, made, *, log, **settings):
    """What the names of a script stand for once it has made files of those that it read."""
    snakemake = SimpleNamespace(
        rule=script,
        log=[str(log)],
        params=SimpleNamespace(settings=settings),
        input=read,
        output=made,
        threads=1,
    )
    path = REPOSITORY / "workflow" / "scripts" / f"{script}.py"
    return runpy.run_path(str(path), init_globals={"snakemake": snakemake})
