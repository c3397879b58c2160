"""The tracks that are over on a morning, with numbers that stay theirs.

Estimates ascend in time. A track that comes after later ones were estimated gets none of its own; fits of the
tracks to come take its measurements.
"""

from dataclasses import dataclass

import numpy as np
import pandas as pd

NO_NUMBER = -1
"""The number of a track that gets no estimate."""


@dataclass(frozen=True)
class Recent:
    """The tracks of the last days that are over.

    tracking: their measurements, of tracks numbered from 0
    numbers: (tracks,) the number of each in the records of an object, or NO_NUMBER
    ends: (tracks,) when each is over, or was made [s]
    """

    tracking: pd.DataFrame
    numbers: np.ndarray
    at: np.ndarray
    ends: np.ndarray

    @property
    def tracks(self) -> int:
        """Number of the tracks."""
        return len(self.numbers)

    @property
    def late(self) -> int:
        """Number of those that came after later ones had been estimated."""
        return int(np.sum(self.numbers == NO_NUMBER))

    def places(self, numbers: pd.Series) -> np.ndarray:
        """Return which of the tracks have some of these numbers."""
        return np.asarray(pd.Index(self.numbers).get_indexer(numbers))


def over(tracking: pd.DataFrame, kept: pd.DataFrame, *, now: float, reach: float) -> Recent:
    """Return the tracks that are over by `now` [s] and whose estimates are at most `reach` [s] old.

    tracking: that table, or another in its place
    kept: track and t of the estimates of earlier mornings
    """
    by_track = tracking.groupby("track", sort=True)
    at = by_track["t_estimate" if "t_estimate" in tracking else "t"].min()
    ends = by_track["t_known" if "t_known" in tracking else "t"].max()
    is_kept = at.isin(kept["t"])
    is_recent = (ends <= now) & (at > now - reach)
    rows = tracking[tracking["track"].isin(at.index[is_recent])]
    known = dict(zip(kept["t"], kept["track"], strict=True))
    following = int(kept["track"].max()) + 1 if len(kept) else 0
    is_new = is_recent & ~is_kept & ~(at <= kept["t"].max())
    numbers = np.where(is_new, following + is_new.cumsum() - 1, at.map(known).fillna(NO_NUMBER)).astype(int)
    return Recent(
        rows.assign(track=np.searchsorted(at.index[is_recent], rows["track"])),
        numbers[is_recent],
        at[is_recent].to_numpy(),
        ends[is_recent].to_numpy(),
    )
