"""The report of --check on beginners' mistakes: dimensions of links, odd axes and links with their places, notes.

The dimensions are held against closed forms: the lengths of a four-bar that was laid out from them in any plane, and the
lengths and twists of Denavit-Hartenberg parameters.
"""
import os
import re

import numpy as np
import pytest

from mech9_cases import run

DONE, STRUCTURE, ASSEMBLY = 0, 4, 5

FOUR_BAR = """&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1, point=0,0,0 /
&pair coordinate=2, links=2,3, kind='revolute', axis=0,0,1, point=0.3,0,0, moving_point=0,0,0 /
&pair coordinate=3, links=3,4, kind='revolute', axis=0,0,1, point=1,0,0, moving_point=0.6,0,0 /
&pair coordinate=4, links=1,4, kind='revolute', axis=0,0,1, point=0.9,0,0, moving_point=0,0,0 /
&drive coordinate=1, kind='polynomial', coefficients=0, 6.5 /
"""

SLIDER_CRANK = """&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&pair coordinate=2, links=2,3, kind='revolute', axis=0,0,1, point=0.3,0,0, moving_point=0,0,0 /
&pair coordinate=3, links=3,4, kind='revolute', axis=0,0,1, point=1,0,0, moving_point=0,0,0 /
&pair coordinate=4, links=1,4, kind='prismatic', axis=1,0,0, point=0,0.1,0, moving_point=0,0,0 /
&initial coordinate=4, position=1.2 /
&drive coordinate=1, kind='polynomial', coefficients=0.4, 10.0 /
"""

# all axes pass through the origin
SPHERE = """&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&pair coordinate=2, links=2,3, kind='revolute', axis=0.3,0,1 /
&pair coordinate=3, links=3,4, kind='revolute', axis=0.5,0.6,1, point=0.5,0.6,1 /
&pair coordinate=4, links=1,4, kind='revolute', axis=0,0.7,1 /
&drive coordinate=1, kind='polynomial', coefficients=0.4, 10.0 /
"""

# a rod with ball joints of three revolutes between two cranks
ROD = """&structure cq=1, 4 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1, point=0,0,0 /
&pair coordinate=2, links=2,3, kind='revolute', axis=1,0,0, point=0.2,0,0 /
&pair coordinate=3, links=3,4, kind='revolute', axis=0,1,0, point=0.2,0,0 /
&pair coordinate=4, links=4,5, kind='revolute', axis=0,0,1, point=0.2,0,0 /
&pair coordinate=5, links=5,6, kind='revolute', axis=1,0,0, point=0.3,0.5,0.5 /
&pair coordinate=6, links=6,7, kind='revolute', axis=0,1,0, point=0.3,0.5,0.5 /
&pair coordinate=7, links=7,8, kind='revolute', axis=0,0,1, point=0.3,0.5,0.5 /
&pair coordinate=8, links=1,8, kind='revolute', axis=1,0,0, point=0.3,0.5,-0.1 /
&initial coordinate=1, position=0, velocity={velocity} /
&initial coordinate=4, position=0 /
&body link={crank}, mass=1, centre=0.1,0,0, inertia=0,0,0.01,0,0,0 /
&body link=8, mass=1, centre=0.3,0.5,0.2, inertia=0.01,0,0,0,0,0 /
&body link=5, mass={rod}, centre=0.3,0.3,0.2, inertia={rod},{rod},{rod},0,0,0 /
"""

# text, exit code, the replacement that is the mistake, the line of the mistaken pair, words
MISTAKES = [
    (FOUR_BAR, ASSEMBLY, ('point=1,0,0', 'point=10,0,0'), 3,
     'link 3 is 10 m long from pair 2 to pair 3, and the other links of the closed chain of pairs 1, 2, 3, 4 are 1.8 m long together'),
    (FOUR_BAR, ASSEMBLY, ('point=0.9,0,0', 'point=900,0,0'), 5, 'link 1 is 900 m long from pair 4 to pair 1'),
    (FOUR_BAR, ASSEMBLY, ('axis=0,0,1, point=1,0,0', 'axis=0,0.1,1, point=1,0,0'), 4,
     'the axis of pair 3 is not parallel to the other axes of the closed chain of pairs 1, 2, 3, 4 (by 5.71 degrees)'),
    (FOUR_BAR, ASSEMBLY, ('axis=0,0,1, point=0.9', 'axis=0,-1e-4,-1, point=0.9'), 5, 'the axis of pair 4 is not parallel'),
    (FOUR_BAR, STRUCTURE, ('axis=0,0,1, point=0,0,0', 'axis=1,0,0, point=0,0,0'), 2,
     'the axis of pair 1 is not parallel to the other axes of the closed chain of pairs 1, 2, 3, 4 (by 90 degrees)'),
    (FOUR_BAR, ASSEMBLY, ('moving_point=0,0,0 /\n&pair coordinate=3', 'moving_point=0,0,0, moving_axis=0,1,0 /\n&pair coordinate=3'), 3,
     'the axes of pairs 2, 3 are not parallel on link 3 (by 90 degrees)'),
    (FOUR_BAR, ASSEMBLY, ('point=0.3,0,0,', 'point=0.3,0,0.1,'), 3,
     'open by 0.1 m along its parallel axes, wherever it moves: see point and moving_point of pair 2;'),
    (FOUR_BAR, ASSEMBLY, ("'revolute', axis=0,0,1, point=0.9", "'prismatic', axis=0,0,1, point=0.9"), 5,
     'the slide of pair 4 is not at right angles to the other axes'),
    (SLIDER_CRANK, ASSEMBLY, ('axis=1,0,0', 'axis=1,0,0.1'), 5, 'the slide of pair 4 is not at right angles to the other axes'),
    (SLIDER_CRANK, STRUCTURE, ('axis=0,0,1, point=0.3', 'axis=0,1,0, point=0.3'), 3, 'the axis of pair 2 is not parallel'),
    (SLIDER_CRANK, ASSEMBLY, ('point=0,0.1,0', 'point=0,0.1,0.05'), 5, 'open by 0.05 m along its parallel axes'),
    (SPHERE, STRUCTURE, ('point=0.5,0.6,1', 'point=0.5,0.7,1'), 4,
     'the axis of pair 3 misses the point in which the other axes of the closed chain of pairs 1, 2, 3, 4 meet by 0.0881 m'),
]


class Cases:
    def __init__(self, mech9k, mech9d, folder, checks):
        self.mech9k, self.mech9d, self.folder, self.checks = mech9k, mech9d, folder, checks

    def check(self, program, text, code=DONE):
        path = os.path.join(self.folder, 'case.nml')
        with open(path, 'w', encoding='utf-8') as file:
            file.write(text)
        done = run(program, path, '--check', folder=self.folder)
        self.checks.true(done.returncode == code, f'exit code {code}', f'{done.returncode}\n{text}{done.stdout}{done.stderr}')
        return done


@pytest.fixture
def s(checks, mech9k, mech9d, tmp_path):
    return Cases(mech9k, mech9d, tmp_path, checks)


def table_of_links(printed):
    """(link, pair, pair) -> axes, angle, points; None where there is a dash."""
    found = re.findall(r'^ +(\d+)  (\d+) and (\d+) +(\S+) +(\S+) +(\S+)$', printed, re.M)
    return {tuple(map(int, row[:3])): [None if word == '-' else float(word) for word in row[3:]] for row in found}


def numbers(values):
    return ','.join(repr(float(value)) for value in values)


def test_lengths_of_links(s):
    """A four-bar from its lengths, in any plane and place; an axis may point either way, a point lie anywhere on it."""
    random = np.random.default_rng(12)
    for unit, turn in (('rad', np.pi), ('deg', 180.0)):
        n, e1 = np.linalg.qr(random.normal(size=(3, 2)))[0].T
        origin, lengths = random.normal(size=3), random.uniform(1.0, 1.3, 4)
        sides = iter((1, -1, 1, 1))

        def end(length):
            return origin + length * e1
        text = f"&mechanism angle_unit='{unit}' /\n&structure cq=1 /\n"
        for k, (links, at, moving) in enumerate((((1, 2), 0, 0), ((2, 3), lengths[1], 0), ((3, 4), lengths[2], lengths[3]),
                                                 ((1, 4), lengths[0], 0)), 1):
            text += (f"&pair coordinate={k}, links={links[0]},{links[1]}, kind='revolute', axis={numbers(next(sides) * 3 * n)}, "
                     f'point={numbers(end(at))}, moving_point={numbers(end(moving))} /\n')
        text += f"&drive coordinate=1, kind='polynomial', coefficients={turn / 3!r} /\n"
        # pair 2 is reversed: its axes make half a turn with their neighbours
        table = table_of_links(s.check(s.mech9k, text).stdout)
        expected = {(1, 1, 4): (lengths[0], 0), (2, 1, 2): (lengths[1], turn), (3, 2, 3): (lengths[2], turn), (4, 3, 4): (lengths[3], 0)}
        s.checks.equal(set(table), set(expected), 'the links and their pairs')
        for key, (length, angle) in expected.items():
            s.checks.near(table[key], [length, angle, length], 6e-6, f'{key}: six digits are printed')


def test_twists(s):
    """Denavit-Hartenberg parameters: a is the distance of skew axes, alpha their angle."""
    parameters = [(0.7, 0.6, 0.2, 0.1), (0.4, 2.1, -0.3, 0.9), (0.0, np.pi / 2, 0.5, 0.0), (0.25, 0.0, 0.1, 0.3)]
    text = '&structure cq=1,2,3,4,5 /\n'
    for k in range(1, 6):
        dh = parameters[k - 1] if k < 5 else (0.1, 0, 0, 0)
        text += f"&pair coordinate={k}, links={k},{k + 1}, kind='revolute', dh={numbers(dh)} /\n"
        text += f"&drive coordinate={k}, kind='polynomial', coefficients=0.2 /\n"
    table = table_of_links(s.check(s.mech9k, text).stdout)
    for k, (a, alpha, _, _) in enumerate(parameters, 1):
        s.checks.near(table[k + 1, k, k + 1][:2], [a, alpha], 6e-6, f'the common normal and the twist of link {k + 1}')


def test_dimensions_at_a_slide(s):
    """A slide has no place."""
    table = table_of_links(s.check(s.mech9k, SLIDER_CRANK).stdout)
    s.checks.near(table[1, 1, 4][:2], [0.1, np.pi / 2], 6e-6, 'the offset of the slide')
    s.checks.true(table[1, 1, 4][2] is None and table[4, 3, 4][2] is None, 'the point of a slide may lie anywhere on it')


def test_dimensions_of_a_star(s):
    """A link with many pairs gets the distances around; a long list is cut."""
    star = '&structure cq={} /\n'.format(','.join(str(k) for k in range(1, 61)))
    for k in range(1, 61):
        star += (f"&pair coordinate={k}, links=1,{k + 1}, kind='{'prismatic' if k < 3 else 'revolute'}', axis=0,0,1, point={k},0,0 /\n"
                 f"&drive coordinate={k}, kind='polynomial', coefficients=0 /\n")
    printed = s.check(s.mech9k, star).stdout
    table = table_of_links(printed)
    s.checks.equal(table[1, 1, 2], [None, 0.0, None], 'two slides have an angle and no distance')
    s.checks.equal(table[1, 4, 5], [1.0, 0.0, 1.0], 'each pair of a star and the next one')
    s.checks.true((1, 4, 6) not in table and table[1, 1, 60] == [59.0, 0.0, None], 'and the last one and the first')
    s.checks.true(len(table) == 40 and 'and 20 more lines' in printed, 'forty lines at most', printed)


@pytest.mark.parametrize('text, code, change, line, words', MISTAKES, ids=[
    'long_coupler', 'long_frame', 'oblique_axis', 'slightly_oblique_axis', 'axis_across', 'axes_of_a_link', 'height_of_a_pin',
    'slide_along_the_axes', 'oblique_slide', 'axis_across_of_a_slider_crank', 'height_of_a_slide', 'missed_centre'])
def test_mistakes(s, text, code, change, line, words):
    right, wrong = change
    s.check(s.mech9k, text)
    s.checks.equal(text.count(right), 1, f'{right} is there once')
    done = s.check(s.mech9k, text.replace(right, wrong), code)
    s.checks.true(words in done.stderr, f'says {words}', done.stderr)
    s.checks.true(f'case.nml:{line}:1: ' in done.stderr, f'{words}: in line {line}', done.stderr)
    s.checks.true('dimensions of the links' in done.stdout, 'the dimensions are shown where nothing can be assembled', done.stdout)


def test_axes_that_are_nearly_parallel(s):
    """Dimensions that are known to few digits have such axes."""
    near = FOUR_BAR.replace('axis=0,0,1, point=1,0,0', 'axis=0,1e-7,1, point=1,0,0').replace('point=0.9,0,0', 'point=900,0,0')
    done = s.check(s.mech9k, '&mechanism data_tolerance=1e-5 /\n' + near, ASSEMBLY)
    s.checks.true('link 1 is 900 m long' in done.stderr and 'parallel' not in done.stderr, 'what is tolerated is not odd', done.stderr)


@pytest.mark.parametrize('coefficients, unit, words', [
    ('0, 360', 'rad', 'the drive of coordinate 1 has the rate 360 rad/s, 57.3 turns a second'),
    ('90, 1', 'rad', 'the drive of coordinate 1 has the angle 90 rad, more than a turn'),
    ('0, 6.28', 'deg', 'the drive of coordinate 1 has the rate 6.28 degrees a second'),
    ('0, -3.14159', 'deg', 'the rate -3.14159 degrees a second'),
    ('0, 10', 'rad', None), ('1.2, 314.16', 'rad', None), ('0, 360', 'deg', None),
    ('0, 0', 'deg', 'the drive of coordinate 1 stands still, so that nothing moves'),
    ('1.5708, 20', 'deg', 'the drive of coordinate 1 has the angle 1.5708 degrees')],
    ids=['degrees_as_radians', 'angle_in_degrees', 'radians_as_degrees', 'half_a_turn_in_radians', 'fast', 'motor', 'degrees', 'still',
         'angle_in_radians'])
def test_notes_on_drives(s, coefficients, unit, words):
    text = f"&mechanism angle_unit='{unit}' /\n" + FOUR_BAR.replace('coefficients=0, 6.5', f'coefficients={coefficients}')
    printed = s.check(s.mech9k, text).stdout
    s.checks.equal('note:' in printed, words is not None, f'{coefficients} {unit}: a note where it is due')
    s.checks.true(words is None or words in printed, f'says {words}', printed)


@pytest.mark.parametrize('second, stands', [
    ('&initial coordinate=2, position=0.5 /', False), ("&drive coordinate=2, kind='polynomial', coefficients=0.5 /", True)], ids=('free', 'driven'))
def test_drives_that_stand_beside_a_pendulum(s, second, stands):
    """A drive that stands still is odd only where nothing else moves."""
    printed = s.check(s.mech9d, """&structure cq=1,2 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&pair coordinate=2, links=2,3, kind='revolute', axis=0,0,1, point=1,0,0 /
&body link=3, mass=1, centre=0.5,0,0 /
&gravity acceleration=0,-9.81,0 /
&drive coordinate=1, kind='polynomial', coefficients=0.3 /
&time start=0, end=1 /
""" + second + '\n').stdout
    s.checks.equal('nothing moves' in printed, stands, 'the note where it is due')


@pytest.mark.parametrize('velocity, rod, words', [
    (1, 1, None), (720, 1, 'the start of coordinate 1 has the rate 720 rad/s'), (1, 0, 'note: link 5 has no mass, while others have')])
def test_notes_on_rates_and_masses(s, velocity, rod, words):
    text = ROD.format(velocity=velocity, crank=2, rod=rod)
    if rod == 0:
        # a link of the ball joint has the mass instead, so that the spin has inertia
        text += '&body link=6, mass=1, inertia=1,1,1,0,0,0 /\n'
    done = s.check(s.mech9d, text)
    s.checks.equal('note:' in done.stdout, words is not None, 'a note where it is due')
    s.checks.true(words is None or words in done.stdout, f'says {words}', done.stdout)


HEAVY = FOUR_BAR + '&body link=3, mass=1, centre=0.6,0.1,0, inertia=0,0,0.1,0,0,0 /\n'
EFFECTS = [
    ('&gravity acceleration=0,0,-9.81 /', 'gravity acts across the plane of the mechanism and moves nothing'),
    ('&gravity acceleration=0,-9.81,-1 /', None),
    ('&gravity acceleration=0,-9810,0 /', 'gravity is 9810 m/s^2; that of the earth is 9.81 m/s^2'),
    ("&load kind='torque', link=3, torque=0,0,1 /\n&load kind='torque', link=3, torque=1,2,0 /", 'the torque of load 2 is about an axis in'),
    ("&load kind='torque', link=3, torque=1,2,0.1, frame='link' /", None),
    ("&load kind='force', link=3, force=0,0,-5 /", 'the force of load 1 acts across the plane of the mechanism and moves nothing'),
    ("&load kind='force', link=3, force=0,1,-5 /", None), ("&load kind='force', link=3, force=0,0,0 /", None),
    ("&load kind='force', link=3, force=1,0,0, law='harmonic', amplitude=1, angular_frequency=6.2832 /",
     'the law of load 1 has the angular frequency 6.2832 degrees a second'),
    ("&load kind='force', link=3, force=1,0,0, law='harmonic', amplitude=1, angular_frequency=360 /", None)]


@pytest.mark.parametrize('group, words', EFFECTS)
def test_notes_on_what_has_no_effect(s, group, words):
    """In check and run, once in each. Link 2 and link 4 have no mass, which is another note."""
    text = "&mechanism angle_unit='deg' /\n" + HEAVY.replace('coefficients=0, 6.5', 'coefficients=0, 65') + group + '\n'
    text += ''.join(f'&body link={link}, mass=0.1 /\n' for link in (2, 4))
    printed = s.check(s.mech9d, text).stdout
    s.checks.equal(printed.count('note:'), int(words is not None), f'{group}: a note where it is due')
    s.checks.true(words is None or words in printed, f'says {words}', printed)
    if words is None or 'frequency' in words:
        return
    done = run(s.mech9d, os.path.join(s.folder, 'case.nml'), '--table', os.path.join(s.folder, 'a.dat'))
    s.checks.equal(done.stderr.count(words) + done.stdout.count(words), 1, f'a run says {words} once')


def test_notes_on_lengths_and_drives(s):
    wrong = FOUR_BAR.replace('point=0.3,0,0', 'point=0.0003,0,0')
    words = 'note: axes are 1 m apart in link 3 and 0.0003 m in link 2'
    s.checks.true(words in s.check(s.mech9k, wrong).stdout, f'says {words}')
    s.checks.true('apart' not in s.check(s.mech9k, FOUR_BAR).stdout, 'lengths of one size')
    s.checks.true('apart' not in s.check(s.mech9k, SLIDER_CRANK).stdout, 'nor of a slider-crank')
    beside = FOUR_BAR.replace('coefficients=0, 6.5', 'coefficients=0.1, 0') + '&time end=0, intervals=0 /\n'
    s.checks.true('stands still' not in s.check(s.mech9k, beside).stdout, 'a single position needs no motion')


def test_body_of_the_frame(s):
    printed = s.check(s.mech9d, ROD.format(velocity=1, crank=1, rod=1)).stdout
    for words in ('note: link 1 is the frame, which does not move: its &body has no effect', 'note: link 2 has no mass'):
        s.checks.true(words in printed, f'says {words}', printed)


MADE_LARGE = re.sub(r'point=([\d.]+),0,0', lambda at: f'point={100*float(at.group(1))!r},0,0', FOUR_BAR)


@pytest.mark.parametrize('text, words', [
    (MADE_LARGE, "note: the longest link has 100 m between two pairs; where millimetres are meant, give &mechanism length_unit='mm'"),
    ("&mechanism length_unit='mm' /\n" + MADE_LARGE, None),
    ("&mechanism angle_unit='deg' /\n" + FOUR_BAR.replace('coefficients=0, 6.5', 'coefficients=0, 6.28'),
     'note: the drive of coordinate 1 has the rate 6.28 degrees a second'),
    (FOUR_BAR + '&body link=1, mass=1 /\n&output drive_forces=.true. /\n', 'note: link 1 is the frame, which does not move: its &body has no effect'),
    (FOUR_BAR, None)], ids=('metres', 'millimetres', 'radians', 'frame', 'none'))
def test_notes_of_a_run(s, text, words):
    """A run tells the notes that a check does, once, but for links without mass."""
    s.check(s.mech9k, text)
    for options in ((), ('--quiet',)):
        done = run(s.mech9k, os.path.join(s.folder, 'case.nml'), '--no-write', *options, folder=s.folder)
        s.checks.equal(done.returncode, DONE, done.stderr)
        told = 0 if options or words is None else 1
        s.checks.equal(done.stderr.count(words or 'note: '), told, f'{options}: {words}')


@pytest.mark.parametrize('a, b', [(1.0, 1.5), (1.0, 1.2)])
def test_overconstrained_chain_is_not_idle(s, a, b):
    """A whole chain that moves although it is overconstrained is not idle: no two links at its ends stand still."""
    twist = np.pi / 6
    other = np.arcsin(b / a * np.sin(twist))
    text = '&structure cq=1 /\n'
    for k, (links, length, angle) in enumerate((((1, 2), a, twist), ((2, 3), b, other), ((3, 4), a, twist), ((4, 1), b, other)), 1):
        text += f"&pair coordinate={k}, links={links[0]},{links[1]}, kind='revolute', dh={length!r},{float(angle)!r},0,0 /\n"
    text += "&drive coordinate=1, kind='polynomial', coefficients=0.5 /\n&initial coordinate=2, position=3 /\n"
    text += '&initial coordinate=3, position=-0.5 /\n&initial coordinate=4, position=-3 /\n'
    printed = s.check(s.mech9k, text).stdout
    s.checks.true('closed chain 1: 3 of its 6 equations redundant' in printed, 'Bennett', printed)
    s.checks.true('idle' not in printed, 'the chain moves as a whole', printed)
