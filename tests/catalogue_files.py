"""A small catalogue: daily sets of a few objects that sink as they please, and weather to fly them under."""

import numpy as np
from sgp4.api import WGS72, Satrec

from opml.environment import solar_activity, space_weather
from opml.interop.element_sets import tle

FIRST_DAY = 57388
"""Modified Julian day of the first sets, 2016-01-01."""

_SGP4_ZERO = 33281.0
"""Modified Julian day from which sgp4init counts days."""

_DAY = 1440.0  # min


def write_sets(path, *, objects, days, seed=1):
    """Write daily sets of objects at 500 km, with a drag that varies from day to day, as TLEs."""
    rng = np.random.default_rng(seed)
    weather = np.cumsum(rng.normal(0.0, 0.05, days))
    text = []
    for number in range(1, objects + 1):
        drag = rng.uniform(0.5, 2.0) * np.exp(weather + rng.normal(0.0, 0.02, days))
        motion = 0.0664 + np.cumsum(2e-8 * drag)  # rad/min
        anomaly = rng.uniform(0.0, 6.0) + np.cumsum(_DAY * motion)
        phase = rng.uniform(0.0, 0.3)
        for day in range(days):
            satellite = Satrec()
            satellite.sgp4init(
                *(WGS72, "i", number, FIRST_DAY - _SGP4_ZERO + day + phase, 2e-4 * drag[day]),
                *(0.0, 0.0, 0.001, 1.0, 1.2, (anomaly[day] - 1.0) % (2.0 * np.pi), motion[day], 0.5),
            )
            text += tle.lines(satellite, number)
    path.write_text("\n".join(text) + "\n")
    return path


def write_weather(path, *, first, last):
    """Write the packaged weather from one modified Julian day to another."""
    lines = solar_activity.read_text(solar_activity.resolve("OBSERVED")).splitlines()
    begin = next(k for k, line in enumerate(lines) if line.startswith("DATE")) + 1
    zero = int(space_weather.read("packaged", "\n".join(lines)).index[0])
    path.write_text(
        "\n".join([*lines[:begin], *lines[begin + first - zero : begin + last - zero + 1]]) + "\n"
    )
    return path
