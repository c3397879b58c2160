"""Draw the true errors of the predictions that survived cleaning against their duration."""

from opml.base.section import JobSettings
from opml.figures import prediction_errors, style
from opml.figures.display_names import describe_run
from opml.learning.data.splits import in_days
from opml.tables import read_table
from opml.workflow.jobs import job


class Settings(JobSettings):
    rso: str
    stations: str
    days: tuple[float, float]


with job(snakemake):
    settings = Settings(**snakemake.params.settings)
    dataset = read_table(snakemake.input[0], "dataset")
    pairs = dataset[dataset["keep"] & in_days(dataset["t_j"], settings.days)]
    note = prediction_errors.pairs_note(pairs, describe_run(settings.rso, settings.stations), settings.days)
    figures = [
        prediction_errors.distribution_position(pairs, note=note),
        prediction_errors.distribution_velocity(pairs, note=note),
    ]
    style.save_all(figures, snakemake.output.pdf, snakemake.output.png)
