# What Earth, Sun and Moon do, tabulated once per run.
# Two seconds for all of them: on a cluster they are no jobs for the queue.
localrules:
    earth_orientation,
    ephemerides,
    solar_activity,
    gravity_field,


rule earth_orientation:
    output:
        ENVIRONMENT["earth_orientation"],
    log:
        f"{RESULTS}/logs/environment/earth_orientation.log",
    benchmark:
        f"{RESULTS}/benchmarks/environment/earth_orientation.tsv"
    conda:
        "../envs/opml.yaml"
    params:
        settings={key: config[key] for key in ("epoch", "duration_days")},
        code=code("earth_orientation.py"),
    message:
        "Earth orientation: GCRF to ITRF with IAU 2006/2000A and the IERS's polar motion and UT1"
    script:
        "../scripts/earth_orientation.py"


rule ephemerides:
    input:
        source("ephemerides"),
    output:
        ENVIRONMENT["ephemerides"],
    log:
        f"{RESULTS}/logs/environment/ephemerides.log",
    benchmark:
        f"{RESULTS}/benchmarks/environment/ephemerides.tsv"
    conda:
        "../envs/opml.yaml"
    params:
        settings={key: config[key] for key in ("epoch", "duration_days")}
        | {"kernel": config["environment"]["ephemerides"]},
        code=code("ephemerides.py"),
    message:
        "Third bodies: positions of Sun, Moon, planets and Pluto"
    script:
        "../scripts/ephemerides.py"


rule solar_activity:
    input:
        lambda wildcards: source(wildcards.activity),
    output:
        f"{RESULTS}/environment/{{activity}}.parquet",
    log:
        f"{RESULTS}/logs/environment/{{activity}}.log",
    benchmark:
        f"{RESULTS}/benchmarks/environment/{{activity}}.tsv"
    wildcard_constraints:
        activity="(?:true_)?solar_activity",
    conda:
        "../envs/opml.yaml"
    params:
        settings=lambda wildcards: {key: config[key] for key in ("epoch", "duration_days")}
        | {
            "source": config["environment"][wildcards.activity],
            "percentile": config["environment"]["percentile"],
        },
        code=code("solar_activity.py"),
    message:
        "Solar activity: {params.settings[source]}"
    script:
        "../scripts/solar_activity.py"


rule gravity_field:
    input:
        source("gravity_field"),
    output:
        ENVIRONMENT["gravity_field"],
    log:
        f"{RESULTS}/logs/environment/gravity_field.log",
    benchmark:
        f"{RESULTS}/benchmarks/environment/gravity_field.tsv"
    conda:
        "../envs/opml.yaml"
    params:
        settings={
            "epoch": config["epoch"],
            "source": config["environment"]["gravity_field"],
            "degree": max(model["degree"] for model in config["force_models"].values()),
            "order": max(model["order"] for model in config["force_models"].values()),
        },
        code=code("gravity_field.py"),
    message:
        "Gravity field of Earth: {params.settings[source]} at the epoch"
    script:
        "../scripts/gravity_field.py"
