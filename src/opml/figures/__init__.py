"""The paper's figures, drawn from tables.

Throughout, `evaluation`, `tracking`, `truth`, `metrics` and `dataset` are tables of that name, `component` is
that of the error, `epoch` the UTC text from which days count, and `note` says what was drawn: whose orbits or
errors, of which training and test.
"""
