"""The documentation as a site, made by Sphinx: `sphinx-build -W --keep-going docs site` (decision 43).

Pages are Markdown that also reads well in the repository; the reference is made from code and command line. Docstrings are plain text with
`names` in single backticks, so they are turned into reStructuredText here. Invariant: a link that leads nowhere fails the build.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

from sphinx.application import Sphinx

from mitl import __version__

DOCS = Path(__file__).resolve().parent
ROOT = DOCS.parent

project = "mitl"
author = "The mitl authors"
version = release = __version__
extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx_click"]
exclude_patterns = ["README.md", "_site"]
html_theme = "furo"
html_title = f"mitl {version}"
html_show_sourcelink = False
html_copy_source = False
pygments_dark_style = "monokai"
myst_enable_extensions = ["colon_fence"]
myst_heading_anchors = 3
autodoc_typehints = "signature"
autodoc_typehints_format = "short"
autodoc_member_order = "bysource"
autodoc_preserve_defaults = True
autodoc_default_options = {"members": True, "undoc-members": False}
python_maximum_signature_line_length = 100
suppress_warnings = ["misc.highlighting_failure"]  # RAPID and shells are named in the fences, and Pygments has no lexer for RAPID

_LINK = re.compile(r"(?<!!)\[([^\]]*)\]\(([^)#\s:]+)(#[^)\s]*)?\)")
_SPECIAL = re.compile(r"([\\*|_])")


def links_of_a_site(app: Sphinx, docname: str, source: list[str]) -> None:
    """Turns links to what is no page into names, and the shelf into the first page; FileNotFoundError for what is missing."""
    folder = (DOCS / f"{docname}.md").parent

    def on_site(found: re.Match[str]) -> str:
        words, target = found[1], (folder / found[2]).resolve()
        if not target.exists():
            raise FileNotFoundError(f"docs/{docname}.md links to {found[2]}, which is no file of the repository")
        if target == DOCS / "README.md":
            return f"[{words}](/index.md)"
        if target.suffix == ".md" and target.is_relative_to(DOCS):
            return found[0]
        name = str(target.relative_to(ROOT))
        return f"`{name}`" if words.strip("`") in {name, target.name} else f"{words} (`{name}`)"

    source[0] = _LINK.sub(on_site, source[0])


def rest_of_plain_text(app: Sphinx, what: str, name: str, obj: object, options: Any, lines: list[str]) -> None:
    """Turns a docstring's lines into reStructuredText that shows them as they are, names between backticks as code."""
    for number, line in enumerate(lines):
        parts = line.split("`")
        if len(parts) % 2 == 0:  # a lone backtick is a character
            parts = [line.replace("`", "'")]
        shown = [_SPECIAL.sub(r"\\\1", part) if n % 2 == 0 else f"``{part}``" for n, part in enumerate(parts)]
        lines[number] = "".join(shown)


def rest_of_help(app: Sphinx, context: object, lines: list[str]) -> None:
    """Does the same with what a command says of itself."""
    rest_of_plain_text(app, "command", "", context, None, lines)


def stars_of_help(app: Sphinx, context: object, lines: list[str]) -> None:
    """Keeps stars and the like in what is said of options, epilogs and arguments as they are; directives are left alone."""
    lines[:] = [line if line.lstrip().startswith("..") else re.sub(r"(?<!`)([*|]|_(?!\w))", r"\\\1", line) for line in lines]


def setup(app: Sphinx) -> dict[str, bool]:
    """Hooks both into the build."""
    app.connect("source-read", links_of_a_site)
    app.connect("autodoc-process-docstring", rest_of_plain_text)
    app.connect("sphinx-click-process-description", rest_of_help)
    for part in ("options", "arguments", "epilog"):
        app.connect(f"sphinx-click-process-{part}", stars_of_help)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
