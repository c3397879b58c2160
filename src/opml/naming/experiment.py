"""An experiment, one model applied to one test, as the parts of its files' names."""

from dataclasses import asdict, dataclass


@dataclass(frozen=True)
class Experiment:
    """One model applied to one test: the parts of its files' names."""

    rso: str
    stations: str
    train: str
    learner: str
    component: str
    target: str
    test: str
    reading: str = ""
    window: str = ""
    label: str = ""

    def names(self) -> dict[str, str]:
        """Return the wildcards by name."""
        return asdict(self)

    def columns(self) -> dict[str, str]:
        """Return the parts as the columns of `metrics`; window, reading and label belong to the stations."""
        names = self.names()
        names["stations"] += names.pop("window") + names.pop("reading") + names.pop("label")
        return names

    def path(self, kind: str) -> str:
        """Return the path of the experiment's file of a kind, such as `metrics`, below the results folder."""
        return f"{kind}/{'/'.join(self.columns().values())}.parquet"
