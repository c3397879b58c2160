# Measured tracks, fixes or ranges in the place of simulated tracks, and a first orbit that needs no truth.
FIRST_ORBIT = product("starts/{rso}/{stations}")

if PLAN.settings.files_of(kinds.TRACKS):

    rule tracking_from_tdm:
        input:
            lambda wildcards: users(PLAN.settings.files_of(kinds.TRACKS)[wildcards.rso]),
        output:
            TRACKING.table,
        log:
            TRACKING.log,
        benchmark:
            TRACKING.benchmark
        wildcard_constraints:
            rso=naming.alternatives(PLAN.settings.files_of(kinds.TRACKS)),
            stations=naming.stations_pattern(PLAN.settings.stations),
        conda:
            "../envs/opml.yaml"
        params:
            settings=lambda wildcards: {
                "epoch": config["epoch"],
                "stations": PARAMS.stations(wildcards),
                "manoeuvres": PLAN.settings.manoeuvres(wildcards.rso),
                **contents(PLAN.settings.files_of(kinds.TRACKS)[wildcards.rso]),
            },
            code=code("tracking_from_tdm.py"),
        message:
            "Tracks: what {wildcards.stations} measured of {wildcards.rso}, from {input[0]}"
        script:
            "../scripts/tracking_from_tdm.py"

    ruleorder: tracking_from_tdm > tracking


if PLAN.settings.files_of(kinds.FIXES):

    rule fixes_from_files:
        input:
            lambda wildcards: users(PLAN.settings.files_of(kinds.FIXES)[wildcards.rso]),
            earth_orientation=EARTH_ORIENTATION.table,
        output:
            TRACKING.table,
        log:
            TRACKING.log,
        benchmark:
            TRACKING.benchmark
        wildcard_constraints:
            rso=naming.alternatives(PLAN.settings.files_of(kinds.FIXES)),
            stations=kinds.FIXES.stations,
        conda:
            "../envs/opml.yaml"
        params:
            settings=lambda wildcards: {
                **PARAMS.span,
                "options": PARAMS.options(wildcards),
                "manoeuvres": PLAN.settings.manoeuvres(wildcards.rso),
                **contents(PLAN.settings.files_of(kinds.FIXES)[wildcards.rso]),
            },
            code=code("fixes_from_files.py"),
        message:
            "Fixes: where {wildcards.rso} was measured to be, from {input[0]}"
        script:
            "../scripts/fixes_from_files.py"

    ruleorder: fixes_from_files > tracking


if PLAN.settings.files_of(kinds.RANGES):

    rule ranges_from_files:
        input:
            points=lambda wildcards: users(PLAN.settings.files_of(kinds.RANGES)[wildcards.rso]),
            sites=lambda wildcards: users(PLAN.settings.companion_files(kinds.RANGES)[wildcards.rso]),
            earth_orientation=EARTH_ORIENTATION.table,
            ephemerides=EPHEMERIDES.table,
        output:
            TRACKING.table,
        log:
            TRACKING.log,
        benchmark:
            TRACKING.benchmark
        wildcard_constraints:
            rso=naming.alternatives(PLAN.settings.files_of(kinds.RANGES)),
            stations=kinds.RANGES.stations,
        conda:
            "../envs/opml.yaml"
        params:
            settings=lambda wildcards: {
                **PARAMS.span,
                "options": PARAMS.options(wildcards),
                "manoeuvres": PLAN.settings.manoeuvres(wildcards.rso),
                **contents(
                    [
                        *PLAN.settings.files_of(kinds.RANGES)[wildcards.rso],
                        *PLAN.settings.companion_files(kinds.RANGES)[wildcards.rso],
                    ]
                ),
            },
            code=code("ranges_from_files.py"),
        message:
            "Ranges: how far {wildcards.rso} was from laser stations, from {input[0]}"
        script:
            "../scripts/ranges_from_files.py"

    ruleorder: ranges_from_files > tracking


if PLAN.settings.measured:

    rule first_orbit:
        input:
            **ENVIRONMENT.fits,
            tracking=rules.tracking.output[0],
            start=lambda wildcards: (
                local(PLAN.settings.starts[wildcards.rso]) if wildcards.rso in PLAN.settings.starts else []
            ),
        output:
            FIRST_ORBIT.table,
        log:
            FIRST_ORBIT.log,
        benchmark:
            FIRST_ORBIT.benchmark
        wildcard_constraints:
            rso=naming.alternatives(PLAN.settings.measured),
            stations=f"(?:{naming.stations_pattern(PLAN.settings.stations)}|{naming.alternatives(kinds.in_place_of_stations())})",
        conda:
            "../envs/opml.yaml"
        resources:
            mem_mb=1000,
            runtime=5,
        params:
            settings=lambda wildcards: {
                **PARAMS.assumed_model,
                "estimation": config["estimation"],
                "rso": PARAMS.rso(wildcards),
                "stations": PARAMS.stations(wildcards),
                **contents(
                    [PLAN.settings.starts[wildcards.rso]] if wildcards.rso in PLAN.settings.starts else []
                ),
            },
            code=code("first_orbit.py"),
        message:
            "First orbit: where the fits of {wildcards.rso} by {wildcards.stations} start"
        script:
            "../scripts/first_orbit.py"
