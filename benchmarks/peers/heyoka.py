"""heyoka: Taylor's method, compiled for the equations (https://github.com/bluescarni/heyoka.py, MPL-2.0)."""

from functools import cache

import erfa
import heyoka
import numpy as np

from benchmarks import case
from benchmarks.case import Arcs
from benchmarks.peers import activity
from benchmarks.peers.settings import tolerances

_BATCH = 8
"""Arcs in a batch: one AVX-512 register of doubles."""

_KM = 1e-3


class Heyoka:
    """Its own dynamics of Earth orbits (`heyoka.model.eo_dynamics`), which have no radiation pressure."""

    title = f"heyoka {heyoka.__version__}"
    model = "EGM2008 20x20, Sun, Moon (VSOP2013, ELP2000 to 1e-4), NRLMSISE-00 as a network, same activity"
    method = "Taylor"
    way = f"batches of {_BATCH} arcs, fast_math"
    settings = tolerances(8, 9, 10, 11, 12)
    raced = "tolerance 1e-9"
    tight = tolerances(14, 15)
    pressure = False
    share = 100
    sample = _BATCH

    def __init__(self):
        self.epoch = _tt(case.paper().epoch)

    def fly(self, arcs: Arcs, setting: str) -> np.ndarray:
        """Fly at one of the settings; its first flight compiles the equations."""
        taylor = _taylor((self.settings | self.tight)[setting], self.epoch)
        ends = np.empty((len(arcs), 6))
        for begin in range(0, len(arcs), _BATCH):
            members = np.arange(begin, min(begin + _BATCH, len(arcs)))
            lanes = np.pad(members, (0, _BATCH - len(members)), mode="edge")
            taylor.set_time(self.epoch + arcs.t[lanes])
            taylor.state[:] = arcs.states[lanes].T * _KM
            taylor.pars[:] = arcs.ballistic
            taylor.propagate_until(self.epoch + arcs.t[lanes] + arcs.duration)
            ends[members] = taylor.state.T[: len(members)] / _KM
        return ends

    def twin(self, arcs: Arcs) -> np.ndarray:
        """Fly ours without radiation pressure."""
        return case.fly(case.force_model("assumed"), arcs.without_pressure())


@cache
def _taylor(tolerance, epoch):
    """Compile the equations for a tolerance."""
    dynamics = heyoka.model.eo_dynamics(
        max_geo_degree=20,
        max_geo_order=20,
        Cb=heyoka.par[0],
        elp2000_thresh=1e-4,
        vsop2013_thresh=1e-4,
        sw_data=_activity(),
    )
    start = np.repeat([[7000.0], [0.0], [0.0], [0.0], [7.5], [0.0]], _BATCH, axis=1)
    return heyoka.taylor_adaptive_batch(
        dynamics,
        start,
        time=np.full(_BATCH, epoch),
        pars=np.zeros((1, _BATCH)),
        tol=tolerance,
        compact_mode=True,
        fast_math=True,
    )


def _tt(epoch):
    """Return the seconds of Terrestrial Time from J2000 to an epoch in UTC text."""
    year, month, day = map(int, epoch[:10].split("-"))
    hour, minute, second = epoch[11:].split(":")
    utc = erfa.dtf2d("UTC", year, month, day, int(hour), int(minute), float(second))
    tt = erfa.taitt(*erfa.utctai(*utc))
    return ((tt[0] - erfa.DJ00) + tt[1]) * erfa.DAYSEC


def _activity():
    """Return the run's solar activity as heyoka's space weather."""
    days = list(activity.daily())
    table = np.zeros(len(days), dtype=heyoka.sw_data_row)
    table["mjd"] = [date.toordinal() - 678576.0 for date, _, _ in days]
    table["f107"] = table["f107a_center81"] = [f107 for _, f107, _ in days]
    table["Ap_avg"] = [ap for _, _, ap in days]
    return heyoka.sw_data(data=table, timestamp="2016_09_28", identifier="msafe")
