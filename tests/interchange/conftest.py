"""A session of imports: both programs in a folder of their own."""
import pytest

from imported import Session


@pytest.fixture
def session(checks, tmp_path, mech9k, mech9d):
    session = Session(checks, tmp_path, mech9k, mech9d)
    if session.without_expat():
        checks.verdict()
    return session
