# The paper's 'Measurement Models'.


rule tracking:
    input:
        truth=rules.truth.output[0],
        earth_orientation=ENVIRONMENT["earth_orientation"],
        asked=checked_names(stations),
    output:
        f"{RESULTS}/tracking/{{rso}}/{{stations}}.parquet",
    log:
        f"{RESULTS}/logs/tracking/{{rso}}/{{stations}}.log",
    benchmark:
        f"{RESULTS}/benchmarks/tracking/{{rso}}/{{stations}}.tsv"
    conda:
        "../envs/opml.yaml"
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
