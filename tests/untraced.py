"""Coverage follows lines of libraries, too: not while figures are written, which took twice the time."""

import sys

from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter

_save = Figure.savefig


def _is_ours(figure):
    """Whether functions of opml write the figure's ticks."""
    axes = [axis for part in figure.axes for axis in (part.xaxis, part.yaxis)]
    return any(isinstance(axis.get_major_formatter(), FuncFormatter) for axis in axes)


def _save_untraced(figure, *given, **options):
    if _is_ours(figure):
        return _save(figure, *given, **options)
    trace = sys.gettrace()
    sys.settrace(None)
    try:
        return _save(figure, *given, **options)
    finally:
        sys.settrace(trace)


def leave_drawing_out():
    """Have figures written without what follows lines."""
    Figure.savefig = _save_untraced
