"""mech9k from outside: options, exit codes, what goes to stdout, stderr and files."""
import json
import os
import subprocess

import numpy as np
import pytest

import data_file
from mech9_cases import PATIENCE, REFERENCE, read_table, run, text_of, tolerance_of

FIG1 = os.path.join(REFERENCE, 'kinematics_fig1.nml')
SLIDER = os.path.join(REFERENCE, 'kinematics_slider_crank.nml')
# design of the exit codes: what ends with which number
DONE, USAGE, DATA, STRUCTURE, ASSEMBLY, SINGULAR, FILE = 0, 2, 3, 4, 5, 6, 8
OPTIONS = ['--check', '--structure', '--table', '--set', '--quiet', '--verbose', '--help', '--version',
           '--no-write', '--report']


class Session:
    """Runs the program in a folder of its own and keeps the counts."""

    def __init__(self, checks, program, folder):
        self.checks, self.program, self.folder = checks, program, folder

    def run(self, *arguments, **more):
        return run(self.program, *arguments, folder=self.folder, **more)

    def ends(self, code, why, *arguments, says='', **more):
        """Run and check the exit code, that stderr says something, and that nothing crashed."""
        done = self.run(*arguments, **more)
        self.checks.true(done.returncode == code, f'{why}: exit code {code}',
                         f'it was {done.returncode}; stderr:\n{done.stderr}')
        for text in [says] if isinstance(says, str) else says:
            self.checks.true(text in done.stderr, f'{why}: says "{text}"', done.stderr)
        trouble = ('Backtrace', 'backtrace', 'Fortran runtime error', 'SIGSEGV', 'AddressSanitizer', 'runtime error:')
        self.checks.true(not any(word in done.stderr for word in trouble), f'{why}: no crash', done.stderr)
        return done

    def path(self, name):
        return os.path.join(self.folder, name)

    def exists(self, name):
        return os.path.exists(self.path(name))

    def write(self, name, text):
        with open(self.path(name), 'w', encoding='utf-8', newline='') as file:
            file.write(text)
        return self.path(name)

    def table(self, name):
        return read_table(text_of(self.path(name)))


@pytest.fixture
def s(checks, mech9k, tmp_path):
    return Session(checks, mech9k, os.fspath(tmp_path))


def same_tables(checks, first, second, why):
    checks.equal(list(second), list(first), f'{why}: the same columns')
    for column in first:
        if column != 'closure':
            checks.near(second[column], first[column], tolerance_of(column), f'{why}: {column}')


def test_help(s):
    done = s.ends(DONE, '--help', '--help')
    for option in OPTIONS:
        s.checks.true(option in done.stdout, f'--help tells of {option}', done.stdout)
    s.checks.equal(done.stderr, '', '--help: nothing on stderr')
    s.ends(DONE, '--help wins over a missing file', 'nowhere.nml', '--help')


def test_version(s, build):
    version = build.version
    done = s.ends(DONE, '--version', '--version')
    s.checks.true(done.stdout.startswith(f'mech9k {version}'), '--version gives the version', done.stdout)


def test_wrong_use(s):
    s.ends(USAGE, 'unknown option', FIG1, '--tabel', 'x', says='--table')
    s.ends(USAGE, 'two files', FIG1, SLIDER)
    s.ends(USAGE, 'an option without its argument', FIG1, '--table', says='--table')
    s.ends(USAGE, 'an argument where none belongs', FIG1, '--quiet=yes', says='--quiet')


def test_data_file_that_is_not_there(s):
    s.ends(FILE, 'no such data file', 'nowhere.nml', says='nowhere.nml')
    said = s.run('nowhere.nml', '--set', 'time.end=2').stderr
    s.checks.true(len(said.splitlines()) == 1, 'a missing file is one error, whatever is set in it', said)
    s.ends(FILE, 'a folder as data file', s.folder)


def test_structure(s):
    done = s.ends(DONE, '--structure', FIG1, '--structure')
    lines = [' '.join(line.split()) for line in done.stdout.splitlines()]
    # the paper's vectors; its nrw is a misprint, by its definition link 1 closes the first chain at position 5
    for line in ('nrg = 1 2 3 4 1 1 6 5 3', 'nws = 0 5 4 7 6 0 1 2 3', 'rdw = 1 1 0 0 0 1 0 0 0',
                 'nrw = 0 0 0 0 1 1 1 1 2'):
        s.checks.true(line in lines, f'--structure prints {line}', done.stdout)
    s.checks.true(not s.exists('kinematics_fig1.dat'), '--structure writes no table')


def test_structure_without_pairs(s):
    """Geometry is not looked at: pairs may be missing."""
    done = s.ends(DONE, '--structure', FIG1, '--structure')
    groups = [group for group in data_file.parse(text_of(FIG1)) if group[0] in ('mechanism', 'structure')]
    alone = s.write('structure_alone.nml', data_file.write(groups))
    s.checks.equal(s.ends(DONE, '--structure without pairs', alone, '--structure').stdout, done.stdout,
                   'the structure alone gives the same vectors')


def test_tables(s):
    s.ends(DONE, 'a plain run', FIG1)
    s.checks.true(s.exists('kinematics_fig1.dat'), 'the table of &output is written into the working folder')
    plain = s.table('kinematics_fig1.dat')
    text = text_of(s.path('kinematics_fig1.dat'))
    s.checks.true(text.startswith('#') and 'Fig. 1: two closed chains' in text.splitlines()[0] + text.splitlines()[1],
                  'the table begins with the title', text[:200])
    names = ['t'] + [f'{d}q{k}' for d in ('', 'd', 'dd') for k in range(1, 8)] + \
        [f'{p}.{v}{x}' for p in 'PQ' for v in ('', 'v', 'a') for x in 'xyz'] + ['closure']
    s.checks.equal(list(plain), names, 'the columns stand in their fixed order')
    s.checks.near(plain['t'], np.arange(21) / 20.0, 1e-15, 'the times are start + (end - start) i/intervals')
    s.checks.near(plain['q5'], 0.5 + 6.0 * plain['t'], 1e-15, 'the drive is followed')
    s.ends(DONE, '--table PATH', FIG1, '--table', 'other.dat')
    same_tables(s.checks, plain, s.table('other.dat'), '--table')
    done = s.ends(DONE, '--table -', FIG1, '--table', '-')
    same_tables(s.checks, plain, read_table(done.stdout), 'the table on stdout')


def test_table_that_cannot_be_written(s):
    s.ends(FILE, 'a table in a folder that is not there', FIG1, '--table', 'nowhere/x.dat', says='nowhere/x.dat')
    if s.checks.has_full_disk():
        s.ends(FILE, 'a full disk', FIG1, '--table', '/dev/full', says='/dev/full')


def test_no_table(s):
    s.ends(DONE, '--no-write', FIG1, '--no-write')
    s.checks.true(not s.exists('kinematics_fig1.dat'), '--no-write writes no table')
    s.ends(DONE, '--check', FIG1, '--check')
    s.checks.true(not s.exists('kinematics_fig1.dat'), '--check writes no table')


def test_settings(s):
    s.ends(DONE, '--set', FIG1, '--table', 'set.dat', '--set', 'time.intervals=5', '--set', 'drive.coefficients=0.5, 3.0')
    table = s.table('set.dat')
    s.checks.near(table['t'], np.arange(6) / 5.0, 1e-15, '--set time.intervals=5')
    s.checks.near(table['q5'], 0.5 + 3.0 * table['t'], 1e-15, '--set drive.coefficients')
    s.ends(DONE, '--set=...', FIG1, '--table=set.dat', '--set=time.intervals=3')
    s.checks.equal(len(s.table('set.dat')['t']), 4, '--set=time.intervals=3')


def test_wrong_settings(s):
    s.ends(DATA, '--set of an unknown name', FIG1, '--set', 'time.interval=5', says='intervals')
    s.ends(DATA, '--set of a wrong value', FIG1, '--set', 'time.intervals=many', says='--set')
    s.ends(USAGE, '--set without a value', FIG1, '--set', 'intervals', says='--set')


def test_two_answers(s):
    done = s.ends(DONE, 'two answers', FIG1, '--check', '--range')
    s.checks.true('mobility' in done.stdout and 'how far' in done.stdout, 'both are given', done.stdout)


@pytest.mark.parametrize('words', [['--help'], ['--help-data'], *([FIG1, option] for option in ('--check', '--structure', '--plan', '--range'))],
                         ids=lambda words: words[-1])
def test_standard_output_that_is_lost(s, words):
    if not s.checks.has_full_disk():
        return
    with open('/dev/full', 'w', encoding='utf-8') as full:
        done = subprocess.run([s.program, *words], stdout=full, stderr=subprocess.PIPE, text=True, timeout=60 * PATIENCE)
    s.checks.true(done.returncode == FILE and 'standard output' in done.stderr, f'{words[-1]} on a full disk', done.stderr)


def test_talk(s):
    done = s.ends(DONE, 'a plain run', FIG1)
    s.checks.equal(done.stdout, '', 'the table is in a file: nothing on stdout')
    s.checks.true(done.stderr != '', 'a run reports on stderr')
    for option in ('--check', '--no-write', '--structure'):
        done = s.ends(DONE, f'--quiet {option}', FIG1, '--quiet', option)
        s.checks.equal(done.stderr, '', f'--quiet {option}: nothing on stderr')
    done = s.ends(DONE, '--quiet', FIG1, '--quiet')
    s.checks.equal((done.stdout, done.stderr), ('', ''), '--quiet: silent')
    s.checks.true(s.run('nowhere.nml', '--quiet').stderr != '', '--quiet still says what is wrong')


def test_report(s):
    s.ends(DONE, '--report', FIG1, '--report', 'report.json')
    report = json.loads(text_of(s.path('report.json')))
    s.checks.true(isinstance(report, dict) and 21 in report.values() or '21' in json.dumps(report),
                  'the report is JSON and counts 21 positions', report)
    s.ends(FILE, 'a report that cannot be written', FIG1, '--report', 'nowhere/report.json', says='nowhere/report.json')


def report_after(s, code, why, *arguments):
    """The report of a run that is expected to end so."""
    if s.exists('short.json'):
        os.remove(s.path('short.json'))
    s.ends(code, why, *arguments, '--report', 'short.json')
    report = json.loads(text_of(s.path('short.json')))
    s.checks.equal((report['program'], report['exit_code']), ('mech9k', code), f'{why}: the report tells program and exit code')
    s.checks.equal(report['errors'] == [], code == DONE, f'{why}: and what is wrong')
    return report


def test_reports_without_a_run(s):
    """Reports where no run was made: as much as is known."""
    s.checks.equal(report_after(s, DONE, 'a check', FIG1, '--check').get('title'),
                   'Fig. 1: two closed chains, one degree of freedom', 'the title of what was checked')
    report_after(s, DONE, 'the structure', FIG1, '--structure')
    wrong = s.write('wrong.nml', text_of(FIG1).replace("'revolute'", "'revolutte'", 1))
    error, = report_after(s, DATA, 'a misspelt kind', wrong)['errors']
    row, line = next((n, l) for n, l in enumerate(text_of(wrong).split('\n'), 1) if 'revolutte' in l)
    s.checks.equal((error['file'], error['line'], error['column']), (wrong, row, line.index("'revolutte'") + 1),
                   'the place of the error')
    s.checks.true("'revolute'" in error['message'], 'its message', error)
    error, = report_after(s, DATA, 'a wrong setting', FIG1, '--set', 'time.intervals=many')['errors']
    s.checks.true(error['file'] == '--set' and 'line' not in error, 'a setting has no line', error)
    errors = report_after(s, STRUCTURE, 'a wrong choice, a drive that is missing', FIG1, '--set', 'structure.cq=5, 1')['errors']
    s.checks.equal(['the mobility is' in error['message'] for error in errors], [True, False], 'both are told, the choice first')
    report_after(s, ASSEMBLY, 'what cannot be assembled', SLIDER, '--set', 'pair(4).point=0,2,0')
    report_after(s, FILE, 'no data file', 'nowhere.nml')
    report_after(s, FILE, 'results that cannot be opened', FIG1, '--table', 'nowhere/x.dat')
    report_after(s, USAGE, 'a plot of nothing', FIG1, '--plot', 'q99')


def test_reports_that_cannot_be_written(s):
    s.ends(FILE, 'a report of a check that cannot be written', FIG1, '--check', '--report', 'nowhere/report.json',
           says='nowhere/report.json')
    s.ends(DATA, 'nor one of an error', FIG1, '--set', 'time.intervals=many', '--report', 'nowhere/report.json',
           says=['nowhere/report.json', 'intervals'])


@pytest.mark.parametrize('words, named', (
    (['--check', '--table', 'x.dat', '--plot', 'q1'], '--table, --plot'),
    (['--plan', '--hdf5', 'x.h5'], '--hdf5'), (['--range', '--no-write'], '--no-write'),
    (['--structure', '--check', '--sketch', 'x.svg'], '--check, --sketch'),
    (['--starts', '3', '--no-write'], '--starts'), (['--check', '--view', 'xy'], '--view'),
    (['--view', 'xy', '--no-write'], '--view'),
    (['--check', '--sketch', 'x.svg', '--set', 'output.force_arrows=.true.'], 'force_arrows')),
    ids=lambda value: ' '.join(value) if isinstance(value, list) else value)
def test_options_without_effect(s, words, named):
    """Options that nothing comes of are named, unless all is to be quiet."""
    done = s.ends(DONE, ' '.join(words), FIG1, *words, says=f'mech9k: without effect: {named};')
    s.checks.equal(s.ends(DONE, 'quietly', FIG1, *words, '--quiet').stderr, '', f'{words}: quiet')
    s.checks.true(done.stderr.count('without effect') == 1, f'{words}: nothing else is said so', done.stderr)


@pytest.mark.parametrize('words', (
    ['--check', '--view', 'xy', '--sketch', 'x.svg'], ['--branches', '--starts', '3'], ['--check', '--range'],
    ['--view', 'xy', '--no-write', '--set', 'output.animation=x.html'], ['--table', 'x.dat']), ids=' '.join)
def test_options_with_effect(s, words):
    done = s.ends(DONE, ' '.join(words), FIG1, *words)
    s.checks.true('without effect' not in done.stderr, f'{words}: all have effect', done.stderr)


def test_overwriting(s):
    """A file that is read is not written over, by whatever name; nor is one result by another."""
    data = s.write('mine.nml', text_of(FIG1))
    os.makedirs(s.path('beside'))
    os.symlink(data, s.path('link.dat'))
    kept = text_of(data)
    for words in (['--table', data], ['--hdf5', 'mine.nml'], ['--table', 'beside/../mine.nml'], ['--table', 'link.dat'],
                  ['--report', 'mine.nml', '--check'], ['--graph', 'mine.nml'], ['--set', 'output.table=mine.nml']):
        s.ends(USAGE, ' '.join(words), data, *words, says='would overwrite')
        s.checks.true(text_of(data) == kept, f'{words}: the data file is as it was')
    s.ends(DONE, 'what is not written overwrites nothing', data, '--check', '--table', 'mine.nml')
    s.checks.equal(text_of(data), kept, 'nor does it')


def test_overwriting_a_drive(s):
    driven = s.write('driven.nml', text_of(FIG1).replace("kind='polynomial', coefficients=0.5, 6.0", "kind='table', file='motion.txt'"))
    motion = ''.join(f'{i / 4} {0.5 + i}\n' for i in range(5))
    s.write('motion.txt', motion)
    s.ends(DONE, 'a drive from a table', driven, '--no-write')
    s.ends(USAGE, 'a table over the drive', driven, '--table', 'motion.txt', says='would overwrite')
    s.checks.equal(text_of(s.path('motion.txt')), motion, 'the drive is as it was')


@pytest.mark.parametrize('words', (['--table', 'twice', '--hdf5', 'twice'], ['--table', 'twice', '--report', 'twice'],
                                   ['--set', 'output.hdf5=twice', '--report', 'twice']), ids=' '.join)
def test_two_results_in_one_file(s, words):
    s.ends(USAGE, ' '.join(words), FIG1, *words, says="cannot both be 'twice'")
    s.checks.true(not s.exists('twice'), f'{words}: nothing is written')


def test_misspelt_kind(s):
    text = text_of(FIG1)
    done = s.ends(DATA, 'a misspelt kind', s.write('kind.nml', text.replace("'revolute'", "'revolutte'", 1)),
                  says=["kind.nml:15:", "revolutte", "'revolute'"])
    s.checks.true('^^^' in done.stderr, 'the place is marked', done.stderr)


def test_line_ends_of_windows(s):
    crlf = s.write('crlf.nml', text_of(FIG1).replace('\n', '\r\n'))
    s.ends(DONE, 'line ends of Windows', crlf, '--table', 'crlf.dat')
    s.ends(DONE, 'a plain run', FIG1, '--table', 'plain.dat')
    same_tables(s.checks, s.table('plain.dat'), s.table('crlf.dat'), 'line ends of Windows change nothing')


def test_empty_file(s):
    s.ends(DATA, 'an empty file', s.write('empty.nml', ''))


def test_wrong_numbers_of_independent_coordinates(s):
    # the loop of seven revolutes is closed at q = 0, but has one freedom, not two
    seven = text_of(os.path.join(REFERENCE, 'kinematics_general_7r.nml'))
    two = s.write('two.nml', seven.replace('cq = 1', 'cq = 1, 2') + "&drive coordinate=2, kind='polynomial', coefficients=0.0 /\n")
    s.ends(STRUCTURE, 'two independent coordinates where one is free', two, '--check', says=['two.nml', '1, 2'])
    # a five-bar has two freedoms
    five = text_of(os.path.join(REFERENCE, 'dynamics_fivebar.nml'))
    one = s.write('one.nml', five.replace('cq = 1, 5', 'cq = 1').replace(', velocity=-0.5', '') +
                  "&drive coordinate=1, kind='polynomial', coefficients=2.1 /\n")
    s.ends(STRUCTURE, 'one independent coordinate where two are free', one, '--check', says=['one.nml', 'cq'])
    s.ends(DATA, 'an independent coordinate without drive', FIG1, '--set', 'structure.cq=1', '--check', says='no drive')
    s.ends(STRUCTURE, 'one without drive that is one too many', FIG1, '--set', 'structure.cq=5, 1', '--check',
           says=['the mobility is 1', 'no drive'])


def test_out_of_reach(s):
    # crank 0.3, rod 1, slider axis 2 off
    s.ends(ASSEMBLY, 'a mechanism that cannot be assembled', SLIDER, '--set', 'pair(4).point=0,2,0')


def test_dead_point(s):
    groups = [(group, dict(items)) for group, items in data_file.parse(text_of(SLIDER))]
    for group, items in groups:
        if group == 'structure':
            items['cq'] = [4]
        if group == 'drive':
            # the slider reaches out to sqrt(1.3^2 - 0.1^2) = 1.296 only
            items.update(coordinate=[4], coefficients=[1.2, 0.2])
        if group == 'initial' and items['coordinate'] == [4]:
            items.update(coordinate=[1], position=[0.5])
    path = s.write('dead_point.nml', data_file.write(groups))
    done = s.ends(SINGULAR, 'a slider driven beyond its dead point', path, '--table', 'dead.dat')
    kept = s.table('dead.dat')
    s.checks.true(1 <= len(kept['t']) < 11 and np.max(kept['q4']) <= np.sqrt(1.3 ** 2 - 0.1 ** 2),
                  'what was computed before the dead point is kept', kept['q4'])
    s.checks.true('4' in done.stderr and 't = ' in done.stderr, 'the coordinate and the time are named', done.stderr)


def test_degrees(s):
    """The same motion told in degrees: angles and their rates are scaled, everything else stays."""
    turn = 180.0 / np.pi
    groups = data_file.parse(text_of(SLIDER))
    for group, items in groups:
        if group == 'mechanism':
            items['angle_unit'] = ['deg']
        if group == 'drive':
            items['coefficients'] = [turn * c for c in items['coefficients']]
        if group == 'initial' and items['coordinate'] != [4]:
            items['position'] = [turn * x for x in items['position']]
    s.ends(DONE, 'angles in degrees', s.write('degrees.nml', data_file.write(groups)), '--table', 'degrees.dat')
    s.ends(DONE, 'angles in radians', SLIDER, '--table', 'radians.dat')
    radians, table = s.table('radians.dat'), s.table('degrees.dat')
    for column in radians:
        factor = turn if column.lstrip('d') in ('q1', 'q2', 'q3') else 1.0
        if column != 'closure':
            s.checks.near(table[column] / factor, radians[column], tolerance_of(column), f'in degrees: {column}')
