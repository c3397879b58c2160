"""Space weather as it is known: outlooks, and what was measured otherwise, or not at all, after a day."""

from support import EPOCH, environment

from opml.environment import known_weather, solar_activity, space_weather


def outlook(nodes, *, days):
    """The table of outlooks of so many days each by persistence, over the run's first nodes."""
    issues = known_weather.Issues(source="OBSERVED", epoch=EPOCH, issue_hours=24, max_days=days)
    return known_weather.outlooks(issues, environment()["solar_activity"]["t"].to_numpy()[:nodes])


def other_after(path, mjd):
    """Write the packaged weather to `path` with other figures for all that was measured after a time [MJD].

    A flux is measured at 20:00 UTC, a Kp when its three hours are over; the centred mean knows all.
    """
    lines = solar_activity.read_text(solar_activity.resolve("OBSERVED")).splitlines()
    begin = next(k for k, line in enumerate(lines) if line.startswith("DATE")) + 1
    first = int(space_weather.read("packaged", "\n".join(lines)).index[0])
    changed = [_changed(line, first + k, mjd) for k, line in enumerate(lines[begin:])]
    path.write_text("\n".join([*lines[:begin], *changed]))
    return path


def _changed(line, day, mjd):
    date, *kp, flux, kind, _ = line.split(",")
    kp = [f"{90 - int(value)}" if day + (k + 1) / 8 > mjd + 1e-6 else value for k, value in enumerate(kp)]
    flux = "222.2" if day + 20 / 24 > mjd + 1e-6 else flux
    return ",".join([date, *kp, flux, kind, "199.9"])


def up_to(path, mjd):
    """Write the packaged weather to `path` up to a day [MJD], that day included."""
    lines = solar_activity.read_text(solar_activity.resolve("OBSERVED")).splitlines()
    begin = next(k for k, line in enumerate(lines) if line.startswith("DATE")) + 1
    first = int(space_weather.read("packaged", "\n".join(lines)).index[0])
    path.write_text("\n".join(lines[: begin + mjd - first + 1]))
    return path
