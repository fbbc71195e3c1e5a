"""Routines that are read, but on purpose not carried out, each with its reason.

Invariant: checking a program that uses them warns, running into one is an error with the reason.
"""

from __future__ import annotations

from rapid_interp.library.table import LibraryRoutine

_SEARCH = "it is not simulated: there is no sensor that could find anything"
_SOCKET = "a program run here has no network"
_MANY = "several robots that move together are not simulated"
_WELD = "it needs process equipment that is not simulated"
_REASONS = {
    _SEARCH: "SearchL SearchC SearchExtJ",
    _SOCKET: """SocketCreate SocketBind SocketListen SocketAccept SocketConnect SocketClose SocketSend SocketReceive SocketSendTo
        SocketReceiveFrom""",
    _MANY: "SyncMoveOn SyncMoveOff SyncMoveUndo SyncMoveSuspend SyncMoveResume",
    _WELD: """ArcL ArcC ArcLStart ArcLEnd ArcCStart ArcCEnd ArcLStop SpotL SpotJ PaintL PaintC DispL DispC CapL CapC STClose STOpen
        STIndGun STIndGunReset STCalib STTune STTuneReset""",
}
_FUNCTIONS = {"num SocketGetStatus": _SOCKET, "num SocketPeek": _SOCKET}

ROUTINES = (
    *(LibraryRoutine(f"PROC {name}", refused=reason) for reason, names in _REASONS.items() for name in names.split()),
    *(LibraryRoutine(f"FUNC {head}", refused=reason) for head, reason in _FUNCTIONS.items()),
)
