"""The picture of docs/weather.md on what an error is made of: python -m validation.pictures.anatomy.

The paper's RSO under the weather that was observed, fitted and predicted as the paper's catalogue does, under
monthly weather. Each cause is what the error changes by once the catalogue knows it, one after the other.
"""

from importlib.resources import files

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter

import opml
from opml.base.constants import DAY
from opml.figures import style
from opml.figures.line_ends import name_ends
from opml.figures.ticks import metres, rounded
from opml.tables import STATE
from validation.pictures import shrunk

EPOCH, DAYS, FIRST = "2016-09-28T12:09:45", 12.0, 4.0
"""The paper's epoch; days of the run; the example is the first prediction that starts after FIRST [d]."""

CAUSES = ("state", "drag coefficient", "weather", "gravity field")
"""What the catalogue does not know, in the order in which it learns it."""

COLORS = dict(
    zip(
        CAUSES,
        (style.PREDICTED_COLOR, style.RESIDUAL, style.HIGHLIGHT, style.OBSERVED_COLOR),
        strict=True,
    )
)


def parts() -> pd.DataFrame:
    """Return a row per prediction: i, t_i and lead [d], the along-track error `error` and its parts [m]."""
    sheets = files("opml") / "workflow" / "project" / "config"
    iss = opml.read_rsos(str(sheets / "rsos.tsv"))["iss"]
    stations = list(opml.read_stations(str(sheets / "stations.tsv")).values())
    monthly, observed = (
        opml.make_environment(EPOCH, days=DAYS, activity=activity) for activity in ("MSAFE", "OBSERVED")
    )
    truth = opml.propagate(opml.Propagator(opml.force_model(observed, **opml.TRUTH), iss), days=DAYS)
    tracks = opml.track(truth, observed, stations, rso=iss)
    propagator = opml.Propagator(opml.force_model(monthly, **opml.ASSUMED), iss)
    fits = opml.estimate(propagator, truth, tracks, monthly, stations)
    fits = fits[fits["converged"]]
    states = truth.set_index("t").loc[fits["t"], STATE].to_numpy()
    exact = fits.assign(**dict(zip(STATE, states.T, strict=True)), cd=iss.cd)
    informed = opml.Propagator(opml.force_model(observed, **opml.ASSUMED), iss)
    steps = [
        opml.predict_tracks(model, truth, estimates)
        for model, estimates in (
            (propagator, fits),
            (propagator, exact.assign(cd=fits["cd"])),
            (propagator, exact),
            (informed, exact),
        )
    ]
    errors = [step["e_y"].to_numpy() for step in steps]
    first = steps[0]
    return pd.DataFrame(
        {"i": first["i"], "t_i": first["t_i"] / DAY, "lead": (first["t_j"] - first["t_i"]) / DAY}
        | {"error": errors[0]}
        | {
            cause: before - after
            for cause, before, after in zip(CAUSES, errors, [*errors[1:], 0.0], strict=True)
        }
    )


def anatomy(rows: pd.DataFrame) -> Figure:
    """Draw the parts of one prediction's error, stacked over its lead time, and the usual size of each."""
    figure = style.page_figure(height_mm=82.0)
    one, usual = figure.subplots(1, 2)
    start = rows.loc[rows["t_i"] >= FIRST, "i"].iloc[0]
    example = rows[rows["i"] == start].sort_values("lead")
    _stack(one, example)
    sizes = rows[[*CAUSES, "error"]].abs().groupby(np.ceil(rows["lead"])).median()
    _sizes(usual, sizes)
    week = metres(rounded(float(sizes["error"].iloc[-1])))
    headline = f"The fit's Cd offsets the weather until the weather changes: a median of {week} after a week"
    note = (
        "ISS-based RSO, three radars, fits of 12 h, simulated under observed weather, predicted under "
        f"monthly means; right: medians of {len(rows)} predictions from {rows['i'].nunique()} fits in "
        f"{DAYS:g} days"
    )
    style.add_head(figure, headline, note)
    return figure


def _stack(axes: Axes, example: pd.DataFrame) -> None:
    """Draw the parts of one error above each other, those below zero downwards, and their sum as a line."""
    lead, above, below = example["lead"].to_numpy(), np.zeros(len(example)), np.zeros(len(example))
    for cause in CAUSES:
        part = example[cause].to_numpy()
        for base, shown in ((above, np.maximum(part, 0.0)), (below, np.minimum(part, 0.0))):
            label = cause if base is above else None
            axes.fill_between(lead, base, base + shown, color=COLORS[cause], alpha=0.75, lw=0.0, label=label)
            base += shown
    axes.plot(lead, example["error"], color=style.TRUE_COLOR, label="error")
    axes.set_title(f"one prediction, from day {example['t_i'].iloc[0]:.2f}", loc="left", fontsize=8.0)
    axes.set(xlabel="lead time [d]", ylabel="along-track error", xlim=(0.0, 7.0))
    axes.yaxis.set_major_formatter(FuncFormatter(metres))
    axes.legend(loc="best", fontsize=style.NOTE_SIZE)


def _sizes(axes: Axes, sizes: pd.DataFrame) -> None:
    """Draw the median size of each part by lead time, its name at its end."""
    colors = COLORS | {"error": style.TRUE_COLOR}
    for cause, color in colors.items():
        axes.plot(sizes.index, sizes[cause], "o-", color=color, ms=3.0, clip_on=False)
    axes.set_title("median size of each part", loc="left", fontsize=8.0)
    axes.set(xlabel="lead time, up to [d]", yscale="log", xlim=(0.8, 7.0))
    axes.yaxis.set_major_formatter(FuncFormatter(metres))
    ends = {cause: float(sizes[cause].iloc[-1]) for cause in colors}
    name_ends(axes, ends, colors)


def main() -> None:
    """Draw the picture and shrink it."""
    shrunk.save(anatomy(parts()), "anatomy")


if __name__ == "__main__":
    main()
