# Read in the place of all other rules where Snakemake has no package `opml` beside it: what it takes to start once
# more, in the workflow's own environment. Only there are the names of products known.
import shlex

from snakemake.logging import logger

INSTALL = "opml: expected the package beside Snakemake, got none: pip install 'opml-orbits[workflow]', or --sdm conda"
logger.warning(INSTALL)
FILES = list(map(str, workflow.config_settings.configfiles))
VALUES = [f"{key}={value}" for key, value in workflow.config_settings.config.items()]
AGAIN = ["--snakefile", str(workflow.main_snakefile), "--nolock"]
AGAIN += ["--configfile", *FILES] if FILES else []
AGAIN += ["--config", *VALUES] if VALUES else []
