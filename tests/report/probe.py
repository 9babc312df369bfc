"""Reads a page: its elements, and what headless Chromium shows of it."""

from __future__ import annotations

import json
import re
import shutil
import subprocess
from html import unescape
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

from tests.patience import STUCK

MISSING = "no Chromium to open the page with: apt-get install chromium"
CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
FLAGS = [
    "--headless",
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--hide-scrollbars",
]
SCRIPT = """
<script>
addEventListener("load", () => {  // which waits for the video's first frame
  const video = document.querySelector("video"), images = [...document.images];
  const box = element => element ? element.getBoundingClientRect().toJSON() : null;
  const out = document.createElement("pre");
  out.id = "probe";
  out.textContent = JSON.stringify({
    title: document.title, width: innerWidth, scrollWidth: document.documentElement.scrollWidth,
    fix: box(document.querySelector(".card .fix")), moment: box(document.querySelector(".card img")),
    rows: [...document.querySelectorAll(".finding")].map(row => row.innerText),
    video: video && {duration: video.duration, width: video.videoWidth, state: video.readyState,
                     muted: video.muted, loop: video.loop, error: video.error && video.error.message},
    broken: images.filter(image => !image.naturalWidth).length, images: images.length,
    ending: box(document.querySelector("#ending")), why: box(document.querySelector("#why")),
    attempts: [...document.querySelectorAll(".attempt")].map(row => row.innerText),
    shades: ["added", "removed", "same"].map(kind => {
      const line = document.querySelector(".diff ." + kind);
      return line && getComputedStyle(line).backgroundColor;
    }),
    charts: document.querySelectorAll("svg").length, page: document.body.innerText,
  });
  document.body.append(out);
});
</script>
"""


class Elements(HTMLParser):
    """Every element's tag and attributes, and the page's text."""

    def __init__(self, page: Path) -> None:
        super().__init__()
        self.found: list[tuple[str, dict[str, str | None]]] = []
        self.data: list[str] = []
        self.html = page.read_text(encoding="utf-8")
        self.feed(self.html)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.found.append((tag, dict(attrs)))

    def handle_data(self, data: str) -> None:
        self.data.append(data)

    @property
    def text(self) -> str:
        """All text as it stands in the page."""
        return "".join(self.data)

    @property
    def words(self) -> str:
        """All text, elements and words one space apart."""
        return " ".join(" ".join(self.data).split())

    def all(self, tag: str, **wanted: str) -> list[dict[str, str | None]]:
        """Attributes of the elements of a tag whose attributes contain these words."""
        return [
            attrs
            for name, attrs in self.found
            if name == tag and all(word in (attrs.get(key.rstrip("_")) or "").split() for key, word in wanted.items())
        ]

    def links(self) -> list[str]:
        return [attrs[key] or "" for _, attrs in self.found for key in ("src", "href", "poster") if key in attrs]


def probe(page: Path, profile: Path, width: int = 1280, policy: bool = True) -> dict[str, Any]:
    """What the page shows at a window's width, once its pictures and its video's first frame are decoded.

    The page's own policy forbids every script; the copy that is opened allows this one alone.
    """
    text = page.read_text(encoding="utf-8")
    changed = text.replace("default-src 'none';", "default-src 'none'; script-src 'nonce-probe';", 1)
    assert changed != text
    copy = page.with_name(f"probe-{width}.html")
    script = SCRIPT.replace("<script>", '<script nonce="probe">')
    copy.write_text(changed.replace("</body>", script + "</body>"), encoding="utf-8")
    command = [str(CHROMIUM), *FLAGS, f"--user-data-dir={profile}", f"--window-size={width},2000"]
    command += [f"--timeout={1000 * STUCK:.0f}", "--dump-dom", copy.resolve().as_uri()]
    dom = subprocess.run(command, capture_output=True, text=True, timeout=STUCK, check=True).stdout
    found = re.search(r'<pre id="probe">(.*?)</pre>', dom, re.DOTALL)
    assert found, dom[-2000:]
    return dict(json.loads(unescape(found[1])))
