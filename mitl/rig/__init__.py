"""The rig: from `sim` or a rig file to the objects that a test run is given. The only place that knows all implementations."""

from mitl.rig.load import load_rig

__all__ = ["load_rig"]
