"""Sockets, if the caller gives the program a network.

Invariant: without `start(..., network=...)` each of these ends the program and says how to allow it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

from rapid_interp.library.table import LibraryRoutine
from rapid_interp.meaning.types import Value
from rapid_interp.running.network import Network, NetworkProblem
from rapid_interp.running.values import MAX_STRING, Fault, Reference, error_number

if TYPE_CHECKING:
    from rapid_interp.running.task import Stepper

MOST_BYTES = 1024
USUAL_S = 60.0
"""Seconds that a socket instruction waits unless `\\Time` says otherwise."""
_FOR_EVER = 1e9
_CODE = "latin-1"
_NEEDS = "sockets are refused, unless a Python caller gives the program a network: start(..., network=HostNetwork([...]))"
CREATED, CONNECTED, BOUND, LISTENING, CLOSED = 1.0, 2.0, 3.0, 4.0, 5.0


@contextmanager
def _network(task: Stepper) -> Iterator[Network]:
    if task.network is None:
        raise Fault(f"no connection is opened: {_NEEDS}", "RAPID-R391")
    try:
        yield task.network
    except NetworkProblem as problem:
        raise Fault(str(problem), "RAPID-R357", number=error_number(problem.error)) from problem


def _handle(socket: Reference) -> int:
    return int(socket.get())


def _seconds(given: float | None) -> float | None:
    return USUAL_S if given is None else None if given > _FOR_EVER else given


def _create(task: Stepper, socket: Reference, udp: bool) -> None:
    with _network(task) as network:
        handle = network.create(udp=udp)
    socket.put(float(handle))
    task.socket_states[handle] = CREATED


def _bind(task: Stepper, socket: Reference, address: str, port: float) -> None:
    with _network(task) as network:
        network.bind(_handle(socket), address, int(port))
    task.socket_states[_handle(socket)] = BOUND


def _listen(task: Stepper, socket: Reference) -> None:
    with _network(task) as network:
        network.listen(_handle(socket))
    task.socket_states[_handle(socket)] = LISTENING


def _accept(task: Stepper, socket: Reference, client: Reference, address: Reference | None, time: float | None) -> None:
    with _network(task) as network:
        handle, host = network.accept(_handle(socket), _seconds(time))
    client.put(float(handle))
    task.socket_states[handle] = CONNECTED
    if address is not None:
        address.put(host)


def _connect(task: Stepper, socket: Reference, address: str, port: float, time: float | None) -> None:
    with _network(task) as network:
        network.connect(_handle(socket), address, int(port), _seconds(time))
    task.socket_states[_handle(socket)] = CONNECTED


def _close(task: Stepper, socket: Reference) -> None:
    with _network(task) as network:
        network.close(_handle(socket))
    task.socket_states[_handle(socket)] = CLOSED


def _bytes(text: Value, raw: Value, data: Value, count: float | None) -> bytes:
    found: bytes
    if text is not None:
        found = text.encode(_CODE, errors="replace")
    elif raw is not None:
        found = raw
    elif data is not None:
        found = bytes(int(value) for value in data)
    else:
        raise Fault("one of \\Str, \\RawData and \\Data is needed", "RAPID-R357", number=error_number("ERR_ARGVALERR"))
    return found if count is None else found[: int(count)]


def _send(task: Stepper, socket: Reference, text: Value, raw: Value, data: Value, count: float | None) -> None:
    with _network(task) as network:
        network.send(_handle(socket), _bytes(text, raw, data, count))


def _send_to(task: Stepper, socket: Reference, address: str, port: float, text: Value, raw: Value, data: Value, count: Value) -> None:
    with _network(task) as network:
        network.send_to(_handle(socket), _bytes(text, raw, data, count), address, int(port))


def _put(found: bytes, text: Reference | None, raw: Reference | None, data: Reference | None, counted: Reference | None) -> None:
    if text is not None:
        text.put(found.decode(_CODE))
    elif raw is not None:
        raw.put(found)
    elif data is not None:
        rest = data.get()[len(found) :]
        data.put((*map(float, found), *rest))
    if counted is not None:
        counted.put(float(len(found)))


def _room(text: Reference | None, raw: Reference | None, data: Reference | None) -> int:
    if text is None and raw is None and data is None:
        raise Fault("one of \\Str, \\RawData and \\Data is needed", "RAPID-R357", number=error_number("ERR_ARGVALERR"))
    return MAX_STRING if text is not None else MOST_BYTES if raw is not None or data is None else min(MOST_BYTES, len(data.get()))


def _receive(
    task: Stepper, socket: Reference, text: Reference | None, raw: Reference | None, data: Reference | None, exactly: float | None,
    counted: Reference | None, time: float | None,
) -> None:  # fmt: skip
    most = _room(text, raw, data)
    wanted = None if exactly is None else min(int(exactly), most)
    found = b""
    with _network(task) as network:
        while not found or (wanted is not None and len(found) < wanted):
            found += network.receive(_handle(socket), (wanted or most) - len(found), _seconds(time))
    _put(found, text, raw, data, counted)


def _receive_from(
    task: Stepper, socket: Reference, text: Reference | None, raw: Reference | None, data: Reference | None, counted: Reference | None,
    address: Reference, port: Reference, time: float | None,
) -> None:  # fmt: skip
    with _network(task) as network:
        found, host, number = network.receive_from(_handle(socket), _room(text, raw, data), _seconds(time))
    _put(found, text, raw, data, counted)
    address.put(host)
    port.put(float(number))


def _status(task: Stepper, socket: Reference) -> float:
    return task.socket_states.get(_handle(socket), CLOSED)


def _peek(task: Stepper, socket: Reference, time: float | None) -> float:
    with _network(task) as network:
        return float(network.waiting(_handle(socket), MOST_BYTES, time or 0.001))


def _allowed(head: str, run: Callable[..., Value]) -> LibraryRoutine:
    return LibraryRoutine(head, run, task=True, refused=_NEEDS)


_OUT = r"\string Str | rawbytes RawData | byte Data{*}"
_IN = r"\INOUT string Str | INOUT rawbytes RawData | INOUT byte Data{*}"
_SOCKET = "INOUT socketdev Socket"
ROUTINES = (
    _allowed(rf"PROC SocketCreate({_SOCKET} \switch UDP)", _create),
    _allowed(f"PROC SocketBind({_SOCKET}, string LocalAddress, num LocalPort)", _bind),
    _allowed(f"PROC SocketListen({_SOCKET})", _listen),
    _allowed(rf"PROC SocketAccept({_SOCKET}, INOUT socketdev ClientSocket \INOUT string ClientAddress \num Time)", _accept),
    _allowed(rf"PROC SocketConnect({_SOCKET}, string Address, num Port \num Time)", _connect),
    _allowed(f"PROC SocketClose({_SOCKET})", _close),
    _allowed(rf"PROC SocketSend({_SOCKET} {_OUT} \num NoOfBytes)", _send),
    _allowed(rf"PROC SocketReceive({_SOCKET} {_IN} \num ReadNoOfBytes \INOUT num NoRecBytes \num Time)", _receive),
    _allowed(rf"PROC SocketSendTo({_SOCKET}, string RemoteAddress, num RemotePort {_OUT} \num NoOfBytes)", _send_to),
    _allowed(
        rf"PROC SocketReceiveFrom({_SOCKET} {_IN} \INOUT num NoRecBytes, INOUT string RemoteAddress, INOUT num RemotePort \num Time)",
        _receive_from,
    ),
    _allowed(f"FUNC socketstatus SocketGetStatus({_SOCKET})", _status),
    _allowed(rf"FUNC num SocketPeek({_SOCKET} \num Time)", _peek),
)
