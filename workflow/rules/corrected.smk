# Ephemerides for operators: corrected by a learner, each epoch with a covariance.
# None needs a truth.
CORRECTED = product(f"corrected/{EPHEMERIS}")
# The export is a job beside that of the table, with a log of its own.
CORRECTED_OEM = product(f"corrected/{EPHEMERIS}_oem")
CORRECTED_FIGURE = product(f"figs/corrected/{EPHEMERIS}")


rule corrected:
    input:
        **ENVIRONMENT.predictions,
        estimates=rules.estimation.output[0],
        predictions=rules.prediction.output[0],
        tracking=rules.tracking.output[0],
        long_estimates=INPUTS.long_estimates(rules.estimation.output[0]),
        arc_estimates=INPUTS.arc_estimates(rules.estimation.output[0]),
        manoeuvres=INPUTS.user_manoeuvres(rules.truth.output[0], rules.tracking.output[0]),
        dataset=rules.train.input.dataset,
        others=INPUTS.learner_tables("rso"),
        replay=rules.replay.output[0],
        futures=INPUTS.futures(rules.futures.output[0]),
        check=checks(PARAMS.split, PARAMS.train_days),
    output:
        CORRECTED.table,
    log:
        CORRECTED.log,
    benchmark:
        CORRECTED.benchmark
    wildcard_constraints:
        window=PLAN.window_pattern,
    conda:
        "../envs/opml.yaml"
    resources:
        mem_mb=1750,
        runtime=8,
    params:
        settings=lambda wildcards: PARAMS.daily_training(wildcards) | PARAMS.ephemeris(wildcards),
        code=code("corrected.py"),
    message:
        "Corrected ephemeris: {wildcards.rso} by {wildcards.stations}, corrected by {wildcards.learner}"
    script:
        "../scripts/corrected.py"


use rule export_truth as export_corrected with:
    input:
        rules.corrected.output[0],
        source=INPUTS.source,
    output:
        CORRECTED.file("oem"),
    log:
        CORRECTED_OEM.log,
    benchmark:
        CORRECTED_OEM.benchmark
    wildcard_constraints:
        window=PLAN.window_pattern,
    params:
        settings=lambda wildcards: {"epoch": config["epoch"], "table": "corrected", "rso": wildcards.rso},
        code=code("export_oem.py"),
    message:
        "Export: corrected ephemeris of {wildcards.rso} by {wildcards.stations}, with covariances, as CCSDS OEM"


use rule errors as corrected_figure with:
    input:
        corrected=rules.corrected.output[0],
        estimates=rules.estimation.output[0],
    output:
        pdf=CORRECTED_FIGURE.file("pdf"),
        png=CORRECTED_FIGURE.file("png"),
    log:
        CORRECTED_FIGURE.log,
    benchmark:
        CORRECTED_FIGURE.benchmark
    wildcard_constraints:
        window=PLAN.window_pattern,
    params:
        **drawing(
            "corrected_figure",
            lambda wildcards: {
                "epoch": config["epoch"],
                **dict(wildcards.items()),
            },
        ),
    message:
        "Figure: {wildcards.rso} by {wildcards.stations} as predicted, as corrected, and as measured later"
