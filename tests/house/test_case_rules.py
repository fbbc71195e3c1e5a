"""Rules of mitl's own cases, beside those of tests/atc/test_cases.py: ids, and where limits come from."""

import re
from collections import Counter

import pytest

from mitl.cli.verify import found_cases

SOURCE = re.compile(r"facts/\w+\.md|thesis \d+(\.\d+)+|ISO \d+|\bours\b")
"""A limit is taken from somewhere that can be looked up, or is said to be ours."""


@pytest.fixture(scope="module")
def cases():
    return found_cases()


def test_every_id_is_unique(cases):
    assert cases
    assert [name for name, count in Counter(case.id for case in cases).items() if count > 1] == []


def test_every_limit_says_where_it_comes_from(cases):
    assert [f"{case.id}: {case.limit_source}" for case in cases if not SOURCE.search(case.limit_source)] == []


@pytest.mark.parametrize("told", ["5 mm", "as usual", "the thesis"])
def test_a_limit_without_a_source_would_be_seen(told):
    assert SOURCE.search(told) is None
