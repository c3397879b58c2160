"""Sources of the environment, and what is known of it."""

from typing import Literal

from opml.base.section import Section, absent, setting
from opml.base.setting_types import Absent, Text


class EnvironmentSettings(Section):
    """Earth, Sun and Moon, and what is known of them."""

    gravity_field: Text = setting(
        "`EGM2008` (to degree 70, in the package) or an ICGEM file, such as EIGEN-6S (the paper's)",
        unit="name or path",
    )
    solar_activity: Text = setting(
        "`MSAFE`, `OBSERVED`, `NEWEST` (of `opml fetch`) or a file of either kind",
        unit="name or path",
        see="#solar-activity",
    )
    true_solar_activity: Absent[Text] = absent(
        "activity of the truth, if it is not `solar_activity`", unit="name or path"
    )
    percentile: Literal[95, 50, 5] = setting("column of an MSAFE bulletin")
    knowledge: Absent[Literal["monthly", "hindcast", "forecast"]] = absent(
        "what the assumed model knows of the weather: `monthly` figures, the weather up to t_j (`hindcast`),"
        " or up to t_i and a `forecast`; by default `solar_activity` as given",
        see="weather.md",
    )
    issue_hours: Absent[Literal[1, 3, 6, 12, 24]] = absent(
        "time between the issues of forecasts, counted from 00:00 UTC; predictions use the newest one",
        unit="h",
    )
