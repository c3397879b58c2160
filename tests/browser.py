"""Pages as a browser lays them out, at the width of a screen."""

import html
import json
import re
import shutil
import subprocess

import pytest
from project import HUNG

_NAMES = ("chromium", "chromium-browser", "google-chrome", "chrome")
_BROWSER = next(filter(None, map(shutil.which, _NAMES)), None)

_MEASURE = """
<body><iframe style="width:{width}px;height:900px;border:0" srcdoc="{page}"></iframe><pre></pre><script>
onload = () => {{
  const page = document.querySelector("iframe").contentDocument, root = page.documentElement;
  const box = one => one.getBoundingClientRect();
  document.querySelector("pre").textContent = JSON.stringify({{
    across: root.scrollWidth,
    cards: [...page.querySelectorAll(".cards section")].map(one => [one.querySelector("h2").textContent,
      box(one).left, box(one).right, box(one).bottom]),
    lines: [...page.querySelectorAll(".line")].map(one => page.defaultView.getComputedStyle(one).color),
    marks: [...page.querySelectorAll(".marks")].map(one => one.scrollWidth - one.clientWidth),
    tables: [...page.querySelectorAll("table")].map(one => one.scrollWidth - one.clientWidth),
    pictures: [...page.images].map(one => [one.naturalWidth, box(one).right]),
  }});
}}
</script>
"""


def laid_out(page, folder, *, width):
    """Return what a browser says of a page at a width [px]: how far all on it reaches."""
    framed = folder / "framed.html"
    framed.write_text(_MEASURE.format(width=width, page=html.escape(page, quote=True)), encoding="utf-8")
    (measures,) = re.findall(r"<pre>(.*)</pre>", opened(framed, f"--window-size={width + 100},1000"))
    return json.loads(html.unescape(measures))


def opened(page, *options):
    """Return the document that a browser makes of the file of a page; its own files are beside that."""
    if _BROWSER is None:
        pytest.skip(f"expected one of {', '.join(_NAMES)}, got none: `apt-get install chromium` brings one")
    options = ["--headless=new", "--no-sandbox", "--disable-gpu", "--enable-unsafe-swiftshader", *options]
    options += [f"--user-data-dir={page.parent}/browser", "--virtual-time-budget=10000", "--dump-dom"]
    run = [_BROWSER, *options, page.as_uri()]
    return subprocess.run(run, capture_output=True, text=True, check=True, timeout=HUNG).stdout
