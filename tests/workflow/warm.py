"""What starts of Snakemake and of jobs import and look up, done once in the process that others fork from."""

import ast
import gc
from pathlib import Path

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

import opml.study.beyond
import opml.study.checks
import opml.study.own_study
import opml.workflow.command_line
import opml.workflow.inputs
import opml.workflow.settings_in_tables
import opml.workflow.starting  # noqa: F401
from opml.base.provenance import script_digest
from opml.environment import earth_orientation
from opml.study.settings.json_schema import json_schema
from opml.study.settings.model.whole import RunSettings


def _import_as(script: Path) -> None:
    """Import what a script does at its head."""
    tree = ast.parse(script.read_text(encoding="utf-8"))
    tree.body = [node for node in tree.body if isinstance(node, ast.Import | ast.ImportFrom)]
    exec(compile(tree, script, "exec"), {})


for script in (Path(__file__).parents[2] / "workflow" / "scripts").glob("*.py"):
    _import_as(script)
    script_digest(script)
earth_orientation.tabulate("2016-09-28T12:09:45", np.zeros(1))
json_schema(RunSettings)
snakemake.cli.get_argument_parser()
parse_once()
gc.freeze()  # what is here stays, and no fork need look through it for what can go
