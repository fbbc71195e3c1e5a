"""The client's session under adversity: what it survives, and what it says where it cannot."""

import gzip
import logging
import socket
import sys
import threading
from types import SimpleNamespace

import httpx
import pytest

from mitl.controllers.rws.bounded import Bounded
from mitl.controllers.rws.credentials import Credentials, find_credentials
from mitl.controllers.rws.dialects import Rws1
from mitl.controllers.rws.errors import BusyError, LoginRefusedError, MalformedAnswerError, NotAllowedError, NotFoundError, UnreachableError
from mitl.controllers.rws.transport import Transport
from mitl.errors import UsageError

from ..served import Served, dialect, remote, transport_to

SECRET = "correct horse battery staple"  # noqa: S105 - of this test


class Time:
    """A clock that only rests move; `then` happens during a rest."""

    def __init__(self):
        self.time = 0.0
        self.rests = []
        self.then = None

    def now(self):
        return self.time

    def rest(self, seconds):
        self.time += seconds
        self.rests.append(seconds)
        if self.then is not None and self.time > 1.0:
            self.then, then = None, self.then
            then()


class Raw:
    """A server that answers every connection with the same bytes, whatever is asked."""

    def __init__(self, *answers):
        self._answers = list(answers)
        self.asked = []
        self._socket = socket.create_server(("127.0.0.1", 0))
        self.address = f"http://127.0.0.1:{self._socket.getsockname()[1]}"
        threading.Thread(target=self._serve, daemon=True).start()

    def _serve(self):
        while True:
            try:
                connection, _ = self._socket.accept()
            except OSError:
                return
            with connection:
                connection.settimeout(2)
                self.asked.append(connection.recv(65536))
                connection.sendall(self._answers[min(len(self.asked), len(self._answers)) - 1])

    def close(self):
        self._socket.close()


@pytest.fixture
def raw():
    made = []

    def make(*answers):
        made.append(Raw(*answers))
        return made[-1]

    yield make
    for one in made:
        one.close()


def http(status, body=b"", kind="application/json", **headers):
    extra = "".join(f"{name}: {value}\r\n" for name, value in headers.items())
    return f"HTTP/1.1 {status} X\r\nContent-Type: {kind}\r\nContent-Length: {len(body)}\r\nConnection: close\r\n{extra}\r\n".encode() + body


DIGEST = 'Digest realm="r", nonce="n", qop="auth"'


class Plain(Rws1):
    """1.0 without introduction, to look at one request alone."""

    def introduce(self):
        return []


def transport(address, time=None, **options):
    time = time or Time()
    return Transport(address, Plain(), Credentials("u", SECRET), rate=0, rest=time.rest, now=time.now, timeout=2.0, **options)


@pytest.mark.parametrize("generation", ["1", "2", "8"])
def test_a_wrong_password_is_told_without_the_password(generation, tmp_path, caplog):
    caplog.set_level(logging.DEBUG)
    served = Served(generation, tmp_path)
    wrong = transport_to(served, credentials=Credentials("Default User", SECRET))
    with pytest.raises(LoginRefusedError, match="401") as refused:
        wrong.ask(wrong.dialect.mode())
    wrong.close()
    served.close()
    assert SECRET not in str(refused.value) + repr(wrong._credentials) + caplog.text


def test_requests_are_paced_below_20_a_second(tmp_path):
    served, time = Served("1", tmp_path), Time()
    paced = transport_to(served, rate=18.0, rest=time.rest, now=time.now)
    for _ in range(37):
        paced.ask(paced.dialect.mode())
    assert time.time >= 36 / 18
    paced.close()
    served.close()


@pytest.mark.parametrize(("status", "header"), [(503, {}), (429, {"Retry-After": "2"})])
def test_a_busy_controller_is_asked_again_and_then_given_up_with_its_own_words(raw, status, header):
    busy = http(status, b'{"_embedded":{"status":{"code":-5,"msg":"too many sessions"}}}', **header)
    good = http(200, b'{"_embedded":{"_state":[{"_type":"pnl-opmode","opmode":"AUTO"}]}}')
    time = Time()
    patient = transport(raw(busy, busy, good).address, time)
    assert patient.item(patient.dialect.mode())["opmode"] == "AUTO"
    assert sum(time.rests) >= (2 if header else 0.4)
    with pytest.raises(BusyError, match="too many sessions"):
        transport(raw(busy).address).ask(patient.dialect.mode())


def test_a_server_that_comes_back_within_patience_is_found_again(tmp_path):
    first, time = Served("1", tmp_path), Time()
    connected = transport_to(first, rest=time.rest, now=time.now)
    connected.ask(connected.dialect.mode())
    port = first.port
    first.close()
    second = []
    time.then = lambda: second.append(Served("1", tmp_path, port=port))
    assert connected.item(connected.dialect.mode())["opmode"] == "AUTO"
    assert second, "it came back only while we waited"
    connected.close()
    second[0].close()


def test_a_server_that_stays_away_is_told_with_its_address(tmp_path):
    served, time = Served("1", tmp_path), Time()
    connected = transport_to(served, rest=time.rest, now=time.now)
    served.close()
    with pytest.raises(UnreachableError, match=r"127\.0\.0\.1.*15 s"):
        connected.ask(connected.dialect.mode())
    assert time.time <= 15


def test_what_changes_something_is_not_sent_twice_where_it_may_have_arrived(raw):
    server = raw(b"")
    with pytest.raises(UnreachableError, match="not known whether it was done"):
        transport(server.address).ask(Plain().start())
    assert len(server.asked) == 1


@pytest.mark.parametrize(
    "answer",
    [
        http(200, b"{"),
        http(200, b"[1, 2]"),
        http(200, b'{"_embedded": 5, "state": "x"}'),
        http(200, b"[" * 100_000),
        http(200, b"<html>", "application/xhtml+xml"),
        http(200, b"\xff\xfe\x00", "application/xhtml+xml"),
        http(200, b'<!DOCTYPE x [<!ENTITY a "b">]><html>&a;</html>', "text/xml"),
        http(
            200,
            b'<!DOCTYPE x [<!ENTITY a SYSTEM "file:///etc/passwd">]><html><li class="a"><span class="opmode">&a;</span></li></html>',
            "text/xml",
        ),
        http(200, b'{"_embedded":{"_state":[{"_type":"pnl-opmode"}]}}'),
        http(200),
        http(200, gzip.compress(bytes(100_000_000), mtime=0), **{"Content-Encoding": "gzip"}),
        http(401, gzip.compress(bytes(1000), mtime=0), **{"Content-Encoding": "gzip", "WWW-Authenticate": DIGEST}),
        b"HTTP/1.1 banana\r\n\r\n",
        b"\x00\x01\x02",
    ],
    ids=lambda answer: answer[-30:].decode("latin-1").strip(),
)
def test_a_malformed_or_hostile_answer_is_an_error_of_ours_never_another(raw, answer):
    client = transport(raw(answer).address)
    with pytest.raises((MalformedAnswerError, UnreachableError)):
        _ = client.item(client.dialect.mode())["opmode"]


@pytest.mark.parametrize("status", [200, 401, 500])
def test_an_answer_without_an_end_is_let_go(raw, status):
    endless = http(status, bytes(50_000), **{"WWW-Authenticate": DIGEST})
    with httpx.Client(transport=Bounded(False, most=40_000), auth=httpx.DigestAuth("u", SECRET)) as client:  # noqa: SIM117 - the second fails
        with pytest.raises(MalformedAnswerError, match="more than 40000 bytes"):
            client.get(raw(endless).address)


def test_an_answer_that_drips_in_is_given_up(raw):
    clock = iter([0.0, 0.0, 61.0, 62.0, 63.0])
    with (
        httpx.Client(transport=Bounded(False, now=lambda: next(clock))) as client,
        pytest.raises(MalformedAnswerError, match="not complete"),
    ):
        client.get(raw(http(200, bytes(300_000))).address)


def test_a_refusal_of_any_form_keeps_its_status(raw):
    for body, kind in ((b"<h1>Forbidden</h1>", "text/html"), (b"{}", "application/json"), (b"", "text/plain")):
        client = transport(raw(http(403, body, kind)).address)
        with pytest.raises(NotAllowedError, match="403"):
            client.ask(client.dialect.start())


def test_mastership_held_by_another_is_told_in_the_controllers_words(tmp_path):
    with remote("1", tmp_path) as rig:
        (tmp_path / "m.mod").write_text("MODULE M\n  PERS num n := 0;\n  PROC main()\n  ENDPROC\nENDMODULE\n")
        other = transport_to(rig.clock)
        other.ask(other.dialect.take_control()[0])
        with pytest.raises(NotAllowedError, match="mastership of domain rapid is held by mitl"):
            rig.controller.load([tmp_path / "m.mod"])
        other.close()
        rig.controller.load([tmp_path / "m.mod"])
        with pytest.raises(NotFoundError, match="none"):
            rig.controller.read("none")


@pytest.mark.parametrize("generation", ["1", "2", "8"])
def test_an_expired_session_is_opened_again_and_holds_again_what_it_held(generation, tmp_path):
    with remote(generation, tmp_path) as rig:
        (tmp_path / "m.mod").write_text("MODULE M\n  PERS num n := 0;\n  PROC main()\n  ENDPROC\nENDMODULE\n")
        rig.controller.load([tmp_path / "m.mod"])
        sessions = rig.clock.service._sessions
        for session in list(sessions._open.values()):
            sessions.close(session)
        rig.controller.write("n", "5")
        assert rig.controller.read("n") == "5"


class TestCertificates:
    def test_only_the_pinned_certificate_is_talked_to_and_sees_a_password(self, tmp_path):
        served = Served("2", tmp_path)
        other = transport_to(served, fingerprint="00" * 32)
        with pytest.raises(UnreachableError, match=r"another certificate.*no password was sent"):
            other.ask(other.dialect.mode())
        assert len(served.service._sessions) == 0
        served.close()

    def test_without_a_pin_a_certificate_that_signs_itself_is_refused(self, tmp_path):
        served, time = Served("2", tmp_path), Time()
        verifying = transport_to(served, fingerprint=None, rest=time.rest, now=time.now, patience=0.5)
        with pytest.raises(UnreachableError, match="certificate"):
            verifying.ask(verifying.dialect.mode())
        served.close()


class TestCredentials:
    def test_they_come_from_the_environment_and_never_show_the_password(self):
        found = find_credentials("cell", {"MITL_RWS_USER": "me", "MITL_RWS_PASSWORD": SECRET})
        assert (found.user, found.password) == ("me", SECRET)
        assert SECRET not in repr(found)

    def test_they_come_from_the_keyring_of_this_computer_and_a_locked_one_is_told(self, monkeypatch):
        kept = {("mitl", "me@cell"): SECRET}
        errors = SimpleNamespace(KeyringError=type("KeyringError", (Exception,), {}))
        module = SimpleNamespace(errors=errors, get_password=lambda service, name: kept.get((service, name)))
        monkeypatch.setitem(sys.modules, "keyring", module)  # the package itself wants a desktop
        assert find_credentials("cell", {"MITL_RWS_USER": "me"}).password == SECRET
        with pytest.raises(UsageError, match="keyring set mitl 'you@cell'"):
            find_credentials("cell", {"MITL_RWS_USER": "you"})

        def locked(_service, _name):
            raise errors.KeyringError("it is locked")

        module.get_password = locked
        with pytest.raises(UsageError, match=r"it is locked.*MITL_RWS_PASSWORD"):
            find_credentials("cell", {})

    def test_without_any_both_ways_to_give_them_are_told(self):
        with pytest.raises(UsageError, match=r"MITL_RWS_PASSWORD.*keyring"):
            find_credentials("no-such-host.invalid", {})


def test_names_cannot_leave_their_place_in_a_path():
    for generation in ("1", "2", "8"):
        asked = dialect(generation).symbol("M/../..", "a/../../execution?action=start#")
        assert "/.." not in asked.path
        assert asked.path.count("?") == 0
