"""Hooks of the site's build (mkdocs.yml): pages that live beside what they describe, and links to them.

README.md and its like stand where a reader of the files looks for them. Here they become pages, and a link
between files of the project becomes one between pages.
"""

import posixpath
import re
from pathlib import Path

from mkdocs.structure.files import File

ROOT = Path(__file__).parents[1]
PAGES = {
    "README.md": "index.md",
    "CONTRIBUTING.md": "contributing.md",
    "CHANGELOG.md": "changes.md",
    "config/README.md": "settings.md",
    "src/opml/data/README.md": "sources.md",
}
_LINK = re.compile(r"\]\((?!\w+:|#)([^)\s#]+)(#[^)\s]*)?\)")


def on_config(config):
    """Add to the navigation the pages that it does not name."""
    pages = {*PAGES.values(), *(path.name for path in (ROOT / "docs").glob("*.md"))}
    config.nav += sorted(pages - set(config.nav))
    return config


def on_files(files, config):
    """Add the pages from outside docs/."""
    for path, page in PAGES.items():
        content = (ROOT / path).read_text(encoding="utf-8")
        files.append(File.generated(config, page, content=content))
    return files


def on_page_markdown(markdown, page, config, files):
    """Point links between files of the project at their pages."""
    homes = {page: path for path, page in PAGES.items()}
    folder = posixpath.dirname(homes.get(page.file.src_uri, f"docs/{page.file.src_uri}"))

    def pointed(match):
        path = posixpath.normpath(posixpath.join(folder, match[1]))
        return f"]({PAGES.get(path, path.removeprefix('docs/'))}{match[2] or ''})"

    return _LINK.sub(pointed, markdown)
