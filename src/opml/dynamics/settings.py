"""Settings of the forces that arcs are propagated under, and of how they are integrated."""

from typing import Annotated

from annotated_types import Ge

from opml.base.constants import BODIES
from opml.base.section import Section, setting
from opml.base.setting_types import Expected, OneOf, Positive, Unique

Degree = Annotated[int, Ge(0), Expected("a whole number from 0")]

Body = Annotated[str, OneOf(BODIES)]

Bodies = Annotated[list[Body], Unique()]

FORCES = {"solid_tides": "tides of the solid Earth", "relativity": "general relativity"}
"""Forces that a force model may have or not, in words."""

Forces = Annotated[list[Annotated[str, OneOf(FORCES)]], Unique()]


class Integrator(Section):
    """The Dormand-Prince 8(5,3) method."""

    position_tolerance_m: Positive = setting(
        "absolute tolerance of each position component, by Dormand-Prince 8(5,3)", unit="m", default=0.1
    )
    min_step_s: Positive = setting("shortest step", unit="s", default=0.001)
    max_step_s: Positive = setting(
        "longest step; 90 s is the paper's, and 120 s the better choice for a study of one's own: it takes"
        " three quarters of the time, and after seven days orbits above 300 km are within a metre",
        unit="s",
        see="performance.md",
        default=90.0,
    )


class ForceModelSettings(Section):
    """A force model."""

    degree: Degree = setting("highest degree of the gravity field")
    order: Degree = setting("highest order of the gravity field")
    third_bodies: Bodies = setting("attracting bodies besides the Earth", unit="names")
    forces: Forces = setting(
        "forces beyond gravity, drag and radiation pressure: `solid_tides`, `relativity`",
        unit="names",
        see="physics.md",
        default=[],
    )


class ForceModels(Section):
    """The truth's force model, and that of fits and predictions."""

    truth: ForceModelSettings = setting("force model of the truth")
    assumed: ForceModelSettings = setting("force model of fits and predictions")
