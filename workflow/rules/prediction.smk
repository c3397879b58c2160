# The paper's 'Orbit Prediction'.
PREDICTIONS = product("predictions/{rso}/{stations}{window}")


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
