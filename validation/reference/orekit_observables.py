"""Have Orekit measure states, with light time and without noise:

    PYTHONPATH=tests python -m validation.reference.orekit_observables <Orekit's data>

Every kind of measurement by the paper's stations, of its RSOs and one of a day's period, each a few hours
apart on its Kepler orbit. Needs the extra `verify`.
"""

import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
from support import kepler_orbit

from opml.base.constants import EARTH_GM
from opml.orbits.sheets import read_rsos, read_stations
from opml.tables import STATE
from validation import orekit
from validation.case import ROOT
from validation.orekit import org
from validation.tables import write_noted

EPOCH = "2016-09-28T12:09:45"
STEP, COUNT = 8171.0, 6


def orbits(rsos):
    """The Kepler orbit (COUNT rows) of each RSO, and of one that stays over a meridian."""
    still = replace(rsos["iss"], name="still", a=42164e3, e=0.1, i=0.3)
    for rso in (*rsos.values(), still):
        table = kepler_orbit(rso, duration=STEP * (COUNT - 0.5), step=STEP)
        yield table.assign(rso=rso.name)


def values(models, ground, state):
    """What the station measures of a spacecraft, one way and two."""
    measurements = org.orekit.estimation.measurements
    satellite, date = measurements.ObservableSatellite(0), state.getDate()

    def estimated(measurement):
        for driver in measurement.getParametersDrivers():
            driver.setReferenceDate(models.epoch)
        return list(measurement.estimateWithoutDerivatives([state]).getEstimatedValue())

    pair = [0.0, 0.0], [1.0, 1.0], [1.0, 1.0], satellite
    azimuth, elevation = estimated(measurements.AngularAzEl(ground, date, *pair))
    right_ascension, declination = estimated(measurements.AngularRaDec(ground, models.gcrf, date, *pair))
    row = {
        "azimuth": azimuth % (2.0 * np.pi),
        "elevation": elevation,
        "right_ascension": right_ascension % (2.0 * np.pi),
        "declination": declination,
    }
    for suffix, two_way in (("", False), ("_two_way", True)):
        single = 0.0, 1.0, 1.0
        distance = measurements.Range(ground, two_way, date, *single, satellite)
        rate = measurements.RangeRate(ground, date, *single, two_way, satellite)
        row[f"range{suffix}"], row[f"range_rate{suffix}"] = (estimated(one)[0] for one in (distance, rate))
    return row


def main(data):
    orekit.start(orekit.Data.find(data))
    models, config = orekit.Orekit(EPOCH), ROOT / "config"
    stations = read_stations(config / "stations.tsv")
    grounds = {
        name: org.orekit.estimation.measurements.GroundStation(models.topocentric(station))
        for name, station in stations.items()
    }
    rows = []
    for orbit in orbits(read_rsos(config / "rsos.tsv")):
        for row in orbit.to_dict("records"):
            state = models.spacecraft(row["t"], np.array([row[name] for name in STATE]), EARTH_GM)
            for name, ground in grounds.items():
                rows.append(row | {"station": name} | values(models, ground, state))
    head = (
        "States, and what stations receive of them; written by orekit_observables.py.",
        f"Orekit {orekit.version()}, t [s] from {EPOCH} UTC, SI units, radians, GCRF.",
    )
    write_noted("orekit_observables.csv", pd.DataFrame(rows), *head)


if __name__ == "__main__":
    main(*map(Path, sys.argv[1:]))
