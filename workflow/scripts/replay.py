"""Run the mornings that are over again, and hold their ephemerides against what came."""

from opml.catalog.flight import Flight
from opml.ephemerides import replays
from opml.ephemerides.known import Known
from opml.ephemerides.task import Task
from opml.learning.data import dataset
from opml.learning.models.daily_training import Lessons
from opml.tables import read_table, write_table
from opml.workflow.job_settings import JobSettings
from opml.workflow.jobs import job, progress

with job(snakemake) as metadata:
    settings, files = JobSettings(snakemake.params.settings), snakemake.input
    known = Known.read(files, settings.values)
    labelled = dataset.read(files.dataset, files.beside)
    lessons = Lessons(labelled, settings.learner, settings.seed, settings.train_days[0])
    first_day = replays.first_day(lessons, known, train_days=settings.train_days)
    starts = replays.morning_departures(known, every_hours=settings.every_hours, first_day=first_day)
    later = read_table(files.later, "estimates") if files.later else None
    judge = replays.judge(labelled, read_table(files.predictions, "predictions"), later)
    judge = replays.at_starts(judge, starts, read_table(files.spread, "spread"))
    flight = Flight.read(files, settings.values, threads=snakemake.threads, progress=progress)
    task = Task(flight, known, starts, replays.grid(judge, max_days=settings.max_days))
    write_table(snakemake.output[0], replays.build(task, lessons, judge), "replay", metadata=metadata)
