# The paper's 'Measurement Models'.


rule tracking:
    input:
        truth=rules.truth.output[0],
        earth_orientation=ENVIRONMENT["earth_orientation"],
    output:
        f"{RESULTS}/tracking/{{rso}}/{{stations}}.parquet",
    log:
        f"{RESULTS}/logs/tracking/{{rso}}/{{stations}}.log",
    benchmark:
        f"{RESULTS}/benchmarks/tracking/{{rso}}/{{stations}}.tsv"
    conda:
        "../envs/opml.yaml"
    threads: 1
    resources:
        mem_mb=1000,
        runtime=10,
    params:
        settings=lambda wildcards: {
            "epoch": config["epoch"],
            "seed": noise_seed(wildcards),
            "rso": wildcards.rso,
            "stations": stations(wildcards),
        },
        code=code("tracking.py"),
    message:
        "Measurement models: tracks of {wildcards.rso} as {wildcards.stations} measure it"
    script:
        "../scripts/tracking.py"
