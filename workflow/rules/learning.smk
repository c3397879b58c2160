# The paper's 'Support Vector Machine' and the validation of the trained models.
EXPERIMENT = "{rso}/{stations}{window}{reading}{label}/{train}/{learner}/{component}"
TEST = f"{EXPERIMENT}/{{target}}/{{test}}"
TARGET_DATASET = product("dataset/{target}/{stations}{window}{reading}{label}")
MODEL = product(f"models/{EXPERIMENT}")
EVALUATION = product(f"evaluation/{TEST}")
METRICS = product(f"metrics/{TEST}")
ROLLING = product("rolling/{rso}/{stations}{window}{reading}{label}/{learner}/{component}")
INTERVALS = product(f"intervals/{TEST}")
COVERAGE = product(f"coverage/{TEST}")


rule train:
    input:
        dataset=DATASET.table,
        beside=INPUTS.learner_tables("rso"),
        check=checks(PARAMS.split),
    output:
        MODEL.table,
    log:
        MODEL.log,
    benchmark:
        MODEL.benchmark
    wildcard_constraints:
        rso=PLAN.training_pattern,
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
        beside=INPUTS.learner_tables("target"),
        check=checks(PARAMS.split, PARAMS.experiment),
    output:
        evaluation=EVALUATION.table,
        metrics=METRICS.table,
    log:
        EVALUATION.log,
    benchmark:
        EVALUATION.benchmark
    wildcard_constraints:
        rso=PLAN.training_pattern,
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


rule rolling:
    input:
        dataset=rules.train.input.dataset,
        beside=INPUTS.learner_tables("rso"),
        judge=INPUTS.true_errors(rules.dataset.output[0]),
    output:
        ROLLING.table,
    log:
        ROLLING.log,
    benchmark:
        ROLLING.benchmark
    conda:
        "../envs/opml.yaml"
    resources:
        mem_mb=1750,
        runtime=30,
    params:
        settings=lambda wildcards: {
            "epoch": config["epoch"],
            "seed": PLAN.seeds.split,
            "learner": PARAMS.learner(wildcards),
            "component": wildcards.component,
            "rolling": STUDY.rolling,
        },
        code=code("rolling.py"),
    message:
        "Rolling: {wildcards.learner} retrained for {wildcards.component} of {wildcards.rso}, {wildcards.stations}"
    script:
        "../scripts/rolling.py"


rule intervals:
    input:
        dataset=rules.train.input.dataset,
        beside=INPUTS.learner_tables("rso"),
        target=rules.evaluate.input.target,
        judge=INPUTS.true_errors(rules.dataset.output[0]),
        beside_target=INPUTS.learner_tables("target"),
        check=checks(PARAMS.split, PARAMS.experiment),
    output:
        intervals=INTERVALS.table,
        coverage=COVERAGE.table,
    log:
        INTERVALS.log,
    benchmark:
        INTERVALS.benchmark
    wildcard_constraints:
        rso=PLAN.training_pattern,
        test=naming.TEST_BY_ROW,
    conda:
        "../envs/opml.yaml"
    resources:
        mem_mb=1750,
        runtime=8,
    params:
        settings=lambda wildcards: {
            **PARAMS.training(wildcards),
            "learner": PARAMS.learner(wildcards),
            "intervals": config["intervals"],
            "experiment": PARAMS.experiment(wildcards),
        },
        code=code("intervals.py"),
    message:
        "Prediction intervals of {wildcards.learner} for {wildcards.target}, {wildcards.test} after {wildcards.train}"
    script:
        "../scripts/intervals.py"
