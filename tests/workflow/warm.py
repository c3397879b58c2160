"""What each start of Snakemake imports and looks up, done once in the process that the others fork from."""

import gc

import nbformat  # noqa: F401
import numpy as np
import smart_open  # noqa: F401
import snakemake.cli
import snakemake.dag
import snakemake.report.html_reporter
import snakemake.storage

import opml.readings.scan_report
import opml.study.beyond
import opml.study.checks
import opml.study.own_study
import opml.workflow.command_line
import opml.workflow.inputs
import opml.workflow.records
import opml.workflow.starting  # noqa: F401
from opml.environment import earth_orientation
from opml.study.settings.json_schema import json_schema
from opml.study.settings.model.whole import RunSettings

earth_orientation.tabulate("2016-09-28T12:09:45", np.zeros(1))
json_schema(RunSettings)
snakemake.cli.get_argument_parser()
gc.freeze()  # what is here stays, and no fork need look through it for what can go
