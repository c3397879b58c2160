"""Answer a task of tracks with baselines: python track_fits.py TASK FOLDER WAY [WAY ...]

last: the paper's prediction, a fit over 12 h under its assumed forces; svr, trees: the same, corrected by
what its own past teaches, by the paper's regression or by boosted trees; sgp4: a set fitted to two days of
the same; fit: a fit over 48 h under all forces; predict: `opml predict`. Weather after t is that of the last
days.
"""

import json
import sys
import tempfile
from dataclasses import replace
from functools import cache
from pathlib import Path
from time import process_time

import numpy as np
import pandas as pd

import opml
from opml.base import epochs
from opml.base.constants import DAY
from opml.benchmark import tasks
from opml.benchmark.answers import COVARIANCE, REQUIRED, about_file
from opml.interop.element_sets import element_fits, mean_elements, sgp4_errors
from opml.orbits.elements import rsw_rotation
from opml.tables import STATE

FULL = {"degree": 48, "order": 48, "forces": ["solid_tides", "relativity"]}
ANY_CD = {"cd_min": 0.01, "cd_max": 10.0}
ERRORS = ["e_x", "e_y", "e_z"]  # radial, along, across
AHEAD = 8  # days of weather after t
FEWEST = 20  # rows to learn or judge from
LEVEL, NORMAL = 0.9, 1.645


def held_weather(folder):
    """Return the lines of the weather known at t, after t as on its last days, below a header."""
    known = (folder / "weather.csv").read_text().splitlines()[1:]
    last = known[-1].split(",")
    days = np.datetime64(last[0]) + np.arange(1, AHEAD + 2)
    kp = np.median([[float(cell) for cell in line.split(",")[1:9]] for line in known[-27:]])
    return known + [",".join([str(day), *[f"{kp:.0f}"] * 8, last[9], "OBS", last[11]]) for day in days]


class Morning:
    """An object at t: what was measured of it, in tables of times since `epoch`."""

    def __init__(self, folder, number, t, times):
        self.folder, self.number, self.t = folder, number, t
        self.tracks = str(folder / f"{number}.tdm")
        begin = Path(self.tracks).read_text().split("START_TIME = ")[1][:10]
        self.epoch = f"{begin}T00:00:00"
        self.now, *self.asked = (epochs.seconds_between(self.epoch, one) for one in (t, *times))
        self.times = times
        body = pd.read_csv(folder / "bodies.csv").set_index("object").loc[number]
        nothing = dict.fromkeys(("a", "e", "i", "argp", "raan", "mean_anomaly"), np.nan)
        self.rso = opml.Rso("object", **nothing, area_to_mass=body.iloc[0], cd=2.2, cr=body.iloc[1])
        self.stations = list(opml.read_stations(folder / "stations.tsv").values())

    @cache  # noqa: B019
    def environment(self):
        """Make the environment from the weather known at t."""
        days = (self.now / DAY) + AHEAD - 0.5
        with tempfile.TemporaryDirectory() as temporary:
            path = Path(temporary, "weather.csv")
            path.write_text("\n".join(held_weather(self.folder)) + "\n")
            return opml.make_environment(self.epoch, days=days, activity=path, degree=48)

    @cache  # noqa: B019
    def fits(self, window, full, days=None):
        """Return propagator, measurements and estimates, of the last days alone where these are named."""
        forces = FULL if full else opml.ASSUMED
        propagator = opml.Propagator(opml.force_model(self.environment(), **forces), self.rso, threads=1)
        measured = opml.read_tracks(self.tracks, epoch=self.epoch, stations=self.stations)
        if days:
            measured = measured[measured["t"] > self.now - days * DAY].reset_index(drop=True)
            measured["track"] -= measured["track"].iloc[0]
        starts = opml.first_orbit(propagator, measured, self.environment(), self.stations)
        estimates = opml.estimate(
            propagator, starts, measured, self.environment(), self.stations,
            settings={"window_hours": window, **ANY_CD},
        )  # fmt: skip
        return propagator, measured, estimates


def ahead_of(propagator, estimates, times):
    """Return where the newest fit that lasts is at times [s], and the estimates with empty ones then."""
    track = estimates["track"].max() + 1 + np.arange(len(times))
    empty = estimates.iloc[[-1] * len(times)].assign(converged=False, track=track, t=times)
    for newest in estimates.index[estimates["converged"]][::-1]:
        started = pd.concat([estimates.loc[[newest]], empty], ignore_index=True)
        flown = opml.predict_tracks(propagator, None, started, max_days=AHEAD)
        flown = flown[flown["i"] == estimates["track"][newest]].reset_index(drop=True)
        if np.isfinite(flown[STATE]).all(axis=None):  # one track of one radar may have no drag at all
            break
    return flown, pd.concat([estimates, empty], ignore_index=True)


def spread(left, duration, leads):
    """Return sigmas by lead [s] from what was left of past predictions."""
    left, found = np.abs(left), []
    for lead in leads:
        near = np.abs(duration / lead - 1.0) < 0.2
        scaled = left[near] if near.sum() > 20 else left * (lead / np.maximum(duration, 0.1 * DAY)) ** 2
        found.append(np.quantile(scaled, LEVEL) / NORMAL)
    return np.array(found)


def by_fit(morning, window, full, days=None, learner=None):
    """Return GCRF states and RSW sigmas at the times asked."""
    propagator, measured, estimates = morning.fits(window, full, days)
    ahead, with_empty = ahead_of(propagator, estimates, morning.asked)
    past = opml.predict_tracks(propagator, None, estimates)
    cleaning = {**ANY_CD, "fence": None, "fence_days": None}
    catalogue = opml.Catalogue(estimates, past, measured, morning.environment(), cleaning)
    rows = opml.dataset(catalogue, labels=opml.label(past, estimates, measured))
    states, rows = ahead[STATE].to_numpy(), rows[rows["keep"]]
    left = rows[ERRORS].to_numpy()
    if learner:
        days = f"days-0-{morning.now / DAY:g}"
        seen = measured[measured["track"] == measured["track"].iloc[-1]]
        empty = pd.concat([measured, *(seen.assign(track=track) for track in ahead["j"])], ignore_index=True)
        pairs = pd.concat([past, ahead], ignore_index=True)
        asked = opml.dataset(replace(catalogue, estimates=with_empty, predictions=pairs, tracks=empty))
        asked = asked[asked["j"].isin(ahead["j"])]
        model = opml.learn(rows, learner=learner, train=days)
        states = moved(states, -model.predict(asked[list(model.variables)].to_numpy()))
        half = 0.5 * morning.now  # what was learned in the first half is judged in the second
        first, second = rows[rows["t_j"] < half], rows[rows["t_i"] >= half]
        if min(len(first), len(second)) >= FEWEST:
            early = opml.learn(first, learner=learner, train=days)
            rows, left = second, second[ERRORS].to_numpy()
            left[:, 1] -= early.predict(rows[list(early.variables)].to_numpy())
    leads = (ahead["t_j"] - ahead["t_i"]).to_numpy()
    sigmas = [spread(left[:, k], rows["duration"].to_numpy(), leads) for k in range(3)]
    return states, np.column_stack(sigmas)


def moved(states, arc):
    """Return states that are an arc [m] farther on along their circles."""
    r, v = states[:, :3], states[:, 3:]
    angle = (arc / np.linalg.norm(r, axis=1))[:, None]
    speed = np.linalg.norm(v, axis=1, keepdims=True) / np.linalg.norm(r, axis=1, keepdims=True)
    return np.hstack(
        [r * np.cos(angle) + v / speed * np.sin(angle), v * np.cos(angle) - r * speed * np.sin(angle)]
    )


def by_set(morning):
    """Return the same of SGP4, from a set fitted to two days of the newest fit's ephemeris."""
    propagator, _, estimates = morning.fits(12, False, None)
    grid = np.arange(0.0, 2 * DAY, 900.0)[1:]
    last = estimates["t"][estimates["converged"]].iloc[-1]
    flown, _ = ahead_of(propagator, estimates, last + grid)
    newest = estimates.set_index("track").loc[flown["i"].iloc[0]]
    if newest["t"] < last:
        flown, _ = ahead_of(propagator, estimates[estimates["t"] <= newest["t"]], newest["t"] + grid)
    t = np.append(newest["t"], flown["t_j"])
    states = np.vstack([newest[STATE].to_numpy(dtype=float), flown[STATE].to_numpy()])
    positions, velocities = element_fits.in_teme(states, morning.epoch, t)
    known = np.concatenate([positions[0], velocities[0]])
    fitted = element_fits.fit(t, positions, at=t[0], known=known, epoch=morning.epoch)
    found = np.array([mean_elements.state(fitted, epoch=time) for time in morning.times])
    return found, sgp4_errors.usual_sigmas(fitted, (np.array(morning.asked) - t[0]) / DAY)


def by_opml(morning):
    """Return the same of `opml predict`."""
    made = opml.predict(
        morning.tracks, date=morning.t, weather=morning.folder / "weather.csv",
        stations=morning.stations, area_to_mass=morning.rso.area_to_mass,
    )  # fmt: skip
    t = np.array(morning.asked) - morning.now
    return made.states(t), made.sigmas(t)


BOOSTING = {"kind": "boosting", "trees": 300, "leaves": 31, "learning_rate": 0.05, "min_rows": 50}
WAYS = {
    "last": lambda morning: by_fit(morning, 12, False),
    "svr": lambda morning: by_fit(morning, 12, False, learner=opml.LEARNER),
    "trees": lambda morning: by_fit(morning, 12, False, learner=BOOSTING),
    "sgp4": by_set,
    "fit": lambda morning: by_fit(morning, 48, True, 6),
    "predict": by_opml,
}


def cells(state, sigmas):
    """Return the cells of a GCRF state and of its position's covariance."""
    axes = rsw_rotation(state)
    covariance = axes.T @ np.diag(sigmas**2) @ axes
    upper = covariance[np.triu_indices(3)]
    return [f"{value:.6f}" for value in state] + [f"{value:.9g}" for value in upper]


def main(folder, answers, *ways):
    """Answer all that is asked; fits that ways share count for the first of them."""
    task = tasks.read(folder)
    lines, runtime = {way: [] for way in ways}, dict.fromkeys(ways, 0.0)
    for (t, number), asked in task.questions.groupby(["t", "object"]):
        morning = Morning(task.inputs(t), number, t, asked["time"].tolist())
        for way in ways:
            begin = process_time()
            for time, state, sigmas in zip(morning.times, *WAYS[way](morning), strict=True):
                lines[way].append([number, t, time, "GCRF", *cells(state, sigmas)])
            runtime[way] += process_time() - begin
        print(t, number, {way: round(seconds) for way, seconds in runtime.items()}, file=sys.stderr)
    for way in ways:
        command = f"python benchmark/track_fits.py {task.name} . {' '.join(ways)}"
        path = Path(answers, f"{task.name}_{way}.csv")
        header = (*REQUIRED, *COVARIANCE)
        write(path, header, lines[way], f"opml {opml.__version__}: {way}", command, runtime[way])


def write(path, header, lines, tool, command, runtime):
    """Write answers, and beside them how they were made."""
    tasks.write_csv(path, header, lines)
    about = {"tool": tool, "command": command, "runtime_s": round(runtime, 1)}
    about_file(path).write_text(json.dumps(about) + "\n")


if __name__ == "__main__":
    main(*sys.argv[1:])
