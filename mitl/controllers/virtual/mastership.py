"""Who may change what: mastership by domain (1.0, 2.0) and write access of control stations (RobotWare 8).

Invariant: a domain has one holder at most. In 1.0 a free domain is taken for the length of a call; 2.0 must ask for it, or say so in the
call; RobotWare 8 answers 410 to mastership and knows only write access, which a session's end does not release unless it said so
(facts/rws.md).
"""

from __future__ import annotations

from mitl.controllers.virtual.answers import HELD, NO_STATION, NOT_ALLOWED, Dialect, Refused
from mitl.controllers.virtual.sessions import Session

DOMAINS = {Dialect.RWS1: ("cfg", "motion", "rapid"), Dialect.RWS2: ("edit", "motion"), Dialect.RWS8: ()}
_EDIT = {Dialect.RWS1: "rapid", Dialect.RWS2: "edit"}


class Mastership:
    """The arbiter of one controller."""

    def __init__(self, dialect: Dialect) -> None:
        self._dialect = dialect
        self._held: dict[str, Session] = {}
        self.station: tuple[str, str] | None = None
        """(id, name) of the control station that has write access."""
        self.motion_control = False

    def holder(self, domain: str) -> Session | None:
        """Gives who holds a domain."""
        return self._held.get(domain)

    def domains(self, named: str) -> tuple[str, ...]:
        """Gives the domains that a name means; no name means all. Raises Refused 410 with RobotWare 8, 404 for an unknown one."""
        known = DOMAINS[self._dialect]
        if not known:
            raise Refused(410, -1073435872, "Mastership is replaced by control stations: see /rw/controlstation")
        if not named:
            return known
        if named.lower() not in known:
            raise Refused(404, -1073445884, f"No mastership domain {named!r}: expected {', '.join(known)}")
        return (named.lower(),)

    def request(self, named: str, session: Session) -> None:
        """Takes domains, all or none. Raises Refused 403 where another holds one."""
        wanted = self.domains(named)
        for domain in wanted:
            self._refuse_other(domain, session)
        self._held.update(dict.fromkeys(wanted, session))

    def release(self, named: str, session: Session) -> None:
        """Gives domains back. Raises Refused 403 where another holds one."""
        for domain in self.domains(named):
            self._refuse_other(domain, session)
            self._held.pop(domain, None)

    def drop(self, session: Session) -> None:
        """Takes from a session that has ended what it held."""
        self._held = {domain: holder for domain, holder in self._held.items() if holder is not session}
        if session.release_when_lost and session.station == self.station:
            self.station, self.motion_control = None, False

    def require_edit(self, session: Session, *, implicit: bool = False) -> None:
        """Lets a change of program or data pass. Raises Refused 403."""
        if self._dialect is Dialect.RWS8:
            self.require_station(session)
            return
        domain = _EDIT[self._dialect]
        self._refuse_other(domain, session)
        if self._dialect is Dialect.RWS2 and not implicit and self._held.get(domain) is not session:
            raise Refused(403, HELD, "The operation needs mastership of domain edit: request it first, or say mastership=implicit")

    def require_start(self, session: Session) -> None:
        """Lets a start of the program pass: nobody else may hold the program; RobotWare 8 wants motion control allowed besides."""
        if self._dialect is Dialect.RWS8:
            self.require_station(session)
            if not self.motion_control:
                raise Refused(403, NOT_ALLOWED, "Motion control is not allowed: see /rw/controlstation/allowmotioncontrol")
            return
        self._refuse_other(_EDIT[self._dialect], session)

    def require_station(self, session: Session) -> None:
        """Lets pass who has write access. Raises Refused 403."""
        if session.station is None:
            raise Refused(403, NO_STATION, "Session is not part of a Control Station")
        if self.station != session.station:
            owner = f"{self.station[1]} has it" if self.station else "nobody has it"
            raise Refused(403, HELD, f"The operation needs write access: {owner}")

    def request_write_access(self, session: Session) -> None:
        """Takes write access for the session's station. Raises Refused 403."""
        if session.station is None:
            raise Refused(403, NO_STATION, "Session is not part of a Control Station")
        if self.station not in (None, session.station):
            raise Refused(403, HELD, "Write access is held by another control station")
        self.station = session.station

    def release_write_access(self, session: Session) -> None:
        """Gives write access back."""
        self.require_station(session)
        self.station, self.motion_control = None, False

    def _refuse_other(self, domain: str, session: Session) -> None:
        holder = self._held.get(domain)
        if holder is not None and holder is not session:
            raise Refused(403, HELD, f"Operation rejected: mastership of domain {domain} is held by {holder.application or holder.user}")
