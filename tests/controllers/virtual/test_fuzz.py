"""Whatever comes in, a response goes out: never a 500, never an exception, and nothing grows without bound."""

import base64

from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from mitl.controllers.virtual.service import Request

WORDS = [
    "rw",
    "rapid",
    "panel",
    "execution",
    "symbol",
    "data",
    "RAPID",
    "T_ROB1",
    "Work",
    "count;value",
    "signals",
    "iosystem",
    "fileservice",
    "$home",
]
WORDS += [
    "..",
    "%2e%2e",
    "elog",
    "0",
    "mechunits",
    "motionsystem",
    "ROB_1",
    "robtarget",
    "tasks",
    "modules",
    "mastership",
    "subscription",
    "1",
    "users",
]
WORDS += [
    "poll",
    "dipc",
    "q",
    "logout",
    "rmmp",
    "start",
    "stop",
    "loadmod",
    "set-value",
    "count%7B99%7D",
    "controlstation",
    "\x00",
    "é",
    "a" * 300,
]
segments = st.lists(st.sampled_from(WORDS) | st.text(max_size=8), max_size=8)
queries = st.dictionaries(
    st.sampled_from(["action", "json", "start", "limit", "tool", "wobj", "coordinate", "mastership"]), st.text(max_size=10)
)
headers = st.dictionaries(st.sampled_from(["accept", "content-type", "cookie", "authorization", "host"]), st.text(max_size=40))
bodies = st.binary(max_size=60) | st.sampled_from([b"value=1", b"lvalue=1", b"1=/rw/panel/opmode&1-p=1", b"%ff=%zz", b"&" * 50])


@settings(max_examples=300, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(
    generation=st.sampled_from("128"),
    method=st.sampled_from(["GET", "POST", "PUT", "DELETE", "HEAD", "OPTIONS", "\x00"]),
    path=segments,
    query=queries,
    given_headers=headers,
    body=bodies,
    logged_in=st.booleans(),
)
def test_every_request_has_a_response_and_none_is_an_internal_error(
    services, generation, method, path, query, given_headers, body, logged_in
):
    service, client = services(generation)
    target = "/" + "/".join(path) + ("?" + "&".join(f"{name}={value}" for name, value in query.items()) if query else "")
    sent = {**given_headers, "cookie": client.cookie} if logged_in else given_headers
    response = service.respond(Request(method, target, sent, body))
    assert 200 <= response.status < 600
    assert b"Internal error" not in response.body
    if not logged_in and "authorization" not in given_headers:
        assert response.status in (400, 401)
    assert len(service._sessions) <= 70


def test_a_made_up_login_is_refused_however_it_looks(services):
    service, _ = services("2")
    for text in (
        "",
        "Basic",
        "Basic !!!",
        "Basic " + base64.b64encode(b"no colon").decode(),
        "Digest x",
        "Basic " + base64.b64encode(b"\xff:\xff").decode(),
    ):
        assert service.respond(Request("GET", "/rw/panel/opmode", {"authorization": text})).status == 401
