"""What a client of each generation is answered, without a network."""

import pytest
from defusedxml import ElementTree

from mitl.controllers.virtual.service import Request

from .conftest import START, Client, Clock, another, login_digest

GENERATIONS = ("1", "2", "8")


def act(client, resource, verb, form=None, query=""):
    """An action as the client's generation spells it."""
    if client.service.dialect.value == "1":
        names = {"start": "start", "load": "loadprog"}
        return client("POST", f"{resource}?action={names.get(verb, verb)}", form)
    return client("POST", f"{resource}/{verb}{query}", form)


def take_control(client):
    """Takes what the generation asks for before something may be changed."""
    if client.service.dialect.value == "8":
        station = {"control-station-name": "test", "control-station-id": "{11111111-2222-3333-4444-555555555555}", "pincode": "1"}
        assert client("POST", "/rw/controlstation/register/remote", station).status == 204
        assert client("POST", "/rw/controlstation/writeaccess/request").status == 204
        assert client("POST", "/rw/controlstation/allowmotioncontrol", {"allow-motion-control": "true"}).status == 204
    elif client.service.dialect.value == "2":
        assert client("POST", "/rw/mastership/edit/request").status == 204


def symbol(client, name):
    return (
        f"/rw/rapid/symbol/data/RAPID/T_ROB1/{name}"
        if client.service.dialect.value == "1"
        else f"/rw/rapid/symbol/RAPID/T_ROB1/{name}/data"
    )


def write(client, name, value):
    suffix = "?action=set" if client.service.dialect.value == "1" else ""
    return client("POST", symbol(client, name) + suffix, {"value": value})


@pytest.fixture(params=GENERATIONS)
def client(request, make):
    made = make(request.param)[1]
    take_control(made)
    return made


def test_a_program_runs_moves_the_arm_and_sets_its_output(client):
    assert act(client, "/rw/rapid/execution", "start", START).status == 204
    assert client.state("/rw/rapid/execution")["ctrlexecstate"] == "running"
    assert write(client, "Work/option", "1").status == 204
    client.service.cell.advance(3.0)
    joints = client.state("/rw/motionsystem/mechunits/ROB_1/jointtarget")
    assert [float(joints[f"rax_{axis}"]) for axis in range(1, 7)] == pytest.approx([20, 10, 0, 0, 40, 0], abs=0.01)
    assert client.state("/rw/iosystem/signals/doDone")["lvalue"] == "1"
    assert client.state(symbol(client, "Work/count"))["value"] == "1"
    act(client, "/rw/rapid/execution", "stop", {"stopmode": "stop"})
    client.service.cell.advance(1.0)
    assert client.state("/rw/rapid/execution")["ctrlexecstate"] == "stopped"


def test_a_program_that_has_ended_can_be_started_again(client):
    for _ in range(2):
        assert act(client, "/rw/rapid/execution", "start", START).status == 204
        write(client, "Work/option", "9")
        client.service.cell.advance(1.0)
        assert client.state("/rw/rapid/execution")["ctrlexecstate"] == "stopped"


def test_the_program_reads_an_input_that_a_client_sets(client):
    act(client, "/rw/rapid/execution", "start", START)
    client.service.cell.advance(0.2)
    signal = "/rw/iosystem/signals/Local/DRV_1/diGo"
    act(client, signal, "set" if client.service.dialect.value == "1" else "set-value", {"lvalue": "1"})
    client.service.cell.advance(0.2)
    assert client.state(symbol(client, "count"))["value"] == "50"


def test_persistent_data_keep_their_value_when_the_pointer_goes_to_main_and_variables_do_not(client):
    assert write(client, "Work/count", "7").status == 204
    assert write(client, "Work/option", "3").status == 204
    assert act(client, "/rw/rapid/execution", "resetpp").status == 204
    assert client.state(symbol(client, "Work/count"))["value"] == "7"
    assert client.state(symbol(client, "Work/option"))["value"] == "0"


def test_one_element_of_an_array_is_read_and_set(client):
    assert write(client, "Work/values%7B2%7D", "20").status == 204
    assert client.state(symbol(client, "Work/values"))["value"] == "[1,20,3]"
    assert client.state(symbol(client, "Work/values%7B2%7D"))["value"] == "20"
    assert client("GET", symbol(client, "Work/values%7B4%7D")).status == 400


def test_the_tcp_is_told_for_a_tool_of_the_program(client):
    place = "/rw/motionsystem/mechunits/ROB_1/robtarget?tool={}&wobj=wobj0&coordinate=Base"
    bare, long = client.state(place.format("tool0")), client.state(place.format("tLong"))
    distance = sum((float(bare[axis]) - float(long[axis])) ** 2 for axis in "xyz") ** 0.5
    assert distance == pytest.approx(100.0, abs=1e-6)
    assert list(bare)[2:13] == ["x", "y", "z", "q1", "q2", "q3", "q4", "cf1", "cf4", "cf6", "cfx"]
    assert client("GET", place.format("noTool")).status == 400


def test_modules_are_loaded_listed_and_unloaded(client):
    text = b"MODULE Extra\n  PERS num more := 5;\nENDMODULE\n"
    home = "$HOME" if client.service.dialect.value == "1" else "HOME"
    assert client("PUT", f"/fileservice/{home}/extra.mod", body=text).status == 201
    task = "/rw/rapid/tasks/T_ROB1"
    assert act(client, task, "loadmod", {"modulepath": f"{home}/extra.mod", "replace": "true"}).status in (201, 204)
    listing = "/rw/rapid/modules?task=T_ROB1" if client.service.dialect.value == "1" else f"{task}/modules"
    assert b"Extra" in client("GET", listing).body
    assert client.state(symbol(client, "Extra/more"))["value"] == "5"
    assert act(client, task, "unloadmod", {"module": "Extra"}).status == 204
    assert b"Extra" not in client("GET", listing).body


def test_a_module_with_errors_is_refused_and_the_event_log_says_where(client):
    client("PUT", "/fileservice/HOME/bad.mod", body=b"MODULE Bad\n  PROC x()\n    a := ;\n  ENDPROC\nENDMODULE\n")
    assert act(client, "/rw/rapid/tasks/T_ROB1", "loadmod", {"modulepath": "HOME/bad.mod"}).status == 400
    entry = client.state("/rw/elog/0?lang=en")
    assert entry["msgtype"] == "3"
    assert "bad.mod:3" in entry["desc"]


@pytest.mark.parametrize(
    ("method", "target", "form", "status", "code"),
    [
        ("GET", "/rw/iosystem/signals/doNone", None, 404, -1073445866),
        ("GET", "/fileservice/HOME/none.mod", None, 404, -1073414146),
        ("GET", "/rw/nothing", None, 404, -1073445884),
        ("DELETE", "/rw/panel/opmode", None, 405, -1073445880),
        ("GET", "/rw/motionsystem/mechunits/ROB_9/jointtarget", None, 404, -1073414146),
    ],
)
def test_refusals_carry_the_status_and_code_of_a_real_controller(client, method, target, form, status, code):
    assert client(method, target, form).status == status
    assert client.code() == code


def test_refusals_of_actions_carry_the_status_and_code_of_a_real_controller(client):
    task, execution = "/rw/rapid/tasks/T_ROB1", "/rw/rapid/execution"
    one = client.service.dialect.value == "1"
    expected = [
        ((task, "loadmod", {"modulepath": "$HOME/none.mod"}), 400, -1073438708),
        ((task, "unloadmod", {"module": "None"}), 400, -1073442816),
        ((execution, "start", {**START, "cycle": "twice"}), 400, -1073445879),
        ((execution, "start", {"cycle": "once"}), 400, -1073445879),
    ]
    for (resource, verb, form), status, code in expected:
        assert (act(client, resource, verb, form).status, client.code()) == (status, code)
    assert client("GET", symbol(client, "Work/none")).status == (400 if one else 404)
    assert client.code() == -1073414146
    client("POST", "/rw/panel/ctrlstate?action=setctrlstate" if one else "/rw/panel/ctrl-state", {"ctrl-state": "motoroff"})
    assert act(client, execution, "start", START).status == 400
    assert client.code() == -1073442809


def test_a_constant_cannot_be_set_nor_data_to_a_wrong_value(client):
    assert write(client, "Work/fixed", "5").status == 403
    assert write(client, "Work/count", "TRUE").status == 400
    assert "count" in client.last.body.decode()


def test_xhtml_has_class_first_and_lies_on_one_line(client):
    target = "/rw/panel/opmode"
    page = client.service.respond(
        Request("GET", target, {"host": "cell", "cookie": client.cookie, "accept": "application/xhtml+xml;v=2.0"})
    )
    text = page.body.decode()
    assert '<li class="pnl-opmode" title="opmode"><span class="opmode">AUTO</span></li>' in text
    assert "\n" not in text
    assert ElementTree.fromstring(page.body).tag.endswith("html")


def test_leaving_automatic_stops_the_program_and_nothing_starts_in_manual(make):
    service, client = make("2")
    take_control(client)
    act(client, "/rw/rapid/execution", "start", START)
    assert client("POST", "/rw/panel/opmode", {"opmode": "man"}).status == 204
    service.cell.advance(1.0)
    assert client.state("/rw/rapid/execution")["ctrlexecstate"] == "stopped"
    assert client.state("/rw/panel/ctrl-state")["ctrlstate"] == "motoroff"
    assert client("POST", "/rw/panel/ctrl-state", {"ctrl-state": "motoron"}).status == 403
    assert act(client, "/rw/rapid/execution", "start", START).status == 400


def test_an_emergency_stop_holds_until_it_is_released(make):
    service, client = make("2")
    act(client, "/rw/rapid/execution", "start", START)
    assert client("POST", "/rw/panel/emergency-stop", {"state": "off"}).status == 204
    service.cell.advance(1.0)
    assert client.state("/rw/panel/ctrl-state")["ctrlstate"] == "emergencystop"
    assert client.state("/rw/rapid/execution")["ctrlexecstate"] == "stopped"
    assert client("POST", "/rw/panel/ctrl-state", {"ctrl-state": "motoron"}).status == 403
    client("POST", "/rw/panel/emergency-stop", {"state": "on"})
    assert client("POST", "/rw/panel/ctrl-state", {"ctrl-state": "motoron"}).status == 204


class TestMastership:
    def test_in_1_0_a_free_domain_is_taken_for_the_call_and_a_held_one_refuses_others(self, make):
        service, first = make("1")
        second = another(service)
        assert write(second, "Work/count", "1").status == 204
        assert first("POST", "/rw/mastership/rapid?action=request").status == 204
        assert write(second, "Work/count", "2").status == 403
        assert second.code() == -1073445862
        assert act(second, "/rw/rapid/execution", "start", START).status == 403
        assert act(second, "/rw/rapid/execution", "stop").status == 204, "everybody may stop"
        assert first("GET", "/logout").status == 204
        assert write(second, "Work/count", "3").status == 204

    def test_in_2_0_it_must_be_held_or_asked_for_in_the_call(self, make):
        service, first = make("2")
        second = another(service)
        target = "/rw/rapid/symbol/RAPID/T_ROB1/Work/count/data"
        assert first("POST", target, {"value": "1"}).status == 403
        assert first("POST", target + "?mastership=implicit", {"value": "1"}).status == 204
        assert second("POST", "/rw/mastership/edit/request").status == 204
        assert first("POST", target + "?mastership=implicit", {"value": "1"}).status == 403
        assert first("POST", "/rw/mastership/edit/request").status == 403
        assert second("GET", "/rw/mastership/edit").status == 200

    def test_with_robotware_8_only_a_registered_control_station_may_write_and_a_lost_session_keeps_its_access(self, make):
        service, first = make("8")
        second = another(service)
        target = "/rw/rapid/symbol/RAPID/T_ROB1/Work/count/data"
        assert first("POST", "/rw/mastership/edit/request").status == 410
        assert first("POST", "/rw/controlstation/writeaccess/request").status == 403
        assert first.code() == -1073435871
        bad = {"control-station-name": "x", "control-station-id": "11111111-2222-3333-4444-555555555555", "pincode": "1"}
        assert first("POST", "/rw/controlstation/register/remote", bad).status == 403
        assert first.code() == -1073435870
        take_control(first)
        assert first("POST", target, {"value": "1"}).status == 204
        assert second("POST", target, {"value": "1"}).status == 403
        first("GET", "/logout")
        assert second.state("/rw/controlstation/writeaccess/status")["held-by-control-station-name"] == "test"


class TestSessions:
    @pytest.mark.parametrize("generation", GENERATIONS)
    def test_a_wrong_password_or_user_never_comes_in(self, make, generation):
        service, _ = make(generation)
        for user, password in (("Default User", "wrong"), ("Default User", ""), ("nobody", "robotics"), ("", "")):
            stranger = Client(service, user, password)
            answer = login_digest(stranger)[0] if generation == "1" else stranger("GET", "/rw/panel/opmode")
            assert answer.status == 401
            assert not answer.cookies
            assert "robotics" not in answer.body.decode()

    def test_a_digest_answer_cannot_be_replayed_and_a_foreign_nonce_is_called_stale(self, make):
        service, _ = make("1")
        _, header = login_digest(Client(service))
        again = service.respond(Request("GET", "/rw/panel/opmode?json=1", {"authorization": header}))
        assert again.status == 401
        foreign = service.respond(Request("GET", "/rw/panel/opmode?json=1", {"authorization": header.replace('nonce="', 'nonce="00')}))
        assert 'stale="TRUE"' in foreign.headers["WWW-Authenticate"]

    def test_a_made_up_cookie_opens_nothing(self, make):
        service, client = make("2")
        assert service.respond(Request("GET", "/rw/panel/opmode", {"cookie": "ABBCX=0; -http-session-=0"})).status == 401
        assert client("GET", "/rw/panel/opmode").status == 200

    def test_idle_sessions_end_with_what_they_held(self, make):
        clock = Clock()
        service, client = make("2", now=clock)
        take_control(client)
        clock.time += 301
        second = another(service)
        assert second("POST", "/rw/mastership/edit/request").status == 204
        assert client("GET", "/rw/panel/opmode").status == 401, "the cookie is worth nothing any more"

    def test_a_session_does_not_outlive_25_minutes_however_busy(self, make):
        clock = Clock()
        _, client = make("2", now=clock)
        statuses = []
        for _ in range(16):
            clock.time += 100
            statuses.append(client("GET", "/rw/panel/opmode").status)
        assert statuses == [200] * 15 + [401]

    def test_the_71st_session_is_refused_with_503(self, make):
        service, _ = make("2")
        for _ in range(69):
            another(service)
        assert Client(service)("GET", "/rw/panel/opmode").status == 503

    def test_too_many_requests_are_refused_where_a_limit_is_set(self, make):
        clock = Clock()
        _, client = make("2", now=clock, rate=20.0)
        statuses = [client("GET", "/rw/panel/opmode").status for _ in range(25)]
        assert statuses[:19] == [200] * 19
        assert statuses[-1] == 503
        clock.time += 1.0
        assert client("GET", "/rw/panel/opmode").status == 200


class TestMediaTypes:
    def test_json_of_1_0_has_no_charset(self, make):
        _, client = make("1")
        assert client("GET", "/rw/panel/opmode").headers["Content-Type"] == "application/json"

    def test_2_0_wants_its_version_in_every_form_and_every_accept(self, make):
        _, client = make("2")
        assert client("POST", "/rw/rapid/execution/stop", **{"content-type": "application/x-www-form-urlencoded"}).status == 415
        assert client("GET", "/rw/panel/opmode", accept="application/json").status == 406
        assert client("PUT", "/fileservice/HOME/x", body=b"x", **{"content-type": "text/plain"}).status == 415

    def test_an_upload_without_a_body_to_answer_still_has_a_content_type(self, make):
        _, client = make("1")
        answer = client("PUT", "/fileservice/$home/a.txt", body=b"hello")
        assert (answer.status, answer.body) == (201, b"")
        assert "Content-Type" in answer.headers


class TestSubscriptions:
    RESOURCES = ("/rw/rapid/execution;ctrlexecstate", "/rw/iosystem/signals/doDone;state")

    @pytest.mark.parametrize(
        "form",
        [
            [("resources", "1"), ("resources", "2"), ("1", RESOURCES[0]), ("1-p", "1"), ("2", RESOURCES[1]), ("2-p", "2")],
            [("resources", "0"), ("0", RESOURCES[0]), ("0-p", "1"), ("resources", "1"), ("1", RESOURCES[1]), ("1-p", "2")],
            [("resources", "2"), ("1", RESOURCES[0]), ("1-p", "1"), ("2", RESOURCES[1]), ("2-p", "2")],
        ],
    )
    def test_three_ways_to_write_the_form_are_understood(self, make, form):
        service, client = make("1")
        answer = client("POST", "/subscription", form)
        assert answer.status == 201
        assert answer.headers["Location"] == "ws://cell/poll/1"
        assert b'<a href="ws://cell/poll/1" rel="self">' in answer.body
        group = service.subscriptions.find("1", next(iter(service.subscriptions._groups.values())).session)
        service.subscriptions.connect(group)
        texts = [text for _, text in service.subscriptions.events()]
        assert len(texts) == 2, "the current values come first"
        assert 'class="rap-ctrlexecstate-ev"' in texts[0]
        assert all("\n" not in text for text in texts)

    def test_a_change_is_told_once(self, make):
        clock = Clock()
        service, client = make("1", now=clock)
        address = "/rw/rapid/symbol/data/RAPID/T_ROB1/Work/count;value"
        client("POST", "/subscription", {"resources": "1", "1": address, "1-p": "2"})
        (group,) = service.subscriptions._groups.values()
        service.subscriptions.connect(group)
        assert len(list(service.subscriptions.events())) == 1
        assert list(service.subscriptions.events()) == []
        write(client, "Work/count", "5")
        ((_, text),) = service.subscriptions.events()
        assert f'<a href="{address}" rel="self">' in text
        assert '<span class="value">5</span>' in text

    def test_what_is_not_there_cannot_be_subscribed_to(self, make):
        _, client = make("1")
        for address in ("/rw/iosystem/signals/doNone;state", "/rw/none", "/rw/rapid/symbol/data/RAPID/T_ROB1/none;value"):
            assert client("POST", "/subscription", {"resources": "1", "1": address, "1-p": "1"}).status in (400, 404)

    def test_a_websocket_needs_the_session_and_the_generations_subprotocol(self, make):
        service, client = make("2")
        client("POST", "/subscription", {"resources": "1", "1": "/rw/panel/opmode", "1-p": "1"})
        other = another(service)
        headers = {"cookie": client.cookie, "sec-websocket-protocol": "rws_subscription"}
        assert service.websocket(Request("GET", "/poll/1", headers)).number == 1
        assert service.websocket(Request("GET", "/poll/1", {**headers, "sec-websocket-protocol": "robapi2_subscription"})).status == 400
        assert service.websocket(Request("GET", "/poll/1", {**headers, "cookie": other.cookie})).status == 404
        assert service.websocket(Request("GET", "/poll/1", {"sec-websocket-protocol": "rws_subscription"})).status == 401


def test_a_fault_of_the_service_is_answered_and_told(make, caplog):
    service, client = make("1")
    service.cell.model = None
    assert client("GET", "/rw/motionsystem/mechunits/ROB_1").status == 500
    assert "AttributeError" in caplog.text
