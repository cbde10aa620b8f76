"""Fixtures of the tests of the tree: its Fortran files."""
import pytest

import floors


@pytest.fixture(scope='session')
def sources():
    """(floor, path, text) of every Fortran file under src."""
    found = list(floors.sources())
    assert len(found) > 10, 'the sources were found'
    return found
