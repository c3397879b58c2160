"""The drawings that explain the method, as SVG in the page: they take the page's ink, light or dark.

A page names one by the directive `schematic`; the directive's text is what a screen reader says. A drawing is
360 units wide, so that its type keeps its size on a phone.
"""

import math
import re
from html import escape

from docutils import nodes
from sphinx.util.docutils import SphinxDirective

from opml.figures.style import HIGHLIGHT, MUTED, PREDICTED_COLOR, RESIDUAL, TRACK_COLOR

WIDTH = 360
INK = "currentColor"
HEAD = 5.0  # of an arrow
SMALL = 10.5
SUBSCRIPT = re.compile(r"_(\w+)([^_]*)")


def text(x, y, words, *, anchor="start", color=INK, size=SMALL, weight="normal", turn=0):
    """Write words, in which `t_i` has a subscript; turn: about the place [deg]."""
    look = f'text-anchor="{anchor}" fill="{color}" font-size="{size}" font-weight="{weight}"'
    lowered = r'<tspan dy="3" font-size="80%">\1</tspan><tspan dy="-3">\2</tspan>'
    marked = SUBSCRIPT.sub(lowered, escape(words))
    turned = f' transform="rotate({turn} {x:.1f} {y:.1f})"' if turn else ""
    return f'<text x="{x:.1f}" y="{y:.1f}" {look}{turned} xml:space="preserve">{marked}</text>'


def lines(x, y, *rows, **look):
    """Write rows of words, one below the other."""
    return "".join(text(x, y + 13.5 * k, row, **look) for k, row in enumerate(rows))


def line(*points, color=INK, width=1.2, dash=""):
    """Draw a line through points."""
    path = " ".join(f"{x:.1f},{y:.1f}" for x, y in points)
    return (
        f'<polyline points="{path}" fill="none" stroke="{color}" stroke-width="{width}"'
        f' stroke-dasharray="{dash}"/>'
    )


def arrow(*points, color=INK, width=1.4):
    """Draw a line through points that ends in a head."""
    (x0, y0), (x1, y1) = points[-2:]
    way = math.atan2(y1 - y0, x1 - x0)
    wings = [(x1 - HEAD * math.cos(way + turn), y1 - HEAD * math.sin(way + turn)) for turn in (-0.5, 0.5)]
    shaft = (x1 - 0.8 * HEAD * math.cos(way), y1 - 0.8 * HEAD * math.sin(way))
    head = " ".join(f"{x:.1f},{y:.1f}" for x, y in ((x1, y1), *wings))
    return line(*points[:-1], shaft, color=color, width=width) + f'<polygon points="{head}" fill="{color}"/>'


def box(x, y, width, height, *, color, shade=0.18):
    """Draw a box with a tint of its color, through which the page shows."""
    place = f'x="{x:.1f}" y="{y:.1f}" width="{width:.1f}" height="{height:.1f}" rx="3"'
    return f'<rect {place} fill="{color}" fill-opacity="{shade}" stroke="{color}" stroke-width="1.2"/>'


def dot(x, y, *, color=INK, radius=4.0, filled=True):
    """Draw a dot, or a ring."""
    fill = color if filled else "none"
    return f'<circle cx="{x:.1f}" cy="{y:.1f}" r="{radius}" fill="{fill}" stroke="{color}"/>'


def svg(height, *parts, words):
    """Return a drawing as an element of the page; words: what it shows."""
    label = escape(words, quote=True)
    return (
        f'<svg class="schematic" viewBox="0 0 {WIDTH} {height}" role="img" aria-label="{label}"'
        f' xmlns="http://www.w3.org/2000/svg">{"".join(parts)}</svg>'
    )


STAGES = (
    ("truth", INK, "the orbit itself: simulated under the", "full model, or a precise orbit"),
    ("tracks", TRACK_COLOR, "radars measure range, azimuth and", "elevation, with noise"),
    ("fits", HIGHLIGHT, "12 hours of tracks give state, C_d", "and covariance at t_i"),
    ("predictions", PREDICTED_COLOR, "a simpler model propagates each", "estimate to later tracks, t_j"),
    ("errors", INK, "predicted minus true state at t_j:", "along-track, e_y, is the largest"),
    ("learning", PREDICTED_COLOR, "e_y of the past from what a", "catalogue knew at t_i"),
    ("correction", RESIDUAL, "a new prediction minus its learned", "error; the residual remains"),
)


def method(words):
    """Draw the way from the truth to the correction."""
    step, top, left, width, height = 55.0, 6.0, 54.0, 92.0, 34.0
    rows = [top + step * k for k in range(len(STAGES))]
    parts = []
    for y, (name, color, *meaning) in zip(rows, STAGES, strict=True):
        parts.append(box(left, y, width, height, color=color))
        parts.append(text(left + width / 2, y + 21.5, name, anchor="middle", size=12.5, weight="600"))
        parts.append(lines(left + width + 12, y + 14, *meaning))
    down = left + width / 2
    parts += [arrow((down, y + height), (down, y + step)) for y in rows[:-1]]
    for x, start, end, what in ((37, 0, 4, "true states"), (16, 3, 6, "new predictions")):
        y0, y1 = rows[start] + height / 2, rows[end] + height / 2
        parts.append(arrow((left, y0), (x, y0), (x, y1), (left, y1)))
        parts.append(text(x - 4, (y0 + y1) / 2, what, anchor="middle", turn=-90))
    return svg(rows[-1] + height + 6, *parts, words=words)


RADIUS, CENTRE = 800.0, (175.0, 925.0)
TRUE_ANGLE = math.radians(-8.5)
RADIAL, ALONG = (math.sin(TRUE_ANGLE), -math.cos(TRUE_ANGLE)), (math.cos(TRUE_ANGLE), math.sin(TRUE_ANGLE))
CROSS = (0.8, -0.6)  # into the page, seen at a slant


def correction(words):
    """Draw a prediction error in RSW, and what the correction leaves of it."""
    true = (CENTRE[0] + RADIUS * RADIAL[0], CENTRE[1] + RADIUS * RADIAL[1])
    corner = _away(true, ALONG, 205.0)
    above = _away(corner, RADIAL, 34.0)
    predicted = _away(above, CROSS, 28.0)
    corrected = _away(predicted, ALONG, -172.0)
    parts = [
        line(*_arc(RADIUS), width=1.6),
        line(*_arc(math.dist(predicted, CENTRE)), color=PREDICTED_COLOR, width=1.6, dash="5 4"),
        arrow(true, corner, width=2.0),
        arrow(corner, above, width=2.0),
        arrow(above, predicted, width=2.0),
        arrow(predicted, corrected, color=RESIDUAL, width=2.4),
        dot(*true),
        dot(*predicted, color=PREDICTED_COLOR),
        dot(*corrected, color=RESIDUAL),
        lines(true[0] - 8, true[1] + 20, "true position", "at t_j"),
        text(predicted[0] + 2, predicted[1] - 10, "predicted at t_j", anchor="middle"),
        text(corrected[0] - 8, corrected[1] + 4, "corrected", anchor="end"),
        text(196, 81, "less the learned error", anchor="middle", turn=-8.5),
        text(160, 112, "e_y, along-track", anchor="middle", turn=-8.5),
        text(corner[0] + 4, corner[1] + 14, "e_x, radial"),
        text(above[0] + 12, above[1] + 6, "e_z, cross-track"),
        text(352, 160, "true orbit", anchor="end"),
        text(6, 42, "predicted orbit"),
        text(6, 198, "Not to scale: after days e_y is kilometres, the others are metres."),
    ]
    return svg(206, *parts, words=words)


def _away(start, direction, size):
    return start[0] + size * direction[0], start[1] + size * direction[1]


def _arc(radius):
    """Return points of an orbit about the Earth's centre, far below the drawing."""
    turns = [math.radians(-13.0 + 0.5 * k) for k in range(53)]
    return [_away(CENTRE, (math.sin(turn), -math.cos(turn)), radius) for turn in turns]


def known(words):
    """Draw the times of a prediction, the windows of the fits, and what is known when."""
    window, axis, end = 64.0, 30.0, WIDTH - 4.0
    t_b, t_i, t_j, t_known = 72.0, 142.0, 276.0, 316.0
    marks = {"t_b": t_b, "t_i": t_i, "t_j": t_j, "t_known": t_known}
    parts = [arrow((4, axis), (end, axis))]
    for name, x in marks.items():
        parts.append(line((x, axis - 4), (x, 134 if x < t_j else 186), color=MUTED, dash="2 3"))
        parts.append(text(x, axis - 9, name, anchor="middle", size=13, weight="600"))
    bars = (
        (44.0, HIGHLIGHT, "tracks of b", t_b - window, t_b),
        (44.0, HIGHLIGHT, "tracks of i", t_i - window, t_i),
        (44.0, HIGHLIGHT, "tracks of j", t_j - window, t_j),
        (80.0, TRACK_COLOR, "weather as measured", 8.0, t_i),
        (80.0, PREDICTED_COLOR, "weather as forecast", t_i, t_j),
    )
    for y, color, name, first, last in bars:
        parts.append(box(first + 1.5, y, last - first - 3, 24, color=color))
        parts.append(text((first + last) / 2, y + 16, name, anchor="middle"))
    predictions = ((124.0, "b predicted", t_b, t_i), (124.0, "i predicted: the row", t_i, t_j))
    for y, name, first, last in predictions:
        parts.append(arrow((first + 3, y), (last - 3, y), color=PREDICTED_COLOR, width=2.0))
        parts.append(text((first + last) / 2, y - 6, name, anchor="middle"))
    parts.append(box(t_known, 140, end - t_known, 40, color=RESIDUAL))
    parts.append(lines((t_known + end) / 2, 157, "may", "learn", anchor="middle"))
    parts.append(arrow((t_j + 3, 160), (t_known - 2, 160), color=RESIDUAL, width=2.0))
    parts.append(lines(t_j - 6, 157, "its error: against truth at t_j,", "or estimate j", anchor="end"))
    parts.append(
        lines(
            4,
            206,
            "t_i  estimates b and i, the error of b, the weather up to then",
            "t_j  the later track begins; in a simulation, the true error",
            "t_known  estimate j is made: the row may be trained on",
        )
    )
    return svg(242, *parts, words=words)


DRAWN = ((0, 3), (1, 2), (2, 6), (3, 5), (4, 8), (5, 6), (7, 8), (7, 11), (8, 10))
"""Pairs that the drawing of a random split tests on."""


def splits(words):
    """Draw which rows four splits train and test on, a dot for each pair of t_i and t_j."""
    panels = {
        "random": lambda i, j: "train" if (i, j) not in DRAWN else "test",
        "grouped": lambda i, j: "train" if i not in (2, 6, 9) else "test",
        "later": lambda i, j: "train" if j < 8 else "test",
        "unseen": lambda i, j: "train" if j < 8 else "test" if i >= 8 else "neither",
    }
    meaning = {
        "random": "rows drawn one by one",
        "grouped": "all rows of an estimate",
        "later": "t_j after the training",
        "unseen": "t_i after it, too",
    }
    looks = {
        "train": {"color": PREDICTED_COLOR},
        "test": {"color": RESIDUAL},
        "neither": {"color": MUTED, "filled": False},
    }
    parts = []
    for k, (name, side) in enumerate(panels.items()):
        x, y = 24.0 + 180.0 * (k % 2), 60.0 + 198.0 * (k // 2)
        parts.append(text(x, y - 20, name, size=12.5, weight="600"))
        parts.append(text(x, y - 6, meaning[name]))
        parts.append(line((x, y + 4), (x, y + 146), (x + 144, y + 146), color=MUTED))
        parts.append(text(x + 142, y + 159, "t_i", anchor="end"))
        parts.append(text(x - 5, y + 14, "t_j", anchor="end"))
        if name in ("later", "unseen"):
            parts.append(line((x, y + 140 - 8 * 11.5 + 5.7), (x + 144, y + 140 - 8 * 11.5 + 5.7), dash="3 3"))
        pairs = [(i, j) for i in range(12) for j in range(i + 1, min(i + 5, 12))]
        for i, j in pairs:
            parts.append(dot(x + 8 + 11.5 * i, y + 140 - 11.5 * j, radius=3.4, **looks[side(i, j)]))
    for x, name in ((60, "train"), (150, "test"), (230, "neither")):
        parts.append(dot(x, 14, radius=3.8, **looks[name]))
        parts.append(text(x + 8, 18, {"train": "trained on", "test": "tested on"}.get(name, "not used")))
    return svg(428, *parts, words=words)


DRAWINGS = {"method": method, "correction": correction, "known": known, "splits": splits}


class Schematic(SphinxDirective):
    """A drawing of this module by its name; the text is read to those who do not see it."""

    required_arguments = 1
    has_content = True

    def run(self):
        """Return the drawing for the page."""
        drawing = DRAWINGS[self.arguments[0]](" ".join(self.content))
        return [nodes.raw("", drawing, format="html")]
