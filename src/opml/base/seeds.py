"""Random generators that depend on a seed and on names only, never on order, time or threads."""

import hashlib

import numpy as np


def derive(seed: int, *names: str) -> np.random.Generator:
    """Return the generator that belongs to `names` under `seed`.

    The names are hashed with SHA-256 into numpy's `SeedSequence`, so the noise of one station, say, stays the
    same whichever others are simulated beside it.
    """
    text = "\x1f".join((str(int(seed)), *map(str, names)))
    words = np.frombuffer(hashlib.sha256(text.encode()).digest(), dtype="<u4")
    return np.random.default_rng(np.random.SeedSequence([int(word) for word in words]))
