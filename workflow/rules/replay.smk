# The mornings that are over again: what an operator would have got, and how far it was off.
EPHEMERIS = "{rso}/{stations}{window}{reading}{label}/{train}/{learner}"


rule spread:
    input:
        **ENVIRONMENT,
        futures=futures,
        estimates=rules.estimation.output[0],
        predictions=rules.prediction.output[0],
        tracking=rules.tracking.output[0],
        manoeuvres=told_manoeuvres,
    output:
        f"{RESULTS}/spreads/{{rso}}/{{stations}}{{window}}{{reading}}.parquet",
    log:
        f"{RESULTS}/logs/spreads/{{rso}}/{{stations}}{{window}}{{reading}}.log",
    benchmark:
        f"{RESULTS}/benchmarks/spreads/{{rso}}/{{stations}}{{window}}{{reading}}.tsv"
    wildcard_constraints:
        window=WINDOW,
    conda:
        "../envs/opml.yaml"
    resources:
        mem_mb=1750,
        runtime=8,
    params:
        settings=lambda wildcards: departure_settings(wildcards)
        | {"every_hours": config["uncertainty"]["every_hours"]},
        code=code("spread.py"),
    message:
        "Spread: how far drag and the weather ahead may take predictions of {wildcards.rso} by {wildcards.stations}"
    script:
        "../scripts/spread.py"


rule replay:
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
        later=later_states,
        spread=rules.spread.output[0],
        asked=checked_names(split, train_days, without_truth),
    output:
        f"{RESULTS}/replays/{EPHEMERIS}.parquet",
    log:
        f"{RESULTS}/logs/replays/{EPHEMERIS}.log",
    benchmark:
        f"{RESULTS}/benchmarks/replays/{EPHEMERIS}.tsv"
    wildcard_constraints:
        window=WINDOW,
    conda:
        "../envs/opml.yaml"
    resources:
        mem_mb=2500,
        runtime=15,
    params:
        settings=lambda wildcards: lesson_settings(wildcards)
        | {"every_hours": config["uncertainty"]["every_hours"]},
        code=code("replay.py"),
    message:
        "Replay: every morning of {wildcards.rso} by {wildcards.stations} again, corrected by {wildcards.learner}"
    script:
        "../scripts/replay.py"
