"""A coordinate whose motion moves no mass is refused in dynamics, also where rates that are round-off give it some."""
import pytest

from mech9_cases import run

DONE, DATA = 0, 3

# a rod with a spherical joint at each end, three revolutes each, between two cranks about crossed axes: q4 turns the rod about
# itself, and moves nothing else
ROD = """
&mechanism links=8, coordinates=8 /
&structure cq=1, 4 /
&pair coordinate=1, links=1,2, kind='revolute', point=0,0,0, axis=0,0,1 /
&pair coordinate=2, links=2,3, kind='revolute', point=0.3,0,0, axis=1,0,0 /
&pair coordinate=3, links=3,4, kind='revolute', point=0.3,0,0, axis=0,1,0 /
&pair coordinate=4, links=4,5, kind='revolute', point=0.3,0,0, axis=0.8,0.5,0.7 /
&pair coordinate=5, links=5,6, kind='revolute', point=1.1,0.5,0.7, axis=1,0,0 /
&pair coordinate=6, links=6,7, kind='revolute', point=1.1,0.5,0.7, axis=0,1,0 /
&pair coordinate=7, links=7,8, kind='revolute', point=1.1,0.5,0.7, axis=0,0,1 /
&pair coordinate=8, links=1,8, kind='revolute', point=1.1,0.1,0.6, axis=1,0,0 /
&initial coordinate=1, position=0.1, velocity=1 /
&initial coordinate=4, position=1.1, velocity=0 /
&body link=2, mass=2, centre=0.15,0,0, inertia=0.01,0.02,0.02,0,0,0 /
&body link=8, mass=1, centre=1.1,0.3,0.65, inertia=0.01,0.01,0.01,0,0,0 /
&time start=0, end=0.05, intervals=2 /
"""
SPINNING = "&body link=5, mass=1e-9, centre=0.7,0.25,0.35, inertia=1e-12,1e-12,1e-12,0,0,0 /\n"


@pytest.mark.parametrize('text, code', [(ROD, DATA), (ROD + SPINNING, DONE)], ids=['without_mass', 'with_little_mass'])
def test_rod_that_turns_about_itself(checks, mech9d, tmp_path, text, code):
    path = tmp_path / 'rod.nml'
    path.write_text(text, encoding='utf-8')
    done = run(mech9d, path, '--table', '-', '--quiet', folder=tmp_path)
    checks.equal(done.returncode, code, f'a rod that turns about itself, exit code {code}: {done.stderr}')
    if code == DATA:
        checks.true('independent coordinate 4 has no inertia' in done.stderr, 'the coordinate is named', done.stderr)
