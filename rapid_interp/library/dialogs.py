"""Questions to the operator: message boxes, entries, function keys.

Invariant: each is one `AskOperator`; who answers, and how long that takes, is the driver's.
"""

from __future__ import annotations

from collections.abc import Sequence

from rapid_interp.effects import AskOperator, SourceLine, Write
from rapid_interp.library.table import Effects, LibraryRoutine, number_told, text_told
from rapid_interp.meaning.types import Value
from rapid_interp.running.values import Fault, Reference, error_number

_BUTTONS = {
    0.0: ("OK",), 1.0: ("Abort", "Retry", "Ignore"), 2.0: ("OK", "Cancel"), 3.0: ("Retry", "Cancel"),
    4.0: ("Yes", "No"), 5.0: ("Yes", "No", "Cancel"),
}  # fmt: skip
_RESULTS = {"OK": 1.0, "Abort": 2.0, "Retry": 3.0, "Ignore": 4.0, "Cancel": 5.0, "Yes": 6.0, "No": 7.0}


def _choice(at: SourceLine, text: str, choices: Sequence[str], max_time: float | None) -> Effects:
    question = AskOperator(at, "choice", text, tuple(choices), max_time=max_time)
    reply = number_told((yield question), "answer of the operator")
    if reply != int(reply) or not 0 <= reply < len(choices):
        raise Fault(f"the operator's answer {reply:g} is none of the {len(choices)} choices", "RAPID-R396")
    return int(reply)


def _pressed(at: SourceLine, text: str, buttons: Value, own: Value, max_time: float | None) -> Effects:
    r"""Gives the answer as `btnres`: a named result for predefined buttons, the 1-based place for those of `\BtnArray`."""
    if own is not None:
        return float((yield from _choice(at, text, own, max_time))) + 1.0
    names = _BUTTONS.get(0.0 if buttons is None else buttons)
    if names is None:
        return 0.0
    return _RESULTS[names[(yield from _choice(at, text, names, max_time))]]


def _lines(*parts: Value) -> str:
    found: list[str] = []
    for part in parts:
        found += part if isinstance(part, tuple) else [part] if part else []
    return "\n".join(found)


def _msg_box(
    at: SourceLine, header: Value, line: str, l2: Value, l3: Value, l4: Value, l5: Value, _wrap: bool, buttons: Value, own: Value,
    _icon: Value, _image: Value, result: Reference | None, max_time: float | None, *_: Value,
) -> Effects:  # fmt: skip
    text = _lines(header, line, l2, l3, l4, l5)
    if buttons == -1.0 and own is None:
        yield Write(at, text)
        return
    answer = yield from _pressed(at, text, buttons, own, max_time)
    if result is not None:
        result.put(answer)


def _message_box(
    at: SourceLine,
    header: Value,
    message: Value,
    array: Value,
    _wrap: bool,
    buttons: Value,
    own: Value,
    _default: Value,
    _icon: Value,
    _image: Value,
    max_time: float | None,
    *_: Value,
) -> Effects:
    return (yield from _pressed(at, _lines(header, message, array), buttons, own, max_time))


def _number(at: SourceLine, text: str, least: float | None, most: float | None, whole: bool, max_time: float | None) -> Effects:
    reply = number_told((yield AskOperator(at, "number", text, (), least, most, max_time)), "answer of the operator")
    if (least is not None and reply < least) or (most is not None and reply > most) or (whole and reply != int(reply)):
        raise Fault(f"the operator's answer {reply:g} is not what was asked for", "RAPID-R396", number=error_number("ERR_UI_NOTALLOWED"))
    return reply


def _num_entry(
    at: SourceLine, header: Value, message: Value, array: Value, _wrap: bool, _icon: Value, _initial: Value, least: Value, most: Value,
    whole: bool, max_time: float | None, *_: Value,
) -> Effects:  # fmt: skip
    return (yield from _number(at, _lines(header, message, array), least, most, whole, max_time))


def _alpha_entry(
    at: SourceLine,
    header: Value,
    message: Value,
    array: Value,
    _wrap: bool,
    _icon: Value,
    _initial: Value,
    max_time: float | None,
    *_: Value,
) -> Effects:
    question = AskOperator(at, "text", _lines(header, message, array), max_time=max_time)
    reply = text_told((yield question), "answer of the operator")
    return reply[:80]


def _list_view(
    at: SourceLine, result: Reference | None, header: Value, items: Value, _buttons: Value, _own: Value, _icon: Value, _default: Value,
    max_time: float | None, *_: Value,
) -> Effects:  # fmt: skip
    chosen = yield from _choice(at, header or "", [item[1] for item in items], max_time)
    if result is not None:
        result.put(1.0)
    return float(chosen) + 1.0


def _tp_read_num(at: SourceLine, answer: Reference, text: str, max_time: float | None, *_: Value) -> Effects:
    answer.put((yield from _number(at, text, None, None, False, max_time)))


def _tp_read_fk(at: SourceLine, answer: Reference, text: str, *keys: Value) -> Effects:
    """The answer is the number of the key, 1 to 5. Keys without text cannot be pressed."""
    named = [(place, key) for place, key in enumerate(keys[:5], start=1) if key]
    if not named:
        raise Fault("TPReadFK needs at least one key with a text", "RAPID-R396")
    answer.put(float(named[(yield from _choice(at, text, [key for _, key in named], keys[5]))][0]))


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
