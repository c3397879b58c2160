"""Origins that roll over the days of a training, to see what models leave of the errors behind them."""

import numpy as np

from opml import naming
from opml.errors import InputError

ORIGINS = (1.0 / 3.0, 1.0 / 2.0, 2.0 / 3.0)
"""Shares of the training's days that models are trained on again, to see what they leave behind them."""

LEAST_BLOCKS = 9
"""Blocks of days that an interval of 90 % needs: with one more that may lie anywhere, nine are 90 %."""


def origins(train: str, *, longest_days: float, block_hours: float) -> list[float]:
    """The origins [days] that roll over the training split `train`.

    An origin counts where the days before it last as long as the longest prediction, as a model cannot be
    asked for durations that it never met. Raises InputError for a split that is no window of days, and where
    too few blocks of days are left behind the origins for an interval of 90 %.
    """
    split = naming.parse_train(train)
    if split.kind != "days":
        raise InputError(f"uncertainty: expected a window of days to train on, got '{train}'")
    first, last = split.days
    found = [first + share * (last - first) for share in ORIGINS if share * (last - first) >= longest_days]
    blocks = sum(int(np.ceil(round((last - origin) * 24.0 / block_hours, 6))) for origin in found)
    if blocks < LEAST_BLOCKS:
        raise InputError(
            f"uncertainty: expected {LEAST_BLOCKS} blocks of {block_hours:g} hours behind origins that lie "
            f"{longest_days:g} days or more within '{train}', got {blocks}"
        )
    return found
