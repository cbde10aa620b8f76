"""Studies: rows of grids, lists and drawn values, each the numbers of a single run with these values; failing runs are rows with
their codes; the summary against the table; mistakes.
"""
import json
import os
import re

import numpy as np
import pytest

from mech9_cases import read_table, run, text_of

DONE, USAGE, DATA, FILE = 0, 2, 3, 8
SLIDER_CRANK = """&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&pair coordinate=2, links=2,3, kind='revolute', axis=0,0,1, point=0.3,0,0, moving_point=0,0,0 /
&pair coordinate=3, links=3,4, kind='revolute', axis=0,0,1, point=1.1,0,0, moving_point=0,0,0 /
&pair coordinate=4, links=1,4, kind='prismatic', axis=1,0,0, zero=0,1,0, moving_point=0,0,0 /
&initial coordinate=4, position=1.2 /
&drive coordinate=1, kind='polynomial', coefficients=0.4, 10 /
&point name='B', link=4 /
&time end=0.7, intervals=40 /
&quantity name='stroke', of='B.x', take='range' /
&quantity name='late', of='B.x', take='end' /
"""
PENDULUM = """&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&initial coordinate=1, position=0.4 /
&body link=2, mass=1, centre=0,-0.5,0, inertia=0,0,0.1,0,0,0 /
&gravity acceleration=0,-9.81,0 /
&time end=1, intervals=20 /
&parameter name='mass', sets='body.mass' , spread=0.1 /
&parameter name='depth', sets='body.centre(2)', spread=0.02, distribution='uniform' /
&quantity name='swing', of='q1', take='range' /
&quantity name='speed', of='dq1', take='peak' /
"""


class Cases:
    def __init__(self, checks, folder):
        self.checks, self.folder = checks, folder

    def write(self, text, name='case.nml'):
        path = os.path.join(self.folder, name)
        with open(path, 'w', encoding='utf-8') as file:
            file.write(text)
        return path

    def study(self, program, text, *more, why):
        """The table of a study, and what is printed beside it."""
        table = os.path.join(self.folder, 'study.dat')
        done = run(program, self.write(text), '--study', '--table', table, *more)
        self.checks.true(done.returncode == DONE, f'{why}: goes through', done.stderr)
        return read_table(text_of(table)), done.stderr

    def single(self, program, text, values):
        """Quantities of a single run with the values of a row."""
        report = os.path.join(self.folder, 'report.json')
        settings = [word for i, value in enumerate(values) for word in ('--set', f'parameter({i + 1}).value={float(value)!r}')]
        done = run(program, self.write(text), '--no-write', '--report', report, *settings)
        with open(report, encoding='utf-8') as file:
            return done.returncode, [one['value'] for one in json.load(file)['quantities']]


@pytest.fixture
def cases(checks, tmp_path):
    return Cases(checks, tmp_path)


def parameters(crank='', rod=''):
    return (f"&parameter name='crank', sets='pair(2).point(1)'{crank} /\n"
            f"&parameter name='rod', sets='pair(3).point(1)'{rod} /\n")


# A grid with cranks that are longer than their rods.
GRID = SLIDER_CRANK + parameters(', low=0.2, high=0.8, count=4', ', low=0.5, high=1.1, count=3') + "&study kind='grid' /\n"


def test_grid(cases, mech9k):
    """A grid: the order of its rows, strokes of twice the crank, and the rows where the crank is longer than the rod: a dead point.
    A crank as long as its rod passes the folded position, and its slider goes to the other side."""
    rows, printed = cases.study(mech9k, GRID, why='grid')
    check = cases.checks
    check.true(np.array_equal(rows['run'], np.arange(1, 13)), 'grid: runs are numbered', str(rows['run']))
    check.true(np.allclose(rows['crank'], np.repeat([0.2, 0.4, 0.6, 0.8], 3), atol=1e-15), 'grid: the first parameter', str(rows['crank']))
    check.true(np.allclose(rows['rod'], np.tile([0.5, 0.8, 1.1], 4), atol=1e-15), 'grid: the last parameter changes fastest', str(rows['rod']))
    whole = rows['crank'] < rows['rod'] + 1e-9
    shorter = rows['crank'] < rows['rod'] - 1e-9
    check.true(np.all(rows['exit_code'][whole] == DONE) and np.all(rows['exit_code'][~whole] != DONE),
               'grid: runs that cannot go on have a code', str(rows['exit_code']))
    check.true(np.allclose(rows['stroke'][shorter], 2 * rows['crank'][shorter], atol=1e-8), 'grid: the stroke is twice the crank', str(rows['stroke']))
    check.true(np.all(np.isnan(rows['stroke'][~whole])), 'grid: failed runs have no stroke')
    codes, counts = np.unique(rows['exit_code'][~whole], return_counts=True)
    for code, count in zip(codes, counts):
        check.true(re.search(rf'{count} runs? failed with exit code {int(code)}', printed), f'grid: code {code} is counted', printed)
    for i in (0, 6, 7, 11):
        code, found = cases.single(mech9k, GRID, (rows['crank'][i], rows['rod'][i]))
        check.true(code == rows['exit_code'][i], f'grid: run {i + 1} ends as alone', code)
        if code == DONE:
            # positions side by side and alone differ by round-off, and late corrections of either are squares of 1e-9
            check.true(np.allclose(found, [rows['stroke'][i], rows['late'][i]], rtol=1e-13, atol=1e-14),
                       f'grid: run {i + 1} has the numbers of a single run', found)


def test_list(cases, mech9k):
    cases.write('# crank rod\n0.25, 1.0\n\n0.3 1.1  # as written\n', 'designs.dat')
    text = SLIDER_CRANK + parameters() + "&study kind='list', file='designs.dat' /\n"
    rows, _ = cases.study(mech9k, text, why='list')
    cases.checks.true(list(rows['crank']) == [0.25, 0.3] and list(rows['rod']) == [1.0, 1.1], 'list: its values', str(rows))
    cases.checks.true(np.allclose(rows['stroke'], [0.5, 0.6], atol=1e-8), 'list: strokes', str(rows['stroke']))


@pytest.mark.parametrize('kind', ('random', 'latin', 'sobol'))
def test_drawn_values(cases, mech9d, kind):
    """Drawn values: the summary is that of the table; another number of runs does not change the first ones, but for strata."""
    text = PENDULUM + f"&study kind='{kind}', runs=32, seed=4 /\n"
    rows, printed = cases.study(mech9d, text, why=kind)
    for name in ('swing', 'speed'):
        line = re.search(rf'{name}: mean (\S+) (?:rad|rad/s) \(standard error (\S+)\), deviation (\S+) ', printed)
        told = [float(word) for word in line.groups()]
        mean, deviation = np.mean(rows[name]), np.std(rows[name], ddof=1)
        cases.checks.true(np.allclose(told, [mean, deviation / np.sqrt(32), deviation], rtol=5e-2, atol=1e-12)
                          and abs(told[0] - mean) <= 1e-7 * abs(mean), f'{kind}: summary of {name}', (told, mean, deviation))
    again, _ = cases.study(mech9d, text.replace('runs=32', 'runs=16'), why=kind)
    if kind != 'latin':
        cases.checks.true(all(np.array_equal(again[name][:16], rows[name][:16]) for name in ('mass', 'depth', 'swing')),
                          f'{kind}: a run does not depend on the number of runs')
    other, _ = cases.study(mech9d, text.replace('seed=4', 'seed=5'), why=kind)
    cases.checks.true(not np.array_equal(other['mass'], rows['mass']), f'{kind}: another seed draws others')
    code, found = cases.single(mech9d, text, (rows['mass'][5], rows['depth'][5]))
    cases.checks.true(code == DONE and found == [rows['swing'][5], rows['speed'][5]], f'{kind}: a row is a single run', found)


THREE_BY_THREE = SLIDER_CRANK + parameters(', low=0.2, high=0.4, count=3', ', low=0.9, high=1.1, count=3') + "&study kind='grid' /\n"


def test_rows_of_three_parts_are_those_of_the_whole_study(cases, mech9k):
    text = THREE_BY_THREE
    whole, _ = cases.study(mech9k, text, why='whole')
    rows = [cases.study(mech9k, text, '--part', f'{k}/3', why=f'part {k}')[0] for k in (1, 2, 3)]
    together = np.concatenate([part['run'] for part in rows])
    order = np.argsort(together)
    for name in whole:
        cases.checks.true(np.array_equal(np.concatenate([part[name] for part in rows])[order], whole[name]), f'parts: {name}')


def test_a_part_belongs_to_a_study(cases, mech9k):
    done = run(mech9k, cases.write(THREE_BY_THREE), '--part', '1/3')
    cases.checks.true(done.returncode == USAGE and '--part K/N is a part of --study or --optimize' in done.stderr, 'parts of studies and searches only', done.stderr)


@pytest.mark.parametrize('wrong', ('8/7', '0/3', '3', 'a/b', '1/2/3'))
def test_a_wrong_part_is_refused(cases, mech9k, wrong):
    done = run(mech9k, cases.write(THREE_BY_THREE), '--study', '--part', wrong)
    cases.checks.true(done.returncode == USAGE and "--part needs the number K of a part, from 1 to N, and how many parts N there are" in done.stderr,
                      f'part {wrong} is refused', done.stderr)


LARGE_GRID = SLIDER_CRANK + parameters(', low=0.2, high=0.8, count=20', ', low=0.5, high=1.1, count=15') + "&study kind='grid' /\n"
FORTY_RUNS = PENDULUM + "&study kind='random', runs=40 /\n"


@pytest.mark.parametrize('name, text', (('mech9k', LARGE_GRID), ('mech9d', FORTY_RUNS)), ids=('mech9k', 'mech9d'))
def test_the_same_bytes_from_any_number_of_threads(cases, build, name, text):
    """The same bytes from 1, 2, 3 and 8 threads: more than the cores, and more than waiting runs in their turn."""
    program = build.program(name)
    tables = []
    for n in ('1', '2', '3', '8'):
        _, printed = cases.study(program, text, '--threads', n, why=f'{n} threads')
        tables.append(text_of(os.path.join(cases.folder, 'study.dat')))
        summary = [line for line in printed.splitlines() if 'note: ' not in line and not re.match(r'\d+ runs?: ', line)]
        if n == '1':
            alone = summary
        cases.checks.true(tables[-1] == tables[0] and summary == alone, f'{n} threads: the same bytes', (summary, alone))


@pytest.mark.parametrize('words, message', (
    (('--threads', '2'), '--threads N is the number of threads of --study'),
    (('--study', '--threads', '0'), '--threads needs a whole number from 1 on'),
    (('--study', '--threads', '1025'), '--threads takes at most 1024')), ids=('no study', '0', '1025'))
def test_a_wrong_number_of_threads_is_refused(cases, mech9d, words, message):
    done = run(mech9d, cases.write(FORTY_RUNS), *words)
    cases.checks.true(done.returncode == USAGE and message in done.stderr, f'{words}: refused', done.stderr)


GIVEN = ', low=0.2, high=0.4, count=3'


@pytest.mark.parametrize('text, options, code, message', (
    (parameters(GIVEN) + "&study kind='grid' /", (), DATA, "parameter 'rod' needs 'low', 'high' and 'count' for a study on a grid"),
    (parameters(GIVEN, ", low=0.1, high=1") + "&study kind='grid' /", (), DATA, "parameter 'rod' needs 'count' for a study"),
    (parameters(GIVEN, ", count=3") + "&study kind='grid' /", (), DATA, "parameter 'rod' needs 'low' and 'high' for a study"),
    (parameters(GIVEN) + "&study kind='sobol', runs=3 /", (), DATA, "parameter 'rod' needs 'spread', or 'low' and 'high'"),
    (parameters(GIVEN, GIVEN) + "&study kind='random' /", (), DATA, "&study needs 'runs'"),
    (parameters(GIVEN, GIVEN) + "&study kind='grid', runs=3 /", (), DATA, "'runs' does not belong to studies of kind 'grid'"),
    (parameters() + "&study kind='list', file='none.dat' /", (), FILE, "the list 'none.dat'"),
    (parameters() + "&study kind='list', file='short.dat' /", (), DATA, 'there are 2 parameters, and this line has 1 value'),
    (parameters() + "&study kind='list', file='word.dat' /", (), DATA, "'long' is not a number"),
    (parameters(GIVEN, GIVEN) + "&study kind='grid' /\n&quantity name='force', of='F1', take='peak' /", (), DATA,
     "15:28: quantity 'force' is of column 'F1', which is not recorded; set drive_forces=.true. in &output"),
    (parameters(GIVEN, GIVEN) + "&study kind='grid' /\n&output sensitivities=.true. /", (), DATA,
     '15:23: a study records no sensitivities: leave out sensitivities in &output'),
    (parameters(GIVEN, GIVEN) + "&study kind='grid' /\n&quantity name='rod', of='q1', take='peak' /", (), DATA,
     "15:16: a parameter has the name 'rod' too"),
    (parameters(GIVEN, GIVEN) + "&study kind='grid' /\n&quantity name='run', of='q1', take='peak' /", (), DATA,
     "15:16: the table of a study has a column 'run' already"),
    (parameters(GIVEN, GIVEN).replace("'crank'", "'exit_code'") + "&study kind='grid' /", (), DATA,
     "12:17: the table of a study has a column 'exit_code' already"),
    (parameters(GIVEN, GIVEN).replace("'crank'", "'rod'") + "&study kind='grid' /", (), DATA, "a second &parameter for name 'rod'"),
    (parameters(GIVEN, GIVEN) + "&study kind='grid' /\n&quantity name='late', of='q1', take='peak' /", (), DATA,
     "a second &quantity for name 'late'"),
    ("&study kind='grid' /", (), DATA, 'a study needs at least one &parameter'),
    (parameters(), (), USAGE, '--study carries out the study of a group &study, and this file has none'),
    (parameters(GIVEN, GIVEN) + "&study kind='grid' /", ('--plot', 'q1'), USAGE, "no column of the results is named 'q1'; the columns are crank rod stroke late"),
    (parameters(GIVEN, GIVEN) + "&study kind='grid' /", ('--check',), USAGE, 'leave --check out')),
    ids=('no range', 'no count', 'no low and high', 'no spread', 'no runs', 'runs of a grid', 'no file', 'a value too few', 'a word', 'a column',
         'sensitivities', 'a name of a parameter', 'run', 'exit_code', 'two parameters of a name', 'two quantities of a name', 'no parameter',
         'no study', 'a column to plot', 'check'))
def test_mistakes(cases, mech9k, text, options, code, message):
    check = cases.checks
    table = cases.write('kept', 'kept.dat')
    cases.write('0.3\n', 'short.dat')
    cases.write('0.3 long\n', 'word.dat')
    done = run(mech9k, cases.write(SLIDER_CRANK + text + '\n'), '--study', '--table', table, *options)
    check.true(done.returncode == code and message in done.stderr, f'{text} {options}: {message}', f'{done.returncode}: {done.stderr}')
    check.true(text_of(table) == 'kept', f'{text} {options}: nothing is written over')


def test_the_first_failed_run_is_told_with_its_reason(cases, mech9k):
    text = GRID
    rows, printed = cases.study(mech9k, text, why='failures')
    first = int(rows['run'][rows['exit_code'] != DONE][0])
    code, _ = cases.single(mech9k, text, (rows['crank'][first - 1], rows['rod'][first - 1]))
    alone = run(mech9k, os.path.join(cases.folder, 'case.nml'), '--no-write', *(word for i, name in enumerate(('crank', 'rod')) for word in
                ('--set', f'parameter({i + 1}).value={float(rows[name][first - 1])!r}'))).stderr.splitlines()
    reason = next(line.split(': ', 1)[1] for line in alone if line.startswith(os.path.join(cases.folder, 'case.nml')))
    cases.checks.true(f'run {first}: {reason}' in printed, 'failures: the first one is told', (reason, printed))


@pytest.mark.parametrize('name, text', (
    ('mech9k', SLIDER_CRANK + parameters(', low=1.3, high=1.5, count=3', ', low=0.5, high=0.6, count=2') + "&study kind='grid' /\n"),
    ('mech9d', PENDULUM.replace('&initial coordinate=1, position=0.4 /\n', '') + "&study kind='random', runs=3 /\n")), ids=('mech9k', 'mech9d'))
def test_where_all_runs_fail_the_study_fails(cases, build, name, text):
    """It fails with the code of the first run, and the table is written."""
    table = os.path.join(cases.folder, 'failed.dat')
    done = run(build.program(name), cases.write(text), '--study', '--table', table)
    rows = read_table(text_of(table))
    cases.checks.true(done.returncode == rows['exit_code'][0] != DONE and 'run 1: ' in done.stderr, 'all fail: run 1', done.stderr)
    cases.checks.true(np.all(rows['exit_code'] != DONE), 'all fail: the table is written', rows['exit_code'])


def test_a_table_that_cannot_be_written(cases, mech9k):
    done = run(mech9k, cases.write(SLIDER_CRANK + parameters(', low=0.2, high=0.3, count=2', ', low=1, high=1.1, count=2') + "&study kind='grid' /\n"),
               '--study', '--table', os.path.join(cases.folder, 'none', 'x.dat'))
    cases.checks.true(done.returncode == FILE and 'table: ' not in done.stderr, 'a table that cannot be written is not told as written', done.stderr)


WAY = "&quantity name='way', of='B.x', take='integral' /\n"


def test_report(cases, mech9k):
    """The report has the runs, the failed ones by code, and least, greatest and mean of each column of the table; units are those of
    a single run."""
    check = cases.checks
    report = os.path.join(cases.folder, 'study.json')
    text = GRID + WAY
    rows, printed = cases.study(mech9k, text, '--report', report, why='report')
    told = json.loads(text_of(report))
    whole = rows['exit_code'] == DONE
    check.true(told['study'] == 'grid' and told['runs'] == 12 and told['exit_code'] == DONE, 'report: its runs', told)
    for one in told['failed_runs']:
        failed = rows['run'][rows['exit_code'] == one['exit_code']]
        check.true(one['runs'] == len(failed) and one['first_run'] == failed[0], 'report: failed runs', one)
    check.true(sum(one['runs'] for one in told['failed_runs']) == np.sum(~whole), 'report: all failed runs', told['failed_runs'])
    for ranges, kept, names in ((told['parameters'], rows['run'] > 0, ['crank', 'rod']), (told['quantities'], whole, ['stroke', 'late', 'way'])):
        check.true([one['name'] for one in ranges] == names, 'report: names', ranges)
        for one in ranges:
            column = rows[one['name']][kept]
            check.true(one['least'] == column.min() and one['greatest'] == column.max()
                       and np.isclose(one['mean'], column.mean(), rtol=1e-13, atol=1e-15), f"report: {one['name']}", one)
    units = re.search('# units: (.*)', text_of(os.path.join(cases.folder, 'study.dat'))).group(1)
    check.true(re.fullmatch(r'\s*1\s+m\s+m\s+m\s+m\s+m_s\s+1\s*', units), 'units of the table', units)
    check.true(re.search(r'^stroke: \S+ to \S+ m$', printed, re.M) and re.search(r'^way: \S+ to \S+ m s$', printed, re.M), 'units of the summary', printed)


def test_a_part_without_runs_is_told(cases, mech9k):
    done = run(mech9k, cases.write(GRID + WAY), '--study', '--part', '13/20', '--no-write')
    cases.checks.true(done.returncode == DONE and 'note: this part has no runs: the study has 12\n' in done.stderr, 'an empty part is told', done.stderr)


def test_too_many_values_for_one_parameter(cases, mech9k):
    cases.write('0.3 0.4\n', 'long.dat')
    done = run(mech9k, cases.write(SLIDER_CRANK + parameters().splitlines()[0] + "\n&study kind='list', file='long.dat' /\n"), '--study')
    cases.checks.true('there is 1 parameter, and this line has 2 values' in done.stderr, 'one parameter', done.stderr)


def test_a_wrong_parameter_is_one_error(cases, mech9k):
    done = run(mech9k, cases.write(SLIDER_CRANK + parameters(', lo=1').splitlines()[0] + "\n&study kind='grid' /\n"), '--study')
    cases.checks.true("unknown name 'lo'" in done.stderr and 'at least one' not in done.stderr, 'a wrong parameter is one error', done.stderr)


def test_a_program_has_the_threads_of_its_build(checks, build, tmp_path):
    """A build that found OpenMP uses it; another one tells that one core makes the runs."""
    found = bool(build.settings.get('OpenMP_Fortran_FLAGS')) and build.kind not in ('Debug', 'Sanitize', 'Threads')
    for name, text in (('mech9k', SLIDER_CRANK + "&parameter name='crank', sets='pair(2).point(1)', low=0.2, high=0.8, count=9 /\n&study kind='grid' /\n"),
                       ('mech9d', PENDULUM + "&study kind='random', runs=9, seed=1 /\n")):
        done = run(build.program(name), Cases(checks, tmp_path).write(text), '--study', '--threads', '2', folder=tmp_path)
        checks.equal(done.returncode, DONE, f'{name}: two threads make a study; {done.stderr}')
        checks.equal('built without threads' in done.stderr, not found, f'{name}: threads are there where OpenMP was found')
