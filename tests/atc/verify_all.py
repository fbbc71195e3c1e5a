"""Runs `mitl verify` several times in one process, because loading Drake takes as long as a case.

Arguments: a folder, then one run each: its name, `:` and the words of the command, separated by spaces. Prints {name: exit code} as JSON.
"""

import json
import sys
from contextlib import redirect_stdout
from io import StringIO
from pathlib import Path

from mitl.cli import run

folder = Path(sys.argv[1])
codes = {}
for asked in sys.argv[2:]:
    name, _, words = asked.partition(":")
    with redirect_stdout(StringIO()):
        codes[name] = run(["verify", *words.split(), "--out", str(folder / name)])
sys.stdout.write(json.dumps(codes))
