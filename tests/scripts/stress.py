"""A stress test: more than a thousand generated mechanisms, run by the program and followed apart from it.

Each ends either in the motion that continuation by arc length finds, its chains closed to round-off, or with the right
exit code. Seeds are fixed. Prints a summary; tests/robustness.md keeps one.

tests/programs/test_stress.py tests each variant of a family by itself. This script runs all of them and prints the summary:

usage: stress.py MECH9K [MEMBERS [SEED [FAMILY]]]      MEMBERS of each variant of a family, 25 if left out

Data files of failures are kept in the folder that MECH9_STRESS_KEEP names.
"""
import collections
import json
import multiprocessing
import os
import re
import subprocess
import sys
import tempfile
import time

import numpy as np

import families
from loops import Loops, courses
from mech9_cases import Checks, read_table, run

CLOSED = 1e-12             # gap of loops gone round in numpy from the table's coordinates, lengths divided by the size
RATES = 1e-10              # J dq of what it is made of: a backward stable solution leaves round-off ...
REDUNDANT = 1e-14          # ... but a redundant chain sees what the block before it leaves open, this over the square of
                           # its least singular value
ACCELERATIONS = 1e-5       # second differences at 1e-4: round-off 1e-8, truncation 1e-8 that grows beside dead points
LIMIT = 1e-9               # of the driven coordinate at a dead point, as promised [rad, sizes]
ALLOWED_FOR = 1000.0       # data_tolerance against an error of one dimension: conditioning enlarges what stays open
SECONDS = 60               # of processor time, for a run of milliseconds; checked builds take a hundred times as long


SEED = 1995


class Mechanism:
    """One member of a family: what the data file says, and how it is run."""

    def __init__(self, family, loops, member, size, intervals, guess):
        self.family, self.loops, self.member, self.size = family, loops.take([member]), member, size
        self.intervals, self.guess, self.changes, self.start = intervals, guess, {}, {}
        self.data_tolerance = 0.0

    def unit(self):
        """Of each coordinate: 1 where a pair turns, the size where it slides."""
        return np.where(self.loops.turns[0] > 0, 1.0, self.size)

    def text(self):
        loops, lines = self.loops, [f"&mechanism title='{self.family} {self.member}', links={self.loops.links.max()}, "
                                    f'coordinates={len(self.loops.links)}, data_tolerance={float(self.data_tolerance)!r} /',
                                    '&structure cq=' + ','.join(str(k + 1) for k in self.loops.inputs) + ' /']
        for k, (reference, moving) in enumerate(loops.links):
            turns, slides = loops.turns[0, k], loops.slides[0, k]
            kind = 'prismatic' if not turns else 'helical' if slides else 'revolute'
            words = [f"&pair coordinate={k + 1}, links={reference},{moving}, kind='{kind}'",
                     'point=' + three(loops.point[0, k] * self.size), 'axis=' + three(loops.axis[0, k])]
            if kind == 'helical':
                words.append(f'pitch={float(2 * np.pi * slides * self.size)!r}')
            if k in self.changes:
                words.append('moving_point=' + three(self.changes[k] * self.size))
            lines.append(', '.join(words) + ' /')
        unit = self.unit()
        for k, value in enumerate(self.guess):
            if value and k not in loops.inputs:
                lines.append(f'&initial coordinate={k + 1}, position={float(value * unit[k])!r} /')
        for k, rate in zip(loops.inputs, loops.rates[0]):
            lines.append(f"&drive coordinate={k + 1}, kind='polynomial', coefficients={float(self.start.get(k, 0.0))!r}, "
                         f'{float(rate * unit[k])!r} /')
        return '\n'.join(lines + [f'&time start=0, end=1, intervals={self.intervals} /']) + '\n'


def three(vector):
    return ','.join(repr(float(x)) for x in vector)


class Stress:
    """Runs mechanisms and keeps the counts."""

    def __init__(self, mech9k, folder, seed, checks=None):
        self.mech9k, self.folder, self.seed, self.checks = mech9k, folder, seed, checks or Checks()
        self.counts = collections.defaultdict(collections.Counter)
        self.worst = collections.defaultdict(float)
        self.unsettled = 0

    def run(self, mechanism):
        """Exit code, stderr, table (or None) and report (or None)."""
        path, table, report = (os.path.join(self.folder, name) for name in ('case.nml', 'case.dat', 'case.json'))
        for name in (table, report):
            if os.path.exists(name):
                os.remove(name)
        with open(path, 'w', encoding='utf-8') as file:
            file.write(mechanism.text())
        began = time.monotonic()
        try:
            done = run(self.mech9k, path, '--table', table, '--report', report, '--quiet', folder=self.folder, timeout=SECONDS)
        except subprocess.TimeoutExpired:
            return None, f'not done after {SECONDS} s', None, None
        self.note('seconds', time.monotonic() - began)
        rows = kept = None
        if done.returncode in (0, 6) and os.path.exists(table):
            with open(table, encoding='utf-8') as file:
                text = file.read()
            rows = read_table(text) if any(not line.startswith('#') for line in text.splitlines()[:-1]) else None
        if os.path.exists(report):
            with open(report, encoding='utf-8') as file:
                kept = json.load(file)
        self.counts[mechanism.family][done.returncode] += 1
        return done.returncode, done.stderr, rows, kept

    def note(self, name, value):
        self.worst[name] = max(self.worst[name], float(value))

    def fail(self, mechanism, why, more=''):
        """A failure with the data file that shows it."""
        where = os.path.join(os.environ.get('MECH9_STRESS_KEEP', self.folder),
                             f'{mechanism.family}_{"".join(str(k) for k in mechanism.loops.inputs)}_{mechanism.member}.nml'
                             .replace(' ', '_'))
        with open(where, 'w', encoding='utf-8') as file:
            file.write(mechanism.text())
        self.checks.true(False, f'{mechanism.family}, inputs {[k + 1 for k in mechanism.loops.inputs]}, '
                                f'member {mechanism.member}: {why}', more)

    def expect(self, mechanism, code, why):
        found, said, _, _ = self.run(mechanism)
        if found == code:
            self.checks.passed += 1
        else:
            self.fail(mechanism, f'{why}: exit code {found}, not {code}', said)

    def begin(self, family, variant):
        """Random numbers of a variant's own, so that it can be run alone."""
        self.rng = np.random.default_rng([self.seed, *family.encode(), variant])

    # --- motions --------------------------------------------------------------------------------------------------

    def moving_family(self, family, variant, members):
        links, pairs, inputs = variant(self.rng, members)
        inputs = [k - 1 for k in inputs]
        rates = self.rng.choice([-1, 1], (members, len(inputs))) * 10.0 ** self.rng.uniform(-0.5, 0.85, (members, len(inputs)))
        rates *= np.where(pairs.turns[:, inputs] > 0, 1.0, 0.3)
        if family == 'RSSR by revolutes':
            rates[:, 1] = 0.0
        extent = np.max(np.linalg.norm(pairs.point, axis=-1), axis=1)
        loops = Loops(links, pairs.point / extent[:, None, None], pairs.axis, pairs.turns,
                      np.where(pairs.turns > 0, pairs.slides / extent[:, None], pairs.slides), inputs, rates)
        _, at_home = loops.at_time(np.zeros((members, len(links) + 1)), iterations=1)
        for member, course in enumerate(courses(loops)):
            # beside a dead point at home t differs by the square of this: below round-off nobody knows which side it is
            if at_home[member] < 1e-6:
                course.ending = 'special'
            # from a position that is well off singular ones a guess beside it leads back to it
            guess = self.rng.uniform(-0.01, 0.01, len(links)) * (at_home[member] > 0.1)
            mechanism = Mechanism(family, loops, member, 10.0 ** self.rng.uniform(-2, 2), int(self.rng.integers(3, 40)), guess)
            self.judge(mechanism, course)

    def judge(self, mechanism, course):
        """The run of one mechanism against its course."""
        code, said, table, report = self.run(mechanism)
        near_end = course.ending == 'dead' and abs(course.limit - 1.0) < 1e-6
        if course.ending == 'dead' and course.limit > 1.0 and not near_end:
            course.ending = 'end'                  # the step in which it turns back went beyond t = 1
        right = {'end': (0,), 'dead': (0, 6) if near_end else (6,)}.get(course.ending, (0, 6))
        if course.ending in ('special', 'unknown'):
            self.unsettled += 1
        if code not in right:
            self.fail(mechanism, f'its course ends with {course.ending} (t = {course.limit}, least {course.least:.1e}): '
                                 f'exit code {code}', said)
            return
        if report and 'least_conditioning' in report and table is not None:
            self.note('condition', 1.0 / report['least_conditioning'] if report['least_conditioning'] else 0.0)
        limit = re.search(r'beyond t = (\S+) s', said)
        if code == 6 and course.ending == 'dead':
            fastest = np.max(np.abs(mechanism.loops.rates))
            off = abs(float(limit.group(1)) - course.limit) * fastest if limit else np.inf
            if not off <= LIMIT:
                self.fail(mechanism, f'the dead point at t = {course.limit!r} is told: off by {off:.1e}', said)
                return
            self.note('limit', off)
        expected = mechanism.intervals + 1
        if code == 6 and limit:
            expected = int(np.floor(float(limit.group(1)) * mechanism.intervals)) + 1
        rows = 0 if table is None else len(table['t'])
        if code == 0 and rows != expected or code == 6 and limit and abs(rows - expected) > 1:
            self.fail(mechanism, f'{rows} rows instead of {expected}', said)
            return
        problem = self.check_rows(mechanism, course, table, report['least_conditioning']) if rows else ''
        if problem:
            self.fail(mechanism, problem, said)
        else:
            self.checks.passed += 1

    def check_rows(self, mechanism, course, table, least):
        """The table by itself: closed, with right rates and accelerations; and on the course."""
        loops, unit, m = mechanism.loops, mechanism.unit(), len(mechanism.loops.links)
        q, dq, ddq = (np.array([table[f'{name}{k}'] for k in range(1, m + 1)]).T / unit for name in ('q', 'dq', 'ddq'))
        rows = loops.take(np.zeros(len(q), dtype=int))
        gap = np.max(rows.gap(q))
        self.note('gap', gap)
        if not gap <= CLOSED:
            return f'a loop is open by {gap:.1e} of the size'
        n = 6 * len(loops.loops)
        value, jacobian = rows.equations(np.concatenate([q, table['t'][:, None]], 1))
        speed = np.max(np.abs(dq), axis=1)
        rate = np.max(np.abs(np.einsum('bij,bj->bi', jacobian[:, :n, :-1], dq)), axis=1) / speed
        self.note('rate', np.max(rate))
        allowed = max(RATES, REDUNDANT / least ** 2 if mechanism.family == 'parallel cranks' else 0.0)
        if not np.max(rate) <= allowed or np.max(np.abs(value[:, n:])) > 1e-13 * (1 + np.max(np.abs(q))):
            return f'rates open a loop by {np.max(rate):.1e} of themselves'
        h = (1e-4 / (speed + np.sqrt(np.max(np.abs(ddq), axis=1))))[:, None]
        there, back = (rows.equations(np.concatenate([q + s * h * dq + h * h / 2 * ddq, table['t'][:, None]], 1))[0][:, :n]
                       for s in (1, -1))
        bend = np.max(np.abs(there + back - 2 * value[:, :n])) / 1e-8
        self.note('bend', bend)
        if not bend <= ACCELERATIONS:
            return f'accelerations open a loop by {bend:.1e} of the motion'
        return self.compare(course, rows, q, table['t'])

    def compare(self, course, rows, q, times):
        """Each row is where the course is at its time. What both leave open is round-off over the least singular value."""
        last = course.z[-1][-1] if course.ending != 'dead' else course.limit
        known = (times < last) & (times > 0)
        if course.ending == 'special':
            known &= times < course.z[-2][-1] if len(course.z) > 1 else False
        if not np.any(known):
            return ''
        guess = np.array([course.guess(t) for t in times[known]])
        right, least = rows.take(np.flatnonzero(known)).at_time(guess)
        clear = least > 1e-3
        apart = np.max(np.abs(right[:, :-1] - q[known]), axis=1)
        beside = np.max(np.abs(guess[:, :-1] - q[known]), axis=1)      # a cubic leaves up to a few hundredths
        if np.any(apart[clear] > 1e-11 / least[clear]) or np.any(beside > 0.1):
            row = int(np.argmax(np.maximum(np.where(clear, apart, 0), np.where(beside > 0.1, beside, 0))))
            return (f'not on its course at t = {times[known][row]}: off by {apart[row]:.1e}, {beside[row]:.1e} from the cubic, '
                    f'least singular value {least[row]:.1e}')
        self.note('apart', np.max(apart[clear] * least[clear]) if np.any(clear) else 0.0)
        return ''

    # --- those that cannot be ---------------------------------------------------------------------------------------

    def wrong_family(self, family, variant, members):
        links, pairs, inputs = variant(self.rng, members)
        loops = Loops(links, pairs.point, pairs.axis, pairs.turns, pairs.slides, [k - 1 for k in inputs], np.ones((members, len(inputs))))
        for member in range(members):
            self.expect(Mechanism(family, loops, member, 10.0 ** self.rng.uniform(-2, 2), 5, np.zeros(len(links))), 4, 'mobility')

    def disturbed_family(self, family, variant, members):
        """Mechanisms that a small error of one dimension locks: exit code 4, and no row that is open. Where the error is
        allowed for they move, and their chains are open by about as much."""
        links, pairs, inputs = variant(self.rng, members)
        extent = np.max(np.linalg.norm(pairs.point, axis=-1), axis=1)
        loops = Loops(links, pairs.point / extent[:, None, None], pairs.axis, pairs.turns, pairs.slides, [k - 1 for k in inputs],
                      np.ones((members, len(inputs))))
        for member in range(members):
            mechanism = Mechanism(family, loops, member, 10.0 ** self.rng.uniform(-2, 2), 5, np.zeros(len(links)))
            self.expect(mechanism, 4, f'locked by an error of {pairs.error[member]:.1e}')
            mechanism.data_tolerance = min(1e-3, ALLOWED_FOR * pairs.error[member])
            if pairs.error[member] > 1e-3 / ALLOWED_FOR:
                continue
            code, said, rows, _ = self.run(mechanism)
            if code not in (0, 6):
                self.fail(mechanism, f'an error of {pairs.error[member]:.1e} that is allowed for: exit code {code}', said)
            elif rows is None or not np.max(rows['closure']) <= 2 * mechanism.data_tolerance * mechanism.size:
                self.fail(mechanism, f'an error of {pairs.error[member]:.1e} opens chains by more than is allowed', said)
            else:
                self.checks.passed += 1

    def infeasible(self, family, variant, change, members):
        """Mechanisms that a change of lengths takes apart: exit code 5."""
        links, pairs, inputs = variant(self.rng, members)
        loops = Loops(links, pairs.point, pairs.axis, pairs.turns, pairs.slides, [k - 1 for k in inputs], np.ones((members, len(inputs))))
        for member in range(members):
            mechanism = Mechanism(family, loops, member, 10.0 ** self.rng.uniform(-2, 2), 5, np.zeros(len(links)))
            if change(mechanism, pairs.point[member]):
                self.expect(mechanism, 5, 'it cannot be put together')

    def add(self, other):
        """The counts of another part of the test."""
        for family, counts in other['counts'].items():
            self.counts[family].update(counts)
        for name, value in other['worst'].items():
            self.note(name, value)
        self.unsettled += other['unsettled']
        self.checks.passed += other['passed']
        self.checks.failed += other['failed']

    def parts(self):
        """The counts for `add`, plain enough to be sent from one process to another."""
        return {'counts': dict(self.counts), 'worst': dict(self.worst), 'unsettled': self.unsettled,
                'passed': self.checks.passed, 'failed': self.checks.failed}

    def summary(self):
        codes = sorted({code for family in self.counts.values() for code in family}, key=str)
        print('\n| mechanisms | ' + ' | '.join(f'exit {code}' for code in codes) + ' | together |')
        print('| --- |' + ' ---: |' * (len(codes) + 1))
        total = collections.Counter()
        for family, counts in self.counts.items():
            total.update(counts)
            print(f'| {family} | ' + ' | '.join(str(counts[code] or '') for code in codes) + f' | {sum(counts.values())} |')
        print('| together | ' + ' | '.join(str(total[code]) for code in codes) + f' | {sum(total.values())} |\n')
        for name, words in (('gap', 'largest gap of a loop, of the size'), ('rate', 'largest opening by rates, of the rates'),
                            ('bend', 'largest opening by accelerations, of the motion'),
                            ('apart', 'largest distance from the curve, times the least singular value'),
                            ('limit', 'largest error of a dead point, driven coordinate in rad or sizes'),
                            ('condition', 'largest condition number, one over the least singular value'),
                            ('seconds', 'longest run, s')):
            print(f'- {words}: {self.worst[name]:.1e}')
        print(f'- curves that meet positions where branches cross, for which codes 0 and 6 are both right: {self.unsettled}')


def stretch_coupler(mechanism, point):
    """A coupler longer than all other sides together."""
    sides = np.linalg.norm(np.diff(np.append(point, point[:1], axis=0), axis=0), axis=1)
    coupler = point[2] - point[1]
    mechanism.changes = {1: point[2] - coupler / sides[1] * 1.02 * (sum(sides) - sides[1])}
    return True


def lift_slider(mechanism, point):
    """A slider whose joint is farther from its line than crank and coupler reach."""
    normal = np.cross(mechanism.loops.axis[0, 3], mechanism.loops.axis[0, 0])
    reach = np.linalg.norm(point[1] - point[0]) + np.linalg.norm(point[2] - point[1])
    away = normal @ (point[2] - point[0])
    # the joint of the slider is moved by -shift in the slider, so that the slider's guide must go by shift
    mechanism.changes = {2: point[2] + normal * (np.sign(away) or 1.0) * (1.05 * reach + abs(away))}
    return True


def start_beyond(mechanism, point):
    """A crank that starts where coupler and rocker together do not reach its end."""
    axis, angle = mechanism.loops.axis[0, 0], 0.0
    reach = np.linalg.norm(point[2] - point[1]) + np.linalg.norm(point[3] - point[2])
    arm = point[1] - point[0]
    for angle in np.linspace(0, 2 * np.pi, 60):
        end = point[0] + np.cos(angle) * arm + np.sin(angle) * np.cross(axis, arm)
        if np.linalg.norm(end - point[3]) > 1.03 * reach:
            mechanism.start = {0: angle}
            return True
    return False


def stretch_link(mechanism, point):
    """A link of a spatial loop that is far longer than all others."""
    mechanism.changes = {3: point[3] + 100.0}
    return True


INFEASIBLE = {
    'coupler too long': (families.four_bar(1), stretch_coupler),
    'slider out of reach': (families.slider_crank(1), lift_slider),
    'start out of reach': (families.four_bar(1), start_beyond),
    'spatial link too long': (families.seven('RRRRRRR'), stretch_link),
}


def variants():
    """All variants, as names of families and numbers."""
    found = {**families.MOVING, **families.DISTURBED, **families.WRONG, **{name: [1] for name in INFEASIBLE}}
    return [(family, number) for family, made in found.items() for number in range(len(made))]


def run_variant(stress, family, number, members):
    """One variant of a family, run and judged."""
    stress.begin(family, number)
    if family in families.MOVING:
        stress.moving_family(family, families.MOVING[family][number], members)
    elif family in families.DISTURBED:
        stress.disturbed_family(family, families.DISTURBED[family][number], max(2, members // 2))
    elif family in families.WRONG:
        stress.wrong_family(family, families.WRONG[family][number], max(1, members // 3))
    else:
        # not every member can be changed so that it cannot be put together
        stress.infeasible(family, *INFEASIBLE[family], max(8, members // 2))


def part(mech9k, seed, family, number, members):
    """The counts of one variant."""
    with tempfile.TemporaryDirectory() as folder:
        stress = Stress(mech9k, folder, seed)
        run_variant(stress, family, number, members)
        sys.stdout.flush()
        return stress.parts()


def main():
    mech9k = os.path.abspath(sys.argv[1])
    members = int(sys.argv[2]) if len(sys.argv) > 2 else 25
    seed = int(sys.argv[3]) if len(sys.argv) > 3 else SEED
    only = sys.argv[4] if len(sys.argv) > 4 else ''
    tasks = [(mech9k, seed, family, number, members) for family, number in variants() if only in family]
    stress = Stress(mech9k, '', seed)
    with multiprocessing.Pool(2) as pool:
        for counted in pool.starmap(part, tasks, chunksize=1):
            stress.add(counted)
    stress.summary()
    stress.checks.finish()


if __name__ == '__main__':
    main()
