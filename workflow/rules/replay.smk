# Replays of past mornings: the ephemerides that an operator would have had, and their errors.
MORNINGS = "{rso}/{stations}{window}{reading}{label}/{train}"
EPHEMERIS = f"{MORNINGS}/{{learner}}"
SPREAD = product("spreads/{rso}/{stations}{window}{reading}")
REPLAY = product(f"replays/{EPHEMERIS}")


rule spread:
    input:
        **ENVIRONMENT.predictions,
        futures=INPUTS.futures(rules.futures.output[0]),
        estimates=rules.estimation.output[0],
        predictions=rules.prediction.output[0],
        tracking=rules.tracking.output[0],
        manoeuvres=INPUTS.user_manoeuvres(rules.truth.output[0], rules.tracking.output[0]),
    output:
        SPREAD.table,
    log:
        SPREAD.log,
    benchmark:
        SPREAD.benchmark
    wildcard_constraints:
        window=PLAN.window_pattern,
    conda:
        "../envs/opml.yaml"
    resources:
        mem_mb=1750,
        runtime=8,
    params:
        settings=lambda wildcards: PARAMS.departures(wildcards)
        | {"every_hours": config["uncertainty"]["every_hours"]},
        code=code("spread.py"),
    message:
        "Spread: how far drag and the weather ahead may take predictions of {wildcards.rso} by {wildcards.stations}"
    script:
        "../scripts/spread.py"


rule replay:
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
        later=INPUTS.later_estimates(rules.estimation.output[0]),
        spread=rules.spread.output[0],
        check=checks(PARAMS.split, PARAMS.train_days),
    output:
        REPLAY.table,
    log:
        REPLAY.log,
    benchmark:
        REPLAY.benchmark
    wildcard_constraints:
        window=PLAN.window_pattern,
    conda:
        "../envs/opml.yaml"
    resources:
        mem_mb=2500,
        runtime=15,
    params:
        settings=lambda wildcards: PARAMS.daily_training(wildcards)
        | {"every_hours": config["uncertainty"]["every_hours"]},
        code=code("replay.py"),
    message:
        "Replay: every morning of {wildcards.rso} by {wildcards.stations} again, corrected by {wildcards.learner}"
    script:
        "../scripts/replay.py"


if OWN.replayed_models:
    REPLAYS = product(f"replays/{MORNINGS}")

    # The learners of a study share the arcs that they ask for.
    use rule replay as replays with:
        output:
            [product(f"replays/{MORNINGS}/{learner}").table for learner in OWN.replayed_models],
        log:
            REPLAYS.log,
        benchmark:
            REPLAYS.benchmark
        wildcard_constraints:
            **PLAN.replays_together,
        threads: 2
        resources:
            mem_mb=4000,
            runtime=60,
        params:
            settings=rules.replay.params.settings,
            code=code("replay.py"),
        message:
            f"Replays: every morning of {{wildcards.rso}} by {{wildcards.stations}} again, corrected by {', '.join(OWN.replayed_models)}"

    ruleorder: replays > replay
