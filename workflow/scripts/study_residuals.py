"""Draw sizes of errors by duration: uncorrected, corrected by the model that the past chooses, by others."""

from opml.figures import study, style
from opml.figures.labels import experiment
from opml.jobs import job
from opml.report.study import choice
from opml.tables import read_table, read_tables

with job(snakemake):
    settings, files = snakemake.params.settings, snakemake.input
    names, learned = settings["learners"], settings["learned"]
    tables = {
        name: read_table(path, "evaluation") for name, path in zip(names, files.evaluations, strict=True)
    }
    past = read_tables(files.trials, "metrics").set_index("learner")["p_ml"] if files.trials else {}
    fixed = [name for name in names if name not in learned]
    figure = study.residuals(
        tables,
        chosen=choice(dict(past), fixed) if len(past) else names[-1],
        learned=learned,
        component=settings["component"],
        note=experiment(**settings),
    )
    style.save_all([figure], snakemake.output.pdf, snakemake.output.png)
