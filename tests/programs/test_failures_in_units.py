"""Failures of files in other units: the same sentence, with its numbers in the units of the file.

Compares the program with itself: the message of a file in SI and that of the same mechanism in other units.
"""
import copy
import os
import re
import sys

import pytest

import data_file
import file_units
from mech9_cases import run
from unit_runs import NAMED, into_radians

sys.path.insert(0, os.path.dirname(__file__))
from test_failure_messages import DRIVEN, FREE

# kinds whose sentences tell numbers with units
WITH_UNITS = ('open_chain', 'nearly_closed_chain', 'locked_chain', 'nearly_moving_chain', 'stop_passed', 'stop_start', 'stop_violated',
              'contact_start', 'contact_violated', 'contact_behind', 'contact_passed', 'open_position', 'lost_link', 'off_curve', 'off_table',
              'no_equilibrium', 'start_on_branches', 'dead_point', 'escape', 'lost_branch', 'driven_dead_point')
CASES = [(program, *case[:4]) for program, cases in (('mech9k', DRIVEN), ('mech9d', FREE)) for case in cases if case[0] in WITH_UNITS]
NUMBER = re.compile(r'(?<![\w.])(-?\d+(?:\.\d+)?(?:[eE][-+]?\d+)?)(?: (mm/s|deg/s|in/s|m/s|rad/s|mm|deg|in|m|rad)\b)?')


def sentence(said):
    """The sentence of a failure, without its place."""
    line = next(line for line in said.splitlines() if re.match(r'(case\.nml|mech9[kd]):', line))
    return re.sub(r'^(case\.nml:(\d+:\d+:)?|mech9[kd]:) ', '', line)


def parts_of(text, moves, units):
    """The words of a sentence, without numbers and units, and the numbers in SI with the digits that they have."""
    numbers = []
    forces = re.search(r'push with \(([^()]*), ([^(),]*)\): (.*?)\. Give', text)
    sizes = {'slide': forces and file_units.si_of(forces[2].replace(' ', '_')), 'turn': forces and file_units.si_of(forces[1].replace(' ', '_'))}

    def take(match):
        value, unit = float(match[1]), match[2]
        before, behind = text[:match.start()], text[match.end():]
        named = re.search(r'\b(d?)q(\d+) = $', before)
        pushed = re.match(r' on coordinate (\d+)', behind) if forces else None
        placed = re.search(r'on coordinate (\d+) at $', before) if forces else None
        if unit:
            value *= file_units.si_of(unit)
        elif named:
            value *= units.size('r' if named[1] else 'q', moves[int(named[2])])
        elif pushed:
            value *= sizes[moves[int(pushed[1])]]
        elif placed:
            value *= units.size('q', moves[int(placed[1])])
        digits = len(re.sub(r'[eE].*|[-.]', '', match[1]).lstrip('0'))
        numbers.append((value, digits))
        return 'N u' if unit else 'N'
    return re.sub(r'\([^()]*(rad|deg|rpm)[^()]*\)|with \([^()]*\)', '()', NUMBER.sub(take, text)), numbers


@pytest.mark.parametrize('program, kind, text, options, code', CASES, ids=[case[1] for case in CASES])
def test_sentence_in_units(checks, build, tmp_path, program, kind, text, options, code):
    if not re.search(r'&mechanism\b', text):
        text = '&mechanism /\n' + text
    if isinstance(options, dict):
        for name in options:
            if not name.startswith('--'):
                with open(os.path.join(tmp_path, name), 'w', encoding='utf-8') as file:
                    file.write(options[name])
        text = re.sub(r"file='", f"file='{tmp_path}/", text)
        options = [name for name in options if name.startswith('--')]
    groups = data_file.parse(text)
    degrees = dict(groups)['mechanism'].get('angle_unit') == ['deg']
    if degrees:
        groups = [(group, dict(items)) for group, items in groups]
        into_radians(groups)
    moves = file_units.motions(groups)
    found = []
    for units in (file_units.FileUnits(), *NAMED):
        with open(os.path.join(tmp_path, 'case.nml'), 'w', encoding='utf-8') as file:
            file.write(data_file.write(file_units.in_units(copy.deepcopy(groups), units, tmp_path)))
        done = run(build.program(program), 'case.nml', '--quiet', '--no-write', *options, folder=tmp_path)
        if not checks.equal(done.returncode, code, f'{kind}, {units}: exit code; {done.stderr}'):
            return
        said = sentence(done.stderr or done.stdout)
        found.append((said, *parts_of(said, moves, units)))
        words, numbers = found[-1][1:]
        checks.equal(words, found[0][1], f'{kind}, {units}: the words')
        for (value, digits), (expected, more) in zip(numbers, found[0][2]):
            # numbers of few digits are rounded in either unit; those that are small beside others are round-off
            checks.near(value, expected, 1.1 * 10.0 ** (1 - max(min(digits, more), 1)), f'{kind}, {units}: a number of: {said}',
                        scale=max(abs(expected), 1e-9))
    checks.true(any(said[0] != found[0][0] for said in found[1:]), f'{kind}: some numbers differ', found[0][0])
