"""Recordings: MCAP, CSV and text files in and out. The only room that speaks MCAP.

Invariant: files are written whole or not at all, but for a recording in progress, which can be read up to its last chunk.
"""

from __future__ import annotations

from mitl.recording.atomic import replacing
from mitl.recording.csv_file import OracleTable, read_csv, write_csv
from mitl.recording.csv_import import ColumnMap, import_csv
from mitl.recording.mcap_reader import read_recording
from mitl.recording.mcap_writer import RecordingWriter, write_recording
from mitl.recording.read import read_path
from mitl.recording.records import LogMessage, PoseTrack, Recording, Series
from mitl.recording.thesis_xml import read_thesis_xml, write_thesis_xml
from mitl.recording.tum import read_tum, write_tum
from mitl.recording.vive_text import read_vive_text

__all__ = [
    "ColumnMap",
    "LogMessage",
    "OracleTable",
    "PoseTrack",
    "Recording",
    "RecordingWriter",
    "Series",
    "import_csv",
    "read_csv",
    "read_path",
    "read_recording",
    "read_thesis_xml",
    "read_tum",
    "read_vive_text",
    "replacing",
    "write_csv",
    "write_recording",
    "write_thesis_xml",
    "write_tum",
]
