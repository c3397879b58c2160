"""Orbits for the tests of readers: flown here, and written as SP3, CPF and OEM by plain formatting."""

import gzip
from pathlib import Path

import numpy as np
from scipy.integrate import solve_ivp
from support import EPOCH

from opml.dynamics.attraction import Attraction
from opml.dynamics.frames import gcrf_to_itrf, spin
from opml.environment import gravity_field
from opml.interop import ccsds

AHEAD_OF_UTC = {"UTC": 0.0, "GPS": 17.0, "TAI": 36.0}
"""Seconds by which the clocks of time systems are ahead in 2016."""


def attraction_of(orientation, epoch=EPOCH):
    """The attraction that bridges nodes, over the times of an Earth orientation table."""
    field = gravity_field.read_icgem(gravity_field.resolve("EGM2008")).freeze(epoch)
    return Attraction(field.c, field.s, gm=field.gm, radius=field.radius, earth_orientation=orientation)


def flown(attraction, state, t, thrust=lambda t: np.zeros(3)):
    """States (n, 6) in GCRF at times t (n,) [s] from the first one, under gravity and a thrust [m/s2]."""

    def rate(at, y):
        pull = attraction.acceleration(y[None, :3], attraction.rotation(np.array([at])))[0]
        return np.concatenate([y[3:], pull + thrust(at)])

    solution = solve_ivp(rate, (t[0], t[-1]), state, "DOP853", t, rtol=1e-12, atol=1e-6, max_step=60.0)
    return solution.y.T


def in_itrf(states, t, orientation):
    """States (n, 6) in ITRF of those in GCRF at times t (n,) [s]."""
    turns = gcrf_to_itrf(orientation, t)
    rate = spin(orientation)
    turning = np.stack([np.interp(t, orientation["t"], rate[:, k]) for k in range(3)], axis=1)
    slower = states[:, 3:] - np.cross(turning, states[:, :3])
    return np.concatenate([np.einsum("nij,nj->ni", turns, part) for part in (states[:, :3], slower)], axis=1)


def calendar(t, scale="UTC"):
    """Calendar times as texts, year to second, of times t (n,) [s since EPOCH] in a time system."""
    return [
        [text[:4], text[5:7], text[8:10], text[11:13], text[14:16], text[17:]]
        for text in ccsds.utc_texts(EPOCH, t + AHEAD_OF_UTC[scale])
    ]


def sp3(path, t, states, *, scale="GPS", satellite="L47", velocities=True, frame="IGS14", version="c"):
    """Write states (n, 6) [m, m/s] in ITRF as SP3; satellite None writes them for two, L01 and L02."""
    names = [satellite] if satellite else ["L01", "L02"]
    times = [
        [int(y), int(mo), int(d), int(h), int(mi), float(s)] for y, mo, d, h, mi, s in calendar(t, scale)
    ]
    start = "{:4d} {:2d} {:2d} {:2d} {:2d} {:11.8f}".format(*times[0])
    kind = "V" if velocities else "P"
    ids = "".join(f"{name:>3}" for name in names) + "  0" * (17 - len(names))
    blank = "  0" * 17
    lines = [
        f"#{version}{kind}{start} {len(t):7d} ORBIT {frame:>5} FIT TEST",
        "## 1916 302985.00000000    60.00000000 57659 0.5067708333333",
        f"+ {len(names):4d}   {ids}",
        *(f"+        {blank}" for _ in range(4)),
        *(f"++       {blank}" for _ in range(5)),
        f"%c M  cc {scale} ccc cccc cccc cccc cccc ccccc ccccc ccccc ccccc",
        "%c cc cc ccc ccc cccc cccc cccc cccc ccccc ccccc ccccc ccccc",
        "%f  0.0000000  0.000000000  0.00000000000  0.000000000000000",
        "%f  0.0000000  0.000000000  0.00000000000  0.000000000000000",
        "%i    0    0    0    0      0      0      0      0         0",
        "%i    0    0    0    0      0      0      0      0         0",
        *("/* a test" for _ in range(4)),
    ]
    for time, state in zip(times, states, strict=True):
        lines.append("*  {:4d} {:2d} {:2d} {:2d} {:2d} {:11.8f}".format(*time))
        for k, name in enumerate(names):
            x, y, z = (state[:3] + 1e5 * k) / 1e3
            lines.append(f"P{name}{x:14.6f}{y:14.6f}{z:14.6f} 999999.999999")
            if velocities:
                x, y, z = state[3:] * 10.0
                lines.append(f"V{name}{x:14.6f}{y:14.6f}{z:14.6f} 999999.999999")
    return _written(path, [*lines, "EOF"])


def flagged(path, line, flag, column):
    """Put a flag into a column of a line of SP3, both counted from 0."""
    lines = path.read_text().splitlines()
    lines[line] = f"{lines[line]:<{column}.{column}}{flag}"
    path.write_text("\n".join(lines))
    return path


def cpf(path, t, states, *, version=1, velocities=False, name="larets", frame=0):
    """Write states (n, 6) [m, m/s] in ITRF as CPF."""
    sequence = "9001" if version == 1 else "272 1"
    days = np.array(["-".join(time[:3]) for time in calendar(t)], "M8[D]") - np.datetime64("1858-11-17")
    lines = [
        f"H1 CPF  {version}  TST 2016 09 28 12 {sequence} {name}",
        f"H2  304206 4206    27944 2016 09 28 12 00 00 2016 09 29 12 00 00   180 1 1  {frame} 0 0 0",
        "H9",
    ]
    for day, (_, _, _, hour, minute, second), state in zip(
        days.astype(int), calendar(t), states, strict=True
    ):
        clock = 3600 * int(hour) + 60 * int(minute) + float(second)
        lines.append("10 0 {} {:13.6f} 0 {:17.4f} {:17.4f} {:17.4f}".format(day, clock, *state[:3]))
        if velocities:
            lines.append("20 0 {:17.7f} {:17.7f} {:17.7f}".format(*state[3:]))
    return _written(path, [*lines, "99"])


def oem(path, parts, *, frame="EME2000", scale="UTC", name="ISS", extra=()):
    """Write parts, each times and states (n, 6) [m, m/s] in the frame, as segments of an OEM."""
    lines = ["CCSDS_OEM_VERS = 2.0", "CREATION_DATE = 2016-09-28T00:00:00", "ORIGINATOR = TEST"]
    for t, states in parts:
        texts = ccsds.utc_texts(EPOCH, t + AHEAD_OF_UTC[scale])
        lines += ["META_START", f"OBJECT_NAME = {name}", "OBJECT_ID = 1998-067-A", "CENTER_NAME = Earth"]
        lines += [f"REF_FRAME = {frame}", f"TIME_SYSTEM = {scale}", f"START_TIME = {texts[0]}"]
        lines += [f"STOP_TIME = {texts[-1]}", *extra, "META_STOP", "COMMENT a test"]
        lines += [
            " ".join([text, *(f"{value / 1e3:.12f}" for value in state)])
            for text, state in zip(texts, states, strict=True)
        ]
    return _written(path, lines)


def _written(path, lines):
    content = "".join(f"{line}\n" for line in lines).encode()
    Path(path).write_bytes(gzip.compress(content, mtime=0) if str(path).endswith(".gz") else content)
    return path
