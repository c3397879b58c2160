# The workflow with all that it needs, as the lock file has it; docs/install.md tells how to build and to run it.
# An exact release: the digest of an image is known to its registry alone.
FROM python:3.11.14-slim-bookworm
WORKDIR /opml
COPY requirements.lock ./
RUN python -m pip install --quiet --disable-pip-version-check --no-deps --requirement requirements.lock
COPY pyproject.toml README.md CHANGELOG.md CONTRIBUTING.md LICENSE Snakefile ./
COPY src src
COPY workflow workflow
COPY config config
COPY profiles profiles
COPY docs docs
RUN python -m pip install --quiet --disable-pip-version-check --no-deps --no-build-isolation --editable .
# Whoever runs it may be no user that the image knows; compiled kernels and fetched files are kept here.
ENV XDG_CACHE_HOME=/tmp/cache
# No account of the image has this number; `docker run --user` takes another.
USER 1000:1000
WORKDIR /project
ENTRYPOINT ["snakemake"]
