"""Have Orekit write two days of tracks as a TDM:

    python -m validation.reference.orekit_tdm <Orekit's larger tables> <Orekit's data>

Azimuth, elevation, range and range rate that Orekit computes from its own orbit of the paper's RSO, for the
paper's stations, with their noise; and the orbit at the measured times. Needs the extra `verify`.
"""

import sys
from pathlib import Path

import numpy as np
import pandas as pd

from opml.orbits.sheets import read_stations
from validation import orekit
from validation.case import ROOT, TABLES
from validation.orekit import java, org
from validation.reference.excerpt import STATE
from validation.tables import write_noted

EPOCH = "2016-09-28T12:09:45"
PATHS = {"eglin": (1, 2, 1), "clear": (1, 2), "kaena": (2, 1)}
"""One of each kind: a radar that sends and receives, and two that receive, named second and first."""


def measured(models, station, orbit, generator):
    """Rows (t, azimuth, elevation, range, range rate) of what a station sees of the orbit, with noise."""
    horizon, rows = models.topocentric(station), []
    sigma = [station.sigma_azimuth, station.sigma_elevation, station.sigma_range]
    for t, *state in orbit.itertuples(index=False):
        date, (position, velocity) = models.date(t), map(models.vector, (state[:3], state[3:]))
        local = horizon.getTrackingCoordinates(position, models.gcrf, date)
        if station.min_elevation <= local.getElevation() and local.getRange() <= station.max_range:
            pv = org.orekit.utils.PVCoordinates(position, velocity)
            rate = horizon.getRangeRate(pv, models.gcrf, date)
            values = [local.getAzimuth(), local.getElevation(), local.getRange()]
            rows.append([t, *(values + generator.normal(size=3) * sigma), rate])
    return np.array(rows)


def segment(models, tdm, name, path, rows):
    """A segment of Orekit's: one pass over a station."""
    metadata, block = tdm.TdmMetadata(), tdm.ObservationsBlock()
    metadata.setTimeSystem(org.orekit.files.ccsds.definitions.TimeSystem.UTC)
    station = path[-1]
    metadata.addParticipant(station, name.upper())
    metadata.addParticipant(3 - station, "ISS")
    metadata.setMode(tdm.TrackingMode.SEQUENTIAL)
    metadata.setPath(path)
    metadata.setAngleType(tdm.AngleType.AZEL)
    metadata.setRangeUnits(tdm.RangeUnits.km)
    types = [getattr(tdm.ObservationType, kind) for kind in ("ANGLE_1", "ANGLE_2", "RANGE")]
    types.append(tdm.ObservationType.DOPPLER_INSTANTANEOUS)
    for t, *values in rows.tolist():
        for kind, value in zip(types, values, strict=True):
            block.addObservation(kind, models.date(t), value)
    return org.orekit.files.ccsds.section.Segment(metadata, block)


def message(models, tdm, orbit, stations):
    """All passes, in the order of time, and the times that anything was measured."""
    generator, passes = np.random.default_rng(2016), []
    for name, station in stations.items():
        rows = measured(models, station, orbit, generator)
        breaks = np.flatnonzero(np.diff(rows[:, 0]) > 90.0) + 1
        passes += [(part[0, 0], name, part) for part in np.split(rows, breaks)]
    passes.sort(key=lambda one: one[:2])
    segments = java.util.ArrayList()
    for _, name, rows in passes:
        segments.add(segment(models, tdm, name, PATHS[name], rows))
    header = tdm.TdmHeader()
    header.setFormatVersion(2.0)
    header.setCreationDate(models.epoch)
    header.setOriginator("OREKIT")
    context = org.orekit.data.DataContext.getDefault()
    whole = tdm.Tdm(header, segments, org.orekit.utils.IERSConventions.IERS_2010, context)
    return whole, np.unique(np.concatenate([rows[:, 0] for *_, rows in passes]))


def save(message, path):
    """A message of Orekit's as text."""
    buffer = java.lang.StringBuilder()
    generator = org.orekit.files.ccsds.utils.generation.KvnGenerator(buffer, 25, "iss", 60.0, 0)
    org.orekit.files.ccsds.ndm.WriterBuilder().buildTdmWriter().writeMessage(generator, message)
    path.write_text(str(buffer), encoding="utf-8")


def main(tables, data):
    orekit.start(orekit.Data.find(data))
    models, tdm = orekit.Orekit(EPOCH), org.orekit.files.ccsds.ndm.tdm
    orbit = pd.read_parquet(tables / "iss_truth_2d_60s.parquet").rename(columns={"t_s": "t"} | STATE)
    stations = read_stations(ROOT / "config" / "stations.tsv")
    whole, times = message(models, tdm, orbit[["t", *STATE.values()]], stations)
    save(whole, TABLES / "orekit.tdm")
    head = (
        "The true orbit at the times of orekit.tdm, GCRF; written by orekit_tdm.py.",
        f"Orekit 13.1.9, the paper's case. t [s] from {EPOCH} UTC, SI units.",
    )
    write_noted("orekit_tdm_orbit.csv", orbit[orbit["t"].isin(times)], *head)


if __name__ == "__main__":
    main(*map(Path, sys.argv[1:]))
