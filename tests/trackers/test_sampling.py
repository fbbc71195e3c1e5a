"""Sampling keeps absolute deadlines and counts what it misses."""

import contextlib
import os
import sys
import time

import numpy as np
import pytest

from mitl.trackers.sampling import Sampler, before_others


def run(take, *, rate=200.0, seconds=0.4):
    sampler = Sampler(take, rate)
    sampler.start()
    time.sleep(seconds)
    sampler.stop()
    return sampler


def test_deadlines_do_not_add_up():
    times = []
    sampler = run(times.append)
    grid = (np.array(times) - times[0]) * 200.0
    same_phase = abs(np.mean(np.exp(2j * np.pi * grid)))  # 1 where all are equally late, 0 where lateness adds up to a whole period
    assert same_phase > 0.3, "a sample is taken soon after its deadline, however late the one before, or the first, was"
    assert sampler.statistics().taken + sampler.statistics().lost >= grid[-1]


def test_a_slow_sample_loses_the_deadlines_that_it_slept_through_and_no_others():
    count = 0

    def take(_now):
        nonlocal count
        count += 1
        if count == 5:
            time.sleep(0.05)

    statistics = run(take).statistics()
    assert statistics.lost >= 9
    assert statistics.latest >= 0.04


def test_a_problem_ends_it_and_is_kept():
    def take(_now):
        raise OSError("unplugged")

    sampler = run(take, seconds=0.05)
    assert not sampler.alive
    assert "unplugged" in str(sampler.problem)


def test_a_silly_rate_is_refused():
    with pytest.raises(ValueError, match="1 to 1000"):
        Sampler(print, 0.0)


@pytest.mark.skipif(sys.platform != "linux", reason="scheduling policies are Linux's")
def test_a_thread_is_before_others_for_its_work_and_no_longer():
    before = os.sched_getscheduler(0)
    with contextlib.suppress(ZeroDivisionError), before_others():
        allowed = os.sched_getscheduler(0) == os.SCHED_RR
        assert allowed or os.sched_getscheduler(0) == before
        assert 1 / 0
    assert os.sched_getscheduler(0) == before
