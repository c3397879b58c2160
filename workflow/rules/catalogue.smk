# A catalogue: what half of its objects teach in one season, judged on the other half in a later one.
CATALOGUE_DENSITIES = product("catalogue/densities")
CATALOGUE_ROWS = product("catalogue/rows/{population}/{test}")
CATALOGUE_RESIDUALS = product("catalogue/residuals/{test}/{learner}")
CATALOGUE_SCORES = product("catalogue/scores")
CATALOGUE_REPORT = product("catalogue/catalogue")
CATALOGUE_SHARES = product("figs/catalogue/{test}")
CATALOGUE_SEASONS = product("figs/catalogue_seasons")

if PLAN.settings.catalogue:

    rule catalogue_densities:
        input:
            users(PLAN.catalogue_weather_files),
        output:
            CATALOGUE_DENSITIES.table,
        log:
            CATALOGUE_DENSITIES.log,
        benchmark:
            CATALOGUE_DENSITIES.benchmark
        conda:
            "../envs/opml.yaml"
        params:
            settings=lambda _: PARAMS.catalogue_weather | contents(PLAN.catalogue_weather_files),
            code=code("catalogue_densities.py"),
        message:
            "Catalogue: mean densities of the thermosphere since 2002"
        script:
            "../scripts/catalogue_densities.py"

    rule catalogue_rows:
        input:
            sets=lambda wildcards: users(PLAN.settings.catalogue_files[wildcards.population]),
            orbits=lambda wildcards: users(PLAN.settings.catalogue_orbits[wildcards.population]),
            weather=users(PLAN.catalogue_weather_files),
            densities=rules.catalogue_densities.output[0],
        output:
            CATALOGUE_ROWS.table,
        log:
            CATALOGUE_ROWS.log,
        benchmark:
            CATALOGUE_ROWS.benchmark
        wildcard_constraints:
            population=naming.alternatives(PLAN.settings.catalogue.populations),
            test=naming.alternatives(PLAN.settings.catalogue.tests),
        conda:
            "../envs/opml.yaml"
        resources:
            mem_mb=6000,
            runtime=60,
        params:
            settings=lambda wildcards: {
                **PARAMS.catalogue_rows(wildcards),
                **contents(
                    [
                        *PLAN.settings.catalogue_files[wildcards.population],
                        *PLAN.settings.catalogue_orbits[wildcards.population],
                        *PLAN.catalogue_weather_files,
                    ]
                ),
            },
            code=code("catalogue_rows.py"),
        message:
            "Catalogue: predictions of {wildcards.population} in the seasons of {wildcards.test}"
        script:
            "../scripts/catalogue_rows.py"

    rule catalogue_residuals:
        input:
            rows=lambda wildcards: path_of(
                rules.catalogue_rows.output[0],
                population=PLAN.catalogue_test(wildcards.test).population,
                test=wildcards.test,
            ),
            others=lambda wildcards: path_of(
                rules.catalogue_rows.output[0],
                population=PLAN.catalogue_test(wildcards.test).teachers,
                test=wildcards.test,
            ),
        output:
            CATALOGUE_RESIDUALS.table,
        log:
            CATALOGUE_RESIDUALS.log,
        benchmark:
            CATALOGUE_RESIDUALS.benchmark
        wildcard_constraints:
            test=naming.alternatives(PLAN.settings.catalogue.tests),
            learner=naming.alternatives(PLAN.settings.catalogue.learners),
        conda:
            "../envs/opml.yaml"
        threads: 2  # its parts are learned side by side
        resources:
            mem_mb=6000,
            runtime=60,
        params:
            settings=PARAMS.catalogue_residuals,
            code=code("catalogue_residuals.py"),
        message:
            "Catalogue: train {wildcards.learner} on half of the objects, judge it on the others, {wildcards.test}"
        script:
            "../scripts/catalogue_residuals.py"

    rule catalogue_scores:
        input:
            [
                path_of(rules.catalogue_residuals.output[0], test=test, learner=learner)
                for test, learner in PLAN.catalogue_trials
            ],
        output:
            CATALOGUE_SCORES.table,
        log:
            CATALOGUE_SCORES.log,
        benchmark:
            CATALOGUE_SCORES.benchmark
        conda:
            "../envs/opml.yaml"
        resources:
            runtime=30,
        params:
            settings={
                "epoch": config["epoch"],
                "seed": PLAN.seeds.split,
                "trials": PLAN.catalogue_trials,
            },
            code=code("catalogue_scores.py"),
        message:
            "Catalogue: remaining share of SGP4's errors, by band of height and lead"
        script:
            "../scripts/catalogue_scores.py"

    use rule errors as catalogue_report with:
        input:
            rules.catalogue_scores.output[0],
        output:
            **documents(CATALOGUE_REPORT, section=SECTIONS["study"]),
        log:
            CATALOGUE_REPORT.log,
        benchmark:
            CATALOGUE_REPORT.benchmark
        params:
            **drawing("catalogue_report", PARAMS.catalogue_seasons),
        message:
            "Catalogue: the report of all tests"

    use rule errors as catalogue_shares with:
        input:
            rules.catalogue_scores.output[0],
        output:
            **figures(CATALOGUE_SHARES, caption="catalogue_shares", section=SECTIONS["study"]),
        log:
            CATALOGUE_SHARES.log,
        benchmark:
            CATALOGUE_SHARES.benchmark
        wildcard_constraints:
            test=naming.alternatives(PLAN.settings.catalogue.tests),
        params:
            **drawing(
                "catalogue_shares",
                lambda wildcards: {
                    **PARAMS.catalogue_season(wildcards),
                    "test": wildcards.test,
                    "population": PLAN.catalogue_test(wildcards.test).population,
                },
            ),
        message:
            "Figure: share of SGP4's errors by band of height and lead, {wildcards.test}"

    use rule errors as catalogue_seasons with:
        input:
            rules.catalogue_scores.output[0],
        output:
            **figures(CATALOGUE_SEASONS, caption="catalogue_seasons", section=SECTIONS["study"]),
        log:
            CATALOGUE_SEASONS.log,
        benchmark:
            CATALOGUE_SEASONS.benchmark
        params:
            **drawing("catalogue_seasons", PARAMS.catalogue_panels),
        message:
            "Figure: remaining share of SGP4's errors with improved sets, by test"
