"""Tables of the environment, by the step of the chain that reads them."""

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from opml import tables
from opml.environment import known_weather, solar_activity
from opml.environment.settings import EnvironmentSettings
from opml.study.settings.model.whole import RunSettings


@dataclass(frozen=True)
class EnvironmentFiles:
    """Paths of the environment's tables by their names, for the truth, for fits and for predictions."""

    run: RunSettings

    def path(self, table: str) -> str:
        """Return the path of a table."""
        return f"{self.run.results}/environment/{table}.parquet"

    @property
    def sources(self) -> EnvironmentSettings:
        """The settings of the environment: where each table comes from, and what is known when."""
        return self.run.environment

    def source(self, table: str) -> str:
        """Return where a table comes from: its name or file."""
        return str(getattr(self.sources, table))

    @property
    def is_forecast(self) -> bool:
        """Whether predictions are propagated under a forecast of the space weather."""
        return self.sources.knowledge == known_weather.FORECAST

    @property
    def true_activity(self) -> str:
        """Name of the solar activity that the truth is propagated under."""
        return "true_solar_activity" if self.sources.true_solar_activity else "solar_activity"

    @cached_property
    def truth(self) -> dict[str, str]:
        """Tables that the truth reads; another activity than the assumed one, where set."""
        return self._all | {"solar_activity": self.path(self.true_activity)}

    @cached_property
    def fits(self) -> dict[str, str]:
        """Tables that fits read; with a forecast, all that was measured by the time of each fit."""
        return self._known(outlooks_every=known_weather.FIT_HOURS)

    @cached_property
    def predictions(self) -> dict[str, str]:
        """Tables that predictions read; those of a day share an outlook, so that their arcs share blocks."""
        return self._known(outlooks_every=self.sources.issue_hours)

    def futures(self, members: int) -> str | list[str]:
        """Return the path of the courses that the weather may take; none where it is taken for known."""
        return self.path(f"futures_{members}") if self.is_forecast else []

    def _known(self, *, outlooks_every: int | None) -> dict[str, str]:
        paths = self._all
        if self.sources.knowledge in known_weather.KNOWN:
            paths["solar_activity"] = self.path("hindcast")
        if self.is_forecast:
            paths[tables.OUTLOOKS] = self.path(f"{tables.OUTLOOKS}_{outlooks_every}h")
        return paths

    @property
    def _all(self) -> dict[str, str]:
        return {table: self.path(table) for table in tables.ENVIRONMENT}

    def source_files(self, table: str) -> list[str]:
        """Return the user's own file behind a table; none where the source is a packaged one."""
        source = self.source(table)
        path = solar_activity.resolve(source) if source == solar_activity.NEWEST else Path(source)
        return [str(path)] if path.suffix else []
