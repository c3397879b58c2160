"""How arcs are integrated: settings of the Dormand-Prince 8(5,3) method."""

from opml.base.section import Section, setting
from opml.base.setting_types import Positive


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
