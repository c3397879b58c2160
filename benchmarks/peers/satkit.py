"""satkit, a Rust library: https://github.com/ssmichael1/satkit, MIT."""

import datetime
import os
import tempfile
from pathlib import Path

import astropy_iers_data
import numpy as np
import satkit
import satkit_data

from benchmarks import case
from benchmarks.case import Arcs
from benchmarks.peers import activity

_DATA = {
    "linux_p1550p2650.440": Path(satkit_data.__file__).parent / "data" / "linux_p1550p2650.440",
    "finals2000A.all": Path(astropy_iers_data.IERS_A_FILE),
}
_ACTIVITY = "Kp_ap_Ap_SN_F107_since_1932.txt"


class _Satkit:
    """What both integrators share: 20x20 gravity, Sun, Moon, drag, pressure; no tides, no relativity."""

    title = f"satkit {satkit.__version__}"
    model = "EGM2008 20x20, Sun, Moon (DE440), NRLMSISE-00 with the same activity, radiation pressure"
    share = 100

    def __init__(self):
        self.folder = tempfile.TemporaryDirectory()
        for name, path in _DATA.items():
            os.symlink(path, Path(self.folder.name) / name)
        (Path(self.folder.name) / _ACTIVITY).write_text(_activity_file())
        satkit.utils.set_offline(True)
        satkit.utils.set_datadir(self.folder.name)
        self.epoch = satkit.time.from_string(case.paper().epoch)
        self.settings = self._settings(**self.options)
        self.tight = self._settings(integrator=satkit.integrator.rkv98, abs_error=1e-12, rel_error=1e-12)

    def _settings(self, **options):
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

    def fly(self, arcs: Arcs) -> np.ndarray:
        """At the settings of the race."""
        return self._fly(arcs, self.settings)

    def fly_tightly(self, arcs: Arcs) -> np.ndarray:
        """By the Runge-Kutta method at 1e-12, for either method."""
        return self._fly(arcs, self.tight)

    def _fly(self, arcs, settings):
        body = satkit.satproperties(cdaoverm=arcs.ballistic, craoverm=arcs.reflection)
        return np.array(
            [
                satkit.propagate(
                    state,
                    self.epoch + satkit.duration(seconds=float(t)),
                    duration_secs=arcs.duration,
                    propsettings=settings,
                    satproperties=body,
                ).state
                for t, state in zip(arcs.t, arcs.states, strict=True)
            ]
        )

    def twin(self, arcs: Arcs) -> np.ndarray:
        """Ours, whose Jupiter and limb of the shadow satkit lacks: both are below a metre."""
        return case.fly(case.force_model("assumed"), arcs)


class RungeKutta(_Satkit):
    """Verner's method, at satkit's own default tolerances."""

    integrator = "Verner 9(8), tolerances 1e-8 (its defaults); Sun and Moon tabulated for all arcs"

    def __init__(self):
        self.options = {"integrator": satkit.integrator.rkv98, "abs_error": 1e-8, "rel_error": 1e-8}
        super().__init__()


class GaussJackson(_Satkit):
    """The multistep method, which needs the fewest evaluations, at our longest step."""

    integrator = "Gauss-Jackson 8, steps of 90 s; Sun and Moon tabulated for all arcs"

    def __init__(self):
        self.options = {"integrator": satkit.integrator.gauss_jackson8, "gj_step_seconds": 90.0}
        super().__init__()


def _activity_file():
    """The run's solar activity in the format of GFZ's file of Kp, ap, Ap, SN and F10.7, day by day."""
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
