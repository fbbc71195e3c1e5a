"""The rig: from `sim` or a rig file to the objects that a test run is given. The only place that knows all implementations.

Invariant: importing this package loads no simulator: the guardian, which must be quick to start, lives in it.
"""

from __future__ import annotations

from collections.abc import Sequence

from mitl.protocols import Rig


def load_rig(name_or_file: str, seed: int, faults: Sequence[str]) -> Rig:
    """Gives the rig `sim` or the one that a rig file describes: see `mitl.rig.load`."""
    from mitl.rig import load  # noqa: PLC0415 - loads the simulator

    return load.load_rig(name_or_file, seed, faults)


__all__ = ["load_rig"]
