"""Write the page of a day."""

from opml.mornings import batch
from opml.report import day, document
from opml.workflow.job_settings import FigureSettings
from opml.workflow.jobs import job

with job(snakemake):
    settings, output = FigureSettings(snakemake.params.settings), snakemake.output
    outcomes = [outcome for path in snakemake.input for outcome in batch.read(path)]
    document.write(day.document(outcomes, date=settings.date), output.md, output.tsv, output.html)
    batch.write(output.json, day.as_json(outcomes, date=settings.date))
