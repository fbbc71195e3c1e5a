"""The RAPID Message Queue: values sent from task to task.

Invariant: tasks begun together (`start_tasks`) share their mail; a task alone has a queue of its own.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from rapid_interp.effects import SourceLine, Wait
from rapid_interp.library.interrupts import number_of
from rapid_interp.library.table import Effects, LibraryRoutine
from rapid_interp.meaning.types import RapidType, Value, fits
from rapid_interp.running.mail import MailBox, Message
from rapid_interp.running.values import Fault, Reference, error_number

if TYPE_CHECKING:
    from rapid_interp.running.task import Stepper

POLL_S = 0.01
"""ASSUMPTION A-48: as WaitTestAndSet, RMQReadWait and RMQSendWait look every 10 ms."""
_PREFIX = "RMQ_"


def _problem(message: str, error: str) -> Fault:
    return Fault(message, "RAPID-R358", number=error_number(error))


def _mine(task: Stepper) -> int:
    return task.mail.slot(_PREFIX + task.name)


def _find(task: Stepper, slot: Reference, name: str) -> None:
    _mine(task)
    found = task.mail.known(name)
    if found is None:
        raise _problem(f"there is no queue {name!r}; that of a task is {_PREFIX}TASKNAME", "ERR_RMQ_NAME")
    slot.put(float(found))


def _slot_name(task: Stepper, slot: float) -> str:
    if not 1 <= slot <= len(task.mail.names):
        raise _problem("the slot is not known: RMQFindSlot comes first", "ERR_RMQ_INVALID")
    name = task.mail.names[int(slot) - 1]
    return _PREFIX + name[len(_PREFIX) :].upper()


def _message(task: Stepper, slot: float, typed: tuple[RapidType, Value], user: float | None) -> Message:
    _slot_name(task, slot)
    return Message(typed[0], typed[1], _mine(task), user or 0.0)


def _send(task: Stepper, slot: float, typed: tuple[RapidType, Value], user: float | None) -> None:
    if not task.mail.send(int(slot), _message(task, slot, typed, user)):
        raise _problem("the queue is full", "ERR_RMQ_FULL")


def _send_wait(
    task: Stepper,
    at: SourceLine,
    slot: float,
    typed: tuple[RapidType, Value],
    user: float | None,
    answer: Reference,
    time_out: float | None,
) -> Effects:
    """Sends, and waits until a message comes back."""
    _send(task, slot, typed, user)
    yield from _read_wait(task, at, answer, time_out)


def _take(task: Stepper) -> Message | None:
    queue = task.mail.queues[_mine(task)]
    return queue.popleft() if queue else None


def _get(task: Stepper, message: Reference) -> None:
    found = _take(task)
    if found is None:
        raise _problem("there is no message", "ERR_RMQ_NOMSG")
    message.put(found)


def _read_wait(task: Stepper, at: SourceLine, message: Reference, time_out: float | None) -> Effects:
    waited = 0.0
    while (found := _take(task)) is None:
        if time_out is not None and waited >= time_out:
            raise _problem(f"no message came within {time_out:g} s", "ERR_RMQ_TIMEOUT")
        yield Wait(at, POLL_S)
        waited += POLL_S
    message.put(found)


def _received(message: Value) -> Message:
    if not isinstance(message, Message):
        raise _problem("the message is empty: RMQGetMessage comes first", "ERR_RMQ_INVMSG")
    return message


def _data(message: Value, target: tuple[RapidType, Reference]) -> None:
    found = _received(message)
    if not fits(found.type, target[0]):
        raise _problem(f"the message holds {found.type.name}, not {target[0].name}", "ERR_RMQ_VALUE")
    target[1].put(found.value)


def _header(message: Value, _header: Value, sender: Reference | None, user: Reference | None) -> None:
    found = _received(message)
    if sender is not None:
        sender.put(float(found.sender))
    if user is not None:
        user.put(found.user)


def _empty(task: Stepper) -> None:
    task.mail.queues[_mine(task)].clear()


def _on_message(task: Stepper, example: tuple[RapidType, Value], interrupt: Reference) -> None:
    task.interrupts.await_mail(number_of(task, interrupt), MailBox(task.mail, _mine(task)), example[0])


ROUTINES = (
    LibraryRoutine("PROC RMQFindSlot(INOUT rmqslot Slot, string Name)", _find, task=True),
    LibraryRoutine("FUNC string RMQGetSlotName(rmqslot Slot)", _slot_name, task=True),
    LibraryRoutine(r"PROC RMQSendMessage(rmqslot Slot, anytype SendData \num UserDef)", _send, task=True),
    LibraryRoutine(
        r"PROC RMQSendWait(rmqslot Slot, anytype SendData \num UserDef, INOUT rmqmessage Message \num TimeOut)", _send_wait, True, task=True
    ),
    LibraryRoutine("PROC RMQGetMessage(INOUT rmqmessage Message)", _get, task=True),
    LibraryRoutine(r"PROC RMQReadWait(INOUT rmqmessage Message \num TimeOut)", _read_wait, True, task=True),
    LibraryRoutine("PROC RMQGetMsgData(rmqmessage Message, INOUT anydata Data)", _data),
    LibraryRoutine(r"PROC RMQGetMsgHeader(rmqmessage Message \INOUT rmqheader Header \INOUT rmqslot SenderId \INOUT num UserDef)", _header),
    LibraryRoutine("PROC RMQEmptyQueue()", _empty, task=True),
    LibraryRoutine("PROC IRMQMessage(anytype InterruptDataType, INOUT intnum Interrupt)", _on_message, task=True),
)
