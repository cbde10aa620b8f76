"""Tools that the tests share: running a program, reading tables, counting checks.

Needs numpy only. A test of pytest takes the fixture `checks`; a script makes a Checks, checks, and leaves through its finish().
"""
import json
import os
import re
import resource
import shutil
import subprocess
import sys
import tempfile

import numpy as np

TESTS = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
TREE = os.path.dirname(TESTS)
REFERENCE = os.path.join(TESTS, 'reference')

# Allowed deviations from the reference values: |difference| / max(1, |value|). A position is closed to
# round-off (1e-16 times the conditioning of a well-posed chain, some hundreds); each derivative in time
# brings one more solution with the same matrix and factors of the driving rate.
POSITION, VELOCITY, ACCELERATION = 1e-12, 1e-11, 1e-10


# The exit code that ctest takes for a test that was not run, or not the whole of it.
SKIPPED = 77


class Checks:
    """Counts checks, prints those that fail, ends the script with 1 if any did. A script that could not test all that it
    should says so by left_out, and ends with SKIPPED, so that it is counted among those that were not run."""

    def __init__(self):
        self.passed = 0
        self.failed = 0
        self.missing = []

    def true(self, condition, why, more=''):
        if condition:
            self.passed += 1
        else:
            self.failed += 1
            print(f'FAILED: {why}')
            if more:
                print('  ' + str(more).rstrip().replace('\n', '\n  '))
        return bool(condition)

    def equal(self, value, expected, why):
        return self.true(value == expected, why, f'got {value!r}, expected {expected!r}')

    def near(self, values, expected, tolerance, why, scale=None):
        """Scaled error |difference| / max(scale, |expected|) of whole arrays. Unless it is given, the scale is the largest
        expected value, but at most 1: lengths of a mechanism of some millimetres count in parts of themselves. Where all
        expected values lie below the tolerance, they are zeros but for round-off, and it is 1."""
        values, expected = np.broadcast_arrays(np.asarray(values, float), np.asarray(expected, float))
        if not self.true(values.size > 0, f'{why}: there are values'):
            return False
        if scale is None:
            largest = float(np.max(np.abs(expected)))
            scale = min(1.0, largest) if largest > tolerance else 1.0
        error = np.abs(values - expected) / np.maximum(scale, np.abs(expected))
        worst = int(np.argmax(np.where(np.isfinite(error), error, np.inf)))
        return self.true(bool(np.all(error <= tolerance)), why,
                         f'scaled error {error.flat[worst]:.3e} in entry {worst}: got {values.flat[worst]!r}, '
                         f'expected {expected.flat[worst]!r}, tolerance {tolerance:.0e}')

    def left_out(self, why):
        """A part of the script cannot be tested here."""
        if why not in self.missing:
            self.missing.append(why)

    def has(self, program, package):
        """Whether a program is here; without it, what it would have tested counts as left out."""
        if shutil.which(program):
            return True
        self.left_out(f'{program} is not installed (Debian: {package})')
        return False

    def has_full_disk(self):
        """Whether there is /dev/full, which stands for a full disk; without it, what it would have tested counts as left out."""
        if os.path.exists('/dev/full'):
            return True
        self.left_out('there is no /dev/full here')
        return False

    def verdict(self):
        """For pytest: fail where a check did, or where there was none; skip where something was left out."""
        if self.failed or not (self.passed or self.missing):
            raise AssertionError(f'{self.failed} of {self.passed + self.failed} checks failed (see FAILED below)')
        if self.missing:
            import pytest
            pytest.skip('; '.join(self.missing))

    def finish(self):
        print(f'{self.passed} checks passed, {self.failed} failed')
        for why in self.missing:
            print(f'LEFT OUT: {why}')
        if self.failed or not (self.passed or self.missing):
            sys.exit(1)
        sys.exit(SKIPPED if self.missing else 0)


def skip(why):
    """Leave a script that cannot test anything here, by the exit code that ctest takes for a test not run."""
    print(f'LEFT OUT: {why}')
    sys.exit(SKIPPED)


# How many times longer than its processor time a program may take by the clock: other work may fill the machine.
PATIENCE = 20


def run(program, *arguments, folder=None, stdin='', timeout=120):
    """Run a program; gives its completed process with text in stdout and stderr. It may take `timeout` seconds of processor time."""
    words = [os.fspath(program), *map(os.fspath, arguments)]
    # the limit is set from outside: a function in the new process would need a copy of this one, which takes longer than most programs
    with subprocess.Popen(words, cwd=folder, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                          errors='replace') as process:
        resource.prlimit(process.pid, resource.RLIMIT_CPU, (timeout, resource.getrlimit(resource.RLIMIT_CPU)[1]))
        try:
            said, errors = process.communicate(stdin, timeout=PATIENCE * timeout)
        except BaseException:
            process.kill()
            raise
    return subprocess.CompletedProcess(words, process.returncode, said, errors)


def text_of(path):
    """All that stands in a file."""
    with open(path, encoding='utf-8') as file:
        return file.read()


def read_table(text):
    """Columns by name of a table of results (lines of '#', a line of names, rows of numbers)."""
    lines = [line for line in text.splitlines() if not line.startswith('#')]
    names = lines[0].split()
    rows = np.array([[float(word) for word in line.split()] for line in lines[1:]])
    if len(set(names)) != len(names) or rows.ndim != 2 or rows.shape[1] != len(names):
        raise ValueError(f'not a table: {len(names)} names, rows of shape {rows.shape}')
    return {name: rows[:, i] for i, name in enumerate(names)}


def without_drives(text):
    """A data file for mech9d of one for mech9k, each &drive of which stands on a line of its own."""
    return ''.join(line for line in text.splitlines(keepends=True) if not line.startswith('&drive'))


def table_of(program, data, *options):
    """The table that a program writes for a data file; fails loudly where the run fails."""
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, 'table.dat')
        done = run(program, os.path.abspath(data), '--table', path, *options, folder=folder)
        if done.returncode != 0:
            raise RuntimeError(f'{program} {data} ended with {done.returncode}:\n{done.stderr}')
        return read_table(text_of(path))


def table_and_report(program, data, *options):
    """The table of a run and its report, read from JSON; fails loudly where the run fails."""
    with tempfile.TemporaryDirectory() as folder:
        report = os.path.join(folder, 'report.json')
        table = table_of(program, data, '--report', report, *options)
        with open(report, encoding='utf-8') as file:
            return table, json.load(file)


def report_of(program, data, *options):
    """The report of a run that writes no results; fails loudly where the run fails."""
    with tempfile.TemporaryDirectory() as folder:
        report = os.path.join(folder, 'report.json')
        done = run(program, os.path.abspath(data), '--no-write', '--report', report, *options, folder=folder)
        if done.returncode != 0:
            raise RuntimeError(f'{program} {data} ended with {done.returncode}:\n{done.stderr}')
        with open(report, encoding='utf-8') as file:
            return json.load(file)


def read_csv(path):
    """Columns by name of a file of reference values: lines of '#', a line of names, rows of numbers."""
    with open(path, encoding='utf-8') as file:
        lines = [line.strip() for line in file if line.strip() and not line.startswith('#')]
    names = re.split(r',(?![^(]*\))', lines[0])   # a(1,5) is one name
    rows = np.array([[float(word) for word in line.split(',')] for line in lines[1:]])
    return {name: rows[:, i] for i, name in enumerate(names)}


def tolerance_of(name):
    """The tolerance that belongs to a column of a table, by what it is."""
    last = name.rsplit('.', 1)[-1]
    if name.startswith('ddq') or last in ('ax', 'ay', 'az'):
        return ACCELERATION
    if name.startswith('dq') or last in ('vx', 'vy', 'vz'):
        return VELOCITY
    return POSITION
