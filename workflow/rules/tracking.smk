# The paper's 'Measurement Models'.
TRACKING = product("tracking/{rso}/{stations}")


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
