"""Write the pages that the package declares, and editors' schema: `python -m validation.pages`."""

from opml.base.files import replacing
from opml.study.settings import editor_schema
from validation.case import ROOT
from validation.pages import board, notebook, settings, tables

PAGES = {
    **tables.pages(),
    settings.KEYS: settings.keys_page,
    board.TABLE: board.page,
    notebook.NOTEBOOK: notebook.text,
}

if __name__ == "__main__":
    for path, text in PAGES.items():
        with replacing(ROOT / path) as temporary:
            temporary.write_text(text(), encoding="utf-8")
        print(f"{path} is written")
    editor_schema.write(ROOT)
