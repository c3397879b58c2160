"""The paper's run and study, as they come with the package."""

from collections.abc import Mapping
from typing import Any

from opml.base.files import PACKAGED, PROJECT
from opml.base.yaml_files import read_yaml

RUN: Mapping[str, Any] = read_yaml(PACKAGED)  # settings of the run; `study` names what is asked of it

PAPER_STUDY: Mapping[str, Any] = read_yaml(PROJECT / "config" / "studies" / "paper.yaml")["study"]
"""The paper's study."""
