"""Names of links and pairs in what the programs write: columns by --names, plots, --check, drawings, graphs, reports, HDF5 files.

Compares the program with itself: columns by names with those by numbers.
"""
import json
import os

import numpy as np
import pytest

from four_bars import NAMED_BARS
from mech9_cases import TREE, read_table, run, text_of

DONE, USAGE = 0, 2

FOUR_BAR = NAMED_BARS + """&point name='P', link=3, position=0.5,0.1,0 /
&drive coordinate='A', kind='polynomial', coefficients=0.4, 10 /
&body link='rocker', mass=2, centre=0.4,0,0, inertia=0,0,0.1,0,0,0 /
&time end=0.2, intervals=8 /
&parameter name='length', sets='pair(C).point(1)' /
&output reactions=.true., drive_forces=.true., sensitivities=.true. /
"""


def write(folder, text=FOUR_BAR):
    path = os.path.join(folder, 'case.nml')
    with open(path, 'w', encoding='utf-8') as file:
        file.write(text)
    return path


def test_columns_by_names(checks, build, tmp_path):
    path = write(tmp_path)
    for name in ('mech9k', 'mech9d'):
        tables = [read_table(run(build.program(name), path, '--quiet', *options).stdout) for options in ((), ('--names',))]
        by = {'q1': 'A.q', 'dq3': 'C.dq', 'ddq4': 'D.ddq', 'q2': 'q2', 'P.x': 'P.x', 'F1': 'A.drive', 'R4.fx': 'D.fx', 'R2.mz': 'R2.mz',
              'd(q4)/d(length)': 'd(D.q)/d(length)', 'd(R3.fy)/d(length)': 'd(C.fy)/d(length)', 't': 't'}
        checks.true(len(tables[0]) == len(tables[1]), f'{name}: as many columns')
        for number, named in by.items():
            checks.true(named in tables[1] and np.array_equal(tables[0][number], tables[1][named]), f'{name}: {number} is {named}')
        checks.true([column for column in tables[1] if column.startswith(('q1', 'dq3', 'R4'))] == [], f'{name}: no such number is left')


def test_plots_by_names(checks, mech9k, tmp_path):
    path = write(tmp_path)
    for options, labels in ((('--plot', 'plot.svg:A.q:D.q,D.dq'), ('q1', 'q4', 'dq4')), (('--names', '--plot', 'plot.svg:q1:q4,D.dq'), ('A.q', 'D.q', 'D.dq'))):
        done = run(mech9k, path, '--table', 'case.dat', *options, folder=tmp_path)
        checks.true(done.returncode == DONE, f'{options}: {done.stderr[:300]}')
        script = text_of(os.path.join(tmp_path, 'plot.gp'))
        checks.true(all(label in script for label in labels), f'{options}: labels {labels}')
    done = run(mech9k, path, '--plot', 'E.q', '--quiet', folder=tmp_path)
    checks.true(done.returncode == USAGE, 'a name that no pair has is no column')


def test_check_tells_names(checks, mech9k, tmp_path):
    said = run(mech9k, write(tmp_path), '--check').stdout.splitlines()
    checks.true(any(line.split()[:4] == ['2', '1', 'and', '2'] and line.endswith('  crank: A and 2') for line in said), 'dimensions of the crank')
    checks.true(any(line.startswith('  q4') and line.endswith('  D') for line in said), 'coordinates at the start')
    checks.true(said[1] == 'independent: 1 (A)' and 'could be independent instead of 1 (A): 2, 3 (C), 4 (D)' in said, f'independent coordinates: {said}')
    plain = FOUR_BAR
    for name, number in (('crank', 2), ('rocker', 4), ('A', 1), ('D', 4)):
        plain = plain.replace(f"name='{name}', links", 'links').replace(f"'{name}'", str(number))
    plain = '\n'.join(line for line in plain.replace("name='C', ", '').replace('pair(C)', 'pair(3)').splitlines() if not line.startswith('&link')) + '\n'
    unnamed = run(mech9k, write(tmp_path, plain), '--check')
    checks.true(unnamed.returncode == DONE and not any(line != line.rstrip() for line in unnamed.stdout.splitlines()), f'without names: {unnamed.stderr}')


def test_plan_range_and_assemblies_tell_names(checks, mech9k, tmp_path):
    path = write(tmp_path)
    said = run(mech9k, path, '--plan').stdout
    checks.true('block 1: links 2 (crank), 3, 4 (rocker)' in said and 'solved for: 2, 4 (D), 3 (C) from' in said, f'the plan: {said}')
    checks.true('without mass, no terms of inertia: links 2 (crank), 3\n' in said, f'links without mass: {said}')
    said = run(mech9k, path, '--range').stdout.splitlines()
    checks.true(said[1].split()[4:7] == ['unit', 'name', 'limited'], f'a column of names: {said}')
    checks.true(said[2].split()[0] == 'q1' and said[2].split()[4:6] == ['rad', 'A'], f'the range of a coordinate: {said}')
    said = run(mech9k, path, '--branches')
    checks.true("&initial coordinate='C', position=" in said.stdout and '&initial coordinate=2, position=' in said.stdout, f'assemblies: {said.stdout}')
    with open(path, 'a', encoding='utf-8') as file:
        file.write(''.join(line + '\n' for line in said.stdout.splitlines()[1:4] if "'D'" not in line))
    checks.equal(run(mech9k, path, '--check').returncode, DONE, 'assemblies go into the data file')


def test_reports_in_words_have_names(checks, mech9k, mech9d, tmp_path):
    path = write(tmp_path)
    said = run(mech9k, path, '--table', 'case.dat', folder=tmp_path).stderr
    checks.true('closed chain 1 (coordinates 2, 3 (C), 4 (D))' in said, f'the chain in the worst position: {said}')
    said = run(mech9k, path, '--check').stdout
    checks.true('\n  pair 3 (C): force along z, moment about x y; columns R3.fz' in said, f'forces that are not determined: {said}')
    said = run(mech9k, write(tmp_path, FOUR_BAR.replace('0.4, 10', '0.4')), '--table', 'case.dat', folder=tmp_path).stderr
    checks.true('note: the drive of coordinate 1 (A) stands still' in said, f'notes: {said}')


def test_drawings_and_graphs_show_names(checks, mech9k, tmp_path):
    path = write(tmp_path)
    checks.true(run(mech9k, path, '--check', '--sketch', 'case.svg', folder=tmp_path).returncode == DONE, 'a sketch is drawn')
    picture = text_of(os.path.join(tmp_path, 'case.svg'))
    checks.true(all(f'>{label}<' in picture for label in ('A', 'C', 'D', 'crank', 'rocker', 'P')), 'names stand in the sketch')
    checks.true('>3<' in picture and '>4<' not in picture, 'numbers stand where there is no name')
    checks.true(run(mech9k, path, '--graph', 'case.dot', folder=tmp_path).returncode == DONE, 'a graph is drawn')
    graph = text_of(os.path.join(tmp_path, 'case.dot'))
    labels = ('q1 A revolute', 'q4 D revolute', r'2\ncrank', r'4\nrocker', '1 frame', ' for q2, q4 D, q3 C')
    checks.true(all(label in graph for label in labels), f'names stand in the graph: {graph}')


def test_reports_have_names(checks, mech9k, tmp_path):
    run(mech9k, write(tmp_path), '--table', 'case.dat', '--report', 'case.json', folder=tmp_path)
    report = json.loads(text_of(os.path.join(tmp_path, 'case.json')))
    checks.true(report['link_names'] == ['', 'crank', '', 'rocker'] and report['coordinate_names'] == ['A', '', 'C', 'D'], 'names by numbers')


def test_hdf5_files_have_names(checks, mech9k, tmp_path):
    h5py = pytest.importorskip('h5py')
    done = run(mech9k, write(tmp_path), '--hdf5', 'case.h5', folder=tmp_path)
    checks.true(done.returncode == DONE, f'the file is written: {done.stderr[:300]}')
    with h5py.File(os.path.join(tmp_path, 'case.h5')) as file:
        checks.true([text.decode().strip() for text in file['coordinate_name'][()]] == ['A', '', 'C', 'D'], 'names of pairs')
        checks.true([text.decode().strip() for text in file['structure/link_name'][()]] == ['', 'crank', '', 'rocker'], 'names of links')
        checks.true('q' in file and file['q'].shape == (9, 4), 'columns stay numbered')


def test_structure_tells_names(checks, mech9k, mech9d, tmp_path):
    """The names stand beside the vectors, which keep their numbers; --quiet leaves them out."""
    path = write(tmp_path)
    for program in (mech9k, mech9d):
        done = run(program, path, '--structure')
        checks.true('links: 2 (crank), 4 (rocker)\ncoordinates: 1 (A), 3 (C), 4 (D)\n' in done.stderr, f'the names: {done.stderr}')
        checks.true(done.stdout.startswith('nrg = ') and '(' not in done.stdout, f'the vectors: {done.stdout}')
        checks.equal(run(program, path, '--structure', '--quiet').stderr, '', 'nothing else where it is quiet')
    unnamed = write(tmp_path, "&structure cq=1 /\n&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /\n")
    checks.true('links:' not in run(mech9k, unnamed, '--structure').stderr, 'no list without names')


def test_cams_by_names(checks, mech9k, tmp_path):
    text = text_of(os.path.join(TREE, 'examples', 'dwell_cam', 'dwell_cam.nml')).replace("coordinate=1, links=1,2", "coordinate=1, name='shaft', links=1,2")
    path = write(tmp_path, text + "&link number=2, name='disc' /\n")
    tables = []
    for options in ((), ('--names',)):
        done = run(mech9k, path, '--cam', '1:cam.dat', *options, folder=tmp_path)
        checks.true(done.returncode == DONE and 'without effect' not in done.stderr, f'{options}: {done.stderr}')
        checks.true('cam 1: link 2 (disc), and a roller' in done.stderr, f'the cam has its name: {done.stderr}')
        tables.append(read_table(text_of(os.path.join(tmp_path, 'cam.dat'))))
    checks.true('q1' in tables[0] and 'shaft.q' not in tables[0] and 'q1' not in tables[1], f'columns: {list(tables[1])}')
    checks.true(np.array_equal(tables[0]['q1'], tables[1]['shaft.q']), 'the same numbers')


def test_poles_tell_names(checks, mech9k, tmp_path):
    done = run(mech9k, write(tmp_path), '--no-write', '--animate', 'film.svg', '--set', "output.poles=3,'rocker'", folder=tmp_path)
    checks.equal(done.returncode, DONE, done.stderr)
    picture = text_of(os.path.join(tmp_path, 'film.svg'))
    checks.true('<title>velocity pole of link 4 (rocker)</title>' in picture and '<title>velocity pole of link 3</title>' in picture, 'poles')


def test_events_tell_names(checks, mech9d, tmp_path):
    """Stops and frictions have the names of their pairs in the lines of a run and under the pointer in a film."""
    path = write(tmp_path, """&structure cq='slide' /
&pair coordinate=1, name='slide', links=1,2, kind='prismatic', axis=1,0,0 /
&body link=2, mass=1, inertia=1,1,1,0,0,0 /
&initial coordinate='slide', position=0.5, velocity=-2 /
&stop coordinate='slide', low=0, restitution=0.5 /
&friction coordinate='slide', dynamic=0.1 /
&gravity acceleration=0,-9.81,0 /
&time end=2, intervals=20 /
""")
    done = run(mech9d, path, '--no-write', '--animate', 'film.svg', folder=tmp_path)
    checks.true(' s: stop 1 (slide) is hit, impulse' in done.stderr and ' s: friction 1 (slide) sticks' in done.stderr, f'events: {done.stderr}')
    picture = text_of(os.path.join(tmp_path, 'film.svg'))
    for title in ('stop 1: low end of q1 (slide) at 0 m', 'friction 1: q1 (slide) sticks'):
        checks.true(f'<title>{title}' in picture, title)
