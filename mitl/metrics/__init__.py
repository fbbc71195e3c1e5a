"""Metrics: pure functions from recorded and expected paths to numbers with an uncertainty. One metric a file.

Invariant: positions are in m, angles in rad, time in s; nothing here knows where a path comes from.
"""
