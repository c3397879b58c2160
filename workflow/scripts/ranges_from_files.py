"""Take laser ranges that were really measured for the tracks of an RSO."""

from opml.base.constants import DAY
from opml.base.section import JobSettings
from opml.catalog.fit import laser_ranges
from opml.interop import crd, sinex
from opml.orbits import manoeuvres
from opml.tables import read_table, write_table
from opml.workflow.jobs import job


class RangeOptions(JobSettings):
    reflectors_m: float
    sigma_m: float
    without: list[int]


class Settings(JobSettings):
    epoch: str
    options: RangeOptions
    duration_days: float
    manoeuvres: list[str]


with job(snakemake) as metadata:
    settings, files = Settings(**snakemake.params.settings), snakemake.input
    coordinates, eccentricities = files.sites
    points, without = crd.read(files.points, epoch=settings.epoch), settings.options.without
    table = laser_ranges.table(
        laser_ranges.of_run(points, DAY * settings.duration_days, without=without),
        laser_ranges.Sites(sinex.read_coordinates(coordinates), sinex.read_eccentricities(eccentricities)),
        epoch=settings.epoch,
        earth_orientation=read_table(files.earth_orientation, "earth_orientation"),
        ephemerides=read_table(files.ephemerides, "ephemerides"),
        sigma=settings.options.sigma_m,
        offset=settings.options.reflectors_m,
    )
    metadata |= manoeuvres.facts(manoeuvres.at_times(settings.manoeuvres, epoch=settings.epoch))
    write_table(snakemake.output[0], table, "laser_ranges", metadata=metadata)
