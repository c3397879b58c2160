# The paper's 'Support Vector Machine' and the validation of the trained models.
EXPERIMENT = "{rso}/{stations}{window}{reading}{label}/{train}/{learner}/{component}"
TEST = f"{EXPERIMENT}/{{target}}/{{test}}"
TARGET_DATASET = product("dataset/{target}/{stations}{window}{reading}{label}")
MODEL = product(f"models/{EXPERIMENT}")
EVALUATION = product(f"evaluation/{TEST}")
METRICS = product(f"metrics/{TEST}")


rule train:
    input:
        dataset=DATASET.table,
        others=INPUTS.learner_tables("rso"),
        check=checks(PARAMS.split),
    output:
        MODEL.table,
    log:
        MODEL.log,
    benchmark:
        MODEL.benchmark
    conda:
        "../envs/opml.yaml"
    resources:
        mem_mb=1750,
        runtime=16,
    params:
        settings=lambda wildcards: {
            **PARAMS.training(wildcards),
            "learner": PARAMS.learner(wildcards),
            "component": wildcards.component,
        },
        code=code("train.py"),
    message:
        "Train {wildcards.learner} on {wildcards.component} of {wildcards.rso}, {wildcards.stations}, {wildcards.train}"
    script:
        "../scripts/train.py"


rule evaluate:
    input:
        model=rules.train.output[0],
        target=TARGET_DATASET.table,
        judge=INPUTS.true_errors(rules.dataset.output[0]),
        others=INPUTS.learner_tables("target"),
        check=checks(PARAMS.split, PARAMS.experiment),
    output:
        evaluation=EVALUATION.table,
        metrics=METRICS.table,
    log:
        EVALUATION.log,
    benchmark:
        EVALUATION.benchmark
    conda:
        "../envs/opml.yaml"
    params:
        settings=lambda wildcards: {
            **PARAMS.training(wildcards),
            "noise": PARAMS.noise_seed(wildcards),
            "experiment": PARAMS.experiment(wildcards),
        },
        code=code("evaluate.py"),
    message:
        "Evaluate P_ML of {wildcards.component} for {wildcards.target}, {wildcards.test} after {wildcards.train}"
    script:
        "../scripts/evaluate.py"
