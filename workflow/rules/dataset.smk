# The paper's 'Dataset Capturing the Orbit Prediction Error Model'.


rule dataset:
    input:
        manoeuvres=known_manoeuvres,
        estimates=rules.estimation.output[0],
        predictions=rules.prediction.output[0],
        tracking=rules.tracking.output[0],
        gravity_field=ENVIRONMENT["gravity_field"],
    output:
        f"{RESULTS}/dataset/{{rso}}/{{stations}}{{window}}{{reading}}.parquet",
    log:
        f"{RESULTS}/logs/dataset/{{rso}}/{{stations}}{{window}}{{reading}}.log",
    benchmark:
        f"{RESULTS}/benchmarks/dataset/{{rso}}/{{stations}}{{window}}{{reading}}.tsv"
    conda:
        "../envs/opml.yaml"
    params:
        settings=lambda wildcards: {
            "epoch": config["epoch"],
            "cleaning": cleaning(wildcards),
            "window_hours": window_hours(wildcards),
        },
        code=code("dataset.py"),
    message:
        "Dataset: learning variables and true errors of {wildcards.rso} with {wildcards.stations}, and what is dropped"
    script:
        "../scripts/dataset.py"
