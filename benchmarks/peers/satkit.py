"""satkit, a Rust library: https://github.com/ssmichael1/satkit, MIT."""

import datetime
import os
import tempfile
from itertools import pairwise
from pathlib import Path

import astropy_iers_data
import numpy as np
import satkit
import satkit_data

from benchmarks import case
from benchmarks.case import Arcs
from benchmarks.peers import activity
from benchmarks.peers.settings import steps, tolerances

_DATA = {
    "linux_p1550p2650.440": Path(satkit_data.__file__).parent / "data" / "linux_p1550p2650.440",
    "finals2000A.all": Path(astropy_iers_data.IERS_A_FILE),
}
_ACTIVITY = "Kp_ap_Ap_SN_F107_since_1932.txt"


def _verner(*digits):
    """Return the options of Verner's method by what a report calls them."""
    return {
        name: {"integrator": satkit.integrator.rkv98, "abs_error": tolerance, "rel_error": tolerance}
        for name, tolerance in tolerances(*digits).items()
    }


def _gauss_jackson(*lengths):
    """Return the options of the multistep method."""
    return {
        name: {"integrator": satkit.integrator.gauss_jackson8, "gj_step_seconds": length}
        for name, length in steps(*lengths).items()
    }


class _Satkit:
    """What both integrators share: 20x20 gravity, Sun, Moon, drag, pressure; no tides, no relativity."""

    title = f"satkit {satkit.__version__}"
    model = "EGM2008 20x20, Sun, Moon (DE440), NRLMSISE-00 with the same activity, radiation pressure"
    pressure = True
    share = 100
    sample = 8
    tight = _verner(13, 14)

    def __init__(self):
        self.folder = tempfile.TemporaryDirectory()
        for name, path in _DATA.items():
            os.symlink(path, Path(self.folder.name) / name)
        (Path(self.folder.name) / _ACTIVITY).write_text(_activity_file())
        satkit.utils.set_offline(True)
        satkit.utils.set_datadir(self.folder.name)
        self.epoch = satkit.time.from_string(case.paper().epoch)
        self.made = {name: self._with(options) for name, options in (self.settings | self.tight).items()}

    def _with(self, options):
        """Return the force model, with the options of an integrator."""
        settings = satkit.propsettings(
            gravity_model=satkit.gravmodel.egm2008,
            gravity_degree=20,
            gravity_order=20,
            tide_model=satkit.tidemodel.none,
            use_relativistic_correction=False,
            enable_interp=False,
            **options,
        )
        # Sun and Moon once for all arcs.
        settings.precompute_terms(self.epoch, self.epoch + satkit.duration(days=2.0 * case.DAYS + 0.01))
        return settings

    def fly(self, arcs: Arcs, setting: str) -> np.ndarray:
        """Fly at one of the settings; the tight ones are Verner's, for either method."""
        settings = self.made[setting]
        body = satkit.satproperties(cdaoverm=arcs.ballistic, craoverm=arcs.reflection)
        return np.array(
            [
                self._arc(t, state, _stops(arcs, t, settings), settings, body)
                for t, state in zip(arcs.t, arcs.states, strict=True)
            ]
        )

    def _arc(self, t, state, stops, settings, body):
        for begin, end in pairwise([t, *stops]):
            state = satkit.propagate(
                state,
                self.epoch + satkit.duration(seconds=float(begin)),
                duration_secs=float(end - begin),
                propsettings=settings,
                satproperties=body,
            ).state
        return state

    def twin(self, arcs: Arcs) -> np.ndarray:
        """Fly ours, whose Jupiter and limb of the shadow satkit lacks: both are below a metre."""
        return case.fly(case.force_model("assumed"), arcs)


class RungeKutta(_Satkit):
    """Verner's method; 1e-8 is satkit's own default."""

    method = "Verner 9(8)"
    way = "Sun and Moon tabulated for all arcs, stops at midnights"
    settings = _verner(7, 8, 9, 11, 12)
    raced = "tolerance 1e-8"


class GaussJackson(_Satkit):
    """The multistep method, which needs the fewest evaluations; in the race at our longest step."""

    method = "Gauss-Jackson 8"
    way = "Sun and Moon tabulated for all arcs"
    settings = _gauss_jackson(120.0, 90.0, 60.0, 30.0, 10.0)
    raced = "90 s"


def _stops(arcs, t, settings):
    """Return the ends of an arc's legs: midnights too, but for a method that begins anew at each."""
    if settings.integrator == satkit.integrator.gauss_jackson8:
        return [t + arcs.duration]
    return arcs.stops(t)


def _activity_file():
    """Return the run's solar activity in GFZ's format of Kp, ap, Ap, SN and F10.7, day by day."""
    origin = datetime.date(1932, 1, 1)
    lines = [
        "# year month day, days since 1932, rotation, 8 Kp, 8 ap, Ap, SN, F10.7 observed, adjusted, status"
    ]
    for day, f107, ap in activity.daily():
        count = (day - origin).days
        kp, aps = " ".join(["2.000"] * 8), " ".join([f"{ap:.0f}"] * 8)
        lines.append(
            f"{day:%Y %m %d} {count} {count + 0.5} 2490 1 {kp} {aps} {ap:.0f} 40 {f107:.1f} {f107:.1f} 2"
        )
    return "\n".join(lines) + "\n"
