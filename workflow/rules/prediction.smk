# The paper's 'Orbit Prediction'.


rule prediction:
    input:
        **ENVIRONMENT,
        truth=true_orbit,
        estimates=rules.estimation.output[0],
    output:
        f"{RESULTS}/predictions/{{rso}}/{{stations}}{{window}}.parquet",
    log:
        f"{RESULTS}/logs/predictions/{{rso}}/{{stations}}{{window}}.log",
    benchmark:
        f"{RESULTS}/benchmarks/predictions/{{rso}}/{{stations}}{{window}}.tsv"
    conda:
        "../envs/opml.yaml"
    resources:
        runtime=5,
    params:
        settings=lambda wildcards: {
            "epoch": config["epoch"],
            "force_model": config["force_models"]["assumed"],
            "integrator": config["integrator"],
            "max_days": config["prediction"]["max_days"],
            "rso": rso(wildcards),
        },
        code=code("prediction.py"),
    message:
        "Orbit prediction: each estimate of {wildcards.rso} to every later track of {wildcards.stations}"
    script:
        "../scripts/prediction.py"


if KNOWLEDGE == knowledge.FORECAST:

    rule ensemble:
        input:
            **ENVIRONMENT,
            futures=rules.futures.output[0],
            estimates=rules.estimation.output[0],
            predictions=rules.prediction.output[0],
        output:
            sample=f"{RESULTS}/ensembles/{{rso}}/{{stations}}{{window}}_n{{members}}.parquet",
            fan=f"{RESULTS}/fans/{{rso}}/{{stations}}{{window}}_n{{members}}.parquet",
            scores=f"{RESULTS}/scores/{{rso}}/{{stations}}{{window}}_n{{members}}.parquet",
        log:
            f"{RESULTS}/logs/ensembles/{{rso}}/{{stations}}{{window}}_n{{members}}.log",
        benchmark:
            f"{RESULTS}/benchmarks/ensembles/{{rso}}/{{stations}}{{window}}_n{{members}}.tsv"
        wildcard_constraints:
            members=naming.MEMBERS,
        conda:
            "../envs/opml.yaml"
        resources:
            mem_mb=3000,
            runtime=20,
        params:
            settings=lambda wildcards: {
                "epoch": config["epoch"],
                "force_model": config["force_models"]["assumed"],
                "integrator": config["integrator"],
                "level": config["intervals"]["level"],
                "window_hours": window_hours(wildcards),
                "seed": noise_seed(wildcards),
                "rso": rso(wildcards),
            },
            code=code("ensemble.py"),
        message:
            "Ensemble: predictions of {wildcards.rso} by {wildcards.stations} under {wildcards.members} futures of the space weather"
        script:
            "../scripts/ensemble.py"
