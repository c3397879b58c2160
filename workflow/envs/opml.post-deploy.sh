#!/usr/bin/env bash
# Run once by Snakemake, in the project's root, inside the environment it has just made.
set -euo pipefail
python -m pip install --no-deps --no-build-isolation .
