"""Draw P_ML against the size of the training data."""

import pandas as pd

from opml.figures import curves, style
from opml.jobs import job
from opml.tables import read_table

with job(snakemake):
    metrics = pd.concat([read_table(path, "metrics") for path in snakemake.input], ignore_index=True)
    partition = snakemake.params.settings["partition"]
    published = {float(ratio): value for ratio, value in partition["published"].items()}
    figure = curves.partition_curve(metrics, component=partition["component"], published=published)
    style.save(figure, snakemake.output.pdf, snakemake.output.png)
