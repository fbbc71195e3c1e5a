"""The client is told of changes, also after the connection was lost."""

import threading
import time

import pytest

from mitl.controllers.rws.errors import RwsError
from mitl.controllers.rws.events import Events

from ..served import remote

PROGRAM = "MODULE M\n  PERS num n := 0;\n  PROC main()\n    SetDO doOne, 1;\n    WaitTime 1000;\n  ENDPROC\nENDMODULE\n"


class Told:
    def __init__(self):
        self.items = []
        self._changed = threading.Condition()

    def __call__(self, item):
        with self._changed:
            self.items.append(item)
            self._changed.notify_all()

    def wait_for(self, field, value):
        with self._changed:
            found = self._changed.wait_for(lambda: any(item.fields.get(field) == value for item in self.items), 10)
        assert found, self.items


@pytest.mark.parametrize("generation", ["1", "2", "8"])
def test_it_is_told_of_data_signals_and_execution(generation, tmp_path):
    (tmp_path / "m.mod").write_text(PROGRAM)
    with remote(generation, tmp_path / "disk") as rig:
        rig.controller.load([tmp_path / "m.mod"])
        dialect, told = rig.transport.dialect, Told()
        resources = [(dialect.symbol_resource("M", "n"), 2), (dialect.signal_resource("doOne"), 2), (dialect.execution_resource, 1)]
        with Events(rig.transport, resources, told):
            told.wait_for("ctrlexecstate", "stopped")
            rig.controller.start()
            told.wait_for("ctrlexecstate", "running")
            rig.controller.write("n", "7")
            told.wait_for("value", "7")
            rig.clock.wait(0.5)
            told.wait_for("lvalue", "1")


def test_a_dropped_connection_is_made_again_and_current_values_are_told(tmp_path):
    (tmp_path / "m.mod").write_text(PROGRAM)
    with remote("1", tmp_path / "disk") as rig:
        rig.controller.load([tmp_path / "m.mod"])
        told = Told()
        with Events(rig.transport, [(rig.transport.dialect.symbol_resource("M", "n"), 2)], told) as events:
            told.wait_for("value", "0")
            subscriptions = rig.clock.service.subscriptions
            (group,) = subscriptions._groups.values()
            subscriptions.remove(str(group.number), group.session)
            rig.controller.write("n", "8")
            told.wait_for("value", "8")
            assert events.connected.is_set()


def test_a_resource_that_is_not_there_ends_it_with_the_controllers_words(tmp_path):
    with remote("1", tmp_path) as rig, Events(rig.transport, [("/rw/iosystem/signals/none;state", 1)], print) as events:
        until = time.monotonic() + 10
        while events.problem is None and time.monotonic() < until:
            time.sleep(0.01)
        assert isinstance(events.problem, RwsError)
        assert "none" in str(events.problem)
