"""/rw/mastership, /rw/controlstation, /users and /logout: who may change what."""

from __future__ import annotations

import re
from collections.abc import Callable

from mitl.controllers.virtual.answers import BAD_STATION, DONE, Answer, Dialect, Item, Refused, answered, invalid
from mitl.controllers.virtual.mastership import DOMAINS, Mastership
from mitl.controllers.virtual.router import ALL, RWS1, RWS2, Call, Route
from mitl.controllers.virtual.sessions import Session

_STATION = re.compile(r"^\{[0-9a-fA-F]{8}(-[0-9a-fA-F]{4}){3}-[0-9a-fA-F]{12}\}$", re.ASCII)
_RWS8: tuple[Dialect, ...] = (Dialect.RWS8,)


class AccessResources:
    """Mastership, write access, users. log_out: ends a session."""

    def __init__(self, mastership: Mastership, log_out: Callable[[Session], None]) -> None:
        self._mastership = mastership
        self._log_out = log_out

    def routes(self) -> list[Route]:
        """Gives the table."""
        domains = ("rw/mastership", "rw/mastership/{domain}")
        return [
            *(Route("POST", path, self.request, RWS1, "request") for path in domains),
            *(Route("POST", path, self.release, RWS1, "release") for path in domains),
            Route("POST", "rw/mastership", self.request, RWS1),
            *(Route("POST", f"{path}/request", self.request, RWS2) for path in domains),
            *(Route("POST", f"{path}/release", self.release, RWS2) for path in domains),
            *(Route("POST", f"{path}/request-with-id", self.request_with_id, RWS2) for path in domains),
            *(Route("POST", f"{path}/release-with-id", self.release, RWS2) for path in domains),
            Route("POST", "rw/mastership/watchdog", self.watchdog, RWS2),
            Route("GET", "rw/mastership", self.all),
            Route("GET", "rw/mastership/{domain}", self.one),
            Route("POST", "rw/controlstation/register/remote", self.register, _RWS8),
            Route("POST", "rw/controlstation/writeaccess/request", self.request_write_access, _RWS8),
            Route("POST", "rw/controlstation/writeaccess/release", self.release_write_access, _RWS8),
            Route("GET", "rw/controlstation/writeaccess/status", self.write_access, _RWS8),
            Route("GET", "rw/controlstation/allowmotioncontrol", self.motion_control, _RWS8),
            Route("POST", "rw/controlstation/allowmotioncontrol", self.allow_motion_control, _RWS8),
            Route("POST", "users", self.introduce, RWS1),
            Route("POST", "users/rmmp", self.ask_remote, ALL),
            Route("POST", "users/rmmp", self.cancel_remote, RWS1, "cancel"),
            Route("POST", "users/rmmp/cancel", self.cancel_remote, RWS2),
            Route("GET", "users/rmmp/poll", self.poll_remote, ALL),
            Route("GET", "users/rmmp", self.poll_remote, ALL),
            Route("GET", "logout", self.log_out),
            Route("POST", "logout", self.log_out),
        ]

    def request(self, call: Call) -> Answer:
        """Takes mastership of a domain or of all."""
        self._mastership.request(call.names.get("domain", ""), call.session)
        return DONE

    def release(self, call: Call) -> Answer:
        """Gives mastership back."""
        self._mastership.release(call.names.get("domain", ""), call.session)
        return DONE

    def request_with_id(self, call: Call) -> Answer:
        """Takes mastership; the id is the session's number."""
        self._mastership.request(call.names.get("domain", ""), call.session)
        return answered(Item("msh-resource-id", "id", {"mastershipid": str(call.session.number)}))

    def watchdog(self, _call: Call) -> Answer:
        """Keeps mastership alive, which every request does."""
        self._mastership.domains("")
        return DONE

    def all(self, call: Call) -> Answer:
        """Who holds each domain."""
        self._mastership.domains("")
        return answered(*(self._described(domain, "msh-resource-li", call) for domain in DOMAINS[call.dialect]))

    def one(self, call: Call) -> Answer:
        """Who holds a domain."""
        (domain,) = self._mastership.domains(call.names["domain"])
        return answered(self._described(domain, "msh-resource", call))

    def _described(self, domain: str, kind: str, call: Call) -> Item:
        holder = self._mastership.holder(domain)
        fields = {
            "mastership": "nomaster" if holder is None else "remote",
            "uid": "" if holder is None else str(holder.number),
            "alias": "" if holder is None else holder.user,
            "application": "" if holder is None else holder.application,
            "location": "" if holder is None else holder.location,
            "mastershipheldbyme": str(holder is call.session).upper(),
        }
        return Item(kind, domain, fields, domain)

    def register(self, call: Call) -> Answer:
        """Makes the session part of a remote control station; its id is a GUID in braces, its PIN digits of the client's choice."""
        name, number, pin = (call.wanted(field) for field in ("control-station-name", "control-station-id", "pincode"))
        if not _STATION.match(number) or not (pin.isascii() and pin.isdigit()) or not name.strip():
            raise Refused(403, BAD_STATION, "Control station id not allowed")
        call.session.station = (number.lower(), name)
        call.session.release_when_lost = call.form.get("release-write-access-when-lost", "false").lower() == "true"
        return DONE

    def request_write_access(self, call: Call) -> Answer:
        """Takes write access."""
        self._mastership.request_write_access(call.session)
        return DONE

    def release_write_access(self, call: Call) -> Answer:
        """Gives write access back."""
        self._mastership.release_write_access(call.session)
        return DONE

    def write_access(self, _call: Call) -> Answer:
        """Who has write access."""
        number, name = self._mastership.station or ("", "")
        fields = {
            "held-by-control-station-Id": number,
            "held-by-control-station-name": name,
            "control-station-write-access-held": str(self._mastership.station is not None).lower(),
            "control-station-external-control-enabled": "true",
        }
        return answered(Item("controlstation-write-access-status", "write-access-status", fields))

    def motion_control(self, _call: Call) -> Answer:
        """Whether the control station may start motion."""
        enabled = str(self._mastership.motion_control).lower()
        return answered(Item("controlstation-motion-control", "allowmotioncontrol", {"is-enabled": enabled}))

    def allow_motion_control(self, call: Call) -> Answer:
        """Allows or forbids motion by the control station."""
        self._mastership.require_station(call.session)
        wanted = call.wanted("allow-motion-control").lower()
        if wanted not in ("true", "false"):
            raise invalid(f"expected allow-motion-control true or false, got {wanted!r}")
        self._mastership.motion_control = wanted == "true"
        return DONE

    def introduce(self, call: Call) -> Answer:
        """Takes the client's own name for itself."""
        call.session.application = call.form.get("application", "")[:100]
        call.session.location = call.form.get("location", "")[:100]
        return DONE

    def ask_remote(self, call: Call) -> Answer:
        """Asks for remote mastering in manual mode. ASSUMPTION A-233: the virtual operator grants it at the next poll."""
        self._no_station(call)
        if call.wanted("privilege") not in ("modify", "exec"):
            raise invalid("expected privilege modify or exec")
        call.session.remote = "PENDING"
        return Answer(202, ())

    def cancel_remote(self, call: Call) -> Answer:
        """Gives remote mastering back."""
        self._no_station(call)
        call.session.remote = "NONE"
        return DONE

    def poll_remote(self, call: Call) -> Answer:
        """The state of the request."""
        self._no_station(call)
        if call.session.remote == "PENDING":
            call.session.remote = "GRANTED"
        return answered(Item("user-rmmp-poll", "rmmp", {"status": call.session.remote, "code": "0"}))

    def log_out(self, call: Call) -> Answer:
        """Ends the session."""
        self._log_out(call.session)
        return DONE

    def _no_station(self, call: Call) -> None:
        if call.dialect is Dialect.RWS8:
            raise Refused(500, -1073445888, "RMMP is not available with this RobotWare")
