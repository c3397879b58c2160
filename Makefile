# make        the paper's partition curve, from a full simulation
# make check  types, style and imports, and the tests that take no seconds (two minutes)
# make test   all tests, of the documentation's site too (8 minutes)
# make coverage   how much of the package the tests reach, and what none does; at least 95 % (8 minutes)
# make faults runs that are killed and damaged at 650 random moments (twenty minutes)
# make draws  the cases that tests draw, drawn anew: each run has others (two minutes)
# make docs   the documentation as a site, in build/site
# make pictures   the paper's figures in the documentation, from a full run (half an hour): docs/images/paper
# make wheel  the package as others install it, and its source, in build/wheel
# make corrector PAYLOADS=<files> FRAGMENTS=<files> WEATHER=<SW-All.csv>   the packaged model of element sets (5 minutes)
# make validate OREKIT_DATA=<folder>   the dynamics against Orekit's (half an hour): docs/tables/orekit.md
# make weather   the skill of forecasts of the space weather (some minutes): the table in docs/weather.md
# make bench [OREKIT_DATA=<folder>]    opml's speed beside its peers' (25 minutes): benchmarks/results.md
# All first build .venv from requirements.lock, unless it stands already.

PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
INSTALLED := $(VENV)/.installed

# uv installs in a fraction of the time, where it is there; `make UV=` does without.
UV ?= $(shell command -v uv 2>/dev/null)
ifeq ($(UV),)
MAKE_VENV := $(PYTHON) -m venv
INSTALL := $(BIN)/python -m pip install --quiet --no-compile --disable-pip-version-check
else
MAKE_VENV := $(UV) venv --quiet --seed --allow-existing --python $(PYTHON)
INSTALL := $(UV) pip install --quiet --python $(BIN)/python
endif

.PHONY: all check test coverage faults draws lint docs pictures wheel corrector validate weather bench clean

all: $(INSTALLED)
	$(BIN)/snakemake -j2 --set-threads estimation=2 prediction=2 -- results/figs/partition_curve.pdf

# A process a core, the longest tests first; those of a module stay together, as they share what they make.
PYTEST := $(BIN)/python -m pytest --numprocesses auto --dist loadfile --no-loadscope-reorder

check: $(INSTALLED)
	$(BIN)/ruff check
	$(BIN)/mypy
	$(BIN)/lint-imports
	$(PYTEST) -m "not slow" tests/unit tests/project

# Tests of the workflow start Python some hundred times: each start reads what an earlier one compiled.
test: export PYTHONDONTWRITEBYTECODE =
test: $(VENV)/.docs
	$(PYTEST) tests/workflow tests/project tests/reference tests/unit

# Apart from the tests, which take half as long again where each line is followed.
coverage: $(INSTALLED)
	$(PYTEST) tests/reference tests/unit --cov

faults: $(INSTALLED)
	$(BIN)/python -m pytest tests/faults

draws: $(INSTALLED)
	$(PYTEST) -m hypothesis --hypothesis-profile anew tests/unit

lint: $(INSTALLED)
	$(BIN)/ruff check
	$(BIN)/snakefmt --check Snakefile workflow
	$(BIN)/snakemake --lint
	$(BIN)/lint-imports
	$(BIN)/mypy

docs: $(VENV)/.docs
	$(BIN)/python -m sphinx -W --keep-going -q -d build/doctrees docs build/site

$(VENV)/.docs: $(INSTALLED) requirements-docs.lock
	$(INSTALL) --constraint requirements.lock --requirement requirements-docs.lock
	touch $@

pictures: $(INSTALLED)
	$(BIN)/snakemake -j2 default study
	$(BIN)/python -m validation.pictures results/figs docs/images/paper

wheel: $(INSTALLED)
	rm -rf build/wheel && mkdir -p build/wheel
	$(BIN)/python -c "from setuptools.build_meta import build_sdist as make; make('build/wheel')" > build/sdist.log
	$(BIN)/python -m pip wheel --quiet --no-deps --no-build-isolation --wheel-dir build/wheel build/wheel/*.tar.gz

corrector: $(INSTALLED)
	@test -n "$(and $(PAYLOADS),$(FRAGMENTS),$(WEATHER))" || { \
		echo "make corrector: expected PAYLOADS=<files> FRAGMENTS=<files> WEATHER=<file>, got not all" >&2; exit 2; }
	$(BIN)/opml train $(PAYLOADS:%=payloads=%) $(FRAGMENTS:%=fragments=%) --weather $(WEATHER) \
		-o src/opml/data/corrector.parquet

validate: $(VENV)/.verify
	@test -n "$(OREKIT_DATA)" || { echo "make validate: expected OREKIT_DATA=<folder with Orekit's data>, got none" >&2; exit 2; }
	$(BIN)/python -m validation --orekit-data "$(OREKIT_DATA)"

weather: $(INSTALLED)
	$(BIN)/python -m validation.forecast_skill docs/weather.md

bench: $(VENV)/.bench
	$(BIN)/python -m benchmarks $(if $(OREKIT_DATA),--orekit-data "$(OREKIT_DATA)")

$(VENV)/.bench: $(INSTALLED) requirements-bench.lock
	$(INSTALL) --constraint requirements.lock --requirement requirements-bench.lock
	touch $@

$(VENV)/.verify: $(INSTALLED) requirements-verify.lock
	$(INSTALL) --constraint requirements.lock --requirement requirements-verify.lock
	touch $@

# Modules are compiled at the end, on all cores, as far as they can be; pip would compile on one, which takes as
# long as all the rest. Kernels are compiled beside them, as the first job would do while all others wait.
$(INSTALLED): requirements.lock pyproject.toml
	@$(PYTHON) -c 'import sys; sys.exit(None if sys.version_info >= (3, 11) else "opml needs Python 3.11 or later")'
	$(MAKE_VENV) $(VENV)
	$(INSTALL) --no-deps --requirement requirements.lock
	$(INSTALL) --no-deps --no-build-isolation --editable .
	-$(BIN)/python -m opml.workflow.compile_kernels & $(BIN)/python -m compileall -q -j 0 -x /tests/ $(VENV)/lib src; wait
	$(BIN)/python -c "from opml.study.settings import editor_schema; editor_schema.write('.')"
	touch $@

clean:
	rm -rf results .snakemake $(VENV) .pytest_cache .ruff_cache .import_linter_cache build src/*.egg-info
	find src tests validation workflow -name __pycache__ -prune -exec rm -rf {} +
