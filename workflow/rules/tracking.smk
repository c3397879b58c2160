# The paper's 'Measurement Models'.
TRACKING = product("tracking/{rso}/{stations}")
CATALOGUE_TRACKING = product("tracking/catalogue/{stations}")


rule tracking:
    input:
        truth=rules.truth.output[0],
        earth_orientation=EARTH_ORIENTATION.table,
        check=checks(PARAMS.stations),
    output:
        TRACKING.table,
    log:
        TRACKING.log,
    benchmark:
        TRACKING.benchmark
    conda:
        "../envs/opml.yaml"
    params:
        settings=lambda wildcards: {
            "epoch": config["epoch"],
            "seed": PARAMS.noise_seed(wildcards),
            "rso": wildcards.rso,
            "stations": PARAMS.stations(wildcards),
        },
        code=code("tracking.py"),
    message:
        "Measurement models: tracks of {wildcards.rso} as {wildcards.stations} measure it"
    script:
        "../scripts/tracking.py"


if PLAN.simulated_catalogue:

    # One job: an RSO takes a fifth of a second, the start of a job a whole one.
    rule trackings:
        input:
            truth=[path_of(rules.truth.output[0], rso=name) for name in PLAN.simulated_catalogue],
            earth_orientation=EARTH_ORIENTATION.table,
            check=checks(PARAMS.stations),
        output:
            [product(f"tracking/{name}/{{stations}}").table for name in PLAN.simulated_catalogue],
        log:
            CATALOGUE_TRACKING.log,
        benchmark:
            CATALOGUE_TRACKING.benchmark
        conda:
            "../envs/opml.yaml"
        params:
            settings=lambda wildcards: {
                "epoch": config["epoch"],
                "seed": PARAMS.noise_seed(wildcards),
                "rsos": PLAN.simulated_catalogue,
                "stations": PARAMS.stations(wildcards),
            },
            code=code("trackings.py"),
        message:
            "Measurement models: tracks of a catalogue as {wildcards.stations} measure it"
        script:
            "../scripts/trackings.py"

    ruleorder: trackings > tracking
