#!/usr/bin/env bash
# Run once by Snakemake, in the run's folder, inside the environment it has just made: adds opml itself, from the tree
# where the run's folder is one, else from the index.
set -euo pipefail
if [ -f src/opml/__init__.py ]; then
    python -m pip install --no-deps --no-build-isolation .
else
    python -m pip install --no-deps opml-orbits==1.0.0
fi
