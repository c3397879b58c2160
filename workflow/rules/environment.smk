# What Earth, Sun and Moon do, tabulated once per run.
# Two seconds for all of them: on a cluster they are no jobs for the queue.
localrules:
    earth_orientation,
    ephemerides,
    solar_activity,
    hindcast,
    outlooks,
    futures,
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


rule thermosphere:
    input:
        source(TRUE_ACTIVITY),
    output:
        f"{RESULTS}/environment/{tables.THERMOSPHERE}.parquet",
    log:
        f"{RESULTS}/logs/environment/{tables.THERMOSPHERE}.log",
    benchmark:
        f"{RESULTS}/benchmarks/environment/{tables.THERMOSPHERE}.tsv"
    conda:
        "../envs/opml.yaml"
    resources:
        mem_mb=2000,
    params:
        settings={key: config[key] for key in ("epoch", "duration_days")}
        | {"source": config["environment"][TRUE_ACTIVITY]},
        code=code("thermosphere.py"),
    message:
        "Thermosphere: densities of NRLMSIS 2.1 around the Earth under {params.settings[source]}"
    script:
        "../scripts/thermosphere.py"


rule hindcast:
    input:
        source("solar_activity"),
    output:
        f"{RESULTS}/environment/hindcast.parquet",
    log:
        f"{RESULTS}/logs/environment/hindcast.log",
    benchmark:
        f"{RESULTS}/benchmarks/environment/hindcast.tsv"
    conda:
        "../envs/opml.yaml"
    params:
        settings={key: config[key] for key in ("epoch", "duration_days")}
        | {"source": config["environment"]["solar_activity"], "knowledge": KNOWLEDGE},
        code=code("hindcast.py"),
    message:
        "Hindcast: the space weather of {params.settings[source]} as it was known at each time"
    script:
        "../scripts/hindcast.py"


rule outlooks:
    input:
        source("solar_activity"),
        [local(path) for path in methods.files(forecast_settings())],
    output:
        f"{RESULTS}/environment/{tables.OUTLOOKS}_{{hours}}h.parquet",
    log:
        f"{RESULTS}/logs/environment/{tables.OUTLOOKS}_{{hours}}h.log",
    benchmark:
        f"{RESULTS}/benchmarks/environment/{tables.OUTLOOKS}_{{hours}}h.tsv"
    wildcard_constraints:
        hours="1|3|6|12|24",
    conda:
        "../envs/opml.yaml"
    params:
        settings=lambda wildcards: {key: config[key] for key in ("epoch", "duration_days")}
        | {
            "source": config["environment"]["solar_activity"],
            "forecast": forecast_settings(),
            "issue_hours": int(wildcards.hours),
            "max_days": config["prediction"]["max_days"],
        },
        code=code("outlooks.py"),
    message:
        "Outlooks: the space weather as it was forecast every {wildcards.hours} hours"
    script:
        "../scripts/outlooks.py"


rule futures:
    input:
        source("solar_activity"),
        [local(path) for path in methods.files(forecast_settings())],
    output:
        f"{RESULTS}/environment/futures_{{members}}.parquet",
    log:
        f"{RESULTS}/logs/environment/futures_{{members}}.log",
    benchmark:
        f"{RESULTS}/benchmarks/environment/futures_{{members}}.tsv"
    wildcard_constraints:
        members=naming.MEMBERS,
    conda:
        "../envs/opml.yaml"
    params:
        settings=lambda wildcards: {key: config[key] for key in ("epoch", "duration_days")}
        | {
            "source": config["environment"]["solar_activity"],
            "forecast": forecast_settings(),
            "members": int(wildcards.members),
            "issue_hours": config["environment"].get("issue_hours"),
            "max_days": config["prediction"]["max_days"],
        },
        code=code("futures.py"),
    message:
        "Futures: {wildcards.members} courses that the space weather may take from each issue"
    script:
        "../scripts/futures.py"


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
