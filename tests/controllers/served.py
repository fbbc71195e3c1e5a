"""A virtual controller served within the test's own process, its virtual time moved by the test."""

import asyncio
import threading
from contextlib import contextmanager
from dataclasses import dataclass

from mitl.controllers.rws.controller import RwsController
from mitl.controllers.rws.credentials import Credentials
from mitl.controllers.rws.dialects import Rws1, Rws2, Rws8
from mitl.controllers.rws.transport import Transport
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


@dataclass
class RemoteRig:
    """What the contract suite needs of a rig whose controller is reached over HTTP."""

    controller: RwsController
    clock: Served
    transport: Transport

    def begin_case(self, _case_id):
        self.controller.stop()


STATION = "11111111-2222-3333-4444-555555555555"


def dialect(generation):
    return {"1": Rws1, "2": Rws2, "8": lambda: Rws8(STATION)}[generation]()


def transport_to(served, **options):
    """A transport without pacing: time at the virtual controller is the test's own."""
    options = {"rate": 0.0, "fingerprint": served.fingerprint, "credentials": Credentials("Default User", PASSWORD), **options}
    credentials = options.pop("credentials")
    return Transport(served.address, dialect(served.dialect.value), credentials, **options)


@contextmanager
def remote(generation, disk, **options):
    """A controller of a generation, served in this process and reached by the client."""
    served = Served(generation, disk, **options)
    transport = transport_to(served)
    controller = RwsController(transport, served)
    try:
        yield RemoteRig(controller, served, transport)
        controller.close()
    finally:
        transport.close()
        served.close()
