"""Names of products, and the paths that belong to one."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Product:
    """The paths of what a rule makes, with its log and its benchmark."""

    results: str  # folder of the results
    name: str  # path below it without suffix; may hold wildcards in braces

    @property
    def table(self) -> str:
        """Path of the product as a Parquet table."""
        return self.file("parquet")

    @property
    def log(self) -> str:
        """Path of the rule's log."""
        return f"{self.results}/logs/{self.name}.log"

    @property
    def benchmark(self) -> str:
        """Path of the rule's benchmark: time and memory of its job."""
        return f"{self.results}/benchmarks/{self.name}.tsv"

    @property
    def title(self) -> str:
        """Last part of the name."""
        return self.name.rpartition("/")[2]

    @property
    def folder(self) -> str:
        """Path of the product as a folder."""
        return f"{self.results}/{self.name}"

    def file(self, suffix: str) -> str:
        """Return the path of the product in the format of a suffix."""
        return f"{self.results}/{self.name}.{suffix}"
