"""A real browser for the pages, where there is one: Playwright drives the Chromium of the machine."""

import os
import shutil
from pathlib import Path

import pytest

SWITCHES = (
    "--no-sandbox",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
)


@pytest.fixture(scope="session")
def chromium():
    """Gives a running Chromium; the tests that need it are skipped where it or Playwright is missing."""
    playwright = pytest.importorskip("playwright.sync_api", reason="needs the extra 'browser': pip install mitl[browser]")
    binary = os.environ.get("CHROMIUM") or shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
    if binary is None or not Path(binary).exists():
        pytest.skip("needs Chromium (Debian: apt-get install chromium), or its path in CHROMIUM")
    with playwright.sync_playwright() as running:
        browser = running.chromium.launch(executable_path=binary, args=list(SWITCHES))
        yield browser
        browser.close()


@pytest.fixture
def page(chromium):
    """Gives a page that fails its test for anything written to the console as an error, and for every request that leaves the machine."""
    context = chromium.new_context(viewport={"width": 1400, "height": 1000})
    page = context.new_page()
    page.problems = []
    page.on("console", lambda message: page.problems.append(message.text) if message.type in {"error", "warning"} else None)
    page.on("pageerror", lambda error: page.problems.append(str(error)))
    page.on(
        "request", lambda request: page.problems.append(request.url) if not request.url.startswith(("file:", "data:", "blob:")) else None
    )
    yield page
    context.close()
    assert page.problems == []
