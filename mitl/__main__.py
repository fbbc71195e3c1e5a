"""`python -m mitl` is `mitl`."""

from mitl.cli import main

main()
