"""Fixtures of the tests of pictures: a browser, where one is installed."""
import pytest

from browser import Browser, PageError, browser_path


@pytest.fixture(scope='module')
def browser():
    if not browser_path():
        pytest.skip('chromium is not installed: pages are not tested')
    try:
        opened = Browser()
    except PageError as error:
        pytest.skip(f'chromium does not start ({error}): pages are not tested')
    yield opened
    opened.close()
