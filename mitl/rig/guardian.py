"""The guardian: a process that stops the robot when mitl itself is gone, be it by SIGKILL, a crash or a freeze.

Invariant: it needs nothing of its parent but the beats on its standard input; end of input or a missing beat means stop. It can do nothing
against a lost network; the emergency stop and the controller's own supervision stay what safety rests on (docs/physical_rig.md).
"""

from __future__ import annotations

import json
import os
import select
import subprocess
import sys
import threading
from collections.abc import Callable
from pathlib import Path
from types import TracebackType
from typing import IO

from mitl.controllers.rws.credentials import find_credentials
from mitl.controllers.rws.transport import Transport
from mitl.errors import MitlError, RigError
from mitl.rig.physical_config import ControllerConfig
from mitl.rig.remote import transport_to

BEAT, MISSED = 0.25, 2.0
"""Seconds between two beats, and without any after which the robot is stopped."""
READY, DONE, SESSION = "watching", "done", "session "
_TRIES = 20
_LEAVES = 10.0


class Guardian:
    """The parent's side: starts the process and beats.

    session: gives the cookies of the parent's session, which the guardian ends after it had to stop the robot: otherwise mastership would
    stay with a process that is gone until the session expires, for five minutes. They go through a pipe and nowhere else.
    """

    def __init__(self, config: ControllerConfig, session: Callable[[], str] = str) -> None:
        self._session = session
        text = json.dumps({name: getattr(config, name) for name in ("address", "generation", "fingerprint", "station")})
        command = [sys.executable, "-m", "mitl.rig.guardian", text]
        self._process = subprocess.Popen(  # noqa: S603 - our own module
            command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, start_new_session=True
        )
        ready = _pipe(self._process.stdout).readline().strip()
        if ready != READY:
            raise RigError(f"the guardian process could not reach the controller: {ready or 'it ended'}")
        self._ended = threading.Event()
        self._closed = False
        self._thread = threading.Thread(target=self._beat, name="guardian-beat", daemon=True)
        self._thread.start()

    @property
    def alive(self) -> bool:
        """Whether the guardian watches."""
        return self._process.poll() is None and self._thread.is_alive()

    @property
    def pid(self) -> int:
        """The process's number."""
        return self._process.pid

    def close(self) -> None:
        """Tells the guardian that all is well and that it may go."""
        self._ended.set()
        self._thread.join(2.0)
        if self._closed:
            return
        self._closed = True
        try:
            self._process.communicate(f"{DONE}\n", timeout=_LEAVES)  # one that has ended has closed its pipe, which communicate knows
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.communicate()

    def __enter__(self) -> Guardian:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, traceback: TracebackType | None) -> None:
        self.close()

    def _beat(self) -> None:
        beats = _pipe(self._process.stdin)
        told = ""
        while not self._ended.wait(BEAT):
            try:
                if (session := self._session()) != told:
                    beats.write(f"{SESSION}{session}\n")
                    told = session
                beats.write(".\n")
                beats.flush()
            except OSError:
                return


def _pipe(stream: IO[str] | None) -> IO[str]:
    if stream is None:
        raise RigError("the guardian process has no pipe")
    return stream


def watch(transport: Transport, beats: int) -> str:
    """Waits on the file descriptor `beats` for the end of them; gives DONE, or the reason for which it then stopped the robot."""
    buffer, session = b"", ""
    while True:
        ready, _, _ = select.select([beats], [], [], MISSED)
        content = os.read(beats, 4096) if ready else b""
        if not ready or not content:
            break
        *lines, buffer = (buffer + content).split(b"\n")
        for line in lines:
            text = line.decode("ascii", "replace")
            if text == DONE:
                return DONE
            if text.startswith(SESSION):
                session = text.removeprefix(SESSION)
    stop = transport.dialect.stop()
    last: MitlError | None = None
    for _ in range(_TRIES):
        try:
            transport.ask(stop)
        except MitlError as error:
            last = error
        else:
            return "mitl is gone: the robot was stopped" + _left(transport, session)
    return f"mitl is gone, and the robot could not be stopped: {last}"


def _left(transport: Transport, session: str) -> str:
    """Ends the session that mitl left; gives what to add to the reason where that failed."""
    if not session:
        return ""
    try:
        transport.end_session(session)
    except MitlError as error:
        return f"; {error}"
    return ""


def main(arguments: list[str]) -> int:
    """Runs the process."""
    config = ControllerConfig(**json.loads(arguments[0]))
    transport = transport_to(config, find_credentials)
    try:
        transport.ask(transport.dialect.execution())
    except MitlError as error:
        sys.stdout.write(f"{error}\n".replace("\n", " ").strip() + "\n")
        return 1
    sys.stdout.write(f"{READY}\n")
    sys.stdout.flush()
    told = watch(transport, sys.stdin.fileno())
    transport.close()
    if told != DONE:
        sys.stderr.write(f"{Path(__file__).stem}: {told}\n")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
