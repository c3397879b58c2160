"""A catalogue's chain: simulate tracks, fit estimates to them, predict from those.

Throughout, `propagator` is under the assumed model unless another is named, `tracking`, `starts`, `estimates`
and `predictions` are tables of that name, `epoch` is the UTC text from which times [s] count, and states of
arcs, arrays (arcs, 6), are in GCRF [m, m/s].
"""
