# Into and out of the ecosystem: orbits as CCSDS OEM, tracks as CCSDS TDM, and an orbit of one's own in the place of the simulated truth.


rule export_truth:
    input:
        rules.truth.output[0],
    output:
        f"{RESULTS}/exports/truth/{{rso}}.oem",
    log:
        f"{RESULTS}/logs/exports/truth/{{rso}}.log",
    benchmark:
        f"{RESULTS}/benchmarks/exports/truth/{{rso}}.tsv"
    conda:
        "../envs/opml.yaml"
    params:
        settings=lambda wildcards: {"epoch": config["epoch"], "table": "truth", "rso": wildcards.rso},
        code=code("export_oem.py"),
    message:
        "Export: the true orbit of {wildcards.rso} as CCSDS OEM"
    script:
        "../scripts/export_oem.py"


use rule export_truth as export_estimates with:
    input:
        rules.estimation.output[0],
    output:
        f"{RESULTS}/exports/estimates/{{rso}}/{{stations}}{{window}}.oem",
    log:
        f"{RESULTS}/logs/exports/estimates/{{rso}}/{{stations}}{{window}}.log",
    benchmark:
        f"{RESULTS}/benchmarks/exports/estimates/{{rso}}/{{stations}}{{window}}.tsv"
    params:
        settings=lambda wildcards: {"epoch": config["epoch"], "table": "estimates", "rso": wildcards.rso},
        code=code("export_oem.py"),
    message:
        "Export: estimates of {wildcards.rso} from {wildcards.stations}, with covariances, as CCSDS OEM"


use rule export_truth as export_predictions with:
    input:
        rules.prediction.output[0],
    output:
        f"{RESULTS}/exports/predictions/{{rso}}/{{stations}}{{window}}.oem",
    log:
        f"{RESULTS}/logs/exports/predictions/{{rso}}/{{stations}}{{window}}.log",
    benchmark:
        f"{RESULTS}/benchmarks/exports/predictions/{{rso}}/{{stations}}{{window}}.tsv"
    params:
        settings=lambda wildcards: {"epoch": config["epoch"], "table": "predictions", "rso": wildcards.rso},
        code=code("export_oem.py"),
    message:
        "Export: predictions of {wildcards.rso} from {wildcards.stations}, one segment per estimate, as CCSDS OEM"


rule export_tracking:
    input:
        rules.tracking.output[0],
    output:
        f"{RESULTS}/exports/tracking/{{rso}}/{{stations}}.tdm",
    log:
        f"{RESULTS}/logs/exports/tracking/{{rso}}/{{stations}}.log",
    benchmark:
        f"{RESULTS}/benchmarks/exports/tracking/{{rso}}/{{stations}}.tsv"
    conda:
        "../envs/opml.yaml"
    params:
        settings=lambda wildcards: {"epoch": config["epoch"], "rso": wildcards.rso},
        code=code("export_tdm.py"),
    message:
        "Export: tracks of {wildcards.rso} by {wildcards.stations} as CCSDS TDM"
    script:
        "../scripts/export_tdm.py"


if SETTINGS.orbits:

    rule truth_from_orbit:
        input:
            lambda wildcards: [local(path) for path in SETTINGS.orbits[wildcards.rso]],
        output:
            f"{RESULTS}/truth/{{rso}}.parquet",
        log:
            f"{RESULTS}/logs/truth/{{rso}}.log",
        benchmark:
            f"{RESULTS}/benchmarks/truth/{{rso}}.tsv"
        wildcard_constraints:
            rso=naming.alternatives(SETTINGS.orbits),
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
            },
            code=code("truth_from_orbit.py"),
        message:
            "Truth: the orbit of {wildcards.rso} from {input[0]}"
        script:
            "../scripts/truth_from_orbit.py"

    ruleorder: truth_from_orbit > truth
