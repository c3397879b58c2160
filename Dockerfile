# The workflow with all that it needs, as the lock file has it; docs/install.md tells how to build and to run it.
FROM python:3.11-slim
WORKDIR /opml
COPY requirements.lock ./
RUN python -m pip install --quiet --disable-pip-version-check --requirement requirements.lock
COPY pyproject.toml README.md CHANGELOG.md CONTRIBUTING.md LICENSE Snakefile ./
COPY src src
COPY workflow workflow
COPY config config
COPY profiles profiles
COPY docs docs
RUN python -m pip install --quiet --disable-pip-version-check --no-deps --no-build-isolation --editable .
# Whoever runs it may be no user that the image knows; compiled kernels and fetched files are kept here.
ENV XDG_CACHE_HOME=/tmp/cache
WORKDIR /project
ENTRYPOINT ["snakemake"]
