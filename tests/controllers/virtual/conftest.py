"""Talking to a Service without a network."""

import base64
import json
import urllib.parse

import pytest

from mitl.controllers.virtual import start
from mitl.controllers.virtual.answers import Dialect
from mitl.controllers.virtual.service import Request

PROGRAM = """MODULE Work
  PERS tooldata tLong := [TRUE,[[0,0,100],[1,0,0,0]],[0.5,[0,0,50],[1,0,0,0],0,0,0]];
  PERS num count := 0;
  VAR num option := 0;
  PERS num values{3} := [1,2,3];
  CONST num fixed := 4;
  PROC main()
    WHILE option <> 9 DO
      IF option = 1 THEN
        MoveAbsJ [[20,10,0,0,40,0],[9E9,9E9,9E9,9E9,9E9,9E9]], v200, fine, tool0;
        SetDO doDone, 1;
        count := count + 1;
        option := 0;
      ENDIF
      IF DInput(diGo) = 1 THEN
        count := 50;
      ENDIF
      WaitTime 0.05;
    ENDWHILE
  ENDPROC
ENDMODULE
"""
START = {"regain": "continue", "execmode": "continue", "cycle": "once", "condition": "none", "stopatbp": "disabled", "alltaskbytsp": "true"}


class Client:
    """A client that keeps its cookies, in the generation's own media types."""

    def __init__(self, service, user="Default User", password="robotics"):  # noqa: S107 - ABB's published default
        self.service = service
        self.user = user
        self.password = password
        self.cookie = ""
        self.last = None

    def __call__(self, method, target, form=None, body=None, **headers):
        two = self.service.dialect is not Dialect.RWS1
        sent = {"host": "cell"}
        if self.cookie:
            sent["cookie"] = self.cookie
        elif two:
            sent["authorization"] = "Basic " + base64.b64encode(f"{self.user}:{self.password}".encode()).decode()
        if two:
            sent["accept"] = "application/hal+json;v=2.0"
            sent["content-type"] = "application/x-www-form-urlencoded;v=2.0" if body is None else "text/plain;v=2.0"
        else:
            target += ("&" if "?" in target else "?") + "json=1"
        content = body if body is not None else urllib.parse.urlencode(form or {}).encode()
        self.last = self.service.respond(Request(method, target, {**sent, **headers}, content))
        if self.last.cookies:
            self.cookie = "; ".join(cookie.partition(";")[0] for cookie in self.last.cookies)
        return self.last

    def state(self, target):
        """The first item of an answer."""
        answer = json.loads(self("GET", target).body)
        return (answer["_embedded"]["_state"] if "_embedded" in answer else answer["state"])[0]

    def code(self):
        """The code of the last refusal, which JSON and XHTML have."""
        text = self.last.body.decode()
        return int(
            text.partition('class="code">')[2].partition("<")[0] or json.loads(text).get("_embedded", json.loads(text))["status"]["code"]
        )


def login_digest(client):
    """Opens a session of 1.0 as requests' HTTPDigestAuth does."""
    import hashlib
    import re

    refused = client("GET", "/rw/panel/opmode")
    assert refused.status == 401
    given = dict(re.findall(r'(\w+)="([^"]*)"', refused.headers["WWW-Authenticate"]))

    def md5(text):
        return hashlib.md5(text.encode(), usedforsecurity=False).hexdigest()

    uri = "/rw/panel/opmode?json=1"
    secret = md5(f"{client.user}:{given['realm']}:{client.password}")
    response = md5(f"{secret}:{given['nonce']}:00000001:abc:auth:{md5('GET:' + uri)}")
    header = (
        f'Digest username="{client.user}", realm="{given["realm"]}", nonce="{given["nonce"]}", uri="{uri}", response="{response}", '
        f'opaque="{given["opaque"]}", algorithm=MD5, qop="auth", nc=00000001, cnonce="abc"'
    )
    return client("GET", "/rw/panel/opmode", authorization=header), header


class Clock:
    """The server's clock, moved by the test."""

    def __init__(self):
        self.time = 1000.0

    def __call__(self):
        return self.time


@pytest.fixture
def make(tmp_path):
    """Gives a function that makes a service of a generation with the program loaded, and a client of it."""
    cells = []

    def made(generation, *, program=PROGRAM, **options):
        cell = start.virtual_cell("irb140", signals={"diGo": "DI"})
        cells.append(cell)
        if program:
            (tmp_path / "work.mod").write_text(program, encoding="utf-8")
            start.load_at_start(cell, tmp_path / "work.mod")
        from mitl.controllers.virtual.files import FileService
        from mitl.controllers.virtual.service import Service

        service = Service(
            cell, FileService(tmp_path / "disk"), Dialect(generation), {"Default User": "robotics", "Admin": "robotics"}, **options
        )
        return service, another(service)

    yield made
    for cell in cells:
        cell.close()


def another(service):
    """Gives one more client with a session of its own."""
    client = Client(service)
    if service.dialect is Dialect.RWS1:
        answer, _ = login_digest(client)
        assert answer.status == 200
    else:
        assert client("GET", "/rw/panel/opmode").status == 200
    return client


@pytest.fixture
def services(make):
    """Gives a function that gives one service and client of each generation; a client that was logged out comes back."""
    known = {}

    def found(generation):
        if generation not in known:
            known[generation] = make(generation)
        service, client = known[generation]
        if client("GET", "/rw/panel/opmode").status == 401:
            known[generation] = service, another(service)
        return known[generation]

    return found
