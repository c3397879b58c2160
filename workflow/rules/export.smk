# Messages: orbits as CCSDS OEM, tracks as CCSDS TDM. An orbit from files in the place of the simulated truth.
TRUTH_OEM = product("exports/truth/{rso}")
TRACKING_TDM = product("exports/tracking/{rso}/{stations}")


rule export_truth:
    input:
        rules.truth.output[0],
        source=INPUTS.source,
    output:
        TRUTH_OEM.file("oem"),
    log:
        TRUTH_OEM.log,
    benchmark:
        TRUTH_OEM.benchmark
    conda:
        "../envs/opml.yaml"
    params:
        settings=lambda wildcards: {"epoch": config["epoch"], "table": "truth", "rso": wildcards.rso},
        code=code("export_oem.py"),
    message:
        "Export: the true orbit of {wildcards.rso} as CCSDS OEM"
    script:
        "../scripts/export_oem.py"


rule export_tracking:
    input:
        rules.tracking.output[0],
    output:
        TRACKING_TDM.file("tdm"),
    log:
        TRACKING_TDM.log,
    benchmark:
        TRACKING_TDM.benchmark
    conda:
        "../envs/opml.yaml"
    params:
        settings=lambda wildcards: {"epoch": config["epoch"], "rso": wildcards.rso},
        code=code("export_tdm.py"),
    message:
        "Export: tracks of {wildcards.rso} by {wildcards.stations} as CCSDS TDM"
    script:
        "../scripts/export_tdm.py"


if PLAN.settings.orbits:

    rule truth_from_orbit:
        input:
            lambda wildcards: users(PLAN.settings.orbits[wildcards.rso]),
        output:
            TRUTH.table,
        log:
            TRUTH.log,
        benchmark:
            TRUTH.benchmark
        wildcard_constraints:
            rso=naming.alternatives(PLAN.settings.orbits),
        conda:
            "../envs/opml.yaml"
        resources:
            mem_mb=1500,
            runtime=10,
        params:
            settings=lambda wildcards: {
                "epoch": config["epoch"],
                "duration_days": config["duration_days"],
                "step_s": config["tracking"]["step_s"],
                **contents(PLAN.settings.orbits[wildcards.rso]),
            },
            code=code("truth_from_orbit.py"),
        message:
            "Truth: the orbit of {wildcards.rso} from {input[0]}"
        script:
            "../scripts/truth_from_orbit.py"

    ruleorder: truth_from_orbit > truth
