# Ephemerides for operators: corrected by a learner, each epoch with a covariance.
# None needs a truth.
CORRECTED = product(f"corrected/{EPHEMERIS}")
# The exports are jobs beside those of the tables, with logs of their own.
CORRECTED_OEM = product(f"corrected/{EPHEMERIS}_oem")
CORRECTED_OMM, CORRECTED_TLE = product(f"corrected/{EPHEMERIS}_omm"), product(f"corrected/{EPHEMERIS}_tle")
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
        check=checks(PARAMS.check_from_newest),
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


rule export_corrected_omm:
    input:
        rules.corrected.output[0],
        source=INPUTS.source,
        check=checks(PARAMS.check_from_newest),
    output:
        CORRECTED.file("omm"),
    log:
        CORRECTED_OMM.log,
    benchmark:
        CORRECTED_OMM.benchmark
    wildcard_constraints:
        window=PLAN.window_pattern,
    conda:
        "../envs/opml.yaml"
    params:
        settings=lambda wildcards: {"epoch": config["epoch"], "rso": wildcards.rso},
        code=code("export_omm.py"),
    message:
        "Export: mean elements of the corrected ephemeris of {wildcards.rso} by {wildcards.stations}, as CCSDS OMM"
    script:
        "../scripts/export_omm.py"


rule export_corrected_tle:
    input:
        rules.corrected.output[0],
        source=INPUTS.source,
        check=checks(PARAMS.check_from_newest),
    output:
        CORRECTED.file("tle"),
    log:
        CORRECTED_TLE.log,
    benchmark:
        CORRECTED_TLE.benchmark
    wildcard_constraints:
        window=PLAN.window_pattern,
    conda:
        "../envs/opml.yaml"
    params:
        settings=lambda wildcards: {"epoch": config["epoch"], "rso": wildcards.rso},
        code=code("export_tle.py"),
    message:
        "Export: mean elements of the corrected ephemeris of {wildcards.rso} by {wildcards.stations}, as TLE"
    script:
        "../scripts/export_tle.py"


rule export_each_corrected:
    input:
        rules.corrected.output[0],
        source=INPUTS.source,
        check=checks(PARAMS.check_from_each),
    output:
        directory(CORRECTED_OEM.folder),
    log:
        CORRECTED_OEM.log,
    benchmark:
        CORRECTED_OEM.benchmark
    wildcard_constraints:
        window=PLAN.window_pattern,
    conda:
        "../envs/opml.yaml"
    params:
        settings=lambda wildcards: {"epoch": config["epoch"], "table": "corrected", "rso": wildcards.rso},
        code=code("export_each_oem.py"),
    message:
        "Export: corrected ephemerides of {wildcards.rso} by {wildcards.stations}, one CCSDS OEM per estimate"
    script:
        "../scripts/export_each_oem.py"


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
