"""What all tests may use."""

import os

from hypothesis import settings

pytest_plugins = ["pytester"]

# CI runs the same examples every time; at a desk each run looks at new ones. Without a deadline: a busy machine is no failure
settings.register_profile("desk", deadline=None)
settings.register_profile("ci", deadline=None, derandomize=True)
settings.load_profile("ci" if os.environ.get("CI") else "desk")
