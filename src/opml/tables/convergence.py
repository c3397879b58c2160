"""The error where no fit of a table of estimates converged."""

from collections.abc import Iterable

import pandas as pd

from opml.base.errors import InputError

FAR = 3.0  # root mean square of weighted residuals from which on measurements are none of the orbit


def none_converged(what: str, estimates: Iterable[pd.DataFrame]) -> InputError:
    """Return the error that no estimate converged, with what the residuals say of the cause.

    what: file or name that the estimates are needed for
    estimates: tables `estimates`, none of whose rows converged
    """
    table = pd.concat(list(estimates))
    rms = table["weighted_rms"].median()
    hint = (
        f", with residuals of {rms:.3g} times the stations' noise in the median: "
        "did these stations measure, and this RSO?"
        if rms > FAR
        else ""
    )
    count = f"none of {len(table)}" if len(table) else "none"
    return InputError(f"{what}: expected an estimate that converged, got {count}{hint}")
