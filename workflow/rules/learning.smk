# The paper's 'Support Vector Machine' and the validation of the trained models.
EXPERIMENT = "{rso}/{stations}{window}{reading}{label}/{train}/{learner}/{component}"


rule train:
    input:
        dataset=f"{RESULTS}/dataset/{{rso}}/{{stations}}{{window}}{{reading}}{{label}}.parquet",
        beside=beside("rso"),
        asked=checked_names(split),
    output:
        f"{RESULTS}/models/{EXPERIMENT}.parquet",
    log:
        f"{RESULTS}/logs/models/{EXPERIMENT}.log",
    benchmark:
        f"{RESULTS}/benchmarks/models/{EXPERIMENT}.tsv"
    wildcard_constraints:
        rso=TRAINED_ON,
    conda:
        "../envs/opml.yaml"
    resources:
        mem_mb=1750,
        runtime=16,
    params:
        settings=lambda wildcards: {
            "epoch": config["epoch"],
            **split(wildcards),
            "span_days": STUDY.span_days,
            "learner": learner(wildcards),
            "component": wildcards.component,
        },
        code=code("train.py"),
    message:
        "Train {wildcards.learner} on {wildcards.component} of {wildcards.rso}, {wildcards.stations}, {wildcards.train}"
    script:
        "../scripts/train.py"


rule train_together:
    input:
        dataset=rules.train.input.dataset,
        beside=beside("rso"),
        target=f"{RESULTS}/dataset/{{target}}/{{stations}}{{window}}{{reading}}{{label}}.parquet",
        judge=judge(rules.dataset.output[0]),
        beside_target=beside("target"),
        asked=checked_names(split, experiment),
    output:
        f"{RESULTS}/models/{EXPERIMENT}/{{target}}/{{test}}.parquet",
    log:
        f"{RESULTS}/logs/models/{EXPERIMENT}/{{target}}/{{test}}.log",
    benchmark:
        f"{RESULTS}/benchmarks/models/{EXPERIMENT}/{{target}}/{{test}}.tsv"
    wildcard_constraints:
        rso=TRAINED_ON,
        test=naming.TEST_TOGETHER,
    conda:
        "../envs/opml.yaml"
    resources:
        mem_mb=1750,
        runtime=16,
    params:
        settings=lambda wildcards: {
            "epoch": config["epoch"],
            **split(wildcards),
            "span_days": STUDY.span_days,
            "learner": learner(wildcards),
            "experiment": experiment(wildcards),
        },
        code=code("train_together.py"),
    message:
        "Train {wildcards.learner} on {wildcards.component} of {wildcards.rso}, {wildcards.stations}, {wildcards.train}, for {wildcards.target}, {wildcards.test}"
    script:
        "../scripts/train_together.py"


rule evaluate:
    input:
        model=trained,
        target=f"{RESULTS}/dataset/{{target}}/{{stations}}{{window}}{{reading}}{{label}}.parquet",
        judge=judge(rules.dataset.output[0]),
        beside=beside("target"),
        asked=checked_names(split, experiment),
    output:
        evaluation=f"{RESULTS}/evaluation/{EXPERIMENT}/{{target}}/{{test}}.parquet",
        metrics=f"{RESULTS}/metrics/{EXPERIMENT}/{{target}}/{{test}}.parquet",
    log:
        f"{RESULTS}/logs/evaluation/{EXPERIMENT}/{{target}}/{{test}}.log",
    benchmark:
        f"{RESULTS}/benchmarks/evaluation/{EXPERIMENT}/{{target}}/{{test}}.tsv"
    wildcard_constraints:
        rso=TRAINED_ON,
    conda:
        "../envs/opml.yaml"
    params:
        settings=lambda wildcards: {
            "epoch": config["epoch"],
            **split(wildcards),
            "noise": noise_seed(wildcards),
            "span_days": STUDY.span_days,
            "experiment": experiment(wildcards),
        },
        code=code("evaluate.py"),
    message:
        "Evaluate P_ML of {wildcards.component} for {wildcards.target}, {wildcards.test} after {wildcards.train}"
    script:
        "../scripts/evaluate.py"


rule rolling:
    input:
        dataset=rules.train.input.dataset,
        beside=beside("rso"),
        judge=judge(rules.dataset.output[0]),
    output:
        f"{RESULTS}/rolling/{{rso}}/{{stations}}{{window}}{{reading}}{{label}}/{{learner}}/{{component}}.parquet",
    log:
        f"{RESULTS}/logs/rolling/{{rso}}/{{stations}}{{window}}{{reading}}{{label}}/{{learner}}/{{component}}.log",
    benchmark:
        f"{RESULTS}/benchmarks/rolling/{{rso}}/{{stations}}{{window}}{{reading}}{{label}}/{{learner}}/{{component}}.tsv"
    conda:
        "../envs/opml.yaml"
    resources:
        mem_mb=1750,
        runtime=30,
    params:
        settings=lambda wildcards: {
            "epoch": config["epoch"],
            "seed": SEED["split"],
            "learner": learner(wildcards),
            "component": wildcards.component,
            "rolling": STUDY.rolling,
        },
        code=code("rolling.py"),
    message:
        "Rolling: {wildcards.learner} trained anew for {wildcards.component} of {wildcards.rso}, {wildcards.stations}"
    script:
        "../scripts/rolling.py"


rule intervals:
    input:
        dataset=rules.train.input.dataset,
        beside=beside("rso"),
        target=rules.evaluate.input.target,
        judge=judge(rules.dataset.output[0]),
        beside_target=beside("target"),
        asked=checked_names(split, experiment),
    output:
        intervals=f"{RESULTS}/intervals/{EXPERIMENT}/{{target}}/{{test}}.parquet",
        coverage=f"{RESULTS}/coverage/{EXPERIMENT}/{{target}}/{{test}}.parquet",
    log:
        f"{RESULTS}/logs/intervals/{EXPERIMENT}/{{target}}/{{test}}.log",
    benchmark:
        f"{RESULTS}/benchmarks/intervals/{EXPERIMENT}/{{target}}/{{test}}.tsv"
    wildcard_constraints:
        rso=TRAINED_ON,
        test=naming.TEST_BY_ROW,
    conda:
        "../envs/opml.yaml"
    resources:
        mem_mb=1750,
        runtime=8,
    params:
        settings=lambda wildcards: {
            "epoch": config["epoch"],
            **split(wildcards),
            "span_days": STUDY.span_days,
            "learner": learner(wildcards),
            "intervals": config["intervals"],
            "experiment": experiment(wildcards),
        },
        code=code("intervals.py"),
    message:
        "Prediction intervals of {wildcards.learner} for {wildcards.target}, {wildcards.test} after {wildcards.train}"
    script:
        "../scripts/intervals.py"
