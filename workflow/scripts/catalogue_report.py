"""Report what correctors leave of SGP4's errors in all tests of a catalogue."""

from opml.base.section import JobSettings
from opml.report import document
from opml.report.catalogue_pages import scores as report
from opml.tables import read_table
from opml.workflow.jobs import job


class Settings(JobSettings):
    seasons_of_tests: dict[str, dict[str, list[str]]]
    trained_on: dict[str, str]


with job(snakemake):
    settings, output = Settings(**snakemake.params.settings), snakemake.output
    scores = read_table(snakemake.input[0], "catalogue_scores")
    blocks = report.document(scores, settings.seasons_of_tests, settings.trained_on)
    document.write(blocks, output.md[0], output.tsv[0], output.html[0])
