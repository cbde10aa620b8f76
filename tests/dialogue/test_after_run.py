"""The end of a conversation, after a run: the table's end, a plot, a comparison, a change and another run.

What is shown is held against the tables that the same program writes for the same data; differences are worked
out here.
"""
import os
import re
import shutil

import numpy as np
import pytest

from mech9_cases import TREE, read_table, run, table_of, text_of
from pseudo_terminal import Terminal, needs_terminal

PROMPT = 'show, plot, compare, change, run or done'
PROMPT_OF_DYNAMICS = 'show, plot, compare, equilibrium, modes, change, run or done'


class Session:
    """A conversation about an example, whose copy stands in a folder of its own."""

    def __init__(self, checks, program, example, folder):
        self.checks, self.program, self.example, self.folder = checks, program, example, folder
        self.data = os.path.join(self.folder, f'{example}.nml')
        shutil.copy(os.path.join(TREE, 'examples', example, f'{example}.nml'), self.data)

    def after_run(self, *lines, code=0):
        """Save and run, then type lines; what was said to each of them."""
        done = run(self.program, '--edit', f'{self.example}.nml', folder=self.folder,
                   stdin='\n'.join(['', 'both', '', *lines]) + '\n')
        self.checks.equal(done.returncode, code, f'{self.example} {lines}: exit code')
        parts = re.split(r'  (?:' + PROMPT + '|' + PROMPT_OF_DYNAMICS + r')(?: \[run\])?: \n', done.stderr)
        self.checks.true(len(parts) > 1, f'{self.example} {lines}: there is a prompt after the run', done.stderr)
        return parts[1:], done.stdout

    def written(self):
        """The table that the run wrote."""
        name = re.search(r"table *= *'([^']*)'", text_of(self.data)).group(1)
        return read_table(text_of(os.path.join(self.folder, name)))

    def independent(self, *options):
        return table_of(self.program, self.data, *options)


@pytest.fixture
def session(checks, mech9k, tmp_path):
    """mech9k about Fig. 1."""
    return Session(checks, mech9k, 'fig1', os.fspath(tmp_path))


@pytest.fixture
def swinging(checks, mech9d, tmp_path):
    """mech9d about a pendulum."""
    return Session(checks, mech9d, 'pendulum', os.fspath(tmp_path))


def rows_shown(text):
    """Names, units and rows of the list."""
    lines = text.splitlines()
    rows = [line.split() for line in lines[2:] if not line.startswith('(')]
    return lines[0].split(), lines[1].split(), np.array(rows, float)


def blocks_shown(text):
    """Columns by name of blocks of rows, each with its names and units above it."""
    columns, names = {}, None
    lines = iter(text.splitlines())
    for line in lines:
        words = line.split()
        if words and words[0] in ('equilibrium', 'mode'):
            names = words
            next(lines)
        elif names and len(words) == len(names):
            for name, word in zip(names, words):
                columns.setdefault(name, []).append(float(word))
    return columns


def test_show(session):
    checks = session.checks
    said, _ = session.after_run('show 3 q5 P.y', 'show 5', 'show q7', 'show 2 q55', 'show 4 q1 P', 'plot P', 'done')
    table = session.written()
    for text, names, count in ((said[0], ['t', 'q5', 'P.y'], 3), (said[1], ['t', 'q1', 'q2', 'q3', 'q4', 'q5'], 5),
                               (said[2], ['t', 'q7'], 8), (said[4], ['t', 'q1', 'P.x', 'P.y', 'P.z'], 4)):
        got, _, rows = rows_shown(text)
        checks.equal(got, names, f'show: the columns {names}')
        # seven significant digits are shown
        checks.true(np.allclose(rows, np.array([table[name][-count:] for name in names]).T, rtol=5e-7, atol=1e-12),
                    f'show: the last {count} rows of the table', text)
    checks.true("no column 'q55'" in said[3] and 'did you mean q5?' in said[3], 'show: a name that is not there', said[3])
    checks.true('no column' not in said[5], 'plot: a point stands for its coordinates', said[5])
    checks.true(all(len(line) <= 79 for text in said for line in text.splitlines()), 'show: within 80 columns')


def test_names_head_the_columns(checks, mech9k, mech9d, tmp_path):
    """Columns of pairs and links with names are headed by these in show, compare and equilibria; numbers are understood as well."""
    session = Session(checks, mech9k, 'four_bar_homework', os.fspath(tmp_path))
    said, _ = session.after_run('show 2 q4 coupler.phi', '?', 'change drive 1 coefficients = 40, 26', 'run', 'compare', 'show 1 A.q B.q O4.dq', 'done')
    checks.equal(rows_shown(said[0])[0], ['t', 'O4.q', 'coupler.phi'], 'show: names')
    checks.true('O2.q A.q B.q O4.q' in ' '.join(said[1].split()), '?: the columns by names', said[1])
    compared = re.findall(r'^ *(\S+) +(\S+) +(\S+) % +', said[4], re.M)
    checks.true(any('coupler.' in name for name, _, _ in compared) and not any(re.match(r'd*q\d', name) for name, _, _ in compared),
                'compare: names', said[4])
    checks.equal(rows_shown(said[5])[0], ['t', 'A.q', 'B.q', 'O4.dq'], 'show: names that are asked for')
    path = os.path.join(session.folder, 'swing.nml')
    with open(path, 'w', encoding='utf-8') as file:
        file.write("""&mechanism title='swing' / &structure cq=1 / &pair coordinate=1, links=1,2, kind='revolute', name='Kurbelzapfen_hinten', axis=0,0,1 /
&body link=2, mass=1, centre=0.3,0,0 / &gravity acceleration=0,-9.81,0 / &initial coordinate=1, position=0.2 /
&motor coordinate=1, kind='dc', resistance=1, constant=1, voltage=0.5 / &time end=1, intervals=10 /
""")
    done = run(mech9d, '--edit', path, folder=session.folder, stdin='\nrun\nequilibrium\nshow\ndone\n')
    lines = [line.split() for line in done.stderr.splitlines() if 'Kurbelzapfen_hinten.q' in line]
    checks.true(sum('equilibrium' in words for words in lines) >= 2, 'equilibrium and show: names', done.stderr)


def test_bare_change(session):
    said, _ = session.after_run('change', 'done')
    session.checks.true('which answer' in said[0], 'change alone: what is missing is said', said[0])


def test_compare(session):
    checks = session.checks
    before = session.independent()
    said, _ = session.after_run('compare', 'change drive 5 coefficients = 0.5, 6.01', '', 'compare', 'run', 'compare', 'done')
    after = session.independent()     # the data file now holds the change
    checks.true('no run before' in said[0], 'compare: nothing to compare with at first', said[0])
    checks.near(after['q5'], 0.5 + 6.01 * after['t'], 1e-14, 'the change is in the data file')
    found = re.findall(r'^ *(\S+) +(\S+) +(\S+) % +(\S+) +(\S+) +(\S+)$', said[3], re.M)
    checks.equal(len(found), 15, 'compare: as many lines as fit')
    largest = {name: np.max(np.abs(after[name] - before[name])) for name in after}
    for name, difference, _, time, old, new in found:
        # four and five significant digits are shown
        checks.near(float(difference) / largest[name], 1.0, 1e-3, f'compare: the largest difference of {name}')
        at = np.argmin(np.abs(after['t'] - float(time)))
        checks.near([float(old), float(new)], [before[name][at], after[name][at]], 1e-4, f'compare: {name} before and now')
    shares = [float(row[2]) for row in found]
    checks.equal(shares, sorted(shares, reverse=True), 'compare: the greatest share first')
    checks.true('to the last bit' in said[5], 'compare: the same data give the same numbers', said[5])


def test_change(session):
    """A wrong value is refused and asked for again; a change that is not run is kept."""
    checks = session.checks
    end = session.independent()['t'][-1]
    said, _ = session.after_run('change time end = soon', '2', 'time intervals = 50', 'change nothing', 'run', 'change time end = 3', 'done')
    after = session.written()
    checks.true(end != 2 and after['t'][-1] == 2 and len(after['t']) == 51, 'two changes, and both are in the run')
    checks.true('no answer that can be changed' in said[2], 'what cannot be changed is told', said[2])
    draft = [name for name in os.listdir(session.folder) if name.endswith('.draft.nml')]
    checks.equal(len(draft), 1, 'a change that was not run is kept in a file')
    checks.true('--resume' in said[-1] and draft and draft[0] in said[-1], 'whose name is told', said[-1])
    checks.near(session.independent()['t'][-1], 2.0, 0.0, 'and the data file is that of the last run')


def test_change_before(session):
    """The summary takes the same words."""
    done = run(session.program, '--edit', 'fig1.nml', folder=session.folder, stdin='time end = 0.5\nchange 61 = 10\n\nsave\n\n')
    session.checks.equal(done.returncode, 0, 'saved')
    table = session.independent()
    session.checks.true(len(table['t']) == 11 and table['t'][-1] == 0.5, 'answers given at once, by name and by number')


def test_plot(session):
    checks = session.checks
    if not checks.has('gnuplot', 'gnuplot-nox'):
        said, _ = session.after_run('plot q1', 'done')
        checks.true('gnuplot' in said[0], 'plot: says what is missing', said[0])
        return
    said, output = session.after_run('plot q1 P.x', 'plot sub.svg:P.x:P.y', 'plot zzz', 'done')
    checks.true('q1' in output and 'P.x' in output and '*' in output, 'plot: in the terminal', output)
    checks.true(os.path.getsize(os.path.join(session.folder, 'sub.svg')) > 1000, 'plot: a picture')
    checks.true('zzz' in said[2], 'plot: a name that is not there', said[2])


def test_plot_marks_events(checks, mech9d, tmp_path):
    Session(checks, mech9d, 'four_bar_stop', os.fspath(tmp_path)).after_run('plot run.svg:q4', 'done')
    script = text_of(os.path.join(tmp_path, 'run.gp'))
    checks.true(re.search(r"^set label 't = \S+ s: stop 1 is hit", script, re.M) is not None, 'plot: impacts are marked', script[:2000])


def test_study(session):
    """A study of the data file is made where it has one, and told; nothing is written."""
    path = os.path.join(session.folder, 'arm.nml')
    with open(path, 'w', encoding='utf-8') as file:
        file.write("&structure cq=1 /\n&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /\n"
                   "&drive coordinate=1, kind='polynomial', coefficients=0, 1 /\n&point name='B', link=2, position=1,0,0 /\n&time end=1, intervals=5 /\n"
                   "&parameter name='arm', sets='point.position(1)', low=0.5, high=2, count=3 /\n&quantity name='reach', of='B.x', take='max' /\n"
                   "&output table='arm.dat' /\n&study kind='grid' /\n")
    done = run(session.program, '--edit', path, folder=session.folder, stdin='\nboth\n\nstudy\nstudy kind = list\ndone\n')
    said = done.stderr + done.stdout
    session.checks.true('modes, study, change' in said or 'compare, study, change' in said, 'study: it is offered', said)
    session.checks.true('3 runs: ' in said and 'reach: 0.5 to 2 m' in said, 'study: its summary', said)


def test_failed_run(session):
    """A run that fails ends nothing; the exit code is that of the last run."""
    checks = session.checks
    said, _ = session.after_run('change pair 7 moving_point = 0.1, 0, 0', '', 'show 1', 'compare', 'done', code=6)
    checks.true('dead point' in said[1], 'a rocker too short for a full turn is told', said[1])
    rows = re.search(r'the last 1 of (\d+) rows', said[2])
    checks.true(rows and 0 < int(rows.group(1)) < 101, 'the results up to there are shown', said[2])
    checks.true(f'Compared at {rows.group(1)} common times' in said[3], 'and compared', said[3])


def test_run_that_cannot_begin(session):
    checks = session.checks
    said, _ = session.after_run('change pair 7 moving_point = 19, 0, 0', 'run', 'show 1', 'compare', 'done', code=5)
    checks.true('assembled' in said[1], 'a rocker that reaches nothing is told', said[1])
    checks.true('no results' in said[2] and 'no results' in said[3], 'there is nothing to look at', said[2:4])


def test_show_in_dynamics(swinging):
    said, _ = swinging.after_run('show 4', 'done')
    table = swinging.written()
    names, _, rows = rows_shown(said[0])
    swinging.checks.true(np.allclose(rows, np.array([table[name][-4:] for name in names]).T, rtol=5e-7, atol=1e-12),
                        'mech9d: the last rows of the table', said[0])


def test_all_digits_of_an_answer(swinging):
    """show has all digits of the last answer, and rows of the run where it has words or no answer was given since the run."""
    checks = swinging.checks
    said, _ = swinging.after_run('modes', 'show', 'equilibrium', 'show', 'show 2', 'run', 'show', 'done')
    # sixteen digits determine a number to some units in the last place
    checks.near(blocks_shown(said[1])['frequency'], np.sqrt(9.81) / (2 * np.pi), 1e-14, 'show after modes')
    checks.near(blocks_shown(said[3])['q1'], np.pi / 2, 1e-14, 'show after equilibrium')
    checks.equal(rows_shown(said[4])[2].shape, (2, 6), 'show 2: rows of the run')
    checks.equal(rows_shown(said[6])[0][:2], ['t', 'q1'], 'show after another run: its rows')
    checks.true(all(len(line) <= 80 for text in said[:4] for line in text.splitlines()), 'within 80 columns', said[:4])


def test_sketch_of_rest(swinging):
    """The sketch of the position of rest is that of the start of a file that starts there, but for the marks of the start."""
    checks = swinging.checks
    said, _ = swinging.after_run('equilibrium rest.svg', 'modes same.svg', 'modes rest.png', 'done')
    checks.true('sketch of the position of rest: rest.svg' in said[0], 'told', said[0])
    checks.true('1.57' in said[0], 'the table is shown, too', said[0])
    checks.true('random positions' in said[2], 'another ending is explained', said[2])
    done = run(swinging.program, 'pendulum.nml', '--check', '--sketch', 'start.svg', '--set', 'initial(1).position=1.5707963267948966',
               folder=swinging.folder)
    checks.equal(done.returncode, 0, 'sketch of a start at rest')
    pictures = [text_of(os.path.join(swinging.folder, name)) for name in ('rest.svg', 'same.svg', 'start.svg')]
    checks.true(pictures[0] == pictures[1] == pictures[2], 'one picture')
    alone = run(swinging.program, 'pendulum.nml', '--equilibrium', '--sketch', 'rest.svg', '--view', 'xz', folder=swinging.folder)
    checks.equal([alone.returncode, alone.stdout], [0, ''], 'the option alone writes the picture in place of the table')
    checks.true(text_of(os.path.join(swinging.folder, 'rest.svg')) != pictures[0], 'from another side')


def test_equilibria_and_modes(swinging):
    """Equilibria and modes of the pendulum as it stands, also with a change that was not run: g/l = 9.81, then 4, in 1/s^2."""
    checks = swinging.checks
    said, _ = swinging.after_run('equilibrium', 'equilibrium 5', 'modes', 'gravity acceleration = 0 -4 0', 'modes', 'modes 4',
                                    'equilibrium x', 'equilibrium 0', 'run', 'modes', 'done')
    checks.true('its lowest frequency is 0.498488 Hz' in said[0], 'equilibrium: told', said[0])
    checks.true('2 positions of equilibrium from the initial position and 5 random ones, 1 of them stable' in said[1],
                'equilibrium 5: told', said[1])
    tables = [blocks_shown(said[i]) for i in (0, 1, 2, 4, 9)]
    checks.equal([len(table['q1'] if 'q1' in table else table['frequency']) for table in tables], [1, 2, 1, 1, 1], 'the tables are shown')
    # three significant digits are shown
    checks.near([table['frequency'][0] for table in tables[2:]], np.sqrt([9.81, 4, 4]) / (2 * np.pi), 1.1e-3,
                'modes: of the data as they stand, run or not')
    rows = [line for text in said for line in text.splitlines() if line.startswith('      ')]
    checks.true(len(rows) > 20 and all(len(line) <= 80 for line in rows) and not re.search(r'[.\d]{6}', ''.join(rows)),
                'equilibria and modes: numbers that people read, within 80 columns', said)
    checks.true('q1.im' in tables[2], 'modes: the columns that do not fit stand below', said[2])
    checks.true(all('random positions' in one for one in said[5:7]), 'what is no number is explained', said[5:7])
    checks.true("not '0'" in said[7], 'no start is none', said[7])


def test_no_rest_in_kinematics(session):
    said, _ = session.after_run('equilibrium', 'done')
    session.checks.true('no answer that can be changed' in said[0], 'mech9k finds no equilibria', said[0])


@needs_terminal
def test_interrupted(session):
    """Ctrl-C ends the run and not the conversation."""
    with Terminal([session.program, '--edit', f'{session.example}.nml'], folder=session.folder) as terminal:
        terminal.expect('right: ')
        terminal.type('time intervals\r')
        terminal.expect(']: ')
        terminal.type('400000000\r')
        terminal.expect('right: ')
        terminal.type('\r')
        terminal.expect('[both]: ')
        terminal.type('\r')
        terminal.expect(']: ')
        terminal.type('\r')
        session.checks.true(terminal.expect(' left'), 'a long run tells the time left', terminal.seen)
        terminal.type('\x03')
        session.checks.true(terminal.expect(PROMPT), 'and the conversation goes on after Ctrl-C', terminal.seen)
        terminal.type('show 2 q5\r')
        session.checks.true(terminal.expect('the last 2 of'), 'with the results so far', terminal.seen)
        terminal.type('\r')
        session.checks.true(terminal.expect('done ends'), 'Enter alone ends nothing', terminal.seen)
        terminal.type('done\r')
        session.checks.equal(terminal.ends(), 130, 'its exit code tells that the run was interrupted')


@needs_terminal
def test_simple_terminal(session):
    """80 x 24, no colour wanted, and a cursor that only goes on: nothing but letters, in lines that fit."""
    with Terminal([session.program, '--edit', 'fig1.nml'], folder=session.folder, term='dumb', NO_COLOR='1') as terminal:
        for prompt, line in (('right: ', ''), ('[both]: ', ''), (']: ', ''), (PROMPT, 'show'), (PROMPT, 'plot q1'), (PROMPT, '?'),
                             (PROMPT, 'time end = 2'), (PROMPT, 'run'), (PROMPT, 'compare'), (PROMPT, 'done')):
            session.checks.true(terminal.expect(prompt), f'dumb terminal: asks {prompt!r}', terminal.seen)
            terminal.type(line + '\r')
        session.checks.equal(terminal.ends(), 0, 'dumb terminal: to the end')
        session.checks.true('\x1b' not in terminal.seen, 'dumb terminal: no sequences', repr(terminal.seen))
        long = [line for line in terminal.plain().split('\n') if len(line) > 80]
        session.checks.equal(long, [], 'dumb terminal: every line fits')
