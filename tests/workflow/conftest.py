"""Folders in which tests run the workflow."""

import pytest
from project import Project


@pytest.fixture
def project(tmp_path):
    return Project(tmp_path)


@pytest.fixture(scope="session")
def finished(tmp_path_factory):
    """A folder in which the trimmed case was run with two cores; tests copy it, none changes it."""
    project = Project(tmp_path_factory.mktemp("finished"))
    project.snakemake("-j2", "--configfile", "config/ci.yaml")
    return project
