"""The criteria of ISO 9283, one a file. ASSUMPTION A-311: formulas from memory of the standard (facts/iso9283.md), no bought copy checked.

Invariant: metres, radians and seconds; arrays of attained points are (n, 3), one row a cycle; no limit is known here.
"""
