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
