"""Motion parameters from a controller's log: recovered from logs that our own planner made with other ones, noise and another clock."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import rapid_interp
from mitl.cli import main
from mitl.errors import UsageError
from mitl.motion.accuracy import Kind, load_accuracy
from mitl.motion.fit import JointLog, fit_motion, held_out, parameters_of, with_factors
from mitl.motion.fit_residuals import residual_bands
from mitl.motion.fit_trust import Misfit
from mitl.motion.offline import run_until, start_run
from mitl.motion.record import View
from mitl.motion.robot_model import load_robot_model
from mitl.recording.joint_log import read_joint_log

TRUE = {"report window J1": 1.15, "path lag": 0.9, "acceleration": 0.85, "fine-point pause": 1.3}
NOISE_DEG, CLOCK, RATE = 0.002, 12.3456, 100.0


def log_of(program, model, clock=CLOCK):
    run = start_run(program.start().run(), model)
    run_until(run, 60.0)
    time = np.arange(-0.5, run.record.end + 0.5, 1 / RATE)
    noise = np.radians(np.random.default_rng(7).normal(0, NOISE_DEG, (len(time), 6)))
    return JointLog("log", time + clock, run.record.joints(time, View.CONTROLLER) + noise, program)


@pytest.fixture(scope="module")
def program(rapid):
    moves = [rapid.joint(450, 0, 400, speed="v1000")]
    for _ in range(3):
        moves += [rapid.line(450, 150, 400, zone="z20", speed="v500"), rapid.line(350, 150, 450, speed="v500")]
        moves += [rapid.line(400, -100, 400, speed="v1000"), rapid.joint(450, 0, 400, speed="v1000")]
    return rapid.program(*moves)


@pytest.fixture(scope="module")
def fitted(program):
    base = load_robot_model("irb140")
    parameters = [parameter for parameter in parameters_of(base) if parameter.name in TRUE]  # all of them take four times as long
    truth = with_factors(base, parameters, np.array([TRUE[parameter.name] for parameter in parameters]))
    log = log_of(rapid_interp.load_text(program, "m.mod"), truth)
    return truth, log, fit_motion([log], base, parameters=parameters)


def test_the_parameters_of_another_arm_are_recovered_from_its_log(fitted):
    truth, _, fit = fitted
    by_name = {found.parameter.name: found for found in fit.parameters}
    for name, factor in TRUE.items():
        if by_name[name].told:
            assert by_name[name].factor == pytest.approx(factor, abs=0.05), name
    assert by_name["acceleration"].told
    assert by_name["fine-point pause"].told
    assert fit.model.tcp_acceleration == pytest.approx(truth.tcp_acceleration, rel=0.02)
    assert fit.model.fine_pause == pytest.approx(truth.fine_pause, abs=2e-3)
    assert fit.offsets[0] == pytest.approx(CLOCK, abs=3e-3)
    assert np.degrees(fit.rms) < 2 * NOISE_DEG


def test_the_residuals_are_those_of_moves_that_were_held_out(fitted):
    _, log, fit = fitted
    out = held_out(fit.runs[0])
    assert 0 < out.sum() < len(out) / 2
    bands = residual_bands(fit, [log])
    assert {Kind.LINE, Kind.JOINT} <= {band.kind for band in bands}
    assert max(band.path for band in bands) < 0.3e-3
    assert max(band.time for band in bands if band.kind is Kind.LINE) < 4e-3


def test_the_command_writes_a_model_that_can_be_used(program, tmp_path, monkeypatch, capsys, fitted):
    monkeypatch.chdir(tmp_path)
    _, log, fit = fitted
    monkeypatch.setattr("mitl.motion.fit.fit_motion", lambda *_: fit)  # fitted once is enough for these tests
    Path("m.mod").write_text(program, encoding="utf-8")
    header = ",".join(["t_s", *(f"j{axis}_deg" for axis in range(1, 7))])
    np.savetxt("log.csv", np.column_stack([log.time, np.degrees(log.joints)]), delimiter=",", header=header, comments="", fmt="%.9f")
    with pytest.raises(SystemExit) as done:
        main(["fit-motion", "log.csv", "--program", "m.mod", "--output", "mine", "--format", "json"])
    assert done.value.code in (0, None)
    assert json.loads(capsys.readouterr().out)["residuals"]
    model = load_robot_model("./mine")
    assert model.tcp_acceleration == pytest.approx(fit.model.tcp_acceleration, rel=1e-5)
    assert model.controller_windows == pytest.approx(fit.model.controller_windows, rel=1e-5)
    assert any(band.kind is Kind.LINE for band in load_accuracy(model.folder).bands)


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("a,b\n1,2\n", "expected a header with t_s or time_s or time"),
        ("t_s,j1,j2,j3,j4,j5,j6\n" + "1,0,0,0,0,0,0\n" * 60, "sample 2: time must increase"),
        ("t_s,j1,j2,j3,j4,j5,j6\n1,0,0,0,0,0,0\n", "1 samples of the axes are too few"),
        ("t_s,j1,j2,j3,j4,j5,j6\n1,0,0,x,0,0,0\n", "row 2: expected numbers"),
    ],
)
def test_what_a_log_lacks_is_told(tmp_path, text, told):
    (tmp_path / "log.csv").write_text(text, encoding="utf-8")
    with pytest.raises(UsageError, match=told):
        read_joint_log(tmp_path / "log.csv")


def test_a_log_without_motion_is_refused(program):
    base = load_robot_model("irb140")
    still = JointLog("still.csv", np.arange(100) / RATE, np.zeros((100, 6)), rapid_interp.load_text(program, "m.mod"))
    with pytest.raises(UsageError, match=r"still.csv: the arm stands still all along"):
        fit_motion([still], base)


def test_a_log_that_the_model_explains_is_trusted_and_its_noise_is_known(fitted):
    _, _, fit = fitted
    assert fit.misfit.trusted
    assert np.degrees(fit.misfit.noise) == pytest.approx(NOISE_DEG, rel=0.15)
    assert fit.misfit.held_out < 2 * fit.misfit.noise
    assert fit.misfit.moves + held_out(fit.runs[0]).sum() == len(fit.runs[0].record.moves)


def test_an_arm_that_the_model_does_not_describe_widens_the_uncertainties_and_is_warned_of(program, fitted, tmp_path, monkeypatch, capsys):
    _, log, fit = fitted
    swaying = np.radians(0.1) * np.sin(2 * np.pi * 1.3 * log.time)  # of a base that is not bolted down, say
    parameter = next(parameter for parameter in parameters_of(load_robot_model("irb140")) if parameter.name == "acceleration")
    bad = fit_motion([replace(log, joints=log.joints + swaying[:, None])], load_robot_model("irb140"), parameters=[parameter])
    assert not bad.misfit.trusted
    assert bad.misfit.held_out > 10 * bad.misfit.noise
    alone = np.sqrt(bad.misfit.seconds / (0.1 * bad.misfit.moves))
    assert bad.misfit.widening == pytest.approx(alone * max(bad.misfit.held_out / bad.misfit.fitted, 1), rel=1e-9)
    assert bad.misfit.widening > 1.5
    good = next(found for found in fit.parameters if found.parameter.name == "acceleration")
    assert bad.parameters[0].sigma > 5 * good.sigma
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("mitl.motion.fit.fit_motion", lambda *_: bad)
    Path("m.mod").write_text(program, encoding="utf-8")
    header = ",".join(["t_s", *(f"j{axis}_deg" for axis in range(1, 7))])
    np.savetxt("log.csv", np.column_stack([log.time, np.degrees(log.joints)]), delimiter=",", header=header, comments="", fmt="%.9f")
    with pytest.raises(SystemExit):
        main(["fit-motion", "log.csv", "--program", "m.mod", "--format", "json"])
    told = capsys.readouterr()
    assert "no measurements" in told.err
    assert json.loads(told.out)["trusted"] is False


def test_moves_held_out_that_are_explained_worse_widen_the_uncertainties():
    assert Misfit(noise=1e-4, fitted=1e-4, held_out=2e-4, moves=10, seconds=20).widening == 2
    assert Misfit(noise=1e-4, fitted=1e-3, held_out=1e-3, moves=10, seconds=40).widening == pytest.approx(np.sqrt(40))
    assert Misfit(noise=0, fitted=0, held_out=0, moves=0, seconds=0).widening == 1
