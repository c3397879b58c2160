"""Write the page of a day."""

from opml.mornings import batch, weather_of_day
from opml.report import day, document
from opml.workflow.job_settings import FigureSettings
from opml.workflow.jobs import job

with job(snakemake):
    settings, files, output = FigureSettings(snakemake.params.settings), snakemake.input, snakemake.output
    outcomes = [outcome for path in files.objects for outcome in batch.read(path)]
    weather = weather_of_day.read(files, epoch=settings.epoch, hour=settings.hour, day=settings.date)
    document.write(day.document(outcomes, weather, date=settings.date), output.md, output.tsv, output.html)
    batch.write(output.json, day.as_json(outcomes, weather, date=settings.date))
