# Files of the targets, by the parts of the study.
PAPER_PARTS = {
    "reproduction": lambda: rules.reproduction.output,
    "evaluations": lambda: [
        *rules.tables.output,
        *(path_of(file, evaluation=name) for name in PAPER.evaluations for file in rules.svr.output),
    ],
    "orbit": lambda: [*rules.estimation_window.output, *rules.orbit.output],
    "distribution": lambda: rules.error_distribution.output,
    "partition": lambda: [
        *(
            path_of(file, ratio=ratio)
            for ratio in STUDY.entry("partition").get("shown", [])
            for file in rules.partition.output
        ),
        *rules.partition_curve.output,
    ],
    "individual": lambda: rules.individual.output,
    "grids": lambda: [path_of(file, grid=name) for name in PAPER.grids for file in rules.rso_grid.output],
    "curves": lambda: [
        path_of(file, curve=name) for name in PAPER.curves for file in rules.transfer_curve.output
    ],
}
PAPER_FILES = [file for part, files in PAPER_PARTS.items() if part in STUDY for file in files()]
STUDY_FILES = (
    [
        *rules.study_report.output,
        *(path_of(file, rso=rso) for rso in STUDY.rsos for file in rules.study_models.output),
    ]
    if OWN.is_asked
    else []
)

if PLAN.settings.misfit:
    # A run that is too short for the default study is wrong only where something of that study is asked for.
    for maker in {file.rule for file in [*PAPER_FILES, *STUDY_FILES]}:
        maker.set_input(fits=lambda wildcards: end_plan(PLAN.settings.misfit))
