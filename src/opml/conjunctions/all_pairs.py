"""Close approaches among all objects of a catalogue of mean elements.

opml screen catalogue.tle --days 7 --within 1
"""

import logging
from collections.abc import Iterator

from opml.base.errors import InputError
from opml.base.files import FilePath
from opml.conjunctions import sieve
from opml.conjunctions.conjunction import Conjunction, check_length, check_radius
from opml.conjunctions.screening import approaches_of
from opml.conjunctions.trajectories import read_elements, span_of_days

_REACH = 300.0  # time before and after a look in which two objects that may be near are propagated [s]

_log = logging.getLogger(__name__)


def screen(path: FilePath, *, days: float, within: float, radius: float) -> Iterator[Conjunction]:
    """Yield the close approaches of all pairs of objects in a file of mean elements, in the order of time.

    days: from the newest set on
    within: largest distance [m]
    radius: sum of the radii of two objects [m]

    The newest set of each object is propagated by SGP4. Raises InputError for a file of fewer than two
    objects, and for a length that is none.
    """
    check_length("within", within)
    check_radius(radius)
    elements = read_elements([path], span_of_days(path, days))
    if len(elements) < 2:
        raise InputError(f"{path}: expected mean elements of two objects or more, got one")
    living = [(one, one.life) for one in elements if one.life is not None]
    known = sum(life[0] <= one.span[0] and life[1] >= one.span[1] for one, life in living)
    if known < len(elements):
        _log.warning("orbits unknown for a part of the time: %d of %d", len(elements) - known, len(elements))
    orbits = [(one.known_set, life) for one, life in living]
    for begin, end, pairs in sieve.near_pairs(orbits, elements[0].span, within):
        reach = begin - _REACH, end + _REACH
        both = ((living[k][0], living[n][0]) for k, n in pairs)
        near = [
            conjunction
            for one, other in both
            for conjunction in approaches_of(
                (one, other), (one.during(reach), other.during(reach)), within, radius
            )
            if begin <= conjunction.t < end
        ]
        yield from sorted(near, key=lambda conjunction: conjunction.t)
