"""One look for every figure: a journal column's sizes, colours with one meaning each, files of stable bytes.

Importing this module sets matplotlib's defaults for the process; it opens no window.
"""

import textwrap
from collections.abc import Iterable, Mapping

import matplotlib
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.legend import Legend
from matplotlib.lines import Line2D
from mpl_toolkits.mplot3d import Axes3D

from opml.base.files import FilePath, replacing

COLUMN_WIDTH_MM = 88.0  # one column of a two-column page
PAGE_WIDTH_MM = 180.0  # both columns
MM_PER_INCH = 25.4

# Okabe & Ito's palette (Color Universal Design, 2008): told apart under every common colour blindness.
TRUE = "#000000"
PREDICTED = "#0072B2"
RESIDUAL = "#D55E00"
MUTED = "#8A8A8A"  # context behind the subject
PUBLISHED = "#4D4D4D"  # figures from a publication, always as hollow markers
OBSERVED = "#009E73"  # where a station saw the RSO
ESTIMATE = "#CC79A7"
TRACK = "#56B4E9"
HIGHLIGHT = "#E69F00"  # what a figure points at: tracks used, days enlarged, values beyond a limit
# Several curves of what is left of the errors, by colours of the palette and by marker.
SERIES = (RESIDUAL, PREDICTED, OBSERVED, ESTIMATE)
MARKERS = "osD^"
# Curves in an order, such as durations, from light to dark.
RAMP = ("#F5B887", "#E07B28", "#A84400", "#4F2000")
# Reasons why rows are not used.
REASONS = (RESIDUAL, HIGHLIGHT, ESTIMATE, "#7A3200", MUTED)

NOTE_SIZE = 6.5
"""Type of what a figure says of itself in a small line [pt]."""

NOTE_ADVANCE = 0.52
"""Mean width of a letter of that line, in its size; what is set so stays inside the figure."""

POINTS_PER_INCH = 72.0
LEAST_ALPHA = 0.4

matplotlib.rcParams.update(
    {
        "font.family": "DejaVu Sans",  # comes with matplotlib, so the same on every machine
        "font.size": 8.0,
        "axes.labelsize": 8.0,
        "xtick.labelsize": 7.5,
        "ytick.labelsize": 7.5,
        "legend.fontsize": 7.5,
        "legend.frameon": False,
        "axes.linewidth": 0.7,
        "axes.spines.top": False,
        "axes.spines.right": False,
        "axes.grid": True,
        "axes.axisbelow": True,
        "grid.color": "#E3E3E3",
        "grid.linewidth": 0.6,
        "lines.linewidth": 1.4,
        "lines.markersize": 4.5,
        "pdf.fonttype": 42,  # text stays text
        "savefig.dpi": 300.0,
    }
)


def column_figure(*, height_mm: float) -> tuple[Figure, Axes]:
    """Empty figure of column width with one pair of axes; its layout follows its contents."""
    figure = _figure(COLUMN_WIDTH_MM, height_mm)
    return figure, figure.add_subplot()


def space_figure(*, height_mm: float) -> tuple[Figure, Axes3D]:
    """Empty figure of column width with axes in three dimensions."""
    figure = _figure(COLUMN_WIDTH_MM, height_mm)
    return figure, figure.add_subplot(projection="3d")


def page_figure(*, height_mm: float) -> Figure:
    """Empty figure of page width without axes; its layout follows its contents."""
    return _figure(PAGE_WIDTH_MM, height_mm)


def _figure(width_mm: float, height_mm: float) -> Figure:
    figure = Figure(figsize=(width_mm / MM_PER_INCH, height_mm / MM_PER_INCH), layout="constrained")
    FigureCanvasAgg(figure)
    return figure


def labelled(figure: Figure) -> dict[str, Artist]:
    """What the legend of a figure of several panels shows: by label, each once."""
    return dict(
        pair for axes in figure.axes for pair in zip(*axes.get_legend_handles_labels()[::-1], strict=True)
    )


def legend(
    figure: Figure,
    *,
    columns: int,
    note: str = "",
    labels: Mapping[str, Artist] | None = None,
) -> Legend:
    """One legend above all panels, under a note in small type; faint and tiny marks are made stronger.

    `labels`: what is shown by label, None for all that the panels have.
    """
    shown = labelled(figure) if labels is None else labels
    made = figure.legend(
        shown.values(),
        shown.keys(),
        loc="outside upper left",
        ncols=columns,
        title=_wrapped(figure, note),
        title_fontsize=NOTE_SIZE,
        alignment="left",
        columnspacing=1.2,
    )
    made.get_title().set_color(PUBLISHED)
    for handle in filter(None, made.legend_handles):
        if (alpha := handle.get_alpha()) is not None:
            handle.set_alpha(max(float(alpha), LEAST_ALPHA))
        if isinstance(handle, Line2D):
            handle.set_markersize(max(handle.get_markersize(), 4.0))
    return made


def noted(figure: Figure, note: str) -> None:
    """Put a note in small type above the panels of a figure that has no legend."""
    if note:
        figure.suptitle(_wrapped(figure, note), x=0.01, ha="left", fontsize=NOTE_SIZE, color=PUBLISHED)


def _wrapped(figure: Figure, note: str) -> str:
    """The note in lines that fit the figure's width; its own line breaks stay."""
    room = int(0.94 * figure.get_figwidth() * POINTS_PER_INCH / (NOTE_ADVANCE * NOTE_SIZE))
    return "\n".join(textwrap.fill(line, room) for line in note.splitlines())


def save(figure: Figure, path_pdf: FilePath, path_png: FilePath) -> None:
    """Write the figure as PDF and PNG, each whole or not at all; the same figure gives the same bytes."""
    _write(figure, path_pdf, "pdf", metadata={"CreationDate": None})
    _write(figure, path_png, "png", metadata={"Software": None})


def save_all(figures: Iterable[Figure], paths_pdf: Iterable[FilePath], paths_png: Iterable[FilePath]) -> None:
    """`save` each figure under the paths of its place. Raises ValueError for another number of paths."""
    for figure, path_pdf, path_png in zip(figures, paths_pdf, paths_png, strict=True):
        save(figure, path_pdf, path_png)


def _write(figure: Figure, path: FilePath, kind: str, *, metadata: dict[str, None]) -> None:
    with replacing(path) as temporary:
        figure.savefig(temporary, format=kind, metadata=metadata)
