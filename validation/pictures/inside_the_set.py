"""The picture of docs/inside.md: a day of one satellite by SGP4 and by the orbit inside its sets.

    python -m validation.pictures.inside_the_set ORBIT SETS...

ORBIT is a precise orbit (Sentinel-3A's), SETS are its element sets, of which those after DATE do not count.
"""

import sys
from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from opml.base import epochs
from opml.base.constants import DAY, HOUR
from opml.element_sets import prediction
from opml.figures import style
from opml.interop import known_orbits
from opml.interop.element_sets import mean_elements
from opml.interop.ephemeris import EPOCH
from opml.orbits.elements import bent_rsw
from validation.pictures import shrunk

DATE, NAME = "2018-12-28T06:00:00", "Sentinel-3A, 804 km"
AXES = ("radial", "along-track", "cross-track")

_T = np.arange(0.0, DAY + 1.0, 120.0)
_LOOKS = {"SGP4": style.PREDICTED_COLOR, "orbit inside": style.RESIDUAL}


def errors(orbit: known_orbits.KnownOrbit, sets: Sequence[str]) -> dict[str, np.ndarray]:
    """Return what SGP4 and the orbit inside are off over a day, (times, 3) in RSW [m]."""
    predicted = prediction.predict(sets, date=DATE, days=1.0)
    truth = orbit.at(epochs.seconds_between(EPOCH, DATE) + _T)
    states = (mean_elements.states(predicted.published, epoch=DATE, t=_T), predicted.states(_T))
    return {name: bent_rsw(one[:, :3], truth) for name, one in zip(_LOOKS, states, strict=True)}


def inside_the_set(off: Mapping[str, np.ndarray]) -> Figure:
    """Draw a panel an axis: errors over a day, SGP4's and those of the orbit inside."""
    figure = style.page_figure(height_mm=105.0)
    rows = figure.subplots(3, 1, sharex=True, squeeze=False)[:, 0]
    for k, (axes, name) in enumerate(zip(rows, AXES, strict=True)):
        _draw(axes, name, {method: one[:, k] for method, one in off.items()})
    rows[-1].set_xlabel("hours after the morning")
    rms = {name: np.sqrt((one**2).mean(axis=0)) for name, one in off.items()}
    sgp4, inside = (" / ".join(f"{size:.0f}" for size in rms[name]) for name in _LOOKS)
    headline = f"The same public set: {sgp4} m off by SGP4, {inside} m by the orbit inside it"
    note = (
        f"{NAME}, errors against its DORIS orbit on {DATE[:10]}, sets and weather known at 06 UTC; in the "
        "headline root mean squares, radial / along-track / cross-track"
    )
    style.add_head_and_legend(figure, headline, note, columns=2)
    return figure


def _draw(axes: Axes, name: str, off: Mapping[str, np.ndarray]) -> None:
    for method, values in off.items():
        axes.plot(_T[: len(values)] / HOUR, values, color=_LOOKS[method], lw=1.0, label=method)
    axes.set_ylabel(f"{name} [m]")
    axes.set_xlim(0.0, DAY / HOUR)


def main(arguments: Sequence[str]) -> None:
    """Draw the picture and shrink it."""
    orbit = known_orbits.read(arguments[:1])
    shrunk.save(inside_the_set(errors(orbit, arguments[1:])), "inside_the_set")


if __name__ == "__main__":
    main(sys.argv[1:])
