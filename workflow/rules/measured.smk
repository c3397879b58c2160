# Tracks that were really measured in the place of simulated ones, and a first orbit that needs no truth.
if SETTINGS.tracks:

    rule tracking_from_tdm:
        input:
            lambda wildcards: [local(path) for path in SETTINGS.tracks[wildcards.rso]],
        output:
            f"{RESULTS}/tracking/{{rso}}/{{stations}}.parquet",
        log:
            f"{RESULTS}/logs/tracking/{{rso}}/{{stations}}.log",
        benchmark:
            f"{RESULTS}/benchmarks/tracking/{{rso}}/{{stations}}.tsv"
        wildcard_constraints:
            rso=naming.alternatives(SETTINGS.tracks),
            stations=naming.stations_pattern(SETTINGS.stations),
        conda:
            "../envs/opml.yaml"
        params:
            settings=lambda wildcards: {
                "epoch": config["epoch"],
                "stations": stations(wildcards),
                "manoeuvres": config.get("manoeuvres", {}).get(wildcards.rso, []),
            },
            code=code("tracking_from_tdm.py"),
        message:
            "Tracks: what {wildcards.stations} measured of {wildcards.rso}, from {input[0]}"
        script:
            "../scripts/tracking_from_tdm.py"

    rule first_orbit:
        input:
            **FIT_ENVIRONMENT,
            tracking=rules.tracking.output[0],
            start=lambda wildcards: (
                local(SETTINGS.starts[wildcards.rso]) if wildcards.rso in SETTINGS.starts else []
            ),
        output:
            f"{RESULTS}/starts/{{rso}}/{{stations}}.parquet",
        log:
            f"{RESULTS}/logs/starts/{{rso}}/{{stations}}.log",
        benchmark:
            f"{RESULTS}/benchmarks/starts/{{rso}}/{{stations}}.tsv"
        wildcard_constraints:
            rso=naming.alternatives(SETTINGS.tracks),
            stations=naming.stations_pattern(SETTINGS.stations),
        conda:
            "../envs/opml.yaml"
        resources:
            mem_mb=1000,
            runtime=5,
        params:
            settings=lambda wildcards: {
                "epoch": config["epoch"],
                "force_model": config["force_models"]["assumed"],
                "integrator": config["integrator"],
                "estimation": config["estimation"],
                "rso": rso(wildcards),
                "stations": stations(wildcards),
            },
            code=code("first_orbit.py"),
        message:
            "First orbit: where the fits of {wildcards.rso} to tracks of {wildcards.stations} start"
        script:
            "../scripts/first_orbit.py"

    ruleorder: tracking_from_tdm > tracking
