# Read in the place of all other rules where Snakemake runs without the package `opml`. It starts the run once
# more in the workflow's own environment, as only the package knows the names of products.
import shlex

from snakemake.logging import logger

INSTALL = (
    "opml: expected the package with Snakemake, got none: pip install 'opml-orbits[workflow]', or --sdm conda"
)
logger.warning(INSTALL)
FILES = list(map(str, workflow.config_settings.configfiles))
VALUES = [f"{key}={value}" for key, value in workflow.config_settings.config.items()]
AGAIN = ["--snakefile", str(workflow.main_snakefile), "--nolock"]
AGAIN += ["--configfile", *FILES] if FILES else []
AGAIN += ["--config", *VALUES] if VALUES else []
