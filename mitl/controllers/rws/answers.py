"""Reads answers and events of Robot Web Services, JSON or XHTML of either generation, into items.

Invariant: whatever the bytes are, the result is items or a MalformedAnswerError; entities and external documents are never read.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any
from xml.etree.ElementTree import Element, ParseError

from defusedxml.common import DefusedXmlException  # type: ignore[import-untyped] # ships no types
from defusedxml.ElementTree import fromstring  # type: ignore[import-untyped] # ships no types

from mitl.controllers.rws.errors import MalformedAnswerError

MOST_BYTES = 32 * 1024 * 1024


@dataclass(frozen=True)
class Item:
    """One item of an answer: class, title, fields, and its own address."""

    kind: str
    title: str
    fields: Mapping[str, str]
    href: str = ""

    def __getitem__(self, name: str) -> str:
        """Gives a field. Raises MalformedAnswerError where it is missing."""
        if name not in self.fields:
            raise MalformedAnswerError(
                f"the controller's answer {self.kind!r} has no field {name!r}; it has {', '.join(self.fields) or 'none'}"
            )
        return self.fields[name]


def items(content_type: str, body: bytes) -> list[Item]:
    """Gives the items of an answer."""
    if not body.strip():
        return []
    if "json" in content_type.lower():
        return _json_items(_json(body))
    return _xhtml_items(_xhtml(body))


def status(content_type: str, body: bytes) -> tuple[int | None, str]:
    """Gives ABB's code and text of a refusal; None and the beginning of the body where it is of another form."""
    shown = body[:200].decode("utf-8", errors="replace").strip()
    try:
        if "json" in content_type.lower():
            found = _json(body)
            inner = found.get("_embedded", found).get("status", {})
            return int(inner["code"]), str(inner.get("msg", ""))
        spans = {element.get("class"): element.text or "" for element in _xhtml(body).iter() if _local(element) == "span"}
        return int(spans["code"]), spans.get("msg", "")
    except (MalformedAnswerError, KeyError, ValueError, AttributeError, TypeError):
        return None, shown


def _json(body: bytes) -> dict[str, Any]:
    try:
        found = json.loads(body)
    except (ValueError, RecursionError) as error:
        raise MalformedAnswerError(f"the controller's answer is no JSON: {error}") from error
    if not isinstance(found, dict):
        raise MalformedAnswerError(f"the controller's answer is no JSON object but {type(found).__name__}")
    return found


def _json_items(answer: dict[str, Any]) -> list[Item]:
    embedded = answer.get("_embedded")
    listed: list[Any] = []
    for place in (embedded.get("_state") if isinstance(embedded, dict) else None, answer.get("state")):
        listed += place if isinstance(place, list) else []
    return [_json_item(entry) for entry in listed if isinstance(entry, dict)]


def _json_item(entry: dict[str, Any]) -> Item:
    fields = {name: str(value) for name, value in entry.items() if not name.startswith("_") and isinstance(value, str | int | float)}
    if isinstance(entry.get("_value"), str):
        fields["_value"] = entry["_value"]
    return Item(str(entry.get("_type", "")), str(entry.get("_title", "")), fields)


def _xhtml(body: bytes) -> Element:
    try:
        root: Element = fromstring(body, forbid_dtd=False)
    except (ParseError, DefusedXmlException, ValueError, RecursionError) as error:
        raise MalformedAnswerError(f"the controller's answer is no XHTML: {error}") from error
    return root


def _xhtml_items(root: Element) -> list[Item]:
    found = []
    for element in root.iter():
        if _local(element) != "li":
            continue
        spans = {child.get("class", ""): "".join(child.itertext()) for child in element.iter() if _local(child) == "span"}
        link = next((child.get("href", "") for child in element.iter() if _local(child) == "a" and child.get("rel") == "self"), "")
        found.append(Item(element.get("class", ""), element.get("title", ""), spans, link))
    return found


def _local(element: Element) -> str:
    return element.tag.rpartition("}")[2] if isinstance(element.tag, str) else ""
