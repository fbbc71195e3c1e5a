"""The report: run record -> one HTML page. A pure function of the run's folder, so that it can be made again from an old run."""

from mitl.report.document import render, write_report

__all__ = ["render", "write_report"]
