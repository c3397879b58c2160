"""Names of a run as figures show them: `swarm` is Swarm A, `eglin-clear-kaena` three radars."""

import re

from opml import naming
from opml.catalog import kinds

RSOS = {
    "iss": "ISS-based RSO",
    "swarma": "SWARM-A",
    "larets": "LARETS",
    "stella": "STELLA",
    "hy2a": "HAIYANG 2A",
    "lares": "LARES",
    "lageos1": "LAGEOS-1",
    "swarm": "Swarm A",
    "laretsslr": "Larets",
    "sentinel3a": "Sentinel-3A",
    "lageos2": "LAGEOS-2",
}
"""RSOs of the paper, as it writes them, and satellites of the packaged studies; others keep their name."""

_COUNTS = {1: "one radar", 2: "two radars", 3: "three radars"}
_CHANGED = re.compile(r"(?P<base>[^_]*)(?:_i(?P<i>[^_]+))?(?:_a(?P<a>[+-][^_]+))?")


def display_rso(name: str) -> str:
    """Return an RSO's name in words: `iss_i50_a+20` is `ISS-based RSO, i = 50 deg, a + 20 km`."""
    match = _CHANGED.fullmatch(name)
    if match is None:
        return name
    inclination, offset = match["i"], match["a"]
    return ", ".join(
        [
            RSOS.get(match["base"], match["base"]),
            *([f"i = {inclination} deg"] if inclination else []),
            *([f"a {offset[0]} {offset[1:]} km"] if offset else []),
        ]
    )


def display_stations(name: str) -> str:
    """Return a station set in words: `eglin-clear` is `two radars (Eglin, Clear)`."""
    if name in kinds.in_place_of_stations():
        return name
    stations = naming.strip_seed(name, naming.NOISE).split("-")
    count = _COUNTS.get(len(stations), f"{len(stations)} radars")
    return f"{count} ({', '.join(station.capitalize() for station in stations)})"


def display_learner(name: str) -> str:
    """Return a learner in words: the paper's own by its origin; others keep their name."""
    return {"svr": "the paper's SVR"}.get(name, name)


def describe_run(rso: str, stations: str) -> str:
    """Return whose tracks a figure is about: `Swarm A by three radars (Eglin, Clear, Kaena)`."""
    return f"{display_rso(rso)} by {display_stations(stations)}"
