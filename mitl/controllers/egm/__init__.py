"""Externally Guided Motion, the half of it that only looks: the controller's own view of its motion, streamed at 250 Hz over UDP.

Invariant: nothing here ever answers a controller, so that nothing can be guided by accident.
"""
