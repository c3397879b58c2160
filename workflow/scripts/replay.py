"""Run the mornings that are over again, and hold their ephemerides against what came."""

from opml.catalog.propagator import Propagator, PropagatorSettings
from opml.ephemerides import replays
from opml.ephemerides.known_tables import KnownSettings, KnownTables
from opml.learning.data import dataset
from opml.learning.models.daily_training import DailyLearner, first_day
from opml.learning.models.learners import paths_of_each
from opml.tables import read_table, write_table
from opml.workflow.jobs import job, metadata_of_each, progress


class Settings(PropagatorSettings, KnownSettings):
    seed: int
    train_days: tuple[float, float]
    every_hours: float
    max_days: float


with job(snakemake) as metadata:
    settings, files = Settings(**snakemake.params.settings), snakemake.input
    known = KnownTables.read(files, settings)
    predictions = read_table(files.predictions, "predictions")
    later = read_table(files.later, "estimates") if files.later else None
    spread = read_table(files.spread, "spread")
    series, paths = [], paths_of_each(files.others, settings.learners)
    for learner, others in zip(settings.learners, paths, strict=True):
        rows = known.marked(dataset.read(files.dataset, others))
        daily = DailyLearner(rows, learner, settings.seed, settings.train_days[0])
        day = first_day(learner, window_hours=settings.window_hours, train_days=settings.train_days)
        starts = replays.morning_departures(known, every_hours=settings.every_hours, first_day=day)
        judged = replays.judge(daily.dataset, predictions, later)
        series.append(replays.ReplaySeries(daily, starts, replays.at_starts(judged, starts, spread)))
    tables = replays.build(
        Propagator.read(files, settings, threads=snakemake.threads, progress=progress),
        known,
        series,
        max_days=settings.max_days,
    )
    for path, table, alone in zip(
        snakemake.output, tables, metadata_of_each(snakemake.params.settings), strict=True
    ):
        write_table(path, table, "replay", metadata=alone)
