"""Parts that --plan tells to be left out. Leaving them out changes no result.

Compares the program with itself: one mechanism in two planes, and in planar and spatial arithmetic.
"""
from mech9_cases import run, table_of

# a crank-rocker with a massless coupler; on its rocker turns one more link about its mass centre
FOUR_BAR = """
&mechanism links=5, coordinates=5 /
&structure cq=1, 5 /
&pair coordinate=1, links=1,2, kind='revolute', point={o}, axis={normal} /
&pair coordinate=2, links=2,3, kind='revolute', point={a}, axis={normal} /
&pair coordinate=3, links=3,4, kind='revolute', point={b}, axis={normal} /
&pair coordinate=4, links=1,4, kind='revolute', point={c}, axis={normal} /
&pair coordinate=5, links=4,5, kind='revolute', point={b}, axis={last} /
&initial coordinate=1, position=0, velocity=1 /
&initial coordinate=5, position=0, velocity=0 /
&body link=2, mass=1, centre={a}, inertia=0.1,0.1,0.1,0,0,0 /
&body link=4, mass=2, centre={b}, inertia=0.1,0.1,{zz},0,0,0 /
&body link=5, mass=1, centre={b}, inertia={inertia},0,0,0 /
&gravity acceleration={g} /
&time start=0, end=0.5, intervals=5 /
&solver relative_tolerance=1e-11, absolute_tolerance=1e-11 /
"""
IN_XY = dict(normal='0,0,1', last='0,0,1', o='0,0,0', a='0.3,0.2,0', b='1.2,0.8,0', c='1.1,0,0', inertia='0.05,0.05,0.1', zz='0.1', g='0,-9.81,0')
# the same in the plane x = 0: x, y, z have become y, z, x
IN_YZ = dict(normal='1,0,0', last='1,0,0', o='0,0,0', a='0,0.3,0.2', b='0,1.2,0.8', c='0,1.1,0', inertia='0.1,0.05,0.05', zz='0.1', g='0,0,-9.81')
# the last axis lies in the plane: the link beyond it turns with the rocker, which has so much less inertia
ACROSS = {**IN_XY, 'last': '0,1,0', 'inertia': '0.05,0.1,0.05', 'zz': '0.05'}
# the crank-rocker alone
ALONE = FOUR_BAR.replace('links=5, coordinates=5', 'links=4, coordinates=4').replace('cq=1, 5', 'cq=1')
ALONE = '\n'.join(line for line in ALONE.splitlines() if 'coordinate=5' not in line and 'link=5' not in line) + '\n'
# one link turns on another, about axes across each other
OPEN = """
&mechanism links=3, coordinates=2 /
&structure cq=1, 2 /
&pair coordinate=1, links=1,2, kind='revolute', point=0,0,0, axis=0,0,1 /
&pair coordinate=2, links=2,3, kind='revolute', point=1,0,0, axis={axis} /
&initial coordinate=1, position=0, velocity=1 /
&initial coordinate=2, position=0, velocity=1 /
&body link=3, mass=1, centre=1,1,1, inertia=0.1,0.1,0.1,0,0,0 /
&time start=0, end=0.5, intervals=5 /
"""
# tolerances of 1e-11 a step, some dozen steps
TOLERANCE = 1e-9


def write(folder, values, form=FOUR_BAR):
    path = folder / 'case.nml'
    path.write_text(form.format(**values), encoding='utf-8')
    return path


def test_plan_names_what_is_left_out(checks, mech9d, tmp_path):
    def plan_of(values, form=FOUR_BAR):
        done = run(mech9d, write(tmp_path, values, form), '--plan', folder=tmp_path)
        checks.equal(done.returncode, 0, 'a plan is printed')
        return done.stdout

    flat = plan_of(IN_XY)
    checks.true('planar arithmetic' in flat and '(0, 0, 1)' in flat, 'planar, and its normal', flat)
    checks.true('without mass, no terms of inertia: links 3\n' in flat, 'the massless link', flat)
    checks.true('left out: links' in flat and 'links 3\n' in flat.split('left out:')[-1], 'its motion is not needed', flat)
    checks.true('planar arithmetic' in plan_of(IN_YZ), 'planar in another plane')
    checks.true('by articulated bodies' in plan_of(dict(axis='0,1,0'), OPEN), 'an open chain in space')
    checks.true('by articulated bodies' in plan_of(dict(axis='0,0,1'), OPEN), 'an open chain in the plane')
    across = plan_of(ACROSS)
    checks.true('by articulated bodies' in across and 'by articulated bodies' in flat, 'an open link on a closed chain')
    checks.true('by articulated bodies' not in plan_of(IN_XY, ALONE), 'one closed chain alone')
    checks.true('spatial arithmetic: pair 5 ' in across, 'the pair that has another axis is named', across)
    checks.true('planar arithmetic: all its pairs turn about or slide across the direction (0, 0, 1) of link 1\n' in across,
                'the block that keeps its plane', across)


def test_leaving_parts_out_changes_no_result(checks, mech9d, tmp_path):
    tables = [table_of(mech9d, write(tmp_path, values)) for values in (IN_XY, IN_YZ, ACROSS)]
    checks.true(abs(tables[0]['q1'][-1]) > 0.1, 'it moves')
    for k in range(1, 5):
        for order in '', 'd', 'dd':
            name = f'{order}q{k}'
            checks.near(tables[1][name], tables[0][name], TOLERANCE, f'{name}: one plane and another')
            checks.near(tables[2][name], tables[0][name], TOLERANCE, f'{name}: planar and spatial')
