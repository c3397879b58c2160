"""What starts of Snakemake and of jobs import and look up, done once in the process that others fork from."""

import ast
import gc
import io
from pathlib import Path

import job_forks  # noqa: F401
import matplotlib.backends.backend_pdf  # noqa: F401
import nbformat  # noqa: F401
import numpy as np
import scipy.stats  # noqa: F401
import sklearn.ensemble  # noqa: F401
import smart_open  # noqa: F401
import snakemake.cli
import snakemake.dag
import snakemake.report.html_reporter
import snakemake.storage
from parsed_snakefiles import parse_once
from support import force_model

from opml.base.provenance import script_digest
from opml.dynamics.ensemble import Departures, propagate
from opml.dynamics.settings import Integrator
from opml.environment import earth_orientation
from opml.figures import style
from opml.learning.models import smo
from opml.study.settings.json_schema import json_schema
from opml.study.settings.model.whole import RunSettings


def _import_as(script: Path) -> None:
    """Import what a script does at its head."""
    tree = ast.parse(script.read_text(encoding="utf-8"))
    tree.body = [node for node in tree.body if isinstance(node, ast.Import | ast.ImportFrom)]
    exec(compile(tree, script, "exec"), {})


def _load_kernels() -> None:
    """Fly a minute and learn from ten rows, as most jobs do first of all: Numba then has what it compiled."""
    still = [7e6, 0.0, 0.0, 0.0, 7.5e3, 0.0]
    departures = Departures([still], first=[0], last=[1], ballistic=[0.1], reflection=[0.1])
    propagate(force_model(2), [0.0, 60.0], departures, integrator=Integrator())
    rows = np.linspace(-1.0, 1.0, 10)
    smo.solve(rows[:, None], rows, np.ones(10), epsilon=0.01, tol=1e-3)


def _draw() -> None:
    """Draw axes with powers of ten: Matplotlib then has the fonts, and their letters' sizes."""
    figure, axes = style.column_figure(height_mm=60.0)
    axes.set(xscale="log", xlim=(1e-4, 1e6), yscale="symlog", ylim=(-1e6, 1e6), xlabel="$x_y$")
    for kind in ("pdf", "png"):
        figure.savefig(io.BytesIO(), format=kind)


for script in (Path(__file__).parents[2] / "workflow" / "scripts").glob("*.py"):
    _import_as(script)
    script_digest(script)
earth_orientation.tabulate("2016-09-28T12:09:45", np.zeros(1))
json_schema(RunSettings)
snakemake.cli.get_argument_parser()
parse_once()
_load_kernels()
_draw()
gc.freeze()  # what is here stays, and no fork need look through it for what can go
