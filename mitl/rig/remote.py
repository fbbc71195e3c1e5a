"""A session with the controller that a rig file names."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any
from urllib.parse import urlsplit

from mitl.controllers.rws.credentials import Credentials
from mitl.controllers.rws.dialects import Rws1, Rws2, Rws8
from mitl.controllers.rws.transport import Transport
from mitl.rig.physical_config import ControllerConfig


def transport_to(config: ControllerConfig, credentials: Callable[[str], Credentials], **options: Any) -> Transport:  # noqa: ANN401 - Transport's own
    """Gives a transport to a controller. credentials: finds user and password by host; options: those of Transport."""
    match config.generation:
        case "1":
            dialect: Rws1 = Rws1()
        case "2":
            dialect = Rws2()
        case _:
            dialect = Rws8(config.station)
    found = credentials(urlsplit(config.address).hostname or "")
    return Transport(config.address, dialect, found, fingerprint=config.fingerprint or None, **options)
