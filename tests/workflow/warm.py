"""What each start of Snakemake imports and looks up, done once in the process that the others fork from."""

import snakemake.cli
import snakemake.dag
import snakemake.report.html_reporter

import opml.study.beyond
import opml.study.checks
import opml.study.own_study  # noqa: F401
from opml.study.settings.json_schema import json_schema
from opml.study.settings.model.whole import RunSettings

json_schema(RunSettings)
snakemake.cli.get_argument_parser()
