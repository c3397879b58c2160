"""Components of the errors of a prediction, by the part they play in corrections."""

from opml.orbits.rsw_covariance import AXES

POSITION = [f"e_{axis}" for axis in AXES]
"""Components of the error of a position; a list, because a DataFrame takes a list of columns."""

CORRECTED = "e_y"  # the component that is corrected, along the path; the others follow from it
