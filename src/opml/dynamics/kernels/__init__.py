"""Compiled kernels, which know arrays and numbers alone: forces, the integrator's step, a block of arcs.

Throughout, `model` is the force model, `weights` and `tides` are its own; x, y, z a position [m], in ITRF
where the Earth's field or air is meant; `inverse_r` the inverse distance from the geocentre [1/m]; sin_lat
and cos_lat of the geodetic latitude, sin_lon and cos_lon of the longitude, eastwards; `state` (6, WIDTH) is
at the beginning of a step, GCRF [m, m/s], t and h its beginning and length [s]; `coefficients` (3, WIDTH) are
Cd A/m and Cr A/m [m2/kg] and the kind of activity; `scratch` has SCRATCH_ROWS rows of lanes by default.
"""
