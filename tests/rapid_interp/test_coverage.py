"""The coverage page and the library's tables."""

from __future__ import annotations

from pathlib import Path

import pytest

from rapid_interp.coverage import page
from rapid_interp.library.catalogue import catalogue
from rapid_interp.meaning.arguments import library_parameters, library_result


def test_the_page_in_docs_is_what_the_tables_say():
    assert (Path(__file__).parents[2] / "docs" / "rapid_coverage.md").read_text() == page()


@pytest.mark.parametrize("routine", [routine for routine in catalogue().values() if routine.run], ids=lambda routine: routine.name)
def test_the_head_of_every_routine_can_be_read(routine):
    assert all(parameter.name for parameter in library_parameters(routine))
    assert not routine.is_function or library_result(routine).name
