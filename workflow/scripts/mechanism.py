"""Gather what a catalogue knows of why each prediction errs."""

from opml.base.section import JobSettings
from opml.catalog.predict import mechanism
from opml.catalog.predict.mechanism import FittedArcs
from opml.catalog.predict.resonance import Resonances
from opml.tables import mechanism_schema, read_metadata, read_table, write_table
from opml.workflow.jobs import job

KINDS = ("estimates", "predictions", "sensitivities")


class Settings(JobSettings):
    resonances: list[tuple[int, int]]
    long_window_hours: float
    cd_bounds: tuple[float, float] | None


with job(snakemake) as metadata:
    settings, files = Settings(**snakemake.params.settings), snakemake.input
    short, long = (
        FittedArcs(*(read_table(files[prefix + kind], kind) for kind in KINDS)) for prefix in ("", "long_")
    )
    gm = read_metadata(files.gravity_field)["gm"]
    resonances = Resonances(settings.resonances, settings.long_window_hours, gm)
    table = mechanism.build(short, long, bounds=settings.cd_bounds, resonances=resonances)
    metadata |= {"resonances": settings.resonances}
    write_table(snakemake.output[0], table, mechanism_schema(settings.resonances), metadata=metadata)
