"""Long-term motion that is asked to end, by Ctrl-C, keeps and tells what was computed: points of a section, running means of exponents,
periodic motions, branches. A full disk is told with the file."""
import json
import os
import signal
import subprocess
import time

import pytest

from mech9_cases import PATIENCE, TREE, read_table, run

PENDULUM = os.path.join(TREE, 'examples', 'driven_pendulum', 'driven_pendulum.nml')
SPRING = os.path.join(TREE, 'examples', 'inclined_spring', 'inclined_spring.nml')
ENDLESS = ('--set', 'solver.maximum_steps=2000000000')


def go(program, folder, *words):
    """Standard error of a program that is interrupted after a second and more."""
    process = subprocess.Popen([program, *words, *ENDLESS], cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                               preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL))
    time.sleep(3)
    process.send_signal(signal.SIGINT)
    _, said = process.communicate(timeout=60 * PATIENCE)
    assert process.returncode == 130, (process.returncode, said)
    return said


def test_section(checks, mech9d, tmp_path):
    """The points so far are in the table."""
    said = go(mech9d, tmp_path, PENDULUM, '--set', 'time.end=1e8', '--set', 'time.intervals=2', '--set', 'section.table=points.dat',
              '--set', 'section.transient=0', '--table', 'run.dat')
    points = read_table((tmp_path / 'points.dat').read_text())
    checks.true(f"section: {len(points['t'])} points" in said and 'interrupted' in said, 'their number is told', said)
    # tolerance: the period has 15 digits
    checks.near(points['t'], 9.42477796076938 * (points['point'] - 1), 1e-12, 'the points', scale=points['t'][-1])
    checks.true(len(points['t']) > 2, 'there are some')


def test_exponents(checks, mech9d, tmp_path):
    """The means up to there are told, and in table and report."""
    said = go(mech9d, tmp_path, PENDULUM, '--exponents', '2', '--set', 'exponents.transient=1', '--set', 'exponents.time=1e8', '--table',
              'means.dat', '--report', 'report.json')
    report, table = json.loads((tmp_path / 'report.json').read_text()), read_table((tmp_path / 'means.dat').read_text())
    checks.true('exponent 2: ' in said and 'interrupted' in said, 'they are told', said)
    checks.equal((report['exit_code'], len(table['t'])), (130, 200), 'code and table')
    checks.true(1 < report['exponents_to'] < 1e8 and table['t'][-1] == report['exponents_to'], 'they end where the motion was interrupted')
    # tolerance: lengths at both ends
    checks.near(sum(report['exponents']), -0.5, 1e-3, 'their sum', scale=1)


def test_exponents_within_the_transient(checks, mech9d, tmp_path):
    """There are no means yet."""
    said = go(mech9d, tmp_path, PENDULUM, '--exponents', '1', '--set', 'exponents.transient=1e8', '--set', 'exponents.time=1e8', '--table',
              'means.dat')
    checks.true('exponent' not in said and not (tmp_path / 'means.dat').exists(), 'nothing is told', said)


def test_periodic_motions(checks, mech9d, tmp_path):
    """The motions that were found are told."""
    said = go(mech9d, tmp_path, PENDULUM, '--periodic', '--set', 'load(2).force=0.9', '--set', 'periodic.starts=1000000')
    checks.true('multipliers' in said and 'found until then' in said and 'the results are' not in said, 'a motion', said)


def test_branches(checks, mech9d, tmp_path):
    """The points so far are in the table."""
    said = go(mech9d, tmp_path, SPRING, '--branch', 'F', '--set', 'branch.step=1e-5', '--set', 'branch.points=100000000', '--table',
              'branch.dat')
    rows = read_table((tmp_path / 'branch.dat').read_text())
    checks.true('it begins where the work was interrupted' in said and len(rows['F']) > 1, 'the branch', said)
    # the spring in its inclined position: the force of its shortening
    length = (0.64 + rows['q1']**2)**0.5
    checks.near(rows['F'], -100 * (length - 1) * rows['q1'] / length, 1e-9, 'its points', scale=1)


@pytest.mark.parametrize('words', (('--set', 'section.table=/dev/full', '--table', 'run.dat'),
                                   ('--exponents', '1', '--table', '/dev/full'),
                                   ('--periodic', '--set', 'load(2).force=0.9', '--table', '/dev/full'),
                                   ('--study', '--set', 'study.exponents=1', '--table', '/dev/full')),
                         ids=('section', 'exponents', 'periodic', 'study'))
def test_full_disk(checks, mech9d, tmp_path, words):
    """The file that cannot be written is named."""
    if not checks.has_full_disk():
        return
    path = tmp_path / 'pendulum.nml'
    with open(PENDULUM, encoding='utf-8') as file:
        text = file.read()
    if '--study' in words:
        text += "&parameter name='torque', sets='load(2).force', low=1, high=1.1, count=2 /\n&study kind='grid' /\n"
    path.write_text(text, encoding='utf-8')
    done = run(mech9d, path, *words, '--set', 'time.end=200', folder=tmp_path)
    checks.true(done.returncode == 8 and "cannot write to '/dev/full'" in done.stderr, 'the message', done.stderr)
