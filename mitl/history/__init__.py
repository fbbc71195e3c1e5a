"""History: runs kept in SQLite, and what can be said of several: trends, first bad run, flakiness, differences, quality gates."""
