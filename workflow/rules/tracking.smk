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


if CATALOGUE:

    # A fifth of a second for each RSO, where the start of a job takes a whole one.
    rule trackings:
        input:
            truth=[path_of(rules.truth.output[0], rso=name) for name in CATALOGUE],
            earth_orientation=ENVIRONMENT["earth_orientation"],
            asked=checked_names(stations),
        output:
            [f"{RESULTS}/tracking/{name}/{{stations}}.parquet" for name in CATALOGUE],
        log:
            f"{RESULTS}/logs/tracking/catalogue/{{stations}}.log",
        benchmark:
            f"{RESULTS}/benchmarks/tracking/catalogue/{{stations}}.tsv"
        conda:
            "../envs/opml.yaml"
        params:
            settings=lambda wildcards: {
                "epoch": config["epoch"],
                "seed": noise_seed(wildcards),
                "rsos": CATALOGUE,
                "stations": stations(wildcards),
            },
            code=code("trackings.py"),
        message:
            "Measurement models: tracks of a catalogue as {wildcards.stations} measure it"
        script:
            "../scripts/trackings.py"

    ruleorder: trackings > tracking
