"""Draw the true prediction errors of the rows that survived cleaning against the prediction duration."""

from opml.figures import errors, style
from opml.jobs import job
from opml.learning.splits import in_days
from opml.tables import read_table

with job(snakemake):
    settings = snakemake.params.settings
    dataset = read_table(snakemake.input[0], "dataset")
    pairs = dataset[dataset["keep"] & in_days(dataset["t_j"], settings["days"])]
    note = errors.of_pairs(pairs, **settings)
    figures = [errors.distribution_position(pairs, note=note), errors.distribution_velocity(pairs, note=note)]
    style.save_all(figures, snakemake.output.pdf, snakemake.output.png)
