"""The component of a position's error that is corrected, and those that are held against it."""

from opml.orbits.rsw_covariance import AXES

POSITION = [f"e_{axis}" for axis in AXES]
"""Components of the error of a position; a list, so that a DataFrame takes it as it is."""

CORRECTED = "e_y"
"""The component that a prediction is corrected in, along its path; the others follow from it."""

UNCORRECTED = "none"
"""The learner whose predictions are the catalogue's own, which the fits' covariances are about."""
