"""What all tests may use."""

import os

from hypothesis import settings

pytest_plugins = ["pytester"]

# CI runs the same examples every time; at a desk each run looks at new ones
settings.register_profile("ci", derandomize=True)
if os.environ.get("CI"):
    settings.load_profile("ci")
