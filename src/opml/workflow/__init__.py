"""The workflow's side of the package: what jobs need, the inputs of rules, a run as an archive."""
