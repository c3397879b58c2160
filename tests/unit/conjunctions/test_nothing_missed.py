"""Random pairs with an approach built in: none is missed, whatever the orbits and what is known of them."""

from itertools import pairwise

import numpy as np
import pytest
from test_approaches import kepler

from opml.base.constants import DAY, EARTH_GM, WGS84_A
from opml.conjunctions import screening
from opml.conjunctions.trajectories import ScreenedObject
from opml.interop import oem
from opml.interop.element_sets import element_set, mean_elements, tle
from opml.interop.ephemeris import EPOCH, Ephemeris
from opml.interop.object_ids import ObjectId

SPAN = 0.5 * DAY
EDGE = 2.1e3
"""Time from the ends of a span in which no approach is built [s]."""

ROUGH = 20.0
"""By how much polynomials through states five minutes apart err at a low perigee [m]."""

KINK = 100.0
"""By how much they err where SGP4 jumps: where the eccentricity of a sinking object gets to 0 [m]."""

STEPS = (20.0, 60.0, 97.3, 180.0, 300.0)
OURS, OTHER = ObjectId("ours", "2000-001A"), ObjectId("other", "2001-001A")


def direction(rng):
    vector = rng.normal(size=3)
    return vector / np.linalg.norm(vector)


def turned(vector, axis, angle):
    sine, cosine = np.sin(angle), np.cos(angle)
    return vector * cosine + np.cross(axis, vector) * sine + axis * (axis @ vector) * (1.0 - cosine)


def velocity_of_orbit(rng, out, distance, most_eccentric):
    """The velocity of an orbit with a perigee above 6450 km, at a distance from the Earth in a direction."""
    e, nu = rng.uniform(0.0, most_eccentric), rng.uniform(-2.5, 2.5)
    if distance * (1.0 + e * np.cos(nu)) / (1.0 + e) < 6.45e6:
        nu = 0.0
    speed = np.sqrt(EARTH_GM / (distance * (1.0 + e * np.cos(nu))))
    along = np.cross(direction(rng), out)
    return speed * (e * np.sin(nu) * out + (1.0 + e * np.cos(nu)) * along / np.linalg.norm(along))


def met(rng, most_eccentric):
    """The states of two objects on crossing orbits that pass each other within two kilometres."""
    out, distance = direction(rng), rng.uniform(6.5e6, 9e6)
    velocities = [velocity_of_orbit(rng, out, distance, most_eccentric) for _ in range(2)]
    return beside(rng, distance * out, *velocities)


def beside(rng, position, one, other):
    across = np.cross(other - one, direction(rng))
    miss = rng.uniform(0.0, 2e3) * across / max(np.linalg.norm(across), 1e-9)
    return np.concatenate([position, one]), np.concatenate([position + miss, other])


def keeping_up(rng):
    """The states of two objects that hardly move relative to each other, or not at all."""
    out, distance = direction(rng), rng.uniform(6.6e6, 8.5e6)
    velocity = velocity_of_orbit(rng, out, distance, 0.3)
    slowly = rng.choice([0.0, 1e-3, 0.1, 1.0, 10.0]) * direction(rng)
    return beside(rng, distance * out, velocity, velocity + slowly)


def trajectories(rng, state, at, edges):
    """Trajectories on an ellipse between times, one after the other."""
    counts = [max(3, int(np.ceil((b - a) / rng.choice(STEPS)))) for a, b in pairwise(edges)]
    spans = [np.linspace(*span, count + 1) for span, count in zip(pairwise(edges), counts, strict=True)]
    return [Ephemeris("one", t, kepler(state, at, t)) for t in spans]


def whole(rng, at):
    return 0.0, SPAN


def in_segments(rng, at):
    """Edges of segments, of which one may be the approach itself."""
    inner = rng.uniform(EDGE, SPAN - EDGE, rng.integers(1, 4))
    inner = np.append(inner[abs(inner - at) > EDGE], [at] if rng.random() < 0.3 else [])
    edges = np.unique([0.0, *inner, SPAN])
    return edges[np.append(True, np.diff(edges) > 1.6e3)] if at not in edges else np.unique([0.0, at, SPAN])


def in_part(rng, at):
    begin = rng.uniform(at - EDGE, at)
    return begin, begin + rng.uniform(EDGE, 2.0 * EDGE)


def to_an_end(rng, at):
    """Edges that begin or end within a tenth of a second about the approach."""
    near = at + rng.uniform(-0.1, 0.1)
    return (0.0, near) if rng.random() < 0.5 else (near, SPAN)


KINDS = {
    "circular": (lambda rng: met(rng, 0.0), whole, whole),
    "eccentric": (lambda rng: met(rng, 0.9), whole, whole),
    "slow": (keeping_up, whole, whole),
    "slow in segments": (keeping_up, in_segments, in_segments),
    "ours in segments": (lambda rng: met(rng, 0.5), in_segments, whole),
    "in segments": (lambda rng: met(rng, 0.5), in_segments, in_segments),
    "in part": (lambda rng: met(rng, 0.5), whole, in_part),
    "to an end": (lambda rng: met(rng, 0.9), to_an_end, whole),
}


def is_found(kind, number):
    """Whether the approach of a pair is found, as near as it was built, or as it is at an end just beside."""
    rng = np.random.default_rng([number, *kind.encode()])
    states_of, ours_known, other_known = KINDS[kind]
    at = rng.uniform(EDGE, SPAN - EDGE)
    states, edges = states_of(rng), (ours_known(rng, at), other_known(rng, at))
    known = np.clip(at, max(edge[0] for edge in edges), min(edge[-1] for edge in edges))
    one, other = (kepler(state, at, np.array([known]))[0, :3] for state in states)
    pair = [
        ScreenedObject(identity, "", 0.0, trajectories(rng, state, at, edge))
        for identity, state, edge in zip((OURS, OTHER), states, edges, strict=True)
    ]
    near = SPAN if states_of is keeping_up else 5.0
    return any(
        np.linalg.norm(found.relative[:3]) <= np.linalg.norm(other - one) + ROUGH
        for found in screening.screen(pair, within=5e3, radius=20.0)
        if abs(found.t - at) <= near
    )


def sinking(rng):
    """Mean elements that are above 80 km for a part of the span alone, and how long."""
    t = np.arange(0.0, SPAN, 60.0)
    while True:
        bstar, motion = 10.0 ** rng.uniform(-2.0, -1.0), rng.uniform(16.1, 16.4) / element_set.PER_DAY
        satellite = element_set.satellite(EPOCH, [motion, 1e-3, *rng.uniform(0.1, 3.0, 4), bstar])
        states = mean_elements.states(satellite, epoch=EPOCH, t=t)
        flies = np.linalg.norm(states[:, :3], axis=1) > WGS84_A + 80e3
        if (end := t[np.argmin(flies)]) > 2.0 * EDGE and not flies.all():
            return satellite, end


def is_found_before_it_decays(folder, number):
    rng = np.random.default_rng(number)
    satellite, end = sinking(rng)
    at = rng.uniform(EDGE, end - 60.0)
    tle.write(folder / "sinking.tle", satellite, ObjectId("sinking", number=40004))
    (read,) = mean_elements.read_sets(folder / "sinking.tle")
    (state,) = mean_elements.states(read.satellite, epoch=EPOCH, t=np.array([at]))
    up = state[:3] / np.linalg.norm(state[:3])
    velocity = turned(state[3:], up, rng.uniform(0.3, 3.0))
    t = np.arange(0.0, SPAN + 1.0, 120.0)
    ours = kepler(np.concatenate([state[:3] + 30.0 * up, velocity]), at, t)
    oem.write(folder / "ours.oem", [Ephemeris("ours", t, ours)], epoch=EPOCH)
    pair = screening.read([folder / "ours.oem", folder / "sinking.tle"])
    found = screening.screen(pair, within=1e3, radius=20.0)
    return any(abs(one.t - at) < 1.0 and np.linalg.norm(one.relative[:3]) <= 30.0 + KINK for one in found)


FEW_AND_MANY = pytest.mark.parametrize(
    "numbers", [range(25), pytest.param(range(25, 125), marks=pytest.mark.slow)], ids=["few", "many"]
)


@FEW_AND_MANY
@pytest.mark.parametrize("kind", KINDS)
def test_no_pair_is_missed(kind, numbers):
    assert [k for k in numbers if not is_found(kind, k)] == []


@FEW_AND_MANY
def test_no_object_is_missed_before_it_decays(tmp_path, numbers):
    assert [k for k in numbers if not is_found_before_it_decays(tmp_path, k)] == []
