# Beyond the paper: what a catalogue knows of why its predictions err, and RSOs pooled to learn from together.
LONG = naming.window_suffix(
    config["mechanism"]["long_window_hours"], default=config["estimation"]["window_hours"]
)


rule sensitivities:
    input:
        **ENVIRONMENT,
        estimates=rules.estimation.output[0],
        predictions=rules.prediction.output[0],
    output:
        f"{RESULTS}/sensitivities/{{rso}}/{{stations}}{{window}}.parquet",
    log:
        f"{RESULTS}/logs/sensitivities/{{rso}}/{{stations}}{{window}}.log",
    benchmark:
        f"{RESULTS}/benchmarks/sensitivities/{{rso}}/{{stations}}{{window}}.tsv"
    conda:
        "../envs/opml.yaml"
    resources:
        mem_mb=1000,
        runtime=8,
    params:
        settings=lambda wildcards: {
            "epoch": config["epoch"],
            "force_model": config["force_models"]["assumed"],
            "integrator": config["integrator"],
            "cd_bounds": cd_bounds(),
            "rso": rso(wildcards),
        },
        code=code("sensitivities.py"),
    message:
        "Sensitivities: how each prediction of {wildcards.rso} by {wildcards.stations} answers to its drag coefficient"
    script:
        "../scripts/sensitivities.py"


rule mechanism:
    input:
        estimates=rules.estimation.output[0],
        predictions=rules.prediction.output[0],
        sensitivities=rules.sensitivities.output[0],
        long_estimates=at_window(LONG, rules.estimation.output[0]),
        long_predictions=at_window(LONG, rules.prediction.output[0]),
        long_sensitivities=at_window(LONG, rules.sensitivities.output[0]),
        gravity_field=ENVIRONMENT["gravity_field"],
    output:
        f"{RESULTS}/mechanism/{{rso}}/{{stations}}{{window}}.parquet",
    log:
        f"{RESULTS}/logs/mechanism/{{rso}}/{{stations}}{{window}}.log",
    benchmark:
        f"{RESULTS}/benchmarks/mechanism/{{rso}}/{{stations}}{{window}}.tsv"
    conda:
        "../envs/opml.yaml"
    resources:
        mem_mb=1000,
    params:
        settings={
            "epoch": config["epoch"],
            "cd_bounds": cd_bounds(),
            **config["mechanism"],
        },
        code=code("mechanism.py"),
    message:
        "Mechanism: sensitivities, long arcs and resonances of the predictions of {wildcards.rso} by {wildcards.stations}"
    script:
        "../scripts/mechanism.py"


rule arcs:
    input:
        **ENVIRONMENT,
        manoeuvres=known_manoeuvres,
        predictions=rules.prediction.output[0],
        arc_estimates=arc_at(rules.estimation.output[0]),
        arc_predictions=arc_at(rules.prediction.output[0]),
    output:
        f"{RESULTS}/arcs/{{rso}}/{{stations}}{{window}}{{arc}}.parquet",
    log:
        f"{RESULTS}/logs/arcs/{{rso}}/{{stations}}{{window}}{{arc}}.log",
    benchmark:
        f"{RESULTS}/benchmarks/arcs/{{rso}}/{{stations}}{{window}}{{arc}}.tsv"
    conda:
        "../envs/opml.yaml"
    resources:
        mem_mb=1000,
        runtime=8,
    params:
        settings=lambda wildcards: {
            "epoch": config["epoch"],
            "force_model": config["force_models"]["assumed"],
            "integrator": config["integrator"],
            **dict(zip(("window_hours", "memory_days"), naming.parse_arc(wildcards.arc), strict=True)),
            "rso": rso(wildcards),
        },
        code=code("arcs.py"),
    message:
        "Arcs: what fits of {wildcards.rso} by {wildcards.stations} over another window know, {wildcards.arc}"
    script:
        "../scripts/arcs.py"


if CATALOGUE:
    FIT_WINDOW = naming.window_suffix(
        THERMOMETER["window_hours"], default=config["estimation"]["window_hours"]
    )

    rule thermometer:
        input:
            catalogue=lambda wildcards: [
                path_of(rules.estimation.output[0], rso=name, stations=wildcards.stations, window=FIT_WINDOW)
                for name in THERMOMETER["rsos"]
            ],
            estimates=at_window(FIT_WINDOW, rules.estimation.output[0]),
            predictions=rules.prediction.output[0],
            sensitivities=rules.sensitivities.output[0],
            arcs=lambda wildcards: path_of(
                rules.arcs.output[0],
                **dict(wildcards.items()),
                arc=naming.arc_suffix(THERMOMETER["window_hours"], ARC_MEMORY_DAYS),
            ),
        output:
            f"{RESULTS}/thermometer/{{rso}}/{{stations}}{{window}}.parquet",
        log:
            f"{RESULTS}/logs/thermometer/{{rso}}/{{stations}}{{window}}.log",
        benchmark:
            f"{RESULTS}/benchmarks/thermometer/{{rso}}/{{stations}}{{window}}.tsv"
        conda:
            "../envs/opml.yaml"
        resources:
            mem_mb=1000,
        params:
            settings=lambda wildcards: {
                "epoch": config["epoch"],
                "thermometer": {
                    key: value for key, value in THERMOMETER.items() if key not in ("rsos", "left_out")
                },
                "member": (
                    THERMOMETER["rsos"].index(wildcards.rso)
                    if wildcards.rso in THERMOMETER["rsos"]
                    else None
                ),
            },
            code=code("thermometer.py"),
        message:
            "Thermometer: what the drag of a catalogue says of {wildcards.rso} by {wildcards.stations}"
        script:
            "../scripts/thermometer.py"


rule perfect_estimates:
    input:
        truth=rules.truth.output[0],
        estimates=at_window("", rules.estimation.output[0]),
    output:
        f"{RESULTS}/estimates/{{rso}}/{{stations}}{naming.PERFECT}.parquet",
    log:
        f"{RESULTS}/logs/estimates/{{rso}}/{{stations}}{naming.PERFECT}.log",
    benchmark:
        f"{RESULTS}/benchmarks/estimates/{{rso}}/{{stations}}{naming.PERFECT}.tsv"
    conda:
        "../envs/opml.yaml"
    params:
        settings=lambda wildcards: {"epoch": config["epoch"], "cd": rso(wildcards)["cd"]},
        code=code("perfect_estimates.py"),
    message:
        "Perfect estimates: the true states of {wildcards.rso} in the place of those by {wildcards.stations}"
    script:
        "../scripts/perfect_estimates.py"


rule oracle:
    input:
        estimates=at_window("", rules.estimation.output[0]),
        predictions=at_window("", rules.prediction.output[0]),
        perfect=rules.perfect_estimates.output[0],
        perfect_predictions=at_window(naming.PERFECT, rules.prediction.output[0]),
        gravity_field=ENVIRONMENT["gravity_field"],
    output:
        f"{RESULTS}/oracle/{{rso}}/{{stations}}.parquet",
    log:
        f"{RESULTS}/logs/oracle/{{rso}}/{{stations}}.log",
    benchmark:
        f"{RESULTS}/benchmarks/oracle/{{rso}}/{{stations}}.tsv"
    conda:
        "../envs/opml.yaml"
    params:
        settings={"epoch": config["epoch"]},
        code=code("oracle.py"),
    message:
        "Oracle: what the prediction errors of {wildcards.rso} by {wildcards.stations} are made of"
    script:
        "../scripts/oracle.py"


rule pool:
    input:
        lambda wildcards: [
            f"{RESULTS}/{wildcards.table}/{rso}/{wildcards.rest}.parquet"
            for rso in naming.parse_pool(wildcards.pool, STUDY.entry("pools"))
        ],
    output:
        f"{RESULTS}/{{table}}/{{pool}}/{{rest}}.parquet",
    log:
        f"{RESULTS}/logs/{{table}}/{{pool}}/{{rest}}.log",
    benchmark:
        f"{RESULTS}/benchmarks/{{table}}/{{pool}}/{{rest}}.tsv"
    wildcard_constraints:
        table="dataset|mechanism",
        pool=naming.pool_pattern(STUDY.entry("pools"), SETTINGS.rsos),
        rest="[^/]+",
    conda:
        "../envs/opml.yaml"
    resources:
        mem_mb=3000,
        runtime=10,
    params:
        settings=lambda wildcards: {
            "epoch": config["epoch"],
            "table": wildcards.table,
            "resonances": config["mechanism"]["resonances"],
            "rsos": naming.parse_pool(wildcards.pool, STUDY.entry("pools")),
        },
        code=code("pool.py"),
    message:
        "Pool: the {wildcards.table} of {wildcards.pool}"
    script:
        "../scripts/pool.py"
