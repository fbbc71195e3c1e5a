"""Trackers: one implementation of the protocol a file."""
