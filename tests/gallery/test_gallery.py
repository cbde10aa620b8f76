"""Each example of the gallery against its expected.txt, the options that its README tells to try, and its picture.

A line of expected.txt is one of
    # a comment
    let name = expression
    where | left | right | tolerance | why      |left - right| <= tolerance max(scale, |right|)
    --option | line | why                       the program, run with this option alone, prints this line
where is `every row`, `first`, `last` or `t = number`. Expressions are of columns (q1, dq4, P.x), of points as wholes
(distance(A, B)), numbers, + - * / **, functions of numpy, rad() and deg(), first(): the value of the first row. The scale is the
largest value of `left` in any row, but at most 1; where that is below the tolerance, 1.

A tolerance is an expression of numbers and of the names
    closed           Newton's method closes chains to 32 units of round-off of the size of the mechanism; the least conditioning
                     of the run divides it, and up to ten coordinates add up in a place
    rates            the same, divided by the conditioning once more
    accelerations    and again
    tolerance        the relative tolerance of an integration, which bounds the error of a step
    steps            the tolerance times the number of steps: the errors of all steps add up
A factor, or a number in place of a name, has its reason in its line or at the head of the file.
"""
import os
import re
import shlex
import xml.etree.ElementTree

import numpy as np
import pytest

from gallery_list import examples
from mech9_cases import run, table_and_report, text_of

FUNCTIONS = {name: getattr(np, name) for name in 'sin cos tan arcsin arccos arctan arctan2 sqrt exp log floor where pi'.split()}
FUNCTIONS.update(rad=np.radians, deg=np.degrees, first=lambda x: x[0],
                 distance=lambda a, b: np.sqrt(sum((x - y) ** 2 for x, y in zip(a, b))), __builtins__={})


def names_of(table):
    """Names that an expression may hold: columns, with P.x spelt P_x, and points as their three components."""
    known = dict(FUNCTIONS)
    for column, values in table.items():
        known[column.replace('.', '_')] = values
        if column.endswith('.x') and column[:-2] + '.z' in table:
            point = column[:-2]
            known[point] = tuple(table[f'{point}.{axis}'] for axis in 'xyz')
    return known


def value_of(expression, known):
    # a dot between a name and a component, not one within a number
    return eval(re.sub(r'\b([A-Za-z]\w*)\.([A-Za-z])', r'\1_\2', expression), known)


def rows_of(where, t):
    """The rows meant, as a selection; none if the table has no such time."""
    if where in ('every row', 'first', 'last'):
        return {'every row': slice(None), 'first': slice(0, 1), 'last': slice(-1, None)}[where]
    time = float(re.fullmatch(r't = (\S+)', where).group(1))
    return np.flatnonzero(np.abs(t - time) <= 1e-12 * max(1.0, abs(time)))


def tolerances_of(report):
    """The names that a tolerance may hold."""
    conditioning = report.get('least_conditioning', 1.0)
    closed = 10 * 32 * np.finfo(float).eps / conditioning
    tolerance = report.get('relative_tolerance', 0.0)
    return {'closed': closed, 'rates': closed / conditioning, 'accelerations': closed / conditioning ** 2,
            'tolerance': tolerance, 'steps': tolerance * report['steps'], '__builtins__': {}}


def check_values(checks, table, known, where, left, right, tolerance, why):
    rows = rows_of(where, table['t'])
    count = len(table['t'])
    values, expected = (np.broadcast_to(value_of(side, known), (count,)) for side in (left, right))
    largest = np.max(np.abs(values))
    checks.near(values[rows], expected[rows], tolerance, f'{where}: {left} = {right} ({why})',
                scale=min(1.0, largest) if largest > tolerance else 1.0)


def program_of(example, build):
    """The program of an example. With user procedures it is named after their first source (trammel.f90: trammel_k)."""
    if not example.procedures:
        return build.program(example.program)
    first = os.path.splitext(os.path.basename(example.procedures[0]))[0]
    return build.program(f'{first}_{example.program[-1]}')


def options_of(example):
    """The commands that the README says to try: the options between backticks."""
    page = text_of(os.path.join(os.path.dirname(example.data), 'README.md'))
    return [text for text in re.findall(r'`(--[^`]+)`', page) if '...' not in text]


EXAMPLES = examples()
TRIED = [(example, text) for example in EXAMPLES for text in options_of(example)]
EACH_EXAMPLE = pytest.mark.parametrize('example', EXAMPLES, ids=[example.name for example in EXAMPLES])


@EACH_EXAMPLE
def test_expected_numbers(checks, build, example):
    program = program_of(example, build)
    table, report = table_and_report(program, example.data)
    checks.true(all(np.all(np.isfinite(values)) for values in table.values()), 'all numbers are finite')
    # closed to round-off: 1e-16 of the size of the mechanism, times the conditioning of its chains
    size = report.get('size', 1.0)
    checks.true(np.max(table['closure']) <= 1e-12 * size, 'the chains are closed in every row', np.max(table['closure']))
    known = names_of(table)
    with open(os.path.join(os.path.dirname(example.data), 'expected.txt'), encoding='utf-8') as file:
        lines = [line.split('#')[0].strip() for line in file]
    for line in filter(None, lines):
        parts = [part.strip() for part in line.split('|')]
        if line.startswith('let '):
            name, expression = line[4:].split('=', 1)
            known[name.strip()] = value_of(expression, known)
        elif line.startswith('--'):
            option, wanted, why = parts
            done = run(program, example.data, option)
            checks.true(wanted in done.stdout.splitlines(), f'{option} tells: {wanted} ({why})', done.stdout)
        else:
            where, left, right, tolerance, why = parts
            check_values(checks, table, known, where, left, right, eval(tolerance, tolerances_of(report)), why)
    checks.true(checks.passed > 3, 'there is more to compare than that it runs')


@pytest.mark.parametrize('example, text', TRIED, ids=[f'{example.name} {text}' for example, text in TRIED])
def test_options_to_try(checks, tmp_path, build, example, text):
    """They are understood, whatever comes of them."""
    done = run(program_of(example, build), example.data, *shlex.split(text), folder=tmp_path)
    # 2 and 3: wrong options, wrong values
    checks.true(done.returncode in (0, 4, 5, 6, 7), f'{text}: ends with {done.returncode}', done.stderr)


def check_page(checks, root, path):
    """Links, paths and guides lie within the page. Symbols, which are moved as wholes, are small."""
    width, height = (float(number) for number in root.get('viewBox').split()[2:])
    lines = [part.get('d') for group in root.iter() if group.get('data-i') and not group.get('transform')
             for part in group if part.get('d')]
    places = np.array([[float(x), float(y)] for line in lines for x, y in re.findall(r'[ML](\S+) ([^MLZ\s]+)', line)])
    checks.true(len(places) > 1 and np.all(places >= 0) and np.all(places <= [width, height]),
                f'{path}: nothing lies outside of the page', f'{places.min(0)} {places.max(0)} of {width} {height}')


@EACH_EXAMPLE
def test_picture(checks, tmp_path, build, example):
    """The picture beside the README, and one drawn now: drawings that a browser can read, of this mechanism."""
    drawn = os.path.join(tmp_path, 'drawn.svg')
    done = run(program_of(example, build), example.data, '--sketch', drawn, '--no-write', folder=tmp_path)
    checks.equal(done.returncode, 0, f'it can be drawn\n{done.stderr}')
    titles = []
    for path in (drawn, os.path.join(os.path.dirname(example.data), example.name + '.svg')):
        root = xml.etree.ElementTree.parse(path).getroot()
        checks.true(root.tag.endswith('}svg') and len(list(root.iter())) > 20, f'{path} is a drawing')
        check_page(checks, root, path)
        titles.append([text.text for text in root.iter() if text.tag.endswith('}title')][:1])
    checks.equal(titles[1], titles[0], 'the picture beside the README has the title of the data file')
