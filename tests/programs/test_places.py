"""Wrong data are told with their place: line and column of the data file, or the setting that holds them; else the message says that the
whole file is meant.
"""
import os

import pytest

from mech9_cases import run, table_of

DATA = 3
PENDULUM = """&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&initial coordinate=1, position=1 /
&body link=2, mass=1, centre=0,-0.5,0 /
&time end=1, intervals=2 /
"""
DRIVE = ("&drive coordinate=1, kind='polynomial', coefficients=1 /\n", ('drive.coordinate=1', "drive.kind='polynomial'", 'drive.coefficients=1'))
# two couplings that hold the same two shafts: equilibrium does not tell how they share the force
SHAFTS = """&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&pair coordinate=2, links=1,3, kind='revolute', point=1,0,0, axis=0,0,1 /
&drive coordinate=1, kind='polynomial', coefficients=0, 1 /
&body link=3, mass=1, centre=0.1,0,0 /
&time end=1, intervals=2 /
&coupling coordinates=1,2, kind='gear', ratio=2 /
&coupling coordinates=1,2, kind='gear', ratio=2 /
&parameter name='mass', sets='body.mass' /
&output reactions=.true., sensitivities=.true. /
"""
# program, data, options, how the message begins; settings are written after --set
CASES = {
    'no inertia': ('mech9d', PENDULUM.replace('mass=1', 'mass=0'), (), 'case.nml:2:1: independent coordinate 1 has no inertia'),
    'no inertia at rest': ('mech9d', PENDULUM.replace('mass=1', 'mass=0'), ('--modes',), 'case.nml:2:1: independent coordinate 1 has no inertia'),
    'all is driven': ('mech9d', PENDULUM + DRIVE[0], ('--equilibrium',), 'case.nml:6:1: every independent coordinate is driven'),
    'all is driven by settings': ('mech9d', PENDULUM, ('--equilibrium', *DRIVE[1]), '--set: every independent coordinate is driven'),
    'a drive of settings': ('mech9d', PENDULUM.replace('position=1', 'position=2'), DRIVE[1],
                            'case.nml:3:33: the position of coordinate 1 at the start is 1 by its drive in an option --set, not 2'),
    'a drive': ('mech9d', PENDULUM.replace('position=1', 'position=2') + DRIVE[0], (),
                'case.nml:3:33: the position of coordinate 1 at the start is 1 by its drive in line 6, not 2'),
    'a sketch': ('mech9d', PENDULUM + "&output sketch='a.png' /\n", (), "case.nml:6:16: 'a.png' is no name of a sketch"),
    'a sketch of a setting': ('mech9d', PENDULUM, ("output.sketch='a.png'",), "--set: 'a.png' is no name of a sketch"),
    'a moving picture': ('mech9d', PENDULUM + "&output animation='a.png' /\n", (), "case.nml:6:19: 'a.png' is no name of a moving picture"),
    'a view': ('mech9d', PENDULUM + "&output sketch='a.svg', view='up' /\n", (), "case.nml:6:30: 'up' is no view"),
    'a shared force': ('mech9k', SHAFTS, (), 'case.nml:7:1: derivatives of forces in the pairs are not computed'),
    'an empty file': ('mech9k', '', (), 'case.nml: the whole file is empty'),
    'no structure': ('mech9k', "&time end=1 /\n", (), 'case.nml: nothing tells the independent coordinates'),
}


@pytest.mark.parametrize('kind', CASES)
def test_the_place_is_told(checks, tmp_path, mech9k, mech9d, kind):
    program, text, options, says = CASES[kind]
    (tmp_path / 'case.nml').write_text(text, encoding='utf-8')
    words = [word for option in options for word in ([option] if option.startswith('--') else ['--set', option])]
    done = run(mech9k if program == 'mech9k' else mech9d, 'case.nml', '--no-write', '--quiet', *words, folder=tmp_path)
    checks.true(done.returncode == DATA and says in done.stderr, f'{kind}: {says}', f'{done.returncode}: {done.stderr}')


def test_utf16(checks, tmp_path, mech9k):
    (tmp_path / 'case.nml').write_text(PENDULUM, encoding='utf-16')
    done = run(mech9k, 'case.nml', folder=tmp_path)
    checks.true(done.returncode == DATA and 'the whole file is written in UTF-16' in done.stderr, 'UTF-16', done.stderr)


def test_drive_of_settings_is_a_drive(checks, tmp_path, mech9d):
    """The force of a drive that settings make is recorded like that of a drive in the data file: the weight's moment."""
    path = os.fspath(tmp_path / 'case.nml')
    with open(path, 'w', encoding='utf-8') as file:
        file.write(PENDULUM + '&gravity acceleration=0,-10,0 /\n&output drive_forces=.true. /\n')
    made = table_of(mech9d, path, *(word for setting in DRIVE[1] for word in ('--set', setting)))
    # at one radian, 0.5 m from the pin
    checks.true('F1' in made, 'the force of the drive has a column', list(made))
    checks.near(made.get('F1', [0]), 5 * 0.8414709848078965, 1e-12, 'the force of the drive')
