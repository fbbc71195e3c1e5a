"""Files that appear whole or not at all."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from mitl.errors import UsageError


@contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """Gives a path beside `path` to write to; it replaces `path` when the block ends well, and vanishes when it does not.

    Raises UsageError naming `path` where it cannot be written.
    """
    beside = path.with_name(f".{path.name}.{os.getpid()}.part")
    try:
        beside.touch()  # where it cannot be written, this says so before any work is done
        yield beside
        beside.replace(path)
    except OSError as error:
        if error.filename is not None and Path(os.fsdecode(error.filename)) != beside:
            raise  # about some other file
        raise UsageError(f"{path}: cannot be written: {error.strerror or error}") from error
    finally:
        beside.unlink(missing_ok=True)
