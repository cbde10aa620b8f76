"""Fixtures of all tests in Python: the programs of a build, and a count of checks.

The build is that of the option --build, of the variable MECH9_BUILD, or build/debug. A test that takes the fixture `checks` fails
where one of its checks does, after all of them were made; a test that leaves something out says so and counts as skipped.
"""
import os
import re
import resource
import sys

import numpy as np
import pytest

from browser import Browser, PageError, browser_path
from mech9_cases import TREE, Checks

# Seconds of processor time that a test, or a program that it calls, may take. A wall clock would fail on a busy machine.
MOST_SECONDS = 900

sys.dont_write_bytecode = True


def pytest_addoption(parser):
    parser.addoption('--build', help='folder of the build whose programs are tested')


def pytest_configure(config):
    # data files of tests have numbers as Python writes them; numpy 2 writes np.float64(0.1)
    if int(np.__version__.split('.')[0]) > 1:
        np.set_printoptions(legacy='1.25')
    resource.setrlimit(resource.RLIMIT_CPU, (MOST_SECONDS, resource.getrlimit(resource.RLIMIT_CPU)[1]))


@pytest.hookimpl(trylast=True)
def pytest_runtest_call(item):
    """After the function of a test has returned: the verdict of its checks, as a part of the test itself."""
    checks = getattr(item, 'funcargs', {}).get('checks')
    if isinstance(checks, Checks):
        checks.verdict()


class Build:
    """A build folder: what kind it is of, and where its programs stand."""

    def __init__(self, folder):
        self.folder = os.path.abspath(folder)
        self.bin = os.path.join(self.folder, 'bin')
        self.tests = os.path.join(self.folder, 'tests', 'bin')     # programs that only tests need, those of user_procs among them
        with open(os.path.join(self.folder, 'CMakeCache.txt'), encoding='utf-8') as file:
            self.settings = dict(re.findall(r'^([\w.-]+):\w+=(.*)$', file.read(), re.M))

    @property
    def kind(self):
        """Release, Debug, Sanitize, Threads or Coverage."""
        return self.settings['CMAKE_BUILD_TYPE']

    @property
    def version(self):
        return self.settings['CMAKE_PROJECT_VERSION']

    @property
    def optimised(self):
        return self.kind == 'Release'

    def program(self, name):
        """The path of a program of the project or of a test."""
        for folder in (self.bin, self.tests):
            path = os.path.join(folder, name)
            if os.access(path, os.X_OK):
                return path
        raise FileNotFoundError(f'{self.folder} has no program {name}; build it first')

    def has(self, name):
        return any(os.access(os.path.join(folder, name), os.X_OK) for folder in (self.bin, self.tests))


def build_of(config):
    """The build that is tested."""
    folder = config.getoption('--build') or os.environ.get('MECH9_BUILD') or os.path.join(TREE, 'build', 'debug')
    if not os.path.exists(os.path.join(folder, 'CMakeCache.txt')):
        pytest.exit(f'{folder} is no build folder; make one by tests/run, or name one by --build', 2)
    return Build(folder)


def pytest_collection_modifyitems(config, items):
    """Tests with the mark `without_sanitizers` are made in the other builds alone."""
    if any(item.get_closest_marker('without_sanitizers') for item in items) and build_of(config).kind == 'Sanitize':
        items[:] = [item for item in items if not item.get_closest_marker('without_sanitizers')]


@pytest.fixture(scope='session')
def build(pytestconfig):
    return build_of(pytestconfig)


@pytest.fixture(scope='session')
def mech9k(build):
    return build.program('mech9k')


@pytest.fixture(scope='session')
def mech9d(build):
    return build.program('mech9d')


@pytest.fixture
def checks():
    return Checks()


@pytest.fixture(scope='module')
def browser():
    """A page in a browser without a window, where one is installed."""
    if not browser_path():
        pytest.skip('chromium is not installed: pages are not tested')
    try:
        opened = Browser()
    except PageError as error:
        pytest.skip(f'chromium does not start ({error}): pages are not tested')
    yield opened
    opened.close()
