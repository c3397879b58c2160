# The paper's 'Support Vector Machine' and the validation of the trained models.
EXPERIMENT = "{rso}/{stations}{reading}/{train}/{learner}/{component}"


rule train:
    input:
        dataset=rules.dataset.output[0],
    output:
        f"{RESULTS}/models/{EXPERIMENT}.parquet",
    log:
        f"{RESULTS}/logs/models/{EXPERIMENT}.log",
    benchmark:
        f"{RESULTS}/benchmarks/models/{EXPERIMENT}.tsv"
    conda:
        "../envs/opml.yaml"
    threads: 1
    resources:
        mem_mb=1500,
        runtime=30,
    params:
        settings=lambda wildcards: {
            "epoch": config["epoch"],
            **split(wildcards),
            "span_days": config["learning"]["span_days"],
            **learner(wildcards),
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
        target=f"{RESULTS}/dataset/{{target}}/{{stations}}{{reading}}.parquet",
    output:
        evaluation=f"{RESULTS}/evaluation/{EXPERIMENT}/{{target}}/{{test}}.parquet",
        metrics=f"{RESULTS}/metrics/{EXPERIMENT}/{{target}}/{{test}}.parquet",
    log:
        f"{RESULTS}/logs/evaluation/{EXPERIMENT}/{{target}}/{{test}}.log",
    benchmark:
        f"{RESULTS}/benchmarks/evaluation/{EXPERIMENT}/{{target}}/{{test}}.tsv"
    conda:
        "../envs/opml.yaml"
    threads: 1
    resources:
        mem_mb=1500,
        runtime=10,
    params:
        settings=lambda wildcards: {
            "epoch": config["epoch"],
            **split(wildcards),
            "span_days": config["learning"]["span_days"],
            "experiment": experiment(wildcards),
        },
        code=code("evaluate.py"),
    message:
        "Evaluate P_ML of {wildcards.component} for {wildcards.target}, {wildcards.test} after {wildcards.train}"
    script:
        "../scripts/evaluate.py"
