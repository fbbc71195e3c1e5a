"""pytest plug-in: options, fixtures and hooks of mitl. docs/event_order.md gives the order of events.

It is loaded in every pytest run of whoever has mitl installed: it imports nothing heavy before a test asks for it, and leaves other
people's tests alone.
"""

from __future__ import annotations

from collections.abc import Generator, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from mitl.pytest_options import HookSpecifications, add_options

if TYPE_CHECKING:
    from mitl.engine.bench import Bench
    from mitl.engine.calibration_session import SessionCalibration
    from mitl.engine.case import CaseInfo
    from mitl.engine.check import Check
    from mitl.engine.recorder import CaseRecorder
    from mitl.engine.run import RunKeeper
    from mitl.protocols import Rig

_MARK = "mitl_case"
_RECORDER: pytest.StashKey[CaseRecorder] = pytest.StashKey()
_KEEPER: pytest.StashKey[RunKeeper] = pytest.StashKey()
_CURRENT: pytest.StashKey[CaseRecorder] = pytest.StashKey()
_CALIBRATION: pytest.StashKey[tuple[int, SessionCalibration] | None] = pytest.StashKey()
_RIG: pytest.StashKey[Rig | Exception] = pytest.StashKey()


def pytest_addhooks(pluginmanager: pytest.PytestPluginManager) -> None:
    """Offers the hook."""
    pluginmanager.add_hookspecs(HookSpecifications)


def pytest_addoption(parser: pytest.Parser) -> None:
    """Adds the options --mitl-..."""
    add_options(parser)


def pytest_configure(config: pytest.Config) -> None:
    """Registers the mark that @case sets, and the collecting of finished cases, which is not for pytest-xdist's workers."""
    config.addinivalue_line("markers", f"{_MARK}(info): set by mitl.engine.case, which declares a test case")
    if not _is_worker(config):
        config.pluginmanager.register(_Collecting(config), "mitl-collecting")


# --- collection --------------------------------------------------------------------------------------------------------------------


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Refuses ids that occur twice, keeps what --mitl-case asks for, and puts it into that order where --mitl-in-order says so."""
    infos = {item: info for item in items if (info := _info(item)) is not None}
    wanted: list[str] = config.getoption("mitl_case")
    if infos:
        from mitl.engine.selection import place, refuse_used_twice, select  # noqa: PLC0415 - only where there are cases
        from mitl.errors import UsageError  # noqa: PLC0415

        try:
            refuse_used_twice((info.id, item.nodeid) for item, info in infos.items())
            chosen = select(list(infos.values()), wanted, long=config.getoption("mitl_long"))
            done = _keeper(config).known() if config.getoption("mitl_resume") else frozenset()
        except UsageError as error:
            raise pytest.UsageError(str(error)) from error
        chosen -= done
        left_out = [item for item in items if (infos[item].id not in chosen if item in infos else bool(wanted))]
        items[:] = [item for item in items if item not in left_out]
        if config.getoption("mitl_in_order"):
            items.sort(key=lambda item: place(infos[item].id, wanted) if item in infos else len(wanted))
        config.hook.pytest_deselected(items=left_out)


@pytest.hookimpl(tryfirst=True)
def pytest_runtestloop(session: pytest.Session) -> None:
    """Loads the rig and opens the run's folder before the first test, so that a wrong option is told before anything moves."""
    config = session.config
    planned = [info for item in session.items if (info := _info(item)) is not None]
    shares_out = config.pluginmanager.hasplugin("dsession")
    if config.option.collectonly or not (planned or (shares_out and config.getoption("mitl_out"))):
        return
    from mitl.errors import UsageError  # noqa: PLC0415 - not in other people's runs
    from mitl.metrics.sequential import POCOCK  # noqa: PLC0415

    repeats: int = config.getoption("mitl_repeats")
    if not 1 <= repeats <= len(POCOCK):
        raise pytest.UsageError(f"--mitl-repeats={repeats}: expected 1 to {len(POCOCK)}")
    (keeper := _keeper(config)).planned.extend(planned)
    try:
        if not shares_out:
            _load_rig(config)
        keeper.open_folder()
        if not _is_worker(config):
            keeper.save()
    except UsageError as error:
        raise pytest.UsageError(str(error)) from error
    if keeper.unwritten:
        raise pytest.UsageError(keeper.unwritten)


# --- fixtures ----------------------------------------------------------------------------------------------------------------------


@pytest.fixture(scope="session")
def mitl_rig(pytestconfig: pytest.Config) -> Iterator[Rig]:
    """The rig of the whole run."""
    if isinstance(loaded := _load_rig(pytestconfig), Exception):
        raise loaded
    yield loaded
    try:
        loaded.controller.stop()
    finally:
        loaded.close()


@pytest.fixture
def mitl_calibration(request: pytest.FixtureRequest, mitl_rig: Rig, pytestconfig: pytest.Config) -> SessionCalibration:
    """The calibration of this session; the first case that needs it drives the procedure, and the next after the frame has moved again."""
    given: SessionCalibration | None = pytestconfig.hook.pytest_mitl_calibration(rig=mitl_rig, case_id=_recorder(request.node).info.id)
    if given is not None:
        _keeper(pytestconfig).keep_calibration(given)
        return given
    known, frame = pytestconfig.stash.get(_CALIBRATION, None), mitl_rig.frame()
    if known is not None and known[0] == frame:
        return known[1]
    from mitl.engine.calibration_session import calibrate_rig, calibration_program  # noqa: PLC0415

    found = calibrate_rig(mitl_rig, calibration_program(mitl_rig, pytestconfig.getoption("mitl_calibration")))
    _keeper(pytestconfig).keep_calibration(found)
    pytestconfig.stash[_CALIBRATION] = (frame, found)
    return found


@pytest.fixture
def rig(request: pytest.FixtureRequest, mitl_rig: Rig) -> Iterator[Rig]:
    """The rig, seeded for this case; the robot is stopped afterwards."""
    from mitl.engine.reel import reel_of  # noqa: PLC0415

    if {"bench", "mitl_calibration"} & set(request.fixturenames):
        request.getfixturevalue("mitl_calibration")  # before begin_case, so that it does not disturb the case's numbers
    recorder = _recorder(request.node)
    mitl_rig.begin_case(recorder.info.id)
    recorder.stop_robot = mitl_rig.controller.stop
    if sick := _keeper(request.config).health:
        recorder.say("warning", f"the rig may be sick: {sick}")
    reel = reel_of(mitl_rig, recorder, keep=_keeper(request.config).folder is not None)
    reel.begin(repeats=request.config.getoption("mitl_repeats"))
    yield reel.rig
    reel.end()
    mitl_rig.controller.stop()


@pytest.fixture
def bench(request: pytest.FixtureRequest, rig: Rig, mitl_calibration: SessionCalibration) -> Iterator[Bench]:
    """What a case works with: runs its program, tracks it, brings it into the work object."""
    from mitl.engine.bench import Bench  # noqa: PLC0415
    from mitl.engine.calibration_session import calibration_program  # noqa: PLC0415
    from mitl.engine.frame_watch import frame_watch, refuse_if_moved, tell_age, void_if_moved  # noqa: PLC0415
    from mitl.engine.replaying import keep_session  # noqa: PLC0415
    from mitl.errors import MitlError  # noqa: PLC0415

    session, recorder = mitl_calibration, _recorder(request.node)
    keep_session(recorder.tape, session)
    tell_age(session.calibration, recorder)
    watch = frame_watch(rig, session, calibration_program(rig, request.config.getoption("mitl_calibration")))
    try:
        before = refuse_if_moved(watch)
    except MitlError:
        request.config.stash[_CALIBRATION] = None
        raise
    recorder.closing.append(lambda: void_if_moved(watch, before, recorder))
    made = Bench(rig, session.calibration, session.poses, recorder, calibrated_at=session.measured_at)
    yield made
    made.close()
    if recorder.voided:
        request.config.stash[_CALIBRATION] = None  # what moved the frame may have moved it for good: the next case calibrates


@pytest.fixture
def check(request: pytest.FixtureRequest) -> Check:
    """The way to a verdict, e.g. `check("line deviation", value=1.2, limit=5.0, uncertainty=0.4, unit="mm")`."""
    from mitl.engine.check import Check  # noqa: PLC0415

    return Check(_recorder(request.node))


# --- one case ----------------------------------------------------------------------------------------------------------------------


@pytest.hookimpl(wrapper=True)
def pytest_runtest_setup(item: pytest.Item) -> Generator[None, Any, Any]:
    """Begins a case; what goes wrong before it starts is its error too."""
    __tracebackhide__ = True
    if _info(item) is not None:
        _recorder(item)
    try:
        return (yield)
    except BaseException as error:
        _note(item, error, "setup")
        raise


@pytest.hookimpl(wrapper=True)
def pytest_runtest_call(item: pytest.Item) -> Generator[None, Any, Any]:
    """Turns the outcome of a case that ran to its end into pytest's terms."""
    __tracebackhide__ = True
    try:
        result = yield
    except BaseException as error:
        _note(item, error, "call")
        raise
    finally:
        recorder = item.stash.get(_RECORDER, None)
        if recorder is not None:
            recorder.end_measuring()
    if recorder is not None:
        from mitl.engine import endings  # noqa: PLC0415 - loaded already, because there is a recorder

        endings.tell_pytest(recorder)
    return result


@pytest.hookimpl(tryfirst=True)
def pytest_pyfunc_call(pyfuncitem: pytest.Function) -> bool | None:
    """Runs a declared case, again while it is inconclusive and averaging may decide it; leaves other tests to pytest."""
    __tracebackhide__ = True
    if _info(pyfuncitem) is None:
        return None
    recorder = _recorder(pyfuncitem)
    recorder.most_looks = pyfuncitem.config.getoption("mitl_repeats")
    arguments = {name: pyfuncitem.funcargs[name] for name in pyfuncitem._fixtureinfo.argnames}  # as pytest's own hook does
    pyfuncitem.obj(**arguments)
    while recorder.next_round():
        pyfuncitem.obj(**arguments)
    return True


@pytest.hookimpl(wrapper=True)
def pytest_runtest_teardown(item: pytest.Item) -> Generator[None, Any, Any]:
    """Writes the case's recording when everything has stopped."""
    __tracebackhide__ = True
    try:
        return (yield)
    except BaseException as error:
        _note(item, error, "teardown")
        raise
    finally:
        recorder = item.stash.get(_RECORDER, None)
        if recorder is not None:
            _keeper(item.config).keep_recording(recorder)


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(item: pytest.Item, call: pytest.CallInfo[None]) -> Generator[None, pytest.TestReport, pytest.TestReport]:
    """Attaches the finished record to the last report, so that it reaches the collecting process of pytest-xdist too."""
    report = yield
    recorder = item.stash.get(_RECORDER, None)
    if recorder is None:
        return report
    if report.skipped and isinstance(report.longrepr, tuple):
        path, line, _ = item.reportinfo()
        report.longrepr = (str(path), (line or 0) + 1, report.longrepr[2])
    if call.when != "teardown":
        return report
    from mitl.engine.results import case_to_json  # noqa: PLC0415

    keeper = _keeper(item.config)
    captured = "".join(f"--- {title} ---\n{text}\n" for title, text in report.sections)
    finished = {"case": case_to_json(keeper.finish(recorder, captured)), "rig": keeper.rig_as_json()}
    vars(report)["mitl"] = finished  # pytest-xdist carries every attribute of a report
    if recorder.fatal:
        item.session.shouldfail = f"fatal in {recorder.info.id}: no other case is run"
    del item.stash[_RECORDER]
    del item.config.stash[_CURRENT]
    return report


# --- the run -----------------------------------------------------------------------------------------------------------------------


class _Collecting:
    """Takes the finished cases of this process and of pytest-xdist's workers into the run's folder."""

    def __init__(self, config: pytest.Config) -> None:
        self._config = config

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        """Keeps a finished case at once."""
        finished = getattr(report, "mitl", None)
        if finished is not None:
            keeper = _keeper(self._config)
            keeper.open_folder()  # not yet open where no case was declared
            keeper.take(finished)
            keeper.save()

    @pytest.hookimpl(trylast=True)
    def pytest_sessionfinish(self) -> None:
        """Completes the folder, after pytest has torn down what an interrupt left standing."""
        keeper = self._config.stash.get(_KEEPER, None)
        if keeper is None:
            return
        broken_off = self._config.stash.get(_CURRENT, None)
        if broken_off is not None:
            keeper.keep_recording(broken_off)
            keeper.add(keeper.finish(broken_off, ""))
        run = keeper.save()
        if run.cases:
            self._config.hook.pytest_mitl_run_finished(run=run, unwritten=keeper.unwritten)
        if keeper.folder is not None and keeper.opened and run.cases:
            from mitl.report import write_report  # noqa: PLC0415 - loads matplotlib

            try:
                write_report(keeper.folder)
            except Exception as error:  # noqa: BLE001 - a report that cannot be drawn must not cost the run
                keeper.problem = f"the report could not be made: {error!r}; the run is kept, try: mitl report {keeper.folder}"

    def pytest_terminal_summary(self, terminalreporter: Any) -> None:  # noqa: ANN401 - pytest does not export its type
        """Says where the run is kept."""
        keeper = self._config.stash.get(_KEEPER, None)
        if keeper is not None and keeper.folder is not None and keeper.cases:
            terminalreporter.write_sep("-", "mitl")
            terminalreporter.write_line(keeper.problem or f"{keeper.record().outcome.value}: {keeper.folder / 'report.html'}")


# --- what the hooks share ----------------------------------------------------------------------------------------------------------


def _info(item: pytest.Item) -> CaseInfo | None:
    """Gives a case's metadata; costs other people's tests a look at their marks."""
    if item.get_closest_marker(_MARK) is None:
        return None
    from mitl.engine.case import case_of  # noqa: PLC0415 - a mark of ours is there, so this is loaded already

    return case_of(item)


def _recorder(item: pytest.Item) -> CaseRecorder:
    """Gives the item's recorder; the first to ask begins the case, also for a test that was not declared with @case."""
    if _RECORDER not in item.stash:
        from mitl.engine.case import undeclared  # noqa: PLC0415
        from mitl.engine.recorder import CaseRecorder  # noqa: PLC0415

        item.config.stash[_CURRENT] = item.stash[_RECORDER] = CaseRecorder(_info(item) or undeclared(item))
    return item.stash[_RECORDER]


def _keeper(config: pytest.Config) -> RunKeeper:
    if _KEEPER not in config.stash:
        from mitl.engine.run import RunKeeper  # noqa: PLC0415

        folder = Path(out).resolve() if (out := config.getoption("mitl_out")) else None
        seed, faults = config.getoption("mitl_seed"), tuple(config.getoption("mitl_fault"))
        config.stash[_KEEPER] = RunKeeper(seed, faults, folder, rig_name=str(config.getoption("mitl_rig")), opened=_is_worker(config))
        config.stash[_KEEPER].judged_from = config.getoption("mitl_judged_from")
        config.stash[_KEEPER].resume = config.getoption("mitl_resume")
    return config.stash[_KEEPER]


def _load_rig(config: pytest.Config) -> Rig | Exception:
    """Gives the rig, or why there is none, which every case that needs it will say. Raises UsageError for wrong options."""
    if _RIG not in config.stash:
        from mitl.errors import UsageError  # noqa: PLC0415

        name, seed, faults = config.getoption("mitl_rig"), config.getoption("mitl_seed"), tuple(config.getoption("mitl_fault"))
        try:
            loaded: Rig = config.hook.pytest_mitl_load_rig(config=config, name=name, seed=seed, faults=faults)
        except Exception as error:
            if isinstance(error, UsageError):
                raise
            config.stash[_RIG] = error
        else:
            _keeper(config).describe(loaded)
            config.stash[_RIG] = _keeper(config).ask_health(loaded, config.getoption("mitl_health")) or loaded
    return config.stash[_RIG]


@pytest.hookimpl(trylast=True)
def pytest_mitl_load_rig(name: str, seed: int, faults: tuple[str, ...]) -> Rig:
    """Gives one of mitl's own rigs."""
    from mitl.rig import load_rig  # noqa: PLC0415 - loads the simulator

    return load_rig(name, seed, faults)


def _is_worker(config: pytest.Config) -> bool:
    return hasattr(config, "workerinput")


def _note(item: pytest.Item, error: BaseException, phase: str) -> None:
    """Records in the case what ended a phase of it; other people's tests have no recorder."""
    recorder = item.stash.get(_RECORDER, None)
    if recorder is not None:
        from mitl.engine import endings  # noqa: PLC0415 - loaded already, because there is a recorder

        endings.note(recorder, item.path, error, phase)
