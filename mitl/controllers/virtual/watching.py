"""What subscribers can watch: addresses of resources to a look at their state as items of an event."""

from __future__ import annotations

from mitl.controllers.virtual.answers import Dialect, Item, Refused, invalid
from mitl.controllers.virtual.cell import VirtualCell
from mitl.controllers.virtual.resources.queues import QueueResources
from mitl.controllers.virtual.resources.symbols import SymbolResources
from mitl.controllers.virtual.subscriptions import LOG, QUEUE, SIGNAL, SYMBOL_1, SYMBOL_2, Look
from mitl.errors import RigError


class Watchable:
    """Finds what an address means in a cell."""

    def __init__(self, cell: VirtualCell, symbols: SymbolResources, queues: QueueResources, dialect: Dialect) -> None:
        self._cell = cell
        self._symbols = symbols
        self._queues = queues
        self._dialect = dialect

    def find(self, address: str) -> Look:
        """Gives how to look at a resource. Raises Refused where it cannot be subscribed to."""
        path, _, _what = address.partition(";")
        match path.lower():
            case "/rw/panel/ctrlstate" | "/rw/panel/ctrl-state":
                return lambda: (Item("pnl-ctrlstate-ev", "ctrlstate", {"ctrlstate": self._cell.state}, address),)
            case "/rw/panel/opmode":
                return lambda: (Item("pnl-opmode-ev", "opmode", {"opmode": self._cell.mode}, address),)
            case "/rw/panel/speedratio":
                return lambda: (Item("pnl-speedratio-ev", "speedratio", {"speedratio": f"{self._cell.speed_ratio:g}"}, address),)
            case "/rw/rapid/execution" if address.endswith(";rapidexeccycle"):
                return lambda: (Item("rap-execcycle-ev", "rapidexeccycle", {"rapidexeccycle": self._cell.cycle}, address),)
            case "/rw/rapid/execution":
                return lambda: (Item("rap-ctrlexecstate-ev", "ctrlexecstate", {"ctrlexecstate": self._executing()}, address),)
            case "/rw/rapid/tasks/t_rob1":
                return lambda: (Item("rap-task-ev", "taskchange", {"change-count": str(self._cell.memory.version)}, address),)
            case "/rw/rapid/tasks/t_rob1/pcp":
                return lambda: self._pointer(address)
        return self._by_pattern(address)

    def _by_pattern(self, address: str) -> Look:
        if match := SYMBOL_1.match(address) or SYMBOL_2.match(address):
            path = match[1]
            self._symbols.value(path, self._dialect)
            return lambda: self._symbol(address, path)
        if match := SIGNAL.match(address):
            name = self._cell.signals.find(match[1]).name
            return lambda: (self._signal(address, name),)
        if match := LOG.match(address):
            domain = int(match[1])
            return lambda: self._log(domain)
        if (match := QUEUE.match(address)) and match[1] in self._queues.queues:
            name = match[1]
            return lambda: self._message(address, name)
        raise invalid(f"{address} cannot be subscribed to")

    def _executing(self) -> str:
        return "running" if self._cell.running else "stopped"

    def _pointer(self, address: str) -> tuple[Item, ...]:
        at = self._cell.controller.at
        fields = {} if at is None else {"module-name": at.module, "begin-position": f"{at.line},1", "end-position": f"{at.line},1"}
        return (Item("rap-pp-ev", "programpointer", fields, address),)

    def _symbol(self, address: str, path: str) -> tuple[Item, ...]:
        try:
            value = self._symbols.value(path, self._dialect)
        except (Refused, RigError):
            return ()  # the module was unloaded since: nothing to tell
        return (Item("rap-value-ev", "value", {}, address), Item("rap-data", f"RAPID/{path}", {"value": value}))

    def _signal(self, address: str, name: str) -> Item:
        return Item("ios-signalstate-ev", name, {"lvalue": f"{self._cell.signals.value(name):g}", "lstate": "not simulated"}, address)

    def _log(self, domain: int) -> tuple[Item, ...]:
        entries = self._cell.log.entries(domain)
        if not entries:
            return ()
        number = str(entries[0].sequence)
        return (Item("elog-message-ev", f"/rw/elog/{domain}/{number}", {"seqnum": number}, f"/rw/elog/{domain}/{number}"),)

    def _message(self, address: str, name: str) -> tuple[Item, ...]:
        queue = self._queues.queues.get(name)
        if queue is None or not queue.messages:
            return ()
        return (Item("dipc-msg-ev", str(queue.received), {**queue.messages[-1], "change-count": str(queue.received)}, address),)
