"""The workflow's side of the package: plan, inputs and params of rules, jobs, a run as an archive."""
