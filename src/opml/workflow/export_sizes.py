"""What ephemerides from each estimate take as messages, told before a run makes them."""

import numpy as np
import pandas as pd

from opml.base.constants import DAY, HOUR
from opml.catalog.fit import fixes, laser_ranges, measured_tracks
from opml.catalog.simulate import tracking, truth
from opml.environment import earth_orientation, nodes
from opml.interop import crd, oem, points_from_files, tdm, truth_from_orbit
from opml.interop.element_sets import histories
from opml.interop.orbit_from_files import OrbitFiles
from opml.orbits import sheets
from opml.orbits.sheets import Station
from opml.workflow.params import Params, Wildcards

_STEP = 60.0
"""Time between the epochs at which stations look for an RSO [s]; shorter passes are missed."""


def size_line(params: Params, wildcards: Wildcards) -> str:
    """Return a line on the messages of ephemerides from each estimate: their number and their size.

    There is an estimate at the start of each track. Raises InputError where no station sees the RSO, and as
    `Params.train_days` does.
    """
    settings = params.ephemeris(wildcards)
    step, max_days, end_days = settings["grid"]
    starts = _tracking(params, wildcards).groupby("track")["t"].min().to_numpy() / DAY
    newest = np.searchsorted(starts, settings["known_until_days"], side="right") - 1
    days = np.minimum(max_days, end_days - starts[max(newest, 0) :])
    size = oem.ephemeris_bytes(DAY * days.sum(), step)
    return (
        f"ephemerides of {wildcards.rso} from each estimate: about {len(days)} files of about "
        f"{_rounded(size / len(days) / 1e6)} MB each ({_rounded(size / 1e9)} GB in all)"
    )


def _rounded(value: float) -> str:
    """Return the text of a number in two digits, never as a power of ten where it is large."""
    return f"{float(f'{value:.2g}'):g}"


def _tracking(params: Params, wildcards: Wildcards) -> pd.DataFrame:
    """Return the tracks of an RSO; where they are still to be simulated, those of a Kepler orbit."""
    plan, rso = params.plan, wildcards.rso
    epoch, duration = plan.values["epoch"], DAY * plan.values["duration_days"]
    stations = [Station(**station) for station in params.stations(wildcards)]
    if rso in plan.tracks:
        return measured_tracks.tracks(tdm.measurements(plan.tracks[rso], epoch=epoch), stations)
    if rso in plan.elements:
        return _sets(params, wildcards)
    if rso in plan.ranges:
        points, without = crd.read(plan.ranges[rso], epoch=epoch), params.ranging(wildcards)["without"]
        return laser_ranges.of_run(points, duration, without=without)
    if rso in plan.fixes:
        return _fixes(params, wildcards)
    if rso in plan.orbits:
        alone = rso in plan.values.get("positions_alone", [])
        files = OrbitFiles(plan.orbits[rso], epoch, duration, positions_alone=alone)
        flown, _ = truth_from_orbit.truth(files, step=_STEP)
    else:
        orbit = sheets.parse_rso(rso, plan.settings.rsos)
        flown = truth.kepler_orbit(orbit, duration=duration, step=_STEP)
    orientation = earth_orientation.tabulate(epoch, nodes(epoch, duration))
    return tracking.simulate(flown, orientation, stations, rso=rso, seed=0)


def _sets(params: Params, wildcards: Wildcards) -> pd.DataFrame:
    """Return the epochs of an RSO's sets of mean elements, a track each."""
    values, history = params.plan.values, params.history(wildcards)
    found = histories.read(
        params.plan.elements[wildcards.rso],
        epoch=values["epoch"],
        leave_out_damaged=history["leave_out_damaged"],
    )
    sets = histories.of_object(found.sets, history["number"])
    within = sets[sets["t"].between(0.0, DAY * values["duration_days"])]
    return within[["t"]].assign(track=np.arange(len(within)))


def _fixes(params: Params, wildcards: Wildcards) -> pd.DataFrame:
    """Return the fixes of an RSO."""
    values, fixing = params.plan.values, params.fixing(wildcards)
    files = OrbitFiles(params.plan.fixes[wildcards.rso], values["epoch"], DAY * values["duration_days"])
    orientation = earth_orientation.tabulate(files.epoch, nodes(files.epoch, files.duration))
    sampling = points_from_files.Sampling(fixing["sigmas"], fixing["every_s"])
    points = points_from_files.read(files, orientation, sampling)
    return fixes.stretches(points, length=HOUR * fixing["stretch_hours"])
