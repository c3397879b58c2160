"""Names of lines at their right ends, on a logarithmic axis."""

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.axes import Axes

from opml.figures.style import NOTE_SIZE

LABEL_STEP = 0.05  # least distance of names, in parts of the axis: a line of their type


def name_ends(axes: Axes, ends: Mapping[str, float], colors: Mapping[str, str]) -> None:
    """Write the names of lines at their right ends, moved until they do not overlap.

    ends: values that lines end at, by name
    colors: by name
    """
    low, high = np.log10(axes.get_ylim())
    names = sorted(ends, key=ends.__getitem__)
    places = push_apart([ends[name] for name in names], LABEL_STEP * (high - low))
    for name, place in zip(names, places, strict=True):
        axes.annotate(
            name,
            (1.0, ends[name]),
            xycoords=axes.get_yaxis_transform(),
            xytext=(1.05, place),
            textcoords=axes.get_yaxis_transform(),
            arrowprops={
                "arrowstyle": "-",
                "color": colors[name],
                "lw": 0.5,
                "shrinkA": 0.0,
                "shrinkB": 1.0,
                "relpos": (0.0, 0.5),
            },
            fontsize=NOTE_SIZE,
            color=colors[name],
            va="center",
            annotation_clip=False,
        )


def push_apart(values: Sequence[float], least: float) -> np.ndarray:
    """Return ascending values moved to distances of at least `least` [powers of ten], as many up as down."""
    wanted = np.log10(np.asarray(values, float))
    steps = least * np.arange(len(wanted))
    spaced = np.maximum.accumulate(wanted - steps) + steps
    return 10.0 ** (spaced - np.mean(spaced - wanted) if len(wanted) else spaced)
