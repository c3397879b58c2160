"""The tracks that are over on a morning, with numbers that stay theirs."""

from dataclasses import dataclass

import numpy as np
import pandas as pd


@dataclass(frozen=True)
class Recent:
    """The tracks of the last days that are over.

    tracking: their measurements, of tracks numbered from 0
    numbers: (tracks,) the number of each in the records of an object
    ends: (tracks,) when each is over, or was made [s]
    late: tracks that came after later ones had been estimated; they count nowhere
    """

    tracking: pd.DataFrame
    numbers: np.ndarray
    at: np.ndarray
    ends: np.ndarray
    late: int

    @property
    def tracks(self) -> int:
        """Number of the tracks."""
        return len(self.numbers)


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
    is_late = is_recent & ~is_kept & (at <= kept["t"].max())
    counting = is_recent & ~is_late
    rows = tracking[tracking["track"].isin(at.index[counting])]
    known = dict(zip(kept["t"], kept["track"], strict=True))
    following = int(kept["track"].max()) + 1 if len(kept) else 0
    new = counting & ~is_kept
    numbers = np.where(new, following + new.cumsum() - 1, at.map(known).fillna(-1)).astype(int)[counting]
    return Recent(
        rows.assign(track=np.searchsorted(at.index[counting], rows["track"])),
        numbers,
        at[counting].to_numpy(),
        ends[counting].to_numpy(),
        int(is_late.sum()),
    )
