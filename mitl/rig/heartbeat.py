"""The heartbeat inside the program: RAPID that stops the robot on the controller itself when mitl is no longer heard.

Our program gets a module beside it, and one call before the first instruction of its main. A timer's trap there looks at a variable that
mitl writes; where it stays the same too long, the trap stops program and motion. So a dead computer, a lost network or a SIGKILL ends in a
standing robot, without anything but the controller. Invariant: the program keeps its lines and its motions; only a call and a trap come in.
"""

from __future__ import annotations

import threading
from collections.abc import Callable, Sequence
from pathlib import Path

from mitl.errors import RigError
from rapid_interp.reading.files import read_texts
from rapid_interp.reading.modules import parse
from rapid_interp.reading.tree import Routine

MODULE, BEAT = "MitlGuard", "MitlGuard:mitlBeat"
LOOKS = 6
"""Looks without a new beat after which the robot is stopped; a beat is written as often as it is looked for."""
_CALL = "mitlWatch; "
_MOST = 1_000_000


class HeartBeat:
    """Beats from a thread of its own while `go` holds. beat: writes the given literal; period in s. well: what must hold for a beat."""

    def __init__(self, beat: Callable[[str], None], period: float, well: Callable[[], bool]) -> None:
        self._beat = beat
        self._period = period
        self._well = well
        self._going = threading.Event()
        self._ended = threading.Event()
        self._count = 0
        self._thread = threading.Thread(target=self._run, name="heartbeat", daemon=True)
        self._thread.start()
        self.problem = ""
        """What the last beat failed of, or ""."""

    def go(self) -> None:
        """Beats once, then from now on. Raises RigError where the first does not arrive."""
        self._once()
        self._going.set()

    def rest(self) -> None:
        """Beats no longer."""
        self._going.clear()

    def close(self) -> None:
        """Ends it."""
        self._ended.set()
        self._going.set()
        self._thread.join(5.0)

    def _run(self) -> None:
        while not self._ended.wait(self._period):
            self._going.wait()
            if self._ended.is_set():
                return
            if not self._well():
                continue  # what watches the robot is gone: let the controller stop it
            try:
                self._once()
            except RigError as error:
                self.problem = str(error)  # the next may arrive; if none does the controller stops the robot
            else:
                self.problem = ""

    def _once(self) -> None:
        self._count = self._count % _MOST + 1
        self._beat(str(self._count))


def with_heartbeat(sources: Sequence[Path], folder: Path, stale_s: float, *, egm_device: str = "") -> list[Path]:
    """Gives the program's files with the heartbeat in them, written into `folder`. Raises RigError where there is no main to put it in.

    stale_s: seconds without a beat after which the robot stops. egm_device: the UdpUc device to which the controller is to stream, or "".
    """
    try:
        texts = read_texts(list(sources))
    except OSError as error:
        raise RigError(f"load refused: {error.filename}: {error.strerror or error}") from error
    written: list[Path] = []
    mains = 0
    for text in texts:
        content = text.text
        for module in parse(text).modules:
            for routine in module.declarations:
                if isinstance(routine, Routine) and routine.kind.upper() == "PROC" and routine.name.text.lower() == "main" and routine.body:
                    mains += 1
                    at = routine.body[0].start
                    content = content[:at] + _CALL + content[at:]
        place = folder / Path(text.file).name
        if place in written or place.stem.lower() == MODULE.lower():
            raise RigError(f"load refused: two files are called {place.name}; the controller's folder holds one")
        place.write_text(content, encoding="utf-8")
        written.append(place)
    if mains != 1:
        raise RigError(f"load refused: expected one main with instructions to put the heartbeat into, found {mains}")
    guard = folder / f"{MODULE}.mod"
    guard.write_text(guard_module(stale_s, egm_device=egm_device), encoding="utf-8")
    return [*written, guard]


def guard_module(stale_s: float, *, egm_device: str = "") -> str:
    """Gives the module. ASSUMPTION A-355: SystemStopAction may stand in a trap, and stops motion and program at once as a stop button does;
    traps run while the program waits for a move, and PERS can be written over the network while it runs.
    """
    stream = _STREAM.format(device=egm_device) if egm_device else ""
    call = "    mitlStream;\n" if egm_device else ""
    data = "  LOCAL VAR egmident stream;\n" if egm_device else ""
    every, stale = round(stale_s / LOOKS, 3), round(stale_s, 1)
    return _GUARD.format(data=data, looks=LOOKS, every=every, stale=stale, stream=stream, call=call)


_GUARD = """MODULE MitlGuard
  ! Loaded by mitl beside the program under test: stops the robot when mitl is no longer heard.
  ! mitl writes another number to mitlBeat every {every} s; {looks} looks without a new one mean stop.
  PERS num mitlBeat:=0;
  LOCAL VAR intnum tick;
  LOCAL VAR num seen:=0;
  LOCAL VAR num missed:=0;
{data}
  PROC mitlWatch()
    seen:=mitlBeat;
    missed:=0;
    IDelete tick;
    CONNECT tick WITH mitlLook;
    ITimer {every},tick;
{call}  ENDPROC

  LOCAL TRAP mitlLook
    IF mitlBeat<>seen THEN
      seen:=mitlBeat;
      missed:=0;
    ELSE
      missed:=missed+1;
      IF missed>={looks} THEN
        missed:=0;
        ErrWrite "mitl is gone","No heartbeat for {stale} s: the robot was stopped.";
        SystemStopAction\\Stop;
      ENDIF
    ENDIF
  ENDTRAP
{stream}ENDMODULE
"""
# ASSUMPTION A-356: an identity that was never set up is an error of EGMReset, which TRYNEXT passes over
_STREAM = """
  LOCAL PROC mitlStream()
    EGMReset stream;
    EGMGetId stream;
    EGMSetupUC ROB_1,stream,"default","{device}"\\Joint;
    EGMStreamStart stream\\SampleRate:=4;
  ERROR
    TRYNEXT;
  ENDPROC
"""
