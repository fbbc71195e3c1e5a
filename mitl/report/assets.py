"""The page's own scripts and style, and the browser libraries that it embeds (vendor/README.md says whence).

Invariant: the page's content security policy names every script by its hash, so that nothing that got into the page runs.
"""

from __future__ import annotations

import base64
import hashlib
from functools import cache
from pathlib import Path

from markupsafe import Markup

_HERE = Path(__file__).resolve().parent


@cache
def text_of(name: str) -> str:
    """Gives the text of a file of this package, e.g. vendor/uplot.min.js."""
    return (_HERE / name).read_text(encoding="utf-8").strip()


def script(*names: str) -> Markup:
    """Gives scripts as elements to embed. Raises ValueError for one that would end its element early."""
    texts = [text_of(name) for name in names]
    for name, text in zip(names, texts, strict=True):
        if "</script" in text.lower() or "<!--" in text:
            raise ValueError(f"{name} holds '</script' or '<!--' and cannot be embedded")
    return Markup("\n").join(Markup("<script>{}</script>").format(Markup(text)) for text in texts)  # noqa: S704 - our own files


def style(*names: str) -> Markup:
    """Gives style sheets as one text to embed."""
    return Markup("\n".join(text_of(name) for name in names))  # noqa: S704 - our own files


def policy(*scripts: str) -> str:
    """Gives the content security policy of a page that embeds these scripts and nothing else."""
    hashes = " ".join(f"'sha256-{base64.b64encode(hashlib.sha256(text_of(name).encode()).digest()).decode()}'" for name in scripts)
    return f"default-src 'none'; script-src {hashes or chr(39) + 'none' + chr(39)}; style-src 'unsafe-inline'; img-src data:"
