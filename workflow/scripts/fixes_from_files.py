"""Take positions that were really measured for the tracks of an RSO."""

from opml.base.constants import DAY, HOUR
from opml.base.section import JobSettings
from opml.catalog.fit import fixes
from opml.interop import object_ids, points_from_files
from opml.interop.orbit_from_files import OrbitFiles
from opml.interop.points_from_files import FixSettings
from opml.orbits import manoeuvres
from opml.tables import read_table, write_table
from opml.workflow.jobs import job


class Settings(JobSettings):
    epoch: str
    duration_days: float
    options: FixSettings
    manoeuvres: list[str]


with job(snakemake) as metadata:
    settings = Settings(**snakemake.params.settings)
    orientation = snakemake.input.earth_orientation
    paths = [path for path in snakemake.input if path != orientation]
    files = OrbitFiles(paths, settings.epoch, DAY * settings.duration_days)
    points = points_from_files.read(files, read_table(orientation, "earth_orientation"), settings.options)
    table = fixes.arcs(points, length=HOUR * settings.options.stretch_hours)
    identity, burns = points_from_files.identity_and_burns(files)
    named = manoeuvres.at_times(settings.manoeuvres, epoch=settings.epoch)
    metadata |= manoeuvres.facts(named + burns) | object_ids.facts(identity)
    write_table(snakemake.output[0], table, "fixes", metadata=metadata)
