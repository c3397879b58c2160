"""What each start of Snakemake imports and looks up, done once in the process that others are forked from."""

import snakemake.cli
import snakemake.dag
import snakemake.report.html_reporter

import opml.study.beyond
import opml.study.checks
import opml.study.own_study  # noqa: F401

snakemake.cli.get_argument_parser()
