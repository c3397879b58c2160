# The paper's 'Truth Dynamic Models'. RSOs that the study names are propagated together, all others alone.
TRUTH = product("truth/{rso}")


rule truth:
    input:
        **ENVIRONMENT.truth,
        check=checks(PARAMS.rso, PARAMS.check_simulated),
    output:
        TRUTH.table,
    log:
        TRUTH.log,
    benchmark:
        TRUTH.benchmark
    conda:
        "../envs/opml.yaml"
    resources:
        mem_mb=1000,
        runtime=6,
    params:
        settings=lambda wildcards: PARAMS.true_model | {"rso": PARAMS.rso(wildcards)},
        code=code("truth.py"),
    message:
        "Truth dynamic model: the true orbit of {wildcards.rso}"
    script:
        "../scripts/truth.py"


for number, together in enumerate(PLAN.truth_groups, start=1):

    TRUTHS = product(f"truth/together/{together[0]}")

    # A rule for each group, as no wildcard names its RSOs. Its files are preferred to those of `truth`.
    rule:
        name:
            "truths" if number == 1 else f"truths_{number}"
        input:
            **ENVIRONMENT.truth,
        output:
            truth=[product(f"truth/{name}").table for name in together],
            group=product(f"{tables.TRUTH_GROUPS}/{together[0]}").table,
        log:
            TRUTHS.log,
        benchmark:
            TRUTHS.benchmark
        conda:
            "../envs/opml.yaml"
        resources:
            mem_mb=3000,
            runtime=20,
        params:
            settings=PARAMS.true_model | {"rsos": [PARAMS.rso_named(name) for name in together]},
            code=code("truths.py"),
        message:
            f"Truth dynamic model: the true orbits of {', '.join(together)}"
        script:
            "../scripts/truths.py"
