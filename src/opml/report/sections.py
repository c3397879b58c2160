"""The sections of Snakemake's report: the paper's, numbered as it prints them, and ours."""

from opml.naming import Experiment, parse_test

SECTIONS = {
    "simulation": "2 Simulation Environment",
    "learning": "3 Prediction Accuracy Improvement through Machine Learning",
    "numerical": "4 Numerical Results of Improving Orbit Prediction",
    "future": "5 Generalize the SVM Model to Future Epochs",
    "nearby": "6 Generalization to Nearby RSOs",
    "study": "7 The study",
}
"""Titles of the sections, by a word for each."""


def section_of(experiment: Experiment) -> str:
    """Return the paper's section that an experiment belongs to."""
    if experiment.target != experiment.rso:
        return SECTIONS["nearby"]
    return SECTIONS["future" if parse_test(experiment.test).kind == "days" else "numerical"]
