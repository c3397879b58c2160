"""Predict under each of the futures of the space weather, and tell their spread."""

from opml.catalog import ensembles, force_model
from opml.constants import HOUR
from opml.jobs import job, progress
from opml.sheets import Rso
from opml.tables import read_table, write_table

with job(snakemake) as metadata:
    settings, files = snakemake.params.settings, snakemake.input
    predictions = read_table(files.predictions, "predictions")
    sample = ensembles.sample(
        force_model.read(files, epoch=settings["epoch"], settings=settings["force_model"]),
        read_table(files.futures, "futures"),
        read_table(files.estimates, "estimates"),
        predictions,
        Rso(**settings["rso"]),
        window=HOUR * settings["window_hours"],
        seed=settings["seed"],
        integrator=force_model.integrator(settings["integrator"]),
        threads=snakemake.threads,
        progress=progress,
    )
    write_table(snakemake.output.sample, sample, "ensemble", metadata=metadata)
    fan = ensembles.fan(sample, predictions, level=settings["level"])
    metadata |= {"level": settings["level"]}
    write_table(snakemake.output.fan, fan, "fan", metadata=metadata)
    write_table(snakemake.output.scores, ensembles.scores(fan), "scores", metadata=metadata)
