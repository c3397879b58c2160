# The paper's figures.
PARTITION = config["experiments"]["partition"]


rule partition_curve:
    input:
        expand(
            rules.evaluate.output.metrics,
            train=[f"random-{ratio}" for ratio in PARTITION["ratios"]],
            target=PARTITION["rso"],
            test="rest",
            **{key: PARTITION[key] for key in ("rso", "stations", "learner", "component")},
        ),
    output:
        pdf=f"{RESULTS}/figs/partition_curve.pdf",
        png=f"{RESULTS}/figs/partition_curve.png",
    log:
        f"{RESULTS}/logs/figs/partition_curve.log",
    benchmark:
        f"{RESULTS}/benchmarks/figs/partition_curve.tsv"
    conda:
        "../envs/opml.yaml"
    threads: 1
    resources:
        mem_mb=500,
        runtime=5,
    params:
        settings={"epoch": config["epoch"], "partition": PARTITION},
        code=code("partition_curve.py"),
    message:
        "Figure: performance metric P_ML against the size of the training data"
    script:
        "../scripts/partition_curve.py"
