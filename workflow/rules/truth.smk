# The paper's 'Truth Dynamic Models'. RSOs that the study names fly together, any other one alone.
NAMED = [*CATALOGUE, *shared_truths.named_rsos(PAPER, BEYOND, OWN)]
TRUTH_GROUPS = shared_truths.groups(STUDY, dict.fromkeys(NAMED), results=Path(RESULTS))
FLOWN_BY = {
    "epoch": config["epoch"],
    "duration_days": config["duration_days"],
    "step_s": config["tracking"]["step_s"],
    "force_model": config["force_models"]["truth"],
    "integrator": config["integrator"],
}


rule truth:
    input:
        **TRUE_ENVIRONMENT,
        asked=checked_names(rso, simulated),
    output:
        f"{RESULTS}/truth/{{rso}}.parquet",
    log:
        f"{RESULTS}/logs/truth/{{rso}}.log",
    benchmark:
        f"{RESULTS}/benchmarks/truth/{{rso}}.tsv"
    conda:
        "../envs/opml.yaml"
    resources:
        mem_mb=1000,
        runtime=6,
    params:
        settings=lambda wildcards: FLOWN_BY | {"rso": rso(wildcards)},
        code=code("truth.py"),
    message:
        "Truth dynamic model: the true orbit of {wildcards.rso}"
    script:
        "../scripts/truth.py"


for number, together in enumerate(TRUTH_GROUPS, start=1):

    # A rule for each group, as no wildcard tells what flies together. Its files are preferred to those of `truth`.
    rule:
        name:
            "truths" if number == 1 else f"truths_{number}"
        input:
            **TRUE_ENVIRONMENT,
        output:
            truth=[f"{RESULTS}/truth/{name}.parquet" for name in together],
            group=f"{RESULTS}/{tables.TRUTH_GROUPS}/{together[0]}.parquet",
        log:
            f"{RESULTS}/logs/truth/together/{together[0]}.log",
        benchmark:
            f"{RESULTS}/benchmarks/truth/together/{together[0]}.tsv"
        conda:
            "../envs/opml.yaml"
        resources:
            mem_mb=3000,
            runtime=20,
        params:
            settings=FLOWN_BY | {"rsos": [asdict(sheets.parse_rso(name, SETTINGS.rsos)) for name in together]},
            code=code("truths.py"),
        message:
            f"Truth dynamic model: the true orbits of {', '.join(together)}"
        script:
            "../scripts/truths.py"
