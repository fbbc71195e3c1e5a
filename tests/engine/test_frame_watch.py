"""A case whose tracker frame moved could not be judged: it is ERROR, whatever its checks say, and says so."""

import pytest

CASE = """
@case("line/far", title="Far", purpose="Try.", program="line.mod")
def test_far(bench, check):
    run = bench.run(2)
    far = run.tool.position[:, 1].max()
    check("far end", value=1e3 * (far - .3), limit=3.0, uncertainty=.3)
    with check.subtest("a part"):
        check("far end again", value=1e3 * (far - .3), limit=3.0, uncertainty=.3)
"""


def only(cases):
    (found,) = cases.results()["cases"]
    return found


@pytest.mark.parametrize("robot", [(), ("--mitl-fault=offset=8",)])
def test_a_frame_that_jumps_during_a_case_makes_it_an_error_and_no_fail(cases, robot):
    cases(CASE, "--mitl-fault=frame-jump=2", *robot).assert_outcomes(failed=1)
    found = only(cases)
    assert found["outcome"] == cases.results()["outcome"] == "error"
    assert {check["outcome"] for check in found["checks"]} == {"error"}
    assert any("could not be judged: the tracker's frame moved during the case" in message["text"] for message in found["messages"])
    assert any("13." in message["text"] for message in found["messages"]), "the jump of 13.6 mm is told"


def test_a_frame_that_moved_before_the_case_keeps_it_from_running(cases):
    cases(CASE, "--mitl-fault=frame-jump=0").assert_outcomes(errors=1)
    found = only(cases)
    assert found["outcome"] == "error"
    assert not found["checks"]
    assert "not where it was calibrated" in found["messages"][0]["text"]
    assert "calibrate again" in found["messages"][0]["text"]


def test_a_frame_that_stays_is_said_to_have_stayed(cases):
    cases(CASE).assert_outcomes(passed=1)
    assert any("the tracker's frame stayed" in message["text"] for message in only(cases)["messages"])


def test_a_robot_that_is_wrong_is_no_moved_frame(cases):
    cases(CASE, "--mitl-fault=offset=8").assert_outcomes(failed=1)
    assert only(cases)["outcome"] == "fail"


NO_RUN = """
@case("line/none", title="None", purpose="Try.", program="line.mod")
def test_none(bench, check, mitl_rig):
    check("one", value=1, limit=2, uncertainty=.1)
    bench.clock.wait({wait})
"""


def test_without_a_reference_the_robot_goes_to_calibration_poses_again(cases):
    cases(NO_RUN.format(wait=0), "--mitl-fault=no-reference").assert_outcomes(passed=1)
    assert any("calibration poses are off" in message["text"] for message in only(cases)["messages"])
    cases(NO_RUN.format(wait=20), "--mitl-fault=no-reference", "--mitl-fault=frame-jump=20").assert_outcomes(failed=1)
    assert only(cases)["outcome"] == "error"


def test_a_tracker_that_is_lost_at_the_end_could_not_be_verified(cases):
    body = NO_RUN.format(wait=0) + "    mitl_rig.devices['reference'].lost = True\n"
    cases(body).assert_outcomes(failed=1)
    assert only(cases)["outcome"] == "error"
    assert any("could not be verified" in message["text"] for message in only(cases)["messages"])


TWO = """
frames = []

@case("line/first", title="First", purpose="Try.", program="line.mod")
def test_first(bench, check, mitl_rig, mitl_calibration):
    frames.append(mitl_calibration)
    object.__setattr__(mitl_rig, "frame", lambda: 1)  # the tracker's software was restarted
    check("x", value=1.0, limit=3.0, uncertainty=.3)

@case("line/second", title="Second", purpose="Try.", program="line.mod")
def test_second(bench, check, mitl_calibration):
    frames.append(mitl_calibration)
    check("calibrations", value=len(set(map(id, frames))), limit=2, uncertainty=0, at_least=True)

@case("line/third", title="Third", purpose="Try.", program="line.mod")
def test_third(bench, check, mitl_calibration):
    check("calibrations", value=len({id(mitl_calibration), *map(id, frames)}), limit=2, uncertainty=0)
"""


def test_a_new_frame_of_the_tracker_is_calibrated_once_before_the_next_case(cases):
    cases(TWO).assert_outcomes(passed=3)
