"""Random generators, by a seed and names alone: order, time and threads do not matter."""

import hashlib

import numpy as np


def derive(seed: int, *names: str) -> np.random.Generator:
    """Return the generator of `names` under `seed`.

    SHA-256 of the names seeds numpy's `SeedSequence`. So the noise of a station, for example, stays the same
    whichever other stations are simulated.
    """
    text = "\x1f".join((str(int(seed)), *map(str, names)))
    words = np.frombuffer(hashlib.sha256(text.encode()).digest(), dtype="<u4")
    return np.random.default_rng(np.random.SeedSequence([int(word) for word in words]))
