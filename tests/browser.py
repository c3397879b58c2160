"""Pages as a browser lays them out, at the width of a screen."""

import html
import json
import re
import shutil
import subprocess

import pytest
from project import HUNG

BROWSER = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)

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
    if BROWSER is None:
        pytest.skip("no Chromium or Chrome is installed")
    framed = folder / "framed.html"
    framed.write_text(_MEASURE.format(width=width, page=html.escape(page, quote=True)), encoding="utf-8")
    options = ["--headless=new", "--no-sandbox", "--disable-gpu", f"--user-data-dir={folder}/browser"]
    options += [f"--window-size={width + 100},1000", "--virtual-time-budget=5000", "--dump-dom"]
    run = [BROWSER, *options, framed.as_uri()]
    found = subprocess.run(run, capture_output=True, text=True, check=True, timeout=HUNG).stdout
    (told,) = re.findall(r"<pre>(.*)</pre>", found)
    return json.loads(html.unescape(told))
