"""Folders in which tests run the workflow."""

import fcntl

import pytest
from project import Project


def pytest_collection_modifyitems(items):
    """Begin with what needs the finished run: it takes longest."""
    items.sort(key=lambda item: "finished" not in item.fixturenames)


@pytest.fixture
def project(tmp_path):
    return Project(tmp_path)


@pytest.fixture(scope="session")
def finished(tmp_path_factory, worker_id):
    """A folder in which the trimmed case was run with two cores; tests copy it, none changes it.

    The first process of tests that needs it makes it, the others wait.
    """
    base = tmp_path_factory.getbasetemp()
    folder = (base if worker_id == "master" else base.parent) / "finished"
    with folder.with_suffix(".lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not folder.exists():
            project = Project(tmp_path_factory.mktemp("running"))
            project.snakemake("-j2", "--configfile", "config/ci.yaml")
            project.folder.rename(folder)
    return Project(folder)
