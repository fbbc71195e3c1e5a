"""SampleStore: records of one size as a sampling thread leaves them, in blocks that whoever reads them takes one at a time.

Invariant: nothing here copies or computes on more than a block in one go. A thread that samples 250 times a second must not wait longer
than that, for a lock or for Python's interpreter, while another asks for the path of ten minutes.
"""

from __future__ import annotations

import threading

_BLOCK = 1000
"""Records in a block: four seconds at 250 Hz, decoded in a fraction of a millisecond."""


class SampleStore:
    """Records of `size` bytes, appended by one thread and read by others."""

    def __init__(self, size: int) -> None:
        self._size = size
        self._lock = threading.Lock()
        self._blocks: list[bytes] = []
        self._newest = bytearray()

    def append(self, record: bytes) -> None:
        """Adds a record."""
        with self._lock:
            self._newest += record
            if len(self._newest) >= _BLOCK * self._size:
                self._blocks.append(bytes(self._newest))
                self._newest = bytearray()

    def blocks(self, after: int = 0) -> tuple[list[bytes], bytes]:
        """Gives the blocks that are full, from the `after`-th on, and the records since; a full block never changes again."""
        with self._lock:
            return self._blocks[after:], bytes(self._newest)

    def last(self) -> bytes:
        """Gives the last record, empty where there is none."""
        with self._lock:
            if self._newest:
                return bytes(self._newest[-self._size :])
            return self._blocks[-1][-self._size :] if self._blocks else b""
