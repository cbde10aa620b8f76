"""Data files of mechanisms with contacts, most of which a motion cannot have, and runs of such files."""
import json

from mech9_cases import read_table, run

SLIDING_POINT = """&structure cq=1 /
&pair coordinate=1, links=1,2, kind='prismatic', axis=0,0,1 /
&body link=2, mass=1 /
&point name='P', link=2, position=0,0,0 /
&initial coordinate=1, position=1, velocity=0 /
&contact point='P' /
&time end=1, intervals=10 /
"""
# A block that friction holds on two feet: three coordinates, four forces.
TWO_FEET = """&structure cq=1,2,3 /
&pair coordinate=1, links=1,2, kind='prismatic', axis=1,0,0 /
&pair coordinate=2, links=2,3, kind='prismatic', axis=0,0,1 /
&pair coordinate=3, links=3,4, kind='revolute', axis=0,1,0 /
&initial coordinate=1, position=0 / &initial coordinate=2, position=0 / &initial coordinate=3, position=0 /
&body link=4, mass=1, inertia=1,1,1,0,0,0 / &gravity acceleration=0,0,-9.81 /
&point name='P', link=4, position=0.5,0,0 / &point name='Q', link=4, position=-0.5,0,0 /
&contact point='P', friction=0.5 / &contact point='Q', friction=0.5 /
&parameter name='m', sets='body(1).mass' / &output sensitivities=.true. /
&time end=1, intervals=10 /
"""
SUNK_POINT = SLIDING_POINT.replace('position=1,', 'position=-0.25,')
DRIVEN_POINT = """&structure cq=1 /
&pair coordinate=1, links=1,2, kind='prismatic', axis=0,0,1 /
&point name='P', link=2, position=0,0,0.5 /
&drive coordinate=1, kind='polynomial', coefficients=0,-1 /
&contact point='P' /
&time end=1, intervals=10 /
"""
STILL_POINT = """&structure cq=1,2 /
&drive coordinate=2, kind='polynomial', coefficients=0.1 /
&pair coordinate=1, links=1,2, kind='prismatic', axis=0,0,1 /
&pair coordinate=2, links=2,3, kind='prismatic', axis=0,0,1 /
&initial coordinate=1, position=0, velocity=0 /
&body link=3, mass=1 /
&point name='P', link=3 /
&contact point='P', link=2, origin=0,0,-0.1 /
&time end=0.05 /
"""
PRESSED_POINT = DRIVEN_POINT.replace('cq=1', 'cq=1,2') + """&pair coordinate=2, links=1,3, kind='prismatic', axis=0,1,0 /
&body link=2, mass=1 /
&body link=3, mass=1 /
&initial coordinate=2, position=0, velocity=1 /
"""
# a rod of 2 m at 60 degrees slides on its end
ROD = """&structure cq=1,2,3 /
&pair coordinates=1,2,3, links=1,2, kind='planar', axis=0,-1,0, zero=1,0,0 /
&body link=2, mass=1, inertia=0.3333333333333333,0.3333333333333333,0.3333333333333333,0,0,0 /
&gravity acceleration=0,0,-9.81 /
&point name='A', link=2, position=-1,0,0 /
&initial coordinate=1, position=0, velocity=-1 /
&initial coordinate=2, position=0.8660254037844386, velocity=0 /
&initial coordinate=3, position=1.0471975511965976, velocity=0 /
&contact point='A', friction=1.5 /
&time end=1, intervals=10 /
"""


def start(positions, rates):
    """Groups &initial of all coordinates."""
    return ''.join(f'&initial coordinate={i}, position={q!r}, velocity={dq!r} /\n' for i, (q, dq) in enumerate(zip(positions, rates), 1))


def go(program, folder, text, end, intervals=20, code=0, options=()):
    """Table, events and standard error of a run that ends with a code."""
    path, table, report = folder / 'meet.nml', folder / 'meet.dat', folder / 'meet.json'
    path.write_text(f'{text}&time end={end!r}, intervals={intervals} /\n', encoding='utf-8')
    done = run(program, path, '--table', table, '--report', report, *options)
    assert done.returncode == code, done.stderr
    columns = read_table(table.read_text()) if code == 0 else None
    return columns, json.loads(report.read_text()).get('events', []), done.stderr
