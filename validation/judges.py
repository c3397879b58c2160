"""Holds what judges predictions of public sets against a precise orbit of one object:

    python -m validation.judges ORBIT NUMBER WEATHER SETS...

ORBIT is an SP3, CPF or OEM file, NUMBER that of the object in the catalogue, WEATHER OBSERVED or a CSSI file,
SETS are files of element sets. At the epochs of the daily sets within the orbit a line a judge tells root
mean squares outwards, along and across the track [m]: of SGP4, of the orbits inside, and of their sigmas.
"""

import sys
from collections.abc import Sequence

import numpy as np
import pandas as pd

from opml.element_sets import catalogue
from opml.element_sets.catalogue import ElementCatalogue
from opml.element_sets.inside import inside_forces, inside_sizes, set_orbits
from opml.interop import known_orbits
from opml.interop.element_sets import mean_elements
from opml.interop.element_sets.element_set import seconds_since
from opml.interop.ephemeris import EPOCH
from opml.orbits.elements import bent_rsw
from opml.tables import STATE


def errors(orbit: known_orbits.KnownOrbit, sets: ElementCatalogue, weather: str) -> dict[str, np.ndarray]:
    """Return the errors (sets, 3) in RSW [m] of each judge at the epochs of sets, and the orbits' sigmas.

    sets: of the object; those outside its precise orbit do not count
    """
    t = seconds_since(EPOCH, sets.satellites)
    truth = orbit.at(t)
    there = np.flatnonzero(np.isfinite(truth).all(axis=1))
    own, truth = sets.take(there), truth[there]
    days = own.table["t"]
    forces = inside_forces.read(weather, first=days.min(), last=days.max())
    inside = set_orbits.states(own, forces, np.full(len(there), np.nan), set_orbits.usual_spans(own))
    positions = inside[[*STATE[:3]]].to_numpy()
    by_sgp4 = [
        mean_elements.states(one, epoch=EPOCH, t=t[k : k + 1])[0]
        for k, one in zip(there, own.satellites, strict=True)
    ]
    return {
        "later set": bent_rsw(np.array(by_sgp4)[:, :3], truth),
        "orbit inside": bent_rsw(positions, truth),
        "its sigma": np.array([inside_sizes.at_epoch(one) for one in own.satellites]),
    }


def main(arguments: Sequence[str]) -> None:
    """Print the table of an orbit's file, a number, weather and files of sets."""
    orbit, number, weather, *files = arguments
    sets = catalogue.read(files).daily()
    own = sets.take(np.flatnonzero(sets.table["number"] == int(number)))
    off = errors(known_orbits.read([orbit]), own, weather)
    rows = {name: [*np.sqrt((one**2).mean(axis=0)), len(one)] for name, one in off.items()}
    print(pd.DataFrame.from_dict(rows, orient="index", columns=[*"rsw", "sets"]).round().to_string())


if __name__ == "__main__":
    main(sys.argv[1:])
