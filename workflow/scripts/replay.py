"""Run the mornings that are over again, and hold their ephemerides against what came."""

from opml.ephemerides import corrected, replays
from opml.learning.data import dataset
from opml.learning.models.daily_training import Lessons
from opml.tables import read_table, write_table
from opml.workflow.jobs import job, progress

with job(snakemake) as metadata:
    settings, files = snakemake.params.settings, snakemake.input
    known = corrected.read(files, settings)
    labelled = dataset.read(files.dataset, files.beside)
    lessons = Lessons(labelled, settings["learner"], settings["seed"], settings["train_days"][0])
    table = replays.build(
        corrected.Flight.read(files, settings, threads=snakemake.threads),
        known,
        lessons,
        replays.departures(
            known,
            every_hours=settings["every_hours"],
            first_day=replays.first_day(lessons, known, train_days=settings["train_days"]),
        ),
        replays.judge(
            labelled,
            read_table(files.predictions, "predictions"),
            read_table(files.later, "estimates") if files.later else None,
        ),
        read_table(files.spread, "spread"),
        max_days=settings["max_days"],
        progress=progress,
    )
    write_table(snakemake.output[0], table, "replay", metadata=metadata)
