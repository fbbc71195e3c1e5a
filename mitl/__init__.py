"""mitl verifies ABB robot controllers from the RAPID source. Start at `mitl.protocols`."""

__version__ = "0.1.0"
