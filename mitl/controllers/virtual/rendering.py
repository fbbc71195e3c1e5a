"""Answers as XHTML and JSON, as the two generations of Robot Web Services write them.

Invariant: `class` is the first attribute of an item and a span, and an answer is written on one line: clients rely on both (facts/rws.md).
"""

from __future__ import annotations

import json
from enum import Enum
from typing import Any
from xml.sax.saxutils import escape, quoteattr

from mitl.controllers.virtual.answers import Answer, Dialect, Item, Refused


class Form(Enum):
    """The representation of an answer."""

    XHTML = "xhtml"
    JSON = "json"


def content_type(form: Form, dialect: Dialect) -> str:
    """Gives the media type of an answer; a client compares the one of JSON in 1.0 with `==`, so it carries no charset."""
    if dialect is Dialect.RWS1:
        return "application/json" if form is Form.JSON else "application/xhtml+xml"
    return "application/hal+json;v=2.0" if form is Form.JSON else "application/xhtml+xml;v=2.0"


def rendered(answer: Answer, form: Form, dialect: Dialect, base: str, path: str) -> bytes:
    """Gives the body of an answer with items. base: address of the server, path: of the resource."""
    if form is Form.XHTML:
        return _page(f"{base}{path}", _state(answer), path).encode()
    state = [_as_json(item) for item in answer.items or ()]
    links: dict[str, Any] = {"base": {"href": f"{base}{path}/"}}
    if dialect is Dialect.RWS1:
        return _json({"_links": links, "_embedded": {"_state": state}})
    return _json({"_links": links, "status": {"code": 294912}, "state": state})


def rendered_refusal(refused: Refused, form: Form, dialect: Dialect, base: str, path: str) -> bytes:
    """Gives the body of a refusal."""
    if form is Form.XHTML:
        status = f'<span class="code">{refused.code}</span><span class="msg">{escape(refused.text)}</span>'
        return _page(f"{base}{path}", f'<div class="status">{status}</div>', path).encode()
    status_json = {"code": refused.code, "msg": refused.text}
    links = {"base": {"href": f"{base}{path}/"}}
    if dialect is Dialect.RWS1:
        return _json({"_links": links, "_embedded": {"status": status_json, "_state": []}})
    return _json({"_links": links, "status": status_json})


def event(items: list[Item], group: str) -> str:
    """Gives the WebSocket text that tells of changed resources."""
    listed = "".join(_listed(item) for item in items)
    body = f'<div class="state"><a href="{group}" rel="group"></a><ul>{listed}</ul></div>'
    return f'<?xml version="1.0" encoding="utf-8"?><html xmlns="http://www.w3.org/1999/xhtml"><head><title>Event</title></head><body>{body}</body></html>'


def _page(base: str, body: str, title: str) -> str:
    head = f"<title>{escape(title.strip('/') or 'services')}</title><base href={quoteattr(base + '/')}/>"
    return f'<?xml version="1.0" encoding="UTF-8"?><html xmlns="http://www.w3.org/1999/xhtml"><head>{head}</head><body>{body}</body></html>'


def _state(answer: Answer) -> str:
    links = "".join(f"<a href={quoteattr(href)} rel={quoteattr(rel)}></a>" for href, rel in answer.links)
    listed = "".join(_listed(item) for item in answer.items or ())
    return f'<div class="state">{links}<ul>{listed}</ul></div>'


def _listed(item: Item) -> str:
    link = f'<a href={quoteattr(item.href)} rel="self"></a>' if item.href else ""
    return f'<li class="{item.kind}" title={quoteattr(item.title)}>{link}{_spans(item)}</li>'


def _spans(item: Item) -> str:
    spans = []
    for name, value in item.fields.items():
        if isinstance(value, str):
            spans.append(f'<span class="{name}">{escape(value)}</span>')
        else:
            spans += [f'<span class="{name}">{escape(str(dict(entry)))}</span>' for entry in value]
    return "".join(spans)


def _as_json(item: Item) -> dict[str, Any]:
    fields = {name: value if isinstance(value, str) else [dict(entry) for entry in value] for name, value in item.fields.items()}
    links = {"_links": {"self": {"href": item.href}}} if item.href else {}
    return {**links, "_type": item.kind, "_title": item.title, **fields}


def _json(value: object) -> bytes:
    return json.dumps(value).encode()
