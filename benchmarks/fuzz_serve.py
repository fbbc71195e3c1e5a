"""Throws seeded random requests at a `mitl serve` of its own on loopback, and prints how many, what came back, and how its memory went.

Run: python benchmarks/fuzz_serve.py [--requests 1000000] [--minutes 60] [--rws 1]. Some log in, some lie, some are no HTTP at all; many are
sent without waiting for answers. It ends with an error where the server dies, answers 500, or no longer answers an honest request. The same
seed sends the same bytes. The bar (issue 7): a million requests without a crash or a leak; memory is compared from a tenth of the way on,
because caches fill first.
"""

from __future__ import annotations

import argparse
import base64
import collections
import os
import random
import socket
import subprocess
import sys
import time
from pathlib import Path
from urllib.parse import urlsplit

import httpx

WORDS = (
    "rw", "rapid", "panel", "execution", "symbol", "data", "RAPID", "T_ROB1", "Work", "count;value", "signals", "iosystem",
    "fileservice", "$home", "..", "%2e%2e", "elog", "0", "1", "mechunits", "motionsystem", "ROB_1", "robtarget", "jointtarget",
    "tasks", "modules", "mastership", "subscription", "users", "poll", "dipc", "q", "logout", "rmmp", "start", "stop", "loadmod",
    "set-value", "count%7B99%7D", "controlstation", "speedratio", "ctrlstate", "opmode", "ctrl", "clock", "system", "symbols",
    "%00", "%ff%fe",
)  # fmt: skip
KNOWN = (
    "rw/system", "rw/panel/ctrlstate", "rw/panel/opmode", "rw/panel/speedratio", "rw/rapid/execution", "rw/rapid/tasks", "rw/rapid/modules",
    "rw/rapid/symbol/data/RAPID/T_ROB1/option", "rw/rapid/symbols", "rw/iosystem/signals", "rw/iosystem/signals/doTrigger", "rw/elog/0",
    "rw/motionsystem/mechunits/ROB_1/jointtarget", "rw/motionsystem/mechunits/ROB_1/robtarget", "fileservice/$home", "fileservice/$home/x",
    "rw/mastership", "rw/mastership/rapid", "users/rmmp", "subscription", "rw/dipc", "rw/rapid/tasks/T_ROB1", "ctrl/clock", "ctrl/identity",
)  # fmt: skip
METHODS = ("GET", "GET", "GET", "POST", "POST", "PUT", "DELETE", "HEAD", "OPTIONS", "PATCH")
QUERIES = ("", "?json=1", "?action=set", "?action=start", "?action=request", "?action=search-symbols", "?resource=x", "?lang=en&order=lifo")
BODIES = (b"", b"value=1", b"lvalue=1", b"1=/rw/panel/opmode&1-p=1&resources=1", b"%ff=%zz", b"&" * 50, b"speed-ratio=1e999", b"\x00" * 40)
PIPELINE = 50
LOGIN = "Basic " + base64.b64encode(b"Default User:robotics").decode()


def no_request(chance: random.Random) -> bytes:
    """Gives bytes that are no proper HTTP, or ask to speak something else; the server hangs up after them."""
    kind = chance.randrange(4)
    if kind == 0:
        return chance.randbytes(chance.randrange(1, 200))
    if kind == 1:
        return request(chance).replace(b"GET ", b"BREW ", 1)[: chance.randrange(20, 300)]
    if kind == 2:
        return request(chance).replace(b"Content-Length: ", b"Transfer-Encoding: chunked\r\nContent-Length: -", 1)
    return request(chance).replace(b"Host: x", b"Host: x\r\nUpgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Key: x", 1)


def request(chance: random.Random, cookie: str = "") -> bytes:
    """Gives a request's bytes; cookie: of a session that is open, which half of them have."""
    known = chance.random() < 0.6
    path = "/" + (chance.choice(KNOWN) if known else "/".join(chance.choice(WORDS) for _ in range(chance.randrange(8))))
    body = chance.choice(BODIES) if chance.random() < 0.7 else chance.randbytes(chance.randrange(300))
    lines = [f"{chance.choice(METHODS)} {path}{chance.choice(QUERIES)} HTTP/1.1", "Host: x", f"Content-Length: {len(body)}"]
    if cookie and chance.random() < 0.6:
        lines.append(f"Cookie: {cookie}")
    elif chance.random() < 0.02:
        lines.append(f"Authorization: {LOGIN}")
    if chance.random() < 0.1:
        lines.append("Authorization: " + "".join(chance.choices('Digest =,"\\x;é', k=30)))
    if chance.random() < 0.1:
        lines.append(f"Cookie: ABBCX={chance.randrange(9)}; -http-session-={chance.random()}")
    if chance.random() < 0.1:
        lines.append(f"Accept: {chance.choice(['application/hal+json;v=2.0', 'text/plain', '*/*', ';;;'])}")
    return "\r\n".join(lines).encode() + b"\r\n\r\n" + body


def throw(address: tuple[str, int], batch: list[bytes], seen: collections.Counter[str]) -> None:
    """Sends requests in one connection without waiting, then reads what comes until the server is done or has hung up."""
    try:
        with socket.create_connection(address, timeout=10) as connection:
            connection.sendall(b"".join(batch) + b"GET / HTTP/1.1\r\nHost: x\r\nConnection: close\r\n\r\n")
            connection.settimeout(2.0)
            answered = b""
            while content := connection.recv(1 << 16):
                answered += content
    except TimeoutError:
        seen["silent"] += 1
        return
    except OSError:
        seen["hung up"] += 1
        return
    for line in answered.split(b"HTTP/1.1 ")[1:]:
        seen[line[:3].decode("ascii", "replace")] += 1


def session(address: tuple[str, int], cookie: str, generation: str) -> str:
    """Gives the cookie of a session that is open: this one, or a new one, or "" where there are too many."""
    login = ("Default User", "robotics")
    auth: httpx.Auth = httpx.DigestAuth(*login) if generation == "1" else httpx.BasicAuth(*login)
    headers = {"Cookie": cookie} if cookie else {}
    with httpx.Client(trust_env=False, timeout=10.0, verify=False) as client:  # noqa: S501 - plain HTTP on loopback
        answer = client.get(f"http://{address[0]}:{address[1]}/rw/panel/opmode", headers=headers, auth=None if cookie else auth)
        if answer.is_success:
            return cookie or "; ".join(f"{one.name}={one.value}" for one in client.cookies.jar)
    return session(address, "", generation) if cookie else ""


def memory(pid: int) -> float:
    """Gives a process's resident memory in MiB."""
    pages = int(Path(f"/proc/{pid}/statm").read_text(encoding="ascii").split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE") / 1024**2


def main() -> int:
    """Runs it; gives 1 where the server failed."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--requests", type=int, default=1_000_000)
    parser.add_argument("--minutes", type=float, default=60.0)
    parser.add_argument("--rws", choices=("1", "2", "8"), default="1")
    parser.add_argument("--seed", type=int, default=1)
    arguments = parser.parse_args()
    chance, seen = random.Random(arguments.seed), collections.Counter[str]()  # noqa: S311 - not for secrets
    command = [sys.executable, "-m", "mitl", "serve", "--no-tls", "--fast", "--rws", arguments.rws]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as server:  # noqa: S603 - our own server
        assert server.stdout is not None  # noqa: S101 - a pipe was asked for
        told = urlsplit(server.stdout.readline().strip())
        address = (told.hostname or "", told.port or 0)
        began, sent, warm, shown, cookie = time.monotonic(), 0, 0.0, 0, ""
        while sent < arguments.requests and time.monotonic() - began < 60 * arguments.minutes and server.poll() is None:
            cookie = session(address, cookie, arguments.rws)
            batch = [request(chance, cookie) for _ in range(PIPELINE)]
            if chance.random() < 0.2:
                batch[-1] = no_request(chance)
            throw(address, batch, seen)
            sent += len(batch)
            if not warm and (sent >= arguments.requests / 10 or time.monotonic() - began > 6 * arguments.minutes):
                warm = memory(server.pid)
            if sent // 50_000 > shown:
                shown = sent // 50_000
                _say(f"{sent} sent, {memory(server.pid):.1f} MiB")
        alive = server.poll() is None
        last: collections.Counter[str] = collections.Counter()
        throw(address, [], last)
        ended = memory(server.pid) if alive else float("nan")
        server.terminate()
    _say(f"{sent} requests in {time.monotonic() - began:.0f} s; answers {dict(seen.most_common())}")
    _say(f"memory {warm:.1f} MiB after the first tenth, {ended:.1f} MiB at the end; alive {alive}, honest request {dict(last)}")
    return 0 if alive and not seen["500"] and last["401"] == 1 else 1


def _say(text: str) -> None:
    sys.stdout.write(f"{text}\n")
    sys.stdout.flush()


if __name__ == "__main__":
    sys.exit(main())
