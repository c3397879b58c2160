# The paper's 'Orbit Prediction'.
PREDICTIONS = product("predictions/{rso}/{stations}{window}")
ENSEMBLES = product("ensembles/{rso}/{stations}{window}_n{members}")
FANS = product("fans/{rso}/{stations}{window}_n{members}")
SCORES = product("scores/{rso}/{stations}{window}_n{members}")


rule prediction:
    input:
        **ENVIRONMENT.predictions,
        truth=INPUTS.truth(rules.truth.output[0]),
        estimates=rules.estimation.output[0],
    output:
        PREDICTIONS.table,
    log:
        PREDICTIONS.log,
    benchmark:
        PREDICTIONS.benchmark
    conda:
        "../envs/opml.yaml"
    resources:
        runtime=5,
    params:
        settings=lambda wildcards: {
            **PARAMS.assumed_model,
            "max_days": config["prediction"]["max_days"],
            "rso": PARAMS.rso(wildcards),
        },
        code=code("prediction.py"),
    message:
        "Orbit prediction: each estimate of {wildcards.rso} to every later track of {wildcards.stations}"
    script:
        "../scripts/prediction.py"


if ENVIRONMENT.is_forecast:

    rule ensemble:
        input:
            **ENVIRONMENT.predictions,
            futures=rules.futures.output[0],
            estimates=rules.estimation.output[0],
            predictions=rules.prediction.output[0],
        output:
            sample=ENSEMBLES.table,
            fan=FANS.table,
            scores=SCORES.table,
        log:
            ENSEMBLES.log,
        benchmark:
            ENSEMBLES.benchmark
        wildcard_constraints:
            members=naming.MEMBERS,
        conda:
            "../envs/opml.yaml"
        resources:
            mem_mb=3000,
            runtime=20,
        params:
            settings=lambda wildcards: {
                **PARAMS.assumed_model,
                "level": config["intervals"]["level"],
                "window_hours": PARAMS.window_hours(wildcards),
                "seed": PARAMS.noise_seed(wildcards),
                "rso": PARAMS.rso(wildcards),
            },
            code=code("ensemble.py"),
        message:
            "Ensemble: predictions of {wildcards.rso} by {wildcards.stations} under {wildcards.members} futures of the space weather"
        script:
            "../scripts/ensemble.py"
