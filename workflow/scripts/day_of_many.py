"""Write the page of a day with many objects."""

from opml.base.section import JobSettings
from opml.figures import style
from opml.figures.catalogue.expected_errors import expected_errors
from opml.mornings import outcomes, weather_of_day
from opml.report import document
from opml.report.catalogue_pages import day_of_many
from opml.workflow.jobs import job


class Settings(JobSettings):
    epoch: str
    hour: float
    date: str
    watched: list[str]


with job(snakemake):
    settings, files, output = Settings(**snakemake.params.settings), snakemake.input, snakemake.output
    found = [outcome for path in files.objects for outcome in outcomes.read(path)]
    weather = weather_of_day.read(files, epoch=settings.epoch, hour=settings.hour, day=settings.date)
    style.save_png(expected_errors(found), output.png)
    page = day_of_many.document(
        found, weather, date=settings.date, watched=settings.watched, picture=output.png
    )
    document.write(page, output.md, output.tsv, output.html, table=day_of_many.table(found))
    outcomes.write(output.json, day_of_many.as_json(found, weather, date=settings.date))
