"""The grammar of file names: every part that a product's name is made of is written and read here alone.

A station set is the stations' names joined with '-' in the sheet's order, ``eglin-kaena``. An RSO is a row's
name, or that row with another inclination in degrees (``iss_i50``), with kilometres added to its semi-major
axis (``iss_a+50``), or both (``iss_i50_a+50``). A split says which rows of a dataset a model is trained or
tested on: ``random-80``, ``grouped-80``, ``days-0-30``, ``days-30-40-unseen``, ``rest``, ``seen``. A test may
end in how its rows are treated: ``days-30-40-unfenced``, ``days-30-40-fence3``, ``rest-zscore``,
``rest-together``.

A suffix stands for one setting that differs from the run's own: ``eglin_noise43`` is what Eglin measures
under another seed, ``random-80_split43`` another draw of the same split, ``eglin_w24`` estimates from 24
hours of tracks, ``eglin_tol1`` of fits that stop earlier, ``eglin_cd0.5`` of fits that believe a drag
coefficient beforehand, ``eglin_light`` of fits that reckon with light time, ``svr_s2`` the learner ``svr``
with 2 as its kernel scale. The run's own setting has no suffix. So two names are never the same thing. What
errors are held against is ``_later`` or ``_smoothed`` estimates; no suffix is the truth.
"""

from opml.naming.estimates import (
    ARC,
    BOTH_SIDES,
    LABELS,
    LIGHT,
    MEMBERS,
    PERFECT,
    READINGS,
    TRACK,
    arc,
    both_sides,
    fitted,
    fitted_pattern,
    label_window,
    other_reading,
    parse_arc,
    parse_both_sides,
    parse_fitted,
    parse_reading,
    parse_window,
    window_pattern,
    windowed,
)
from opml.naming.experiment import (
    Experiment,
)
from opml.naming.objects import (
    WITHOUT,
    learner_pattern,
    parse_learner,
    parse_pool,
    pool_pattern,
    pool_without,
    rso_parts,
    rso_pattern,
    scaled,
    station_names,
    stations_pattern,
    varied_rso,
)
from opml.naming.row_splits import (
    STANDARDISATIONS,
    TEST,
    TEST_BY_ROW,
    TEST_TOGETHER,
    TRAIN,
    Split,
    as_unseen,
    check_split,
    days_split,
    fenced,
    parse_test,
    parse_train,
    treated,
)
from opml.naming.spelling import (
    NOISE,
    NUMBER,
    POSITIVE,
    SPLIT,
    any_of,
    number,
    parse_seed,
    seed_pattern,
    seeded,
    without_seed,
)

__all__ = [
    "ARC",
    "BOTH_SIDES",
    "LABELS",
    "LIGHT",
    "MEMBERS",
    "NOISE",
    "NUMBER",
    "PERFECT",
    "POSITIVE",
    "READINGS",
    "SPLIT",
    "STANDARDISATIONS",
    "TEST",
    "TEST_BY_ROW",
    "TEST_TOGETHER",
    "TRACK",
    "TRAIN",
    "WITHOUT",
    "Experiment",
    "Split",
    "any_of",
    "arc",
    "as_unseen",
    "both_sides",
    "check_split",
    "days_split",
    "fenced",
    "fitted",
    "fitted_pattern",
    "label_window",
    "learner_pattern",
    "number",
    "other_reading",
    "parse_arc",
    "parse_both_sides",
    "parse_fitted",
    "parse_learner",
    "parse_pool",
    "parse_reading",
    "parse_seed",
    "parse_test",
    "parse_train",
    "parse_window",
    "pool_pattern",
    "pool_without",
    "rso_parts",
    "rso_pattern",
    "scaled",
    "seed_pattern",
    "seeded",
    "station_names",
    "stations_pattern",
    "treated",
    "varied_rso",
    "window_pattern",
    "windowed",
    "without_seed",
]
