"""Checks of laser ranges: their files, where their stations are, and where their first orbit comes from."""

import math

from opml.base.constants import DAY
from opml.base.errors import InputError
from opml.interop import crd, sinex
from opml.orbits import sheets
from opml.study.settings.merging import Settings
from opml.study.settings.overlay import Source


def check(source: Source, settings: Settings) -> None:
    """Look at laser ranges: their RSO, whether they fit the run, and whether all their stations are known."""
    for name in settings.station_files:
        if name not in settings.ranges:
            raise source.wrong(("ranging", name), "expected an RSO that has ranges")
    for name in settings.ranges:
        if name not in settings.station_files:
            raise source.wrong(("ranges", name), f"expected {name} under ranging, too, got none")
        with source.naming(("ranges", name)):
            rso = sheets.parse_rso(name, settings.rsos)
            if name in settings.tracks | settings.fixes | settings.elements:
                raise InputError("expected ranges, tracks, fixes or elements, got more than one of them")
            _check_files(source, settings, name)
        if name not in settings.starts and not math.isfinite(rso.a):
            expected = "expected elements, or a file under starts, as ranges alone tell no first orbit"
            raise source.wrong(("rsos", name), f"{expected}, got neither")


def _check_files(source: Source, settings: Settings, name: str) -> None:
    """Raise InputError where no ranges could be made of an RSO's files, or a station of theirs is nowhere."""
    # Brings the compiled kernels with it, half a second that no other plan should wait for.
    from opml.catalog.fit import laser_ranges

    epoch, duration = source.values["epoch"], DAY * source.values["duration_days"]
    points, without = crd.read(settings.ranges[name], epoch=epoch), settings.ranging(name).without
    points = laser_ranges.of_run(points, duration, without=without)
    coordinates, eccentricities = settings.station_files[name]
    sites = laser_ranges.Sites(sinex.read_coordinates(coordinates), sinex.read_eccentricities(eccentricities))
    laser_ranges.positions(points, sites, epoch=epoch)
