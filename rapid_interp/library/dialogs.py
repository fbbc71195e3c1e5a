"""Questions to the operator: message boxes, entries, function keys.

Invariant: each is one `AskOperator`; who answers, and how long that takes, is the driver's.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TypeAlias

from rapid_interp.effects import AskOperator, BreakSignal, SourceLine, Write
from rapid_interp.library.signals import signal_name
from rapid_interp.library.table import Effects, LibraryRoutine, number_told, text_told
from rapid_interp.meaning.types import Value
from rapid_interp.running.values import Fault, Reference, error_number

_BUTTONS = {
    0.0: ("OK",), 1.0: ("Abort", "Retry", "Ignore"), 2.0: ("OK", "Cancel"), 3.0: ("Retry", "Cancel"),
    4.0: ("Yes", "No"), 5.0: ("Yes", "No", "Cancel"),
}  # fmt: skip
Later: TypeAlias = tuple[Value, ...]
r"""The values of `\MaxTime`, `\DIBreak`, `\DIPassive`, `\DOBreak`, `\DOPassive` and `\BreakFlag`."""
_RESULTS = {"OK": 1.0, "Abort": 2.0, "Retry": 3.0, "Ignore": 4.0, "Cancel": 5.0, "Yes": 6.0, "No": 7.0}


_BREAKS = {error_number(name) for name in ("ERR_TP_MAXTIME", "ERR_TP_DIBREAK", "ERR_TP_DOBREAK")}


def _asked(question: AskOperator, later: Later) -> Effects:
    r"""Gives the answer, or None if nobody answered in time or a signal broke the question off and `\BreakFlag` was told so."""
    max_time, digital_in, passive_in, digital_out, passive_out, flag = later
    breaks = tuple(
        BreakSignal(signal_name(signal), float(not passive), error)
        for signal, passive, error in ((digital_in, passive_in, "ERR_TP_DIBREAK"), (digital_out, passive_out, "ERR_TP_DOBREAK"))
        if signal is not None
    )
    try:
        reply = yield replace(question, max_time=max_time, breaks=breaks)
    except Fault as fault:
        if flag is None or fault.number not in _BREAKS:
            raise
        flag.put(fault.number)
        return None
    if flag is not None:
        flag.put(0.0)
    return reply


def _choice(at: SourceLine, text: str, choices: Sequence[str], later: Later) -> Effects:
    answer = yield from _asked(AskOperator(at, "choice", text, tuple(choices)), later)
    if answer is None:
        return None
    reply = number_told(answer, "answer of the operator")
    if reply != int(reply) or not 0 <= reply < len(choices):
        raise Fault(f"the operator's answer {reply:g} is none of the {len(choices)} choices", "RAPID-R396")
    return int(reply)


def _pressed(at: SourceLine, text: str, buttons: Value, own: Value, later: Later) -> Effects:
    r"""Gives the answer as `btnres`: a named result for predefined buttons, the 1-based place for those of `\BtnArray`."""
    names = own if own is not None else _BUTTONS.get(0.0 if buttons is None else buttons)
    if names is None:
        return 0.0
    chosen = yield from _choice(at, text, names, later)
    if chosen is None:
        return 0.0
    return float(chosen) + 1.0 if own is not None else _RESULTS[names[chosen]]


def _lines(*parts: Value) -> str:
    found: list[str] = []
    for part in parts:
        found += part if isinstance(part, tuple) else [part] if part else []
    return "\n".join(found)


def _msg_box(
    at: SourceLine, header: Value, line: str, l2: Value, l3: Value, l4: Value, l5: Value, _wrap: bool, buttons: Value, own: Value,
    _icon: Value, _image: Value, result: Reference | None, *later: Value,
) -> Effects:  # fmt: skip
    text = _lines(header, line, l2, l3, l4, l5)
    if buttons == -1.0 and own is None:
        yield Write(at, text)
        return
    answer = yield from _pressed(at, text, buttons, own, later)
    if result is not None:
        result.put(answer)


def _message_box(
    at: SourceLine, header: Value, message: Value, array: Value, _wrap: bool, buttons: Value, own: Value, _default: Value, _icon: Value,
    _image: Value, *later: Value,
) -> Effects:  # fmt: skip
    return (yield from _pressed(at, _lines(header, message, array), buttons, own, later))


def _number(at: SourceLine, text: str, least: float | None, most: float | None, whole: bool, initial: Value, later: Later) -> Effects:
    answer = yield from _asked(AskOperator(at, "number", text, (), least, most), later)
    if answer is None:
        return initial or 0.0
    reply = number_told(answer, "answer of the operator")
    if (least is not None and reply < least) or (most is not None and reply > most) or (whole and reply != int(reply)):
        raise Fault(f"the operator's answer {reply:g} is not what was asked for", "RAPID-R396", number=error_number("ERR_UI_NOTALLOWED"))
    return reply


def _num_entry(
    at: SourceLine, header: Value, message: Value, array: Value, _wrap: bool, _icon: Value, initial: Value, least: Value, most: Value,
    whole: bool, *later: Value,
) -> Effects:  # fmt: skip
    return (yield from _number(at, _lines(header, message, array), least, most, whole, initial, later))


def _num_tune(
    at: SourceLine, header: Value, message: Value, array: Value, _wrap: bool, _icon: Value, initial: Value, increment: Value, least: Value,
    most: Value, *later: Value,
) -> Effects:  # fmt: skip
    if increment <= 0:
        raise Fault(f"the increment must be positive, found {increment:g}", "RAPID-R396", number=error_number("ERR_UI_INITVALUE"))
    return (yield from _number(at, _lines(header, message, array), least, most, False, initial, later))


def _alpha_entry(
    at: SourceLine, header: Value, message: Value, array: Value, _wrap: bool, _icon: Value, initial: Value, *later: Value
) -> Effects:
    answer = yield from _asked(AskOperator(at, "text", _lines(header, message, array)), later)
    return (initial or "") if answer is None else text_told(answer, "answer of the operator")[:80]


def _list_view(
    at: SourceLine, result: Reference | None, header: Value, items: Value, _buttons: Value, _own: Value, _icon: Value, _default: Value,
    *later: Value,
) -> Effects:  # fmt: skip
    chosen = yield from _choice(at, header or "", [item[1] for item in items], later)
    if chosen is None:
        return 0.0
    if result is not None:
        result.put(1.0)
    return float(chosen) + 1.0


def _tp_read_num(at: SourceLine, answer: Reference, text: str, *later: Value) -> Effects:
    answer.put((yield from _number(at, text, None, None, False, answer.get(), later)))


def _tp_read_fk(at: SourceLine, answer: Reference, text: str, *keys: Value) -> Effects:
    """The answer is the number of the key, 1 to 5. Keys without text cannot be pressed."""
    named = [(place, key) for place, key in enumerate(keys[:5], start=1) if key]
    if not named:
        raise Fault("TPReadFK needs at least one key with a text", "RAPID-R396")
    chosen = yield from _choice(at, text, [key for _, key in named], keys[5:])
    if chosen is not None:
        answer.put(float(named[chosen][0]))


_LATER = r"\num MaxTime \signaldi DIBreak \switch DIPassive \signaldo DOBreak \switch DOPassive \INOUT errnum BreakFlag"
_MESSAGE = r"\string Header \string Message | string MsgArray{*} \switch Wrap"
_CHOICE = r"\num Buttons | string BtnArray{*}"
ROUTINES = (
    LibraryRoutine(
        r"PROC UIMsgBox(\string Header, string MsgLine1 \string MsgLine2 \string MsgLine3 \string MsgLine4 \string MsgLine5 \switch Wrap"
        rf" {_CHOICE} \num Icon \string Image \INOUT num Result {_LATER})",
        _msg_box,
        True,
    ),
    LibraryRoutine(rf"FUNC num UIMessageBox({_MESSAGE} {_CHOICE} \num DefaultBtn \num Icon \string Image {_LATER})", _message_box, True),
    LibraryRoutine(
        rf"FUNC num UINumEntry({_MESSAGE} \num Icon \num InitValue \num MinValue \num MaxValue \switch AsInteger {_LATER})",
        _num_entry,
        True,
    ),
    LibraryRoutine(
        rf"FUNC num UINumTune({_MESSAGE} \num Icon, num InitValue, num Increment \num MinValue \num MaxValue {_LATER})", _num_tune, True
    ),
    LibraryRoutine(
        rf"FUNC dnum UIDnumTune({_MESSAGE} \num Icon, dnum InitValue, dnum Increment \dnum MinValue \dnum MaxValue {_LATER})",
        _num_tune,
        True,
    ),
    LibraryRoutine(
        rf"FUNC dnum UIDnumEntry({_MESSAGE} \num Icon \dnum InitValue \dnum MinValue \dnum MaxValue \switch AsInteger {_LATER})",
        _num_entry,
        True,
    ),
    LibraryRoutine(rf"FUNC string UIAlphaEntry({_MESSAGE} \num Icon \string InitString {_LATER})", _alpha_entry, True),
    LibraryRoutine(
        rf"FUNC num UIListView(\INOUT num Result \string Header, listitem ListItems{{*}} {_CHOICE} \num Icon \num DefaultIndex {_LATER})",
        _list_view,
        True,
    ),
    LibraryRoutine(rf"PROC TPReadNum(INOUT num TPAnswer, string TPText {_LATER})", _tp_read_num, True),
    LibraryRoutine(rf"PROC TPReadDnum(INOUT dnum TPAnswer, string TPText {_LATER})", _tp_read_num, True),
    LibraryRoutine(
        "PROC TPReadFK(INOUT num TPAnswer, string TPText, string TPFK1, string TPFK2, string TPFK3, string TPFK4, string TPFK5"
        rf" {_LATER})",
        _tp_read_fk,
        True,
    ),
)
