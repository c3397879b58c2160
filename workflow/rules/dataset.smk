# The paper's 'Dataset Capturing the Orbit Prediction Error Model'.
TRUE_DATASET = product("dataset/{rso}/{stations}{window}{reading}")
LABELS = product("labels/{rso}/{stations}{window}{label}")
DATASET = product("dataset/{rso}/{stations}{window}{reading}{label}")


rule dataset:
    input:
        manoeuvres=INPUTS.truth_or(rules.truth.output[0], rules.tracking.output[0]),
        estimates=rules.estimation.output[0],
        predictions=rules.prediction.output[0],
        tracking=rules.tracking.output[0],
        gravity_field=GRAVITY_FIELD.table,
    output:
        TRUE_DATASET.table,
    log:
        TRUE_DATASET.log,
    benchmark:
        TRUE_DATASET.benchmark
    conda:
        "../envs/opml.yaml"
    params:
        settings=lambda wildcards: {
            "epoch": config["epoch"],
            "cleaning": PARAMS.cleaning(wildcards),
            "window_hours": PARAMS.window_hours(wildcards),
        },
        code=code("dataset.py"),
    message:
        "Dataset: learning variables and true errors of {wildcards.rso} with {wildcards.stations}, and what is dropped"
    script:
        "../scripts/dataset.py"


rule labels:
    input:
        predictions=rules.prediction.output[0],
        estimates=INPUTS.later_estimates(rules.estimation.output[0]),
        tracking=rules.tracking.output[0],
    output:
        LABELS.table,
    log:
        LABELS.log,
    benchmark:
        LABELS.benchmark
    wildcard_constraints:
        label=PLAN.label_pattern,
    conda:
        "../envs/opml.yaml"
    params:
        settings=lambda wildcards: {
            "epoch": config["epoch"],
        },
        code=code("labels.py"),
    message:
        "Labels: predictions of {wildcards.rso} by {wildcards.stations} compared with later estimates, {wildcards.label}"
    script:
        "../scripts/labels.py"


use rule dataset as labelled_dataset with:
    input:
        **dict(rules.dataset.input.items()),
        labels=rules.labels.output[0],
    output:
        DATASET.table,
    log:
        DATASET.log,
    benchmark:
        DATASET.benchmark
    wildcard_constraints:
        label=PLAN.label_pattern,
    params:
        settings=rules.dataset.params.settings,
        code=code("dataset.py"),
    message:
        "Dataset: learning variables and labels of {wildcards.rso} with {wildcards.stations}, {wildcards.label}"
