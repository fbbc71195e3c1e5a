"""/rw/elog: the event log by domain."""

from __future__ import annotations

from mitl.controllers.virtual.answers import DONE, Answer, Item, answered, invalid
from mitl.controllers.virtual.cell import VirtualCell
from mitl.controllers.virtual.event_log import LEVELS, Entry
from mitl.controllers.virtual.router import RWS1, RWS2, Call, Route

_DOMAINS = {0: "Common", 1: "Operational", 2: "System", 3: "Hardware", 4: "Program", 5: "Motion", 7: "I/O", 8: "User", 9: "Internal"}


class EventLogResources:
    """The event log."""

    def __init__(self, cell: VirtualCell) -> None:
        self._cell = cell

    def routes(self) -> list[Route]:
        """Gives the table."""
        return [
            Route("GET", "rw/elog", self.domains),
            Route("GET", "rw/elog/{domain}", self.entries),
            Route("GET", "rw/elog/{domain}/{sequence}", self.entry),
            Route("POST", "rw/elog/{domain}", self.clear, RWS1, "clear"),
            Route("POST", "rw/elog/{domain}/clear", self.clear, RWS2),
            Route("POST", "rw/elog/clearall", self.clear_all, RWS2),
        ]

    def domains(self, _call: Call) -> Answer:
        """The domains and how many entries each has."""
        return answered(
            *(
                Item(
                    "elog-domain-li",
                    str(number),
                    {"domain-name": name, "numevts": str(len(self._cell.log.entries(number))), "buffsize": "1000"},
                )
                for number, name in _DOMAINS.items()
            )
        )

    def entries(self, call: Call) -> Answer:
        """A domain's entries, newest first; `elogseqnum` gives those after a number, `limit` that many."""
        domain = _domain(call)
        found = self._cell.log.entries(domain)
        after = call.query.get("elogseqnum", "")
        if after.isascii() and after.isdigit() and len(after) < 10:
            found = [entry for entry in found if entry.sequence > int(after)]
        if call.query.get("order") == "fifo":
            found.reverse()
        limit = call.query.get("limit", "50")
        count = int(limit) if limit.isascii() and limit.isdigit() and len(limit) < 6 else 50
        return answered(*(_described(entry, domain) for entry in found[:count]))

    def entry(self, call: Call) -> Answer:
        """One entry."""
        domain = _domain(call)
        found = [entry for entry in self._cell.log.entries(domain) if str(entry.sequence) == call.names["sequence"]]
        if not found:
            raise invalid(f"no entry {call.names['sequence']} in domain {domain}")
        return answered(_described(found[0], domain))

    def clear(self, call: Call) -> Answer:
        """Empties a domain."""
        self._cell.log.clear(_domain(call))
        return DONE

    def clear_all(self, _call: Call) -> Answer:
        """Empties the log."""
        self._cell.log.clear()
        return DONE


def _domain(call: Call) -> int:
    text = call.names["domain"]
    if not text.isascii() or not text.isdigit() or len(text) > 2:
        raise invalid(f"no domain {text[:20]!r} of the event log")
    return int(text)


def _described(entry: Entry, domain: int) -> Item:
    fields = {
        "msgtype": str(LEVELS[entry.level]),
        "code": str(entry.code),
        "src-name": "mitl",
        "tstamp": entry.time.strftime("%Y-%m-%d T  %H:%M:%S"),
        "argc": "0",
        "title": entry.title,
        "desc": entry.text,
        "conseqs": "",
        "causes": "",
        "actions": "",
    }
    return Item("elog-message-li", f"/rw/elog/{domain}/{entry.sequence}", fields)
