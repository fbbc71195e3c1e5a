"""A virtual controller served within the test's own process, its virtual time moved by the test."""

import asyncio
import threading
from concurrent.futures import ThreadPoolExecutor

from mitl.controllers.virtual import start
from mitl.controllers.virtual.answers import Dialect
from mitl.controllers.virtual.server import Pace, VirtualServer
from mitl.controllers.virtual.tls import self_signed

PASSWORD = "robotics"  # noqa: S105 - ABB's published default


class Served:
    """A running server: address, fingerprint of its certificate, and the rig's clock."""

    def __init__(self, generation, disk, *, pace=Pace.MANUAL, cell=None, port=0, tls=None, **service):
        self.dialect = Dialect(generation)
        self.cell = cell or start.virtual_cell("irb140")
        encrypted = self.dialect is not Dialect.RWS1 if tls is None else tls
        context, self.fingerprint = self_signed("127.0.0.1") if encrypted else (None, None)
        self.service = start.service(self.cell, self.dialect, disk, **service)
        self.server = VirtualServer(self.service, host="127.0.0.1", port=port, pace=pace, tls=context)
        self._loop = asyncio.new_event_loop()
        self._thread = threading.Thread(target=self._loop.run_forever, daemon=True)
        self._thread.start()
        self.address = self._do(self.server.start())
        self.port = int(self.address.rpartition(":")[2])

    def _do(self, coroutine):
        return asyncio.run_coroutine_threadsafe(coroutine, self._loop).result(30)

    def now(self):
        return self.cell.clock.now()

    def wait(self, seconds):
        self._do(self.server.advance(seconds))

    def close(self):
        if self._loop.is_closed():
            return
        self._do(self.server.stop())
        self._loop.call_soon_threadsafe(self._loop.stop)
        self._thread.join(5)
        self._loop.close()


def in_parallel(function, arguments):
    """Gives the results of calls made at the same time."""
    with ThreadPoolExecutor(len(arguments)) as pool:
        return list(pool.map(function, arguments))
