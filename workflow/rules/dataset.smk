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


rule labels:
    input:
        predictions=rules.prediction.output[0],
        estimates=at_label_window(rules.estimation.output[0]),
        tracking=rules.tracking.output[0],
    output:
        f"{RESULTS}/labels/{{rso}}/{{stations}}{{window}}{{label}}.parquet",
    log:
        f"{RESULTS}/logs/labels/{{rso}}/{{stations}}{{window}}{{label}}.log",
    benchmark:
        f"{RESULTS}/benchmarks/labels/{{rso}}/{{stations}}{{window}}{{label}}.tsv"
    wildcard_constraints:
        label=LATER,
    conda:
        "../envs/opml.yaml"
    params:
        settings=lambda wildcards: {
            "epoch": config["epoch"],
            "after_hours": naming.parse_both_sides(label_window(wildcards)),
        },
        code=code("labels.py"),
    message:
        "Labels: predictions of {wildcards.rso} by {wildcards.stations} held against later estimates, {wildcards.label}"
    script:
        "../scripts/labels.py"


use rule dataset as labelled_dataset with:
    input:
        **dict(rules.dataset.input.items()),
        labels=rules.labels.output[0],
    output:
        f"{RESULTS}/dataset/{{rso}}/{{stations}}{{window}}{{reading}}{{label}}.parquet",
    log:
        f"{RESULTS}/logs/dataset/{{rso}}/{{stations}}{{window}}{{reading}}{{label}}.log",
    benchmark:
        f"{RESULTS}/benchmarks/dataset/{{rso}}/{{stations}}{{window}}{{reading}}{{label}}.tsv"
    wildcard_constraints:
        label=LATER,
    params:
        settings=rules.dataset.params.settings,
        code=code("dataset.py"),
    message:
        "Dataset: learning variables and labels of {wildcards.rso} with {wildcards.stations}, {wildcards.label}"
