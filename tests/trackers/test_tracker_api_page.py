"""The snippets of docs/tracker_api.md run, in their order, as one program; and the page names every method of the protocol."""

import re
from pathlib import Path

from mitl.protocols import Tracker

PAGE = (Path(__file__).parents[2] / "docs" / "tracker_api.md").read_text(encoding="utf-8")


def test_the_snippets_run():
    snippets = re.findall(r"```python\n(.*?)```", PAGE, flags=re.DOTALL)
    assert len(snippets) >= 6
    exec(compile("\n".join(snippets), "tracker_api.md", "exec"), {})  # noqa: S102 - our own page


def test_every_method_of_the_protocol_is_on_the_page():
    methods = [name for name in vars(Tracker) if not name.startswith("_") and callable(getattr(Tracker, name))]
    assert set(methods) >= {"start", "stop", "path", "latest", "average"}
    for name in methods:
        assert f"{name}(" in PAGE, name
