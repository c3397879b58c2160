"""The look of every figure: a journal column's sizes, colours with one meaning each, files of stable bytes.

Importing this module sets matplotlib's defaults for the process; it opens no window.
"""

import math
import textwrap
from collections.abc import Callable, Iterable, Sequence

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
PAGE_HEIGHT_MM = 297.0
SCREEN_WIDTH_MM = 100.0
MM_PER_INCH = 25.4

# Okabe & Ito's palette (Color Universal Design, 2008): distinct under every common colour blindness.
TRUE_COLOR = "#000000"
PREDICTED_COLOR = "#0072B2"
RESIDUAL = "#D55E00"
MUTED = "#8A8A8A"  # context behind the subject
PUBLISHED = "#4D4D4D"  # numbers from a publication, always as hollow markers
OBSERVED_COLOR = "#009E73"  # where a station saw the RSO
ESTIMATE = "#CC79A7"
TRACK_COLOR = "#56B4E9"
HIGHLIGHT = "#E69F00"  # what a figure points at: tracks used, days enlarged, values beyond a limit
# Several curves of corrected errors, by colours of the palette and by marker.
SERIES = (RESIDUAL, PREDICTED_COLOR, OBSERVED_COLOR, ESTIMATE)
MARKERS = "osD^"
# Curves in an order, such as durations, from light to dark.
RAMP = ("#F5B887", "#E07B28", "#A84400", "#4F2000")

NOTE_SIZE = 6.5  # size of the type of a figure's note [pt]

NOTE_ADVANCE = 0.54
"""Mean width of a letter of the note, in parts of its size; lines that are set so stay inside the figure."""

HEADLINE_SIZE = 9.0  # of the type [pt]

_HEAD_INCHES, _LINE_INCHES = 0.35, 0.11  # of a headline and a note of one line, and of each line more
_LEGEND_ROW = 1.5  # lines of a note that a row of a legend is as high as

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

# Matplotlib's settings of type, axes and lines as they are now, for figures that others make.
LOOK = matplotlib.rcParams.find_all(r"^(axes|font|grid|legend|lines|xtick|ytick)\b")


def column_figure(*, height_mm: float) -> tuple[Figure, Axes]:
    """Return an empty figure of column width with one pair of axes; its layout follows its contents."""
    figure = _figure(COLUMN_WIDTH_MM, height_mm)
    return figure, figure.add_subplot()


def space_figure(*, height_mm: float) -> tuple[Figure, Axes3D]:
    """Return an empty figure of column width with axes in three dimensions."""
    figure = _figure(COLUMN_WIDTH_MM, height_mm)
    return figure, figure.add_subplot(projection="3d")


def page_figure(*, height_mm: float) -> Figure:
    """Return an empty figure of page width without axes; its layout follows its contents."""
    return _figure(PAGE_WIDTH_MM, height_mm)


def screen_figure(*, height_mm: float = 70.0) -> Figure:
    """Return an empty figure whose words a phone still shows large enough."""
    return _figure(SCREEN_WIDTH_MM, height_mm)


def panel_figure(
    titles: Sequence[str],
    draw: Callable[[Axes, str], None],
    *,
    columns: int,
    heights_mm: tuple[float, float],
    share_y: bool = True,
) -> Figure:
    """Return a figure of page width with a panel for each title, row by row; all share the horizontal axis.

    draw: draws the panel of a title
    columns: of panels; more where the figure would be higher than a page
    heights_mm: of all that is no panel, and of a row of panels
    """
    frame_mm, row_mm = heights_mm
    columns = max(columns, math.ceil(len(titles) / ((PAGE_HEIGHT_MM - frame_mm) // row_mm)))
    rows = math.ceil(len(titles) / columns)
    figure = page_figure(height_mm=frame_mm + row_mm * rows)
    panels = figure.subplots(rows, columns, squeeze=False, sharex=True, sharey=share_y).ravel()
    for axes, title in zip(panels, titles, strict=False):
        draw(axes, title)
        axes.set_title(title, fontsize=8.0, loc="left")
        axes.xaxis.set_tick_params(labelbottom=True)
    for axes in panels[len(titles) :]:
        axes.remove()
    return figure


def _figure(width_mm: float, height_mm: float) -> Figure:
    figure = Figure(figsize=(width_mm / MM_PER_INCH, height_mm / MM_PER_INCH), layout="constrained")
    FigureCanvasAgg(figure)
    return figure


def _legend_entries(figure: Figure) -> dict[str, Artist]:
    """Return what the panels of a figure show, by label, each once."""
    return dict(
        pair for axes in figure.axes for pair in zip(*axes.get_legend_handles_labels()[::-1], strict=True)
    )


def legend(figure: Figure, *, columns: int, note: str = "") -> Legend:
    """Add one legend above all panels, under a note in small type; faint and tiny marks are box stronger."""
    entries = _legend_entries(figure)
    box = figure.legend(
        entries.values(),
        entries.keys(),
        loc="outside upper left",
        ncols=columns,
        title=_wrap(figure, note),
        title_fontsize=NOTE_SIZE,
        alignment="left",
        columnspacing=1.2,
    )
    box.get_title().set_color(PUBLISHED)
    for handle in filter(None, box.legend_handles):
        if (alpha := handle.get_alpha()) is not None:
            handle.set_alpha(max(float(alpha), LEAST_ALPHA))
        if isinstance(handle, Line2D):
            handle.set_markersize(max(handle.get_markersize(), 4.0))
    return box


def add_head(figure: Figure, headline: str, note: str) -> None:
    """Put a sentence that says what a figure shows above its panels, and a note in small type under it."""
    wrapped = _wrap(figure, note)
    room = NOTE_SIZE / HEADLINE_SIZE * (1 + wrapped.count("\n"))
    title = figure.suptitle(
        headline + "\n" * math.ceil(room), x=0.01, ha="left", fontsize=HEADLINE_SIZE, fontweight="bold"
    )
    below = 1.5 * HEADLINE_SIZE / (figure.get_figheight() * POINTS_PER_INCH)
    height = title.get_position()[1] - below
    figure.text(0.01, height, wrapped, va="top", fontsize=NOTE_SIZE, color=PUBLISHED)


def add_head_and_legend(figure: Figure, headline: str, note: str, *, columns: int) -> None:
    """Put a headline and its note above a figure's panels, and one legend between them."""
    rows = math.ceil(len(_legend_entries(figure)) / columns)
    add_head(figure, headline, note + "\n " * math.ceil(_LEGEND_ROW * rows + 0.5))
    marks = legend(figure, columns=columns)
    marks.set_loc("upper left")
    head = _HEAD_INCHES + _LINE_INCHES * _wrap(figure, note).count("\n")
    marks.set_bbox_to_anchor((0.0, 1.0 - head / figure.get_figheight()), figure.transFigure)


def _wrap(figure: Figure, note: str) -> str:
    """Return the note in lines that fit the figure's width; its own line breaks stay."""
    room = int(0.94 * figure.get_figwidth() * POINTS_PER_INCH / (NOTE_ADVANCE * NOTE_SIZE))
    return "\n".join(textwrap.fill(line, room) for line in note.splitlines())


def save(figure: Figure, path_pdf: FilePath, path_png: FilePath) -> None:
    """Write the figure as PDF and PNG, each whole or not at all; the same figure gives the same bytes."""
    _write(figure, path_pdf, "pdf", metadata={"CreationDate": None})
    save_png(figure, path_png)


def save_png(figure: Figure, path: FilePath) -> None:
    """Write the figure as PNG alone, as `save` does."""
    _write(figure, path, "png", metadata={"Software": None})


def save_all(figures: Iterable[Figure], paths_pdf: Iterable[FilePath], paths_png: Iterable[FilePath]) -> None:
    """Write each figure as `save` does, under the paths in its place.

    Raises ValueError for another number of paths than of figures.
    """
    for figure, path_pdf, path_png in zip(figures, paths_pdf, paths_png, strict=True):
        save(figure, path_pdf, path_png)


def _write(figure: Figure, path: FilePath, kind: str, *, metadata: dict[str, None]) -> None:
    with replacing(path) as temporary:
        figure.savefig(temporary, format=kind, metadata=metadata)
