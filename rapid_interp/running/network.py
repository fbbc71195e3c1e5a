"""The network of a program: none, unless the caller of `Program.start` gives one.

Invariant: a program reaches only the hosts that the caller names. Time on the network is the machine's, not that of a simulation.
"""

from __future__ import annotations

import socket
from collections.abc import Collection
from dataclasses import dataclass, field
from typing import Protocol

MOST_SOCKETS = 32


class NetworkProblem(Exception):  # noqa: N818 - becomes a RAPID error
    """What went wrong, with the name of the RAPID error (`ERR_SOCK_TIMEOUT`) that the program may handle."""

    def __init__(self, error: str, reason: str) -> None:
        super().__init__(reason)
        self.error = error


class Network(Protocol):
    """What the Socket instructions need. Sockets are numbers from 1; times are seconds, None waits for ever."""

    def create(self, *, udp: bool) -> int:
        """Gives a new socket."""
        ...

    def bind(self, handle: int, address: str, port: int) -> None:
        """Ties a socket to a local address."""
        ...

    def listen(self, handle: int) -> None:
        """Lets others connect."""
        ...

    def accept(self, handle: int, time_out: float | None) -> tuple[int, str]:
        """Gives the socket and the address of who connects."""
        ...

    def connect(self, handle: int, address: str, port: int, time_out: float | None) -> None:
        """Connects to a host."""
        ...

    def send(self, handle: int, data: bytes) -> None:
        """Sends to who is connected."""
        ...

    def receive(self, handle: int, most: int, time_out: float | None) -> bytes:
        """Gives what came, at least a byte and at most so many."""
        ...

    def send_to(self, handle: int, data: bytes, address: str, port: int) -> None:
        """Sends one message to a host."""
        ...

    def receive_from(self, handle: int, most: int, time_out: float | None) -> tuple[bytes, str, int]:
        """Gives a message, and the address and port that it came from."""
        ...

    def waiting(self, handle: int, most: int, time_out: float | None) -> int:
        """Gives how many bytes can be received now."""
        ...

    def close(self, handle: int) -> None:
        """Closes a socket; one that is not open is no error."""
        ...


@dataclass(slots=True)
class HostNetwork:
    """The network of this machine, for the `hosts` that the caller names (as the program names them) and no others."""

    hosts: Collection[str]
    _open: dict[int, socket.socket] = field(default_factory=dict)
    _given: int = 0

    def _allowed(self, address: str) -> str:
        if address not in self.hosts:
            raise NetworkProblem("ERR_SOCK_ADDR_INVALID", f"{address!r} is none of the hosts that this program may reach")
        return address

    def _socket(self, handle: int, time_out: float | None) -> socket.socket:
        found = self._open.get(handle)
        if found is None:
            raise NetworkProblem("ERR_SOCK_CLOSED", "the socket is not open")
        found.settimeout(time_out)
        return found

    def _keep(self, made: socket.socket) -> int:
        self._given += 1
        self._open[self._given] = made
        return self._given

    def create(self, *, udp: bool) -> int:
        """Gives a new socket."""
        if len(self._open) >= MOST_SOCKETS:
            raise NetworkProblem("ERR_SOCK_NOSPACE", f"more than {MOST_SOCKETS} sockets")
        return self._keep(socket.socket(socket.AF_INET, socket.SOCK_DGRAM if udp else socket.SOCK_STREAM))

    def bind(self, handle: int, address: str, port: int) -> None:
        """Ties a socket to a local address."""
        with _told("ERR_SOCK_ADDR_INUSE"):
            found = self._socket(handle, None)
            found.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            found.bind((self._allowed(address), port))

    def listen(self, handle: int) -> None:
        """Lets others connect."""
        with _told("ERR_SOCK_NOT_BOUND"):
            self._socket(handle, None).listen()

    def accept(self, handle: int, time_out: float | None) -> tuple[int, str]:
        """Gives the socket and the address of who connects."""
        with _told("ERR_SOCK_CLOSED"):
            made, (address, _) = self._socket(handle, time_out).accept()
        return self._keep(made), str(address)

    def connect(self, handle: int, address: str, port: int, time_out: float | None) -> None:
        """Connects to a host."""
        with _told("ERR_SOCK_CONNREF"):
            self._socket(handle, time_out).connect((self._allowed(address), port))

    def send(self, handle: int, data: bytes) -> None:
        """Sends to who is connected."""
        with _told("ERR_SOCK_CLOSED"):
            self._socket(handle, None).sendall(data)

    def receive(self, handle: int, most: int, time_out: float | None) -> bytes:
        """Gives what came, at least a byte and at most so many."""
        with _told("ERR_SOCK_CLOSED"):
            found = self._socket(handle, time_out).recv(most)
        if not found:
            raise NetworkProblem("ERR_SOCK_CLOSED", "the other side closed the connection")
        return found

    def send_to(self, handle: int, data: bytes, address: str, port: int) -> None:
        """Sends one message to a host."""
        with _told("ERR_SOCK_ADDR_INVALID"):
            self._socket(handle, None).sendto(data, (self._allowed(address), port))

    def receive_from(self, handle: int, most: int, time_out: float | None) -> tuple[bytes, str, int]:
        """Gives a message, and the address and port that it came from."""
        with _told("ERR_SOCK_CLOSED"):
            data, (address, port) = self._socket(handle, time_out).recvfrom(most)
        return data, str(address), int(port)

    def waiting(self, handle: int, most: int, time_out: float | None) -> int:
        """Gives how many bytes can be received now."""
        try:
            with _told("ERR_SOCK_CLOSED"):
                return len(self._socket(handle, time_out).recv(most, socket.MSG_PEEK))
        except NetworkProblem as problem:
            if problem.error == "ERR_SOCK_TIMEOUT":
                return 0
            raise

    def close(self, handle: int) -> None:
        """Closes a socket; one that is not open is no error."""
        found = self._open.pop(handle, None)
        if found is not None:
            found.close()

    def close_all(self) -> None:
        """Closes what is open."""
        for handle in list(self._open):
            self.close(handle)


class _told:  # noqa: N801 - reads as a word at its use
    """Turns the operating system's refusals into `NetworkProblem`; a time that is up is `ERR_SOCK_TIMEOUT`."""

    def __init__(self, error: str) -> None:
        self._error = error

    def __enter__(self) -> None:
        return None

    def __exit__(self, kind: object, problem: BaseException | None, trace: object) -> None:
        if isinstance(problem, TimeoutError | BlockingIOError):
            raise NetworkProblem("ERR_SOCK_TIMEOUT", "nothing happened in time") from problem
        if isinstance(problem, OSError | OverflowError):
            raise NetworkProblem(self._error, str(problem)) from problem
