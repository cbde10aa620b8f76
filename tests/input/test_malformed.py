"""Every file of malformed/expected.txt through the program: its exit code, what it says, and no crash."""
import os

import pytest

from mech9_cases import TESTS, run, text_of

FOLDER = os.path.join(TESTS, 'input', 'malformed')
CRASH = ('Backtrace', 'backtrace', 'Fortran runtime', 'SIGSEGV', 'SIGFPE', 'AddressSanitizer', 'runtime error:')
# name | exit code | text of the message | ...
EXPECTED = [line.split(' | ') for line in text_of(os.path.join(FOLDER, 'expected.txt')).splitlines() if line and not line.startswith('#')]


def test_list_was_read(checks):
    checks.true(len(EXPECTED) >= 40, 'at least forty files are tried', len(EXPECTED))


@pytest.mark.parametrize('name, code, texts', [(name, int(code), texts) for name, code, *texts in EXPECTED],
                         ids=[name.replace('.nml', '') for name, *_ in EXPECTED])
def test_malformed(checks, mech9k, name, code, texts):
    done = run(mech9k, name, '--check', '--quiet', folder=FOLDER, timeout=60)
    checks.equal(done.returncode, code, f'{name}: exit code; {done.stderr}')
    for text in texts:
        checks.true(text in done.stderr, f'{name}: says {text}', done.stderr)
    checks.true(not any(word in done.stderr for word in CRASH), f'{name}: no crash', done.stderr)
