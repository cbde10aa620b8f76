"""Profiles of cams (--cam) against closed forms: circles, flat faces, offset and swinging rollers; undercut, other planes and units,
profiles that are read back as curves, bad input.

Compares the program with itself in part: one cam in other planes, other units, other numbers of links, and held while its follower
runs around it; a profile that is read back by a path pair. All else is closed forms.
"""
import json
import os
import re

import numpy as np
import pytest

import xml.etree.ElementTree as tree
from mech9_cases import read_table, run, text_of

USAGE, DATA = 2, 3
ROUND_OFF = 2e-13   # of lengths below 1 m that take some twenty operations
CURVATURE = 1e-10   # of radii: quotients of products of accelerations


class Cases:
    def __init__(self, mech9k, folder, checks):
        self.mech9k, self.folder, self.checks = mech9k, folder, checks

    def write(self, name, text):
        path = os.path.join(self.folder, name)
        with open(path, 'w', encoding='utf-8') as file:
            file.write(text)
        return path

    def profile(self, text, *options, number=''):
        """The table of a cam by its columns, and the lines about it."""
        table = os.path.join(self.folder, 'cam.dat')
        done = run(self.mech9k, self.write('case.nml', text), '--cam', number + table, *options)
        if not self.checks.equal(done.returncode, 0, f'a cam is computed: {done.stderr}'):
            raise RuntimeError(f'no cam is computed:\n{done.stderr}')
        return read_table(text_of(table)), done.stderr

    def refused(self, text, code, words, *options):
        done = run(self.mech9k, self.write('case.nml', text), *(options or ('--cam', '-')))
        said = done.stderr
        self.checks.equal(done.returncode, code, f'refused: {words}; {said}')
        self.checks.true(words in ' '.join(said.split()), f'the message says "{words}"', said)

    def near(self, values, expected, tolerance, why):
        error = float(np.max(np.abs(np.asarray(values) - expected)))
        self.checks.true(error <= tolerance, f'{why}: differs by {error:.3g}, and {tolerance:.3g} is allowed')


@pytest.fixture
def s(checks, mech9k, tmp_path):
    return Cases(mech9k, tmp_path, checks)


def around(table, centre):
    """Distances of the profile from a point of its plane."""
    return np.hypot(table['profile.x'] - centre[0], table['profile.y'] - centre[1])


# A crank of length E with a rod of length R + ROLLER: the roller at the end of the rod touches a circle of radius R about the crank pin.
E, R, ROLLER = 0.01, 0.038, 0.012
ROD = """&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&pair coordinate=2, links=2,3, kind='revolute', axis=0,0,1, point=0.01,0,0, moving_point=0,0,0 /
&pair coordinate=3, links=3,4, kind='revolute', axis=0,0,1, point={rod},0,0, moving_point={arm},0,0 /
&pair coordinate=4, links=1,4, {guide} /
&initial coordinate=2, position=1.5 /
&initial coordinate=4, position={start} /
&drive coordinate=1, kind='polynomial', coefficients=0.2, {speed}, 1.1 /
&cam link=2, follower=4, point={arm},0,0, roller={roller} {more} /
&time end=1, intervals=50 /
"""
SLIDE = "kind='prismatic', axis=0,1,0, point={offset},0,0, moving_point=0,0,0"
SWING = "kind='revolute', axis=0,0,1, point=-0.06,0.02,0, moving_point=0,0,0"


@pytest.mark.parametrize('speed', [5.0, -5.0])
@pytest.mark.parametrize('guide, arm, start', [
    (SLIDE.format(offset=0), 0, 0.05), (SLIDE.format(offset=0.007), 0, 0.05), (SWING, 0.06, 0.5)], ids=['slide', 'offset', 'swing'])
def test_eccentric_circle(s, speed, guide, arm, start):
    """The envelope of rollers at a fixed distance from a point is a circle, whatever guides them and however the cam turns."""
    text = ROD.format(rod=R + ROLLER, arm=arm, guide=guide, start=start, speed=speed, roller=ROLLER, more='')
    table, said = s.profile(text)
    s.near(around(table, (E, 0)), R, ROUND_OFF, f'an eccentric circle, {guide}')
    s.near(table['radius'], R, CURVATURE, f'radius of an eccentric circle, {guide}')
    s.near(np.hypot(table['pitch.x'] - E, table['pitch.y']), R + ROLLER, ROUND_OFF, 'pitch curve of an eccentric circle')
    s.checks.true('undercut: none' in said, 'an eccentric circle is not undercut', said)
    if guide == SLIDE.format(offset=0):
        angle = np.arcsin(np.abs(E * np.cos(table['q1'])) / (R + ROLLER))
        s.near(table['pressure_angle'], angle, 1e-12, 'pressure angle of an eccentric circle: that of the rod')
    # the same rod, with the roller inside of a ring
    ring, _ = s.profile(text.replace('roller=', "side='outer', roller="))
    s.near(around(ring, (E, 0)), R + 2 * ROLLER, ROUND_OFF, f'a ring around its rollers, {guide}')
    s.near(ring['radius'], -R - 2 * ROLLER, CURVATURE, 'a ring is concave')


def test_edge_on_a_circle(s):
    """An edge touches the pitch curve itself."""
    edge, _ = s.profile(ROD.format(rod=R, arm=0, guide=SLIDE.format(offset=0), start=0.03, speed=5, roller=0, more=''))
    s.near(around(edge, (E, 0)), R, ROUND_OFF, 'an edge runs along a circle')


def test_swinging_face(s):
    """A face that keeps its distance from a crank pin touches a circle about the pin, on an arm that swings as well."""
    table, said = s.profile("""&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&pair coordinate=2, links=2,3, kind='revolute', axis=0,0,1, point=0.01,0,0, moving_point=0,0.03,0 /
&pair coordinate=3, links=3,4, kind='prismatic', axis=1,0,0, moving_point=0,0.005,0 /
&pair coordinate=4, links=1,4, kind='revolute', axis=0,0,1, point=-0.08,0.01,0, moving_point=0,0,0 /
&initial coordinate=2, position=0 /
&initial coordinate=3, position=-0.08 /
&initial coordinate=4, position=0 /
&drive coordinate=1, kind='polynomial', coefficients=0, 6, 1 /
&cam link=2, follower=4, point=0.02,0.005,0, face=0,3,0 /
&time end=1, intervals=50 /
""")
    s.near(around(table, (E, 0)), 0.03 * np.ones(51), ROUND_OFF, 'a swinging flat face on a circle')
    s.near(table['radius'], 0.03, CURVATURE, 'radius of a circle under a swinging face')
    # along the face offsets count against x; the pressure angle is that of the arm from the pivot to the contact
    arm = 0.02 - table['offset']
    s.near(table['pressure_angle'], np.arctan(0.005 / np.abs(arm)), 1e-11, 'pressure angle of a swinging flat face')


def curve345(x):
    return x**3 * (10 - 15 * x + 6 * x * x), 30 * x * x * (1 - x)**2, 60 * x * (1 - x) * (1 - 2 * x)


LIFT = """&structure cq=1,2 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&pair coordinate=2, links=1,3, kind='prismatic', axis=0,1,0, point={offset},{height},0, moving_point=0,0,0 /
&drive coordinate=1, kind='polynomial', coefficients=0, 1 /
&drive coordinate=2, kind='segments', times=0, {beta}, times(3)=3, values=0, {lift}, values(3)={lift}, laws='polynomial345', 'dwell' /
&cam link=2, follower=3, {cam} /
&time end=2.4, intervals=240 /
"""


# The formulas of textbooks for translating followers, with one radian of the cam in a second.
DENSE = np.linspace(0, 1, 2000001)


def lift_at(t, lift, beta):
    """The lift of LIFT and its derivatives."""
    w, ds, dds = curve345(np.minimum(t / beta, 1))
    return lift * w, lift * ds / beta, lift * dds / beta**2


def test_translating_flat_face(s):
    height, lift, beta = 0.04, 0.02, 2.0
    w, ds, dds = lift_at(np.linspace(0, 2.4, 241), lift, beta)
    # a flat face: radius of curvature base + s + s'', contact at a distance s' from the axis
    table, said = s.profile(LIFT.format(offset=0, height=height, beta=beta, lift=lift, cam='face=0,-1,0'))
    s.near(table['radius'], height + w + dds, 1e-12, 'radius of curvature under a flat face')
    s.near(np.abs(table['offset']), ds, 1e-12, 'contact on a flat face')
    s.near(table['pressure_angle'], 0, 1e-15, 'pressure angle of a flat face across its slide')
    s.near(np.hypot(table['profile.x'], table['profile.y']), np.hypot(height + w, ds), ROUND_OFF, 'profile under a flat face')
    ws, _, wdd = curve345(DENSE)
    least = height + lift * ws + lift * wdd / beta**2
    found = re.search(r'convex: (\S+) m at q1 = (\S+) rad', said)
    s.checks.near(float(found[1]), least.min(), 1e-6, 'least radius between outputs')
    s.checks.near(float(found[2]), beta * DENSE[least.argmin()], 1e-3, 'place of the least radius')


def test_translating_offset_roller(s):
    """The tangent of the pressure angle is (s' - e)/(s + height) on the side where the offset helps."""
    height, offset, lift, beta, radius = 0.04, 0.008, 0.02, 2.0, 0.01
    w, ds, dds = lift_at(np.linspace(0, 2.4, 241), lift, beta)
    table, said = s.profile(LIFT.format(offset=offset, height=height, beta=beta, lift=lift, cam=f'roller={radius}'))
    tangent = np.abs(ds - offset) / (height + w)
    s.near(np.tan(table['pressure_angle']), tangent, 1e-12, 'pressure angle of an offset roller')
    ws, fine, _ = curve345(DENSE)
    largest = np.arctan(np.abs(lift * fine / beta - offset) / (height + lift * ws)).max()
    found = re.search(r'greatest pressure angle: (\S+) rad', said)
    s.checks.near(float(found[1]), largest, 1e-6, 'greatest pressure angle')
    # radius of the pitch curve from the polar formula of x = e, y = height + s in the turning cam
    y = height + w
    speed = np.hypot(ds - offset, y)
    curvature = (y * y + (ds - offset) * (2 * ds - offset) - y * dds) / speed**3
    s.near(1 / (table['radius'] + radius), curvature, 1e-10, 'curvature of the pitch curve')
    s.checks.equal(table['undercut'].max(), 0.0, 'no undercut')


def test_undercut_by_a_roller(s):
    """A roller larger than the least radius of the pitch curve undercuts it where the curve is too sharp."""
    height, lift, beta = 0.03, 0.02, 1.2
    t = np.linspace(0, 2.4, 241)
    w, ds, dds = curve345(np.minimum(t / beta, 1))
    y, ds, dds = height + lift * w, lift * ds / beta, lift * dds / beta**2
    curvature = (y * y + 2 * ds**2 - y * dds) / np.hypot(ds, y)**3
    text = LIFT.format(offset=0, height=height, beta=beta, lift=lift, cam='roller=0.025')
    table, said = s.profile(text)
    expected = curvature * 0.025 >= 1
    s.checks.true(0 < expected.sum() < 200, 'some of the cam is undercut')
    s.checks.true(np.array_equal(table['undercut'] > 0, expected), 'undercut where the pitch curve is too sharp')
    found = re.search(r'undercut: from q1 = (\S+) to (\S+) rad \(t = ', said)
    if s.checks.true(found, 'the range of undercut is told', said):
        x = np.linspace(0, 1.5, 1500001)
        w, d, dd = curve345(np.minimum(x / beta, 1))
        y, d, dd = height + lift * w, lift * d / beta, lift * dd / beta**2
        inside = x[(y * y + 2 * d**2 - y * dd) / np.hypot(d, y)**3 * 0.025 >= 1]
        s.checks.near([float(found[1]), float(found[2])], [inside[0], inside[-1]], 2e-5, 'ends of the undercut lie between outputs')


def test_undercut_by_a_flat_face(s):
    height, lift, beta = 0.03, 0.02, 1.2
    w, _, dds = lift_at(np.linspace(0, 2.4, 241), lift, beta)
    table, said = s.profile(LIFT.format(offset=0, height=height, beta=beta, lift=lift, cam='face=0,-1,0'))
    least = height + w + dds
    s.checks.true(np.array_equal(table['undercut'] > 0, least <= 0), 'undercut of a flat face')
    s.checks.true('a flat tool' in said, 'undercut of a flat face is told', said)


def test_published_cam(s):
    """Problem of a textbook: a disk cam lifts a radial flat face by 50 mm and back in one turn, harmonically, from a least radius of
    25 mm (H. H. Mabie, C. F. Reinholtz: Mechanisms and Dynamics of Machinery, chapter on cams). The contour is a circle of radius
    50 mm, and contact reaches 25 mm to both sides."""
    table, said = s.profile("""&structure cq=1,2 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&pair coordinate=2, links=1,3, kind='prismatic', axis=0,1,0, moving_point=0,0,0 /
&drive coordinate=1, kind='polynomial', coefficients=0, 6.283185307179586 /
&drive coordinate=2, kind='harmonic', mean=0.05, amplitude=0.025, angular_frequency=6.283185307179586, phase=-1.5707963267948966 /
&cam link=2, follower=3, face=0,-1,0 /
&time end=1, intervals=72 /
""")
    s.near(around(table, (0, -0.025)), 0.05, ROUND_OFF, 'a harmonic flat follower runs on a circle')
    s.near(table['radius'], 0.05, CURVATURE, 'its radius')
    s.checks.true('from -0.025 to 0.025 m' in said, 'length of its face', said)
    s.checks.true('73 points, closed' in said, 'its profile is closed', said)


DRIVES = """&drive coordinate=1, kind='polynomial', coefficients=0, {turn} /
&drive coordinate=2, kind='segments', times=0, 2, 3, values=0, 0.02, 0.02, laws='polynomial345', 'dwell' /
&time end=2.4, intervals=240 /
"""


def test_same_cam_held_and_in_another_plane(s):
    """The same cam where the cam is held and its follower runs around it, in another plane, and with other units and numbers."""
    first, _ = s.profile(LIFT.format(offset=0.008, height=0.04, beta=2, lift=0.02, cam='roller=0.01'))
    held, _ = s.profile("""&structure cq=1,2 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&pair coordinate=2, links=2,3, kind='prismatic', axis=0,1,0, point=0.008,0.04,0, moving_point=0,0,0 /
&cam link=1, follower=3, roller=0.01 /
""" + DRIVES.format(turn=-1))
    turned, _ = s.profile("""&mechanism angle_unit='deg' /
&structure cq=1,2 /
&pair coordinate=1, links=2,1, kind='revolute', axis=-1,0,0 /
&pair coordinate=2, links=3,1, kind='prismatic', axis=0,0,-1, point=0,0,0, moving_point=0,0.008,0.04 /
&cam link=2, follower=3, roller=0.01, guide=2 /
""" + DRIVES.format(turn=57.29577951308232))
    for name in ('radius', 'undercut'):
        s.near(held[name], first[name], 1e-11, f'{name} of a cam that is held')
        s.near(turned[name], first[name], 1e-11, f'{name} of a cam in another plane')
    s.near(held['pressure_angle'], first['pressure_angle'], 1e-12, 'pressure angle of a cam that is held')
    s.near(np.radians(turned['pressure_angle']), first['pressure_angle'], 1e-12, 'pressure angle of a cam in another plane')
    for a, b in (('x', 'y'), ('y', 'z')):
        s.near(held[f'profile.{a}'], first[f'profile.{a}'], ROUND_OFF, 'a cam that is held')
        s.near(turned[f'profile.{b}'], first[f'profile.{a}'], ROUND_OFF, 'a cam in another plane')


def test_plate_cam_that_slides(s):
    """Its profile is the curve of its law, moved by the roller."""
    plate, _ = s.profile("""&structure cq=1,2 /
&pair coordinate=1, links=1,2, kind='prismatic', axis=-1,0,0, moving_point=0,1,0 /
&pair coordinate=2, links=1,3, kind='prismatic', axis=0,1,0, moving_point=0,0,0 /
&cam link=2, follower=3, roller=0.1 /
""" + DRIVES.format(turn=1))
    x = np.linspace(0, 2.4, 241)
    w, ds, _ = curve345(np.minimum(x / 2, 1))
    w, ds = 0.02 * w, 0.01 * ds
    s.near(plate['profile.x'], x + 0.1 * ds / np.hypot(1, ds), ROUND_OFF, 'a sliding cam')
    s.near(plate['profile.y'], w - 0.1 / np.hypot(1, ds) + 1, 1e-12, 'a sliding cam lies below its follower')
    s.checks.true(np.all(np.isinf(plate['radius'][220:])), 'a sliding cam is straight where its follower rests')


@pytest.fixture
def follow(s):
    """The path of a data file whose follower runs on a profile that was written."""
    text = LIFT.format(offset=0, height=0.04, beta=2, lift=0.02, cam='roller=0.01').replace('intervals=240', 'intervals=2400')
    s.profile(text)
    return s.write('follow.nml', """&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&pair coordinate=2, links=2,3, kind='path', file='cam.dat', columns=3,4, orientation='tangent' /
&pair coordinate=3, links=3,4, kind='revolute', axis=0,0,1, point=0,{r},0, moving_point=0,0,0 /
&pair coordinate=4, links=1,4, kind='prismatic', axis=0,1,0, moving_point=0,0,0 /
&initial coordinate=2, position=0.03 /
&initial coordinate=3, position=2 /
&initial coordinate=4, position=0.05 /
&drive coordinate=1, kind='polynomial', coefficients=0, 1 /
&time start=0.8, end=1.5, intervals=35 /
""".format(r=0.01))


def test_profile_read_back(s, follow):
    """A profile that is read back as a curve leads the roller's centre as the motion law does."""
    table = os.path.join(s.folder, 'result.dat')
    done = run(s.mech9k, follow, '--table', table)
    if not s.checks.equal(done.returncode, 0, f'a profile is read back: {done.stderr}'):
        return
    rows = read_table(text_of(table))
    w, ds, dds = curve345(rows['t'] / 2)
    s.near(rows['q4'], 0.04 + 0.02 * w, 1e-9, 'a follower on a profile that was read back')
    s.near(rows['dq4'], 0.01 * ds, 1e-7, 'its velocity')
    s.near(rows['ddq4'], 0.005 * dds, 1e-4, 'its acceleration')


@pytest.mark.parametrize('columns, words', [
    ('3,40', "column 40 is asked for by 'columns', and this line has 11 numbers"), ('3', 'columns')])
def test_columns_that_are_refused(s, follow, columns, words):
    s.refused(text_of(follow).replace('columns=3,4', 'columns=' + columns), DATA, words, '--check')


def test_rest_gives_no_points(s):
    """Outputs at which cam and follower rest give no points; the others do."""
    text = LIFT.format(offset=0, height=0.04, beta=1, lift=0.02, cam='roller=0.01').replace(
        "coordinate=1, kind='polynomial', coefficients=0, 1", "coordinate=1, kind='segments', times=0,1,3, values=0,1,1, "
        "laws='cycloidal','dwell'")
    table, said = s.profile(text)
    s.checks.true('the follower rests against the cam; no points there' in said, 'rest is told', said)
    s.checks.true(90 < len(table['t']) < 110, f'rows of the motion only: {len(table["t"])}')


@pytest.mark.parametrize('cam, undercut_parts', [('roller=0.01', 0), ('roller=0.025', 1), ('face=0,-1,0', 0)])
def test_pictures(s, cam, undercut_parts):
    """The drawing is SVG with the curves; red marks what is undercut."""
    picture = os.path.join(s.folder, 'cam.svg')
    text = LIFT.format(offset=0, height=0.03, beta=1.2 if undercut_parts else 2, lift=0.02, cam=cam)
    s.profile(text, '--cam', picture)
    root = tree.parse(picture).getroot()
    marks = [item.get('id') or item.get('class') for item in root.iter()]
    s.checks.true('profile' in marks and 'follower' in marks, f'curve and follower are drawn: {cam}')
    s.checks.equal(marks.count('undercut'), undercut_parts, f'undercut parts: {cam}')
    s.checks.equal('pitch' in marks, 'roller' in cam, f'pitch curve: {cam}')


def test_cost_of_many_outputs(s):
    """The time grows with the number of outputs, not with its square, which would take minutes."""
    text = LIFT.format(offset=0, height=0.04, beta=2, lift=0.02, cam='roller=0.01').replace('intervals=240', 'intervals=100000')
    done = run(s.mech9k, s.write('case.nml', text), '--cam', os.path.join(s.folder, 'cam.svg'))
    s.checks.equal(done.returncode, 0, f'a cam with many outputs: {done.stderr}')


def test_reports(s):
    """The report tells what the lines tell, by names; the lines have no blanks at their ends."""
    path = os.path.join(s.folder, 'report.json')
    text = LIFT.format(offset=0, height=0.03, beta=1.2, lift=0.02, cam='roller=0.025').replace(
        '&time', "&cam link=2, follower=3, face=0,-1,0 /\n&time")
    other = os.path.join(s.folder, 'face.dat')
    table, said = s.profile(text, '--cam', '2:' + other, '--report', path, number='1:')
    s.checks.true(not any(line != line.rstrip() for line in said.split('\n')), 'no blanks at the ends of lines', said)
    with open(path, encoding='utf-8') as file:
        report = json.load(file)
    s.checks.equal((report['exit_code'], report['errors'], len(report['cams'])), (0, [], 2), 'a report with two cams')
    roller, face = report['cams']
    s.checks.equal((roller['cam'], roller['link'], roller['follower'], roller['roller'], roller['closed']), (1, 2, 3, 0.025, False), 'the cam')
    s.checks.equal((roller['points'], face['points']), (len(table['t']), len(read_table(text_of(other))['t'])), 'numbers of points')
    # with one radian of the cam in a second the pitch curve is 0.03 m + the lift away from the axis
    s.near([roller['pitch_curve']['least_distance'], roller['pitch_curve']['largest_distance']], [0.03, 0.05], ROUND_OFF, 'pitch curve')
    angle = roller['greatest_pressure_angle']
    s.checks.true(angle['value'] >= np.max(table['pressure_angle']), 'the greatest pressure angle is not less than those at outputs')
    s.near(angle['q'], angle['t'], ROUND_OFF, 'its place')
    s.checks.true(f"{angle['value']:.6g}"[:6] in said, 'the line and the report agree', said)
    ranges = roller['undercut']
    rows = table['t'][table['undercut'] > 0]
    s.checks.true(len(ranges) == 1 and ranges[0]['from']['t'] <= rows[0] and ranges[0]['to']['t'] >= rows[-1], 'range of undercut')
    s.near(face['contact_on_face'], [0, 0.02 * 1.875 / 1.2], 1e-6, 'contact on the face: the largest rate of a 3-4-5 polynomial is 15/8')
    s.checks.true('roller' not in face and 'pitch_curve' not in face, 'a face has no roller')


def test_report_of_a_straight_profile(s):
    path = os.path.join(s.folder, 'report.json')
    _, said = s.profile("""&structure cq=1,2 /
&pair coordinate=1, links=1,2, kind='prismatic', axis=1,0,0 /
&pair coordinate=2, links=1,3, kind='prismatic', axis=0,1,0 /
&drive coordinate=1, kind='polynomial', coefficients=0, 1 /
&drive coordinate=2, kind='polynomial', coefficients=0.1, 0.2 /
&cam link=2, follower=3, roller=0.01 /
""", '--report', path)
    s.checks.true('  no curved part: the profile is straight\n' in said, 'a straight profile', said)
    with open(path, encoding='utf-8') as file:
        s.checks.equal(json.load(file)['cams'][0]['least_convex_radius']['value'], None, 'its radius is not finite')


GOOD = LIFT.format(offset=0, height=0.04, beta=2, lift=0.02, cam='roller=0.01')
CAM = '&cam link=2, follower=3, roller=0.01 /'


@pytest.mark.parametrize('changed, code, words', [
    ('', USAGE, 'a group &cam, and it has none'),
    (CAM + CAM, USAGE, 'there are 2 cams; tell which one by its number, as in --cam 1:-'),
    ('&cam link=2, follower=9, roller=0.01 /', DATA, 'there is no link 9; they are 1 to 3'),
    ('&cam link=3, follower=3 /', DATA, 'two different links'),
    ('&cam link=2, follower=3, roller=-1 /', DATA, 'roller'),
    ('&cam link=2, follower=3, roller=1, face=0,1,0 /', DATA, "leave 'roller' or 'face' out"),
    ("&cam link=2, follower=3, face=0,1,0, side='outer' /", DATA, "leave 'side' out"),
    ('&cam link=2, follower=3, face=0,0,0 /', DATA, 'normal of the flat face is zero'),
    ('&cam link=2, follower=3, axis=0,0,0 /', DATA, "normal of the cam's plane is zero"),
    ('&cam link=2, follower=3, guide=1 /', DATA, 'pair 1 does not guide the follower'),
    ('&cam link=2, follower=3, guide=7 /', DATA, 'pair 7 does not guide the follower'),
    ('&cam link=2, follower=3, axis=0,1,0 /', DATA, 'case.nml:6'),
    ('&cam link=2, follower=3, axis=1,0,1 /', DATA, 'is not plane: its follower moves by'),
    ('&cam link=2, follower=3, face=0,1,1 /', DATA, 'is not plane: the flat face'),
    ('&cam link=1, follower=3, face=1,0,0, axis=0,0,1 /', DATA,
     "has no profile: the flat face of link 3 does not turn against the cam, which is link 1; check 'link', 'follower', 'point'"),
    ('&cam link=2, follower=1, roller=0.01 /', DATA, 'the centre of the roller on link 1 does not move against the cam'),
    ('&cam link=2, follower=1 /', DATA, 'the edge on link 1 does not move against the cam')], ids=[
    'no_cam', 'two_cams', 'no_such_link', 'one_link', 'negative_roller', 'roller_and_face', 'side_of_a_face', 'zero_face', 'zero_axis',
    'guide_of_the_cam', 'no_such_guide', 'axis_in_the_plane', 'oblique_axis', 'oblique_face', 'face_that_does_not_turn',
    'roller_that_does_not_move', 'edge_that_does_not_move'])
def test_cams_that_are_refused(s, changed, code, words):
    s.checks.true(CAM in GOOD, 'the group that is changed')
    s.refused(GOOD.replace(CAM, changed), code, words)


@pytest.mark.parametrize('words, options', [
    ('there is no cam 2; this file has 1 cam', ('--cam', '2:-')),
    ('ends in .svg', ('--cam', 'cam.png')),
    ('--cam needs an argument', ('--cam',)),
    ('cannot both be', ('--cam', 'a.dat', '--cam', 'a.dat')),
    ('--animate shows a run, and --cam makes none', ('--cam', 'a.dat', '--animate', 'a.html'))])
def test_options_that_are_refused(s, words, options):
    s.refused(GOOD, USAGE, words, *options)


def test_data_file_is_not_overwritten(s):
    s.refused(GOOD, USAGE, 'would overwrite', '--cam', s.write('case.nml', GOOD))


def test_law_that_ends_before_the_run(s):
    s.refused(GOOD.replace('times(3)=3', 'times(3)=2.2'), DATA, 'the run goes on to')
