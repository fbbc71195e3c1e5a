"""Campaigns: many seeded runs of the test cases, sound and broken, to tell what they find and how often they cry wolf.

`plan` says which runs, `trial` does one, `execute` does them on Dask and can be interrupted, `summary` counts, `tables` writes.
"""
