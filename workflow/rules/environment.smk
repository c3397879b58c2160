# What Earth, Sun and Moon do, tabulated once per run.
from opml.environment.earth_orientation import bulletin_digest

EARTH_ORIENTATION = product("environment/earth_orientation")
EPHEMERIDES = product("environment/ephemerides")
SOLAR_ACTIVITY = product("environment/{activity}")
HINDCAST = product("environment/hindcast")
OUTLOOKS = product(f"environment/{tables.OUTLOOKS}_{{hours}}h")
FUTURES = product("environment/futures_{members}")
GRAVITY_FIELD = product("environment/gravity_field")


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
        EARTH_ORIENTATION.table,
    log:
        EARTH_ORIENTATION.log,
    benchmark:
        EARTH_ORIENTATION.benchmark
    conda:
        "../envs/opml.yaml"
    params:
        settings=lambda _: PARAMS.span | {"bulletin": bulletin_digest(**PARAMS.span)},
        code=code("earth_orientation.py"),
    message:
        "Earth orientation: GCRF to ITRF with IAU 2006/2000A and the IERS's polar motion and UT1"
    script:
        "../scripts/earth_orientation.py"


rule ephemerides:
    output:
        EPHEMERIDES.table,
    log:
        EPHEMERIDES.log,
    benchmark:
        EPHEMERIDES.benchmark
    conda:
        "../envs/opml.yaml"
    params:
        settings=lambda _: PARAMS.span,
        code=code("ephemerides.py"),
    message:
        "Third bodies: positions of Sun, Moon, planets and Pluto"
    script:
        "../scripts/ephemerides.py"


rule solar_activity:
    input:
        lambda wildcards: users(ENVIRONMENT.source_files(wildcards.activity)),
    output:
        SOLAR_ACTIVITY.table,
    log:
        SOLAR_ACTIVITY.log,
    benchmark:
        SOLAR_ACTIVITY.benchmark
    wildcard_constraints:
        activity="(?:true_)?solar_activity",
    conda:
        "../envs/opml.yaml"
    params:
        settings=lambda wildcards: PARAMS.span
        | {
            "source": ENVIRONMENT.source(wildcards.activity),
            "percentile": ENVIRONMENT.sources.percentile,
        }
        | contents(ENVIRONMENT.source_files(wildcards.activity)),
        code=code("solar_activity.py"),
    message:
        "Solar activity: {params.settings[source]}"
    script:
        "../scripts/solar_activity.py"


rule hindcast:
    input:
        users(ENVIRONMENT.source_files("solar_activity")),
    output:
        HINDCAST.table,
    log:
        HINDCAST.log,
    benchmark:
        HINDCAST.benchmark
    conda:
        "../envs/opml.yaml"
    params:
        settings=lambda _: PARAMS.span
        | {"source": ENVIRONMENT.source("solar_activity"), "knowledge": ENVIRONMENT.sources.knowledge}
        | contents(ENVIRONMENT.source_files("solar_activity")),
        code=code("hindcast.py"),
    message:
        "Hindcast: the space weather of {params.settings[source]} as it was known at each time"
    script:
        "../scripts/hindcast.py"


rule outlooks:
    input:
        users(ENVIRONMENT.source_files("solar_activity")),
    output:
        OUTLOOKS.table,
    log:
        OUTLOOKS.log,
    benchmark:
        OUTLOOKS.benchmark
    wildcard_constraints:
        hours="1|3|6|12|24",
    conda:
        "../envs/opml.yaml"
    params:
        settings=lambda wildcards: PARAMS.span
        | {
            "source": ENVIRONMENT.source("solar_activity"),
            "issue_hours": int(wildcards.hours),
            "max_days": config["prediction"]["max_days"],
        }
        | contents(ENVIRONMENT.source_files("solar_activity")),
        code=code("outlooks.py"),
    message:
        "Outlooks: the space weather as it was forecast every {wildcards.hours} hours"
    script:
        "../scripts/outlooks.py"


rule futures:
    input:
        users(ENVIRONMENT.source_files("solar_activity")),
    output:
        FUTURES.table,
    log:
        FUTURES.log,
    benchmark:
        FUTURES.benchmark
    wildcard_constraints:
        members=naming.MEMBERS,
    conda:
        "../envs/opml.yaml"
    params:
        settings=lambda wildcards: PARAMS.span
        | {
            "source": ENVIRONMENT.source("solar_activity"),
            "members": int(wildcards.members),
            "issue_hours": ENVIRONMENT.sources.issue_hours,
            "max_days": config["prediction"]["max_days"],
        }
        | contents(ENVIRONMENT.source_files("solar_activity")),
        code=code("futures.py"),
    message:
        "Futures: {wildcards.members} courses that the space weather may take from each issue"
    script:
        "../scripts/futures.py"


rule gravity_field:
    input:
        users(ENVIRONMENT.source_files("gravity_field")),
    output:
        GRAVITY_FIELD.table,
    log:
        GRAVITY_FIELD.log,
    benchmark:
        GRAVITY_FIELD.benchmark
    conda:
        "../envs/opml.yaml"
    params:
        settings=lambda _: {
            "epoch": config["epoch"],
            "source": ENVIRONMENT.source("gravity_field"),
            "degree": max(model["degree"] for model in config["force_models"].values()),
            "order": max(model["order"] for model in config["force_models"].values()),
            **contents(ENVIRONMENT.source_files("gravity_field")),
        },
        code=code("gravity_field.py"),
    message:
        "Gravity field of Earth: {params.settings[source]} at the epoch"
    script:
        "../scripts/gravity_field.py"
