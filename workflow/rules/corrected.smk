# What leaves the house: ephemerides corrected by what was learned, each epoch with a covariance. None needs a truth.


rule corrected:
    input:
        **ENVIRONMENT,
        estimates=rules.estimation.output[0],
        predictions=rules.prediction.output[0],
        tracking=rules.tracking.output[0],
        long_estimates=fits_over("mechanism"),
        arc_estimates=fits_over("arcs"),
        manoeuvres=told_manoeuvres,
        dataset=rules.train.input.dataset,
        beside=beside("rso"),
        replay=rules.replay.output[0],
        futures=futures,
        asked=checked_names(split, train_days, without_truth),
    output:
        f"{RESULTS}/corrected/{EPHEMERIS}.parquet",
    log:
        f"{RESULTS}/logs/corrected/{EPHEMERIS}.log",
    benchmark:
        f"{RESULTS}/benchmarks/corrected/{EPHEMERIS}.tsv"
    wildcard_constraints:
        window=WINDOW,
    conda:
        "../envs/opml.yaml"
    resources:
        mem_mb=1750,
        runtime=8,
    params:
        settings=lambda wildcards: lesson_settings(wildcards) | ephemeris_settings(wildcards),
        code=code("corrected.py"),
    message:
        "Corrected ephemeris: {wildcards.rso} by {wildcards.stations}, corrected by {wildcards.learner}"
    script:
        "../scripts/corrected.py"


use rule export_truth as export_corrected with:
    input:
        rules.corrected.output[0],
    output:
        f"{RESULTS}/corrected/{EPHEMERIS}.oem",
    log:
        f"{RESULTS}/logs/corrected/{EPHEMERIS}_oem.log",
    benchmark:
        f"{RESULTS}/benchmarks/corrected/{EPHEMERIS}_oem.tsv"
    wildcard_constraints:
        window=WINDOW,
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
        pdf=f"{RESULTS}/figs/corrected/{EPHEMERIS}.pdf",
        png=f"{RESULTS}/figs/corrected/{EPHEMERIS}.png",
    log:
        f"{RESULTS}/logs/figs/corrected/{EPHEMERIS}.log",
    benchmark:
        f"{RESULTS}/benchmarks/figs/corrected/{EPHEMERIS}.tsv"
    wildcard_constraints:
        window=WINDOW,
    params:
        draw="corrected_figure",
        settings=lambda wildcards: {
            "epoch": config["epoch"],
            "level": config["intervals"]["level"],
            **dict(wildcards.items()),
        },
        code=code("corrected_figure.py"),
    message:
        "Figure: {wildcards.rso} by {wildcards.stations} as predicted, as corrected, and as measured later"


if KNOWLEDGE == knowledge.FORECAST:
    # Without anything learned: {train} says up to when the catalogue has estimates.
    FORECAST = "{rso}/{stations}{window}{reading}_n{members}/{train}"

    rule forecast:
        input:
            **ENVIRONMENT,
            futures=rules.futures.output[0],
            estimates=rules.estimation.output[0],
            predictions=rules.prediction.output[0],
            tracking=rules.tracking.output[0],
            long_estimates=[],
            arc_estimates=[],
            manoeuvres=told_manoeuvres,
            asked=checked_names(split),
        output:
            f"{RESULTS}/forecasts/{FORECAST}.parquet",
        log:
            f"{RESULTS}/logs/forecasts/{FORECAST}.log",
        benchmark:
            f"{RESULTS}/benchmarks/forecasts/{FORECAST}.tsv"
        wildcard_constraints:
            members=naming.MEMBERS,
        conda:
            "../envs/opml.yaml"
        resources:
            mem_mb=1750,
            runtime=8,
        params:
            settings=lambda wildcards: departure_settings(wildcards)
            | ephemeris_settings(wildcards)
            | {"seed": noise_seed(wildcards)},
            code=code("forecast.py"),
        message:
            "Forecast ephemeris: {wildcards.rso} by {wildcards.stations} under {wildcards.members} futures of the space weather"
        script:
            "../scripts/forecast.py"

    use rule export_truth as export_forecast with:
        input:
            rules.forecast.output[0],
        output:
            f"{RESULTS}/forecasts/{FORECAST}.oem",
        log:
            f"{RESULTS}/logs/forecasts/{FORECAST}_oem.log",
        benchmark:
            f"{RESULTS}/benchmarks/forecasts/{FORECAST}_oem.tsv"
        wildcard_constraints:
            members=naming.MEMBERS,
        params:
            settings=lambda wildcards: {"epoch": config["epoch"], "table": "forecast", "rso": wildcards.rso},
            code=code("export_oem.py"),
        message:
            "Export: forecast ephemeris of {wildcards.rso} by {wildcards.stations}, with covariances, as CCSDS OEM"
