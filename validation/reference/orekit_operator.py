"""Tracks of weeks for a whole operator's chain, and what came of it, both by Orekit:

    python -m validation.reference.orekit_operator write <Orekit's larger tables> <Orekit's data> <folder>
    python -m validation.reference.orekit_operator open <corrected.oem> <Orekit's data> <folder>

`write` flies Orekit's orbit of the paper's RSO on to 35 days and leaves it in the folder (`orbit.parquet`),
with the tracks of its first 28 days (`iss.tdm`: three stations, every minute, with their noise). `open` reads
an ephemeris that was made of these tracks, holds it against the orbit, and propagates from its first state.
Needs the extra `verify`.
"""

import sys
from pathlib import Path

import numpy as np
import pandas as pd

from opml.base.constants import DAY
from opml.orbits.elements import in_rsw
from opml.orbits.sheets import read_stations
from validation import orekit
from validation.case import ROOT, Case
from validation.orekit import org
from validation.reference import orekit_tdm
from validation.reference.excerpt import STATE

ORBIT_DAYS, TRACK_DAYS, STEP = 35.0, 28.0, 60.0
MARKS = (0.25, 1.0, 2.0, 3.0, 5.0, 7.0)
"""Times after the start of an ephemeris that it is looked at, each with the quarter day before it [days]."""


def forces(models, case, model):
    """Orekit's forces of the paper's RSO under the model 'truth' or 'assumed', and the field's GM."""
    settings = case.force_models[model]
    field = models.field(settings["degree"], settings["order"])
    return models.forces(settings, case.rsos["iss"]), field.getMu()


def write(tables, data, folder):
    """The orbit, and its tracks as a TDM."""
    orekit.start(orekit.Data.find(data))
    models, case = orekit.Orekit(orekit_tdm.EPOCH), Case.read()
    known = pd.read_parquet(tables / "iss_truth_2d_60s.parquet").rename(columns=STATE)
    names, t = list(STATE.values()), np.arange(0.0, ORBIT_DAYS * DAY + 1.0, STEP)
    pulls, gm = forces(models, case, "truth")
    states = models.interpolate(known[names].to_numpy()[0], gm, t, pulls, case.integrator)
    apart = states[: len(known), :3] - known[names[:3]].to_numpy()
    print(f"from the two days that are known: {np.linalg.norm(apart, axis=1).max():.3f} m at most")
    orbit = pd.DataFrame({"t": t} | dict(zip(names, states.T, strict=True)))
    orbit.to_parquet(folder / "orbit.parquet")
    stations = read_stations(ROOT / "config" / "stations.tsv")
    tdm = org.orekit.files.ccsds.ndm.tdm
    message, _ = orekit_tdm.message(models, tdm, orbit[orbit["t"] <= TRACK_DAYS * DAY], stations)
    orekit_tdm.save(message, folder / "iss.tdm")


def read(path):
    """The first segment of an OEM, as Orekit's parser reads it."""
    parser = org.orekit.files.ccsds.ndm.ParserBuilder().buildOemParser()
    return parser.parseMessage(org.orekit.data.DataSource(str(path))).getSegments()[0]


def sigmas(models, segment):
    """Times [s] of the covariances, and the standard deviations (n, 3) [m] of the position in RSW."""
    found = list(segment.getCovarianceMatrices())
    matrices = [one.getCovarianceMatrix() for one in found]
    t = [one.getEpoch().durationFrom(models.epoch) for one in found]
    return np.array(t), np.sqrt([[matrix.getEntry(k, k) for k in range(3)] for matrix in matrices])


def told(t, off, sigma):
    """Print sizes of errors `off` (n, 3) [m] in RSW, what was stated of them, and what lay inside 90 %."""
    print("day | r.m.s. radial, along, cross [m] | sigma along [m] | inside the 90 % interval [%]")
    for day in MARKS:
        own = (t > (day - 0.25) * DAY) & (t <= day * DAY)
        sizes, inside = np.sqrt((off[own] ** 2).mean(axis=0)), abs(off[own]) <= 1.645 * sigma[own]
        print(day, sizes.round(1), sigma[own, 1].mean().round(1), (100.0 * inside.mean(axis=0)).round(1))


def open_again(path, data, folder):
    """An ephemeris against the orbit, and against what Orekit flies from its first state."""
    orekit.start(orekit.Data.find(data))
    models, case = orekit.Orekit(orekit_tdm.EPOCH), Case.read()
    segment, orbit = read(path), pd.read_parquet(folder / "orbit.parquet")
    between = segment.getPropagator()
    first, last = (date.durationFrom(models.epoch) for date in (segment.getStart(), segment.getStop()))
    true = orbit[orbit["t"].between(first, last)]
    t, expected = true["t"].to_numpy(), np.ascontiguousarray(true[list(STATE.values())])
    states = np.array([models.state(between.getPVCoordinates(models.date(time), models.gcrf)) for time in t])
    when, sigma = sigmas(models, segment)
    at = np.stack([np.interp(t, when, column) for column in sigma.T], axis=1)
    print(f"{path.name}: days {first / DAY:.3f} to {last / DAY:.3f}; against Orekit's orbit:")
    told(t - t[0], in_rsw(states - expected, expected)[:, :3], at)
    pulls, gm = forces(models, case, "assumed")
    free = models.interpolate(states[0], gm, t, pulls, case.integrator, begin=t[0])
    print("Orekit's flight from its first state, against the same orbit:")
    told(t - t[0], in_rsw(free - expected, expected)[:, :3], at)


if __name__ == "__main__":
    {"write": write, "open": open_again}[sys.argv[1]](*map(Path, sys.argv[2:]))
