"""Draw the true prediction errors of the rows that survived cleaning against the prediction duration."""

from opml.figures import errors, style
from opml.jobs import job
from opml.learning.splits import in_days
from opml.tables import read_table

with job(snakemake):
    dataset = read_table(snakemake.input[0], "dataset")
    pairs = dataset[dataset["keep"] & in_days(dataset["t_j"], snakemake.params.settings["days"])]
    figures = [errors.distribution_position(pairs), errors.distribution_velocity(pairs)]
    style.save_all(figures, snakemake.output.pdf, snakemake.output.png)
