"""Runs with derivatives through events, and derivatives against differences of runs."""
import json
import re

import numpy as np

from mech9_cases import read_table, run

BOUNCING = """&structure cq=1 /
&pair coordinate=1, links=1,2, kind='prismatic', axis=0,0,1 /
&body link=2, mass=2 /
&gravity acceleration=0,0,-9.81 /
&stop coordinate=1, low=0, restitution=0.9 /
&initial coordinate=1, position=1 /
&parameter name='h', sets='initial(1).position' /
&parameter name='e', sets='stop(1).restitution' /
&parameter name='g', sets='gravity(1).acceleration(3)' /
&parameter name='low', sets='stop(1).low' /
&parameter name='m', sets='body(1).mass' /
"""
OSCILLATOR = """&structure cq=1 /
&pair coordinate=1, links=1,2, kind='prismatic', axis=1,0,0 /
&body link=2, mass=1 /
&load kind='coordinate', coordinate=1, stiffness=1, damping=0.2 /
&load kind='coordinate', coordinate=1, force=1, law='harmonic', amplitude=1, angular_frequency=2.5, phase=1.5707963267948966 /
&stop coordinate=1, low=0, restitution=0.8 /
&initial coordinate=1, position=0.5, velocity=0.1 /
"""
FOUR_BAR = """&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&pair coordinate=2, links=2,3, kind='revolute', point=0.2,0,0, axis=0,0,1 /
&pair coordinate=3, links=3,4, kind='revolute', point=0.7,0,0, axis=0,0,1, moving_point=1,0,0 /
&pair coordinate=4, links=1,4, kind='revolute', point=0.6,0,0, axis=0,0,1 /
&initial coordinate=1, position=0.5, velocity=1 /
&initial coordinate=2, position=0.3 /
&initial coordinate=3, position=1 /
&initial coordinate=4, position=1.7 /
&body link=2, mass=0.2, centre=0.1,0,0, inertia=0,0,0.0006666666666666667,0,0,0 /
&body link=3, mass=0.5, centre=0.45,0,0, inertia=0,0,0.010416666666666667,0,0,0 /
&body link=4, mass=2, centre=0.8,0,0, inertia=0,0,0.026666666666666667,0,0,0 /
&gravity acceleration=0,-9.81,0 /
&load kind='coordinate', coordinate=1, damping=0.05 /
&stop coordinate=4, high=2.3, restitution=0.7 /
&parameter name='v', sets='initial(1).velocity' /
&parameter name='m', sets='body(3).mass' /
&parameter name='l', sets='pair(3).point(1)' /
&parameter name='e', sets='stop(1).restitution' /
&parameter name='high', sets='stop(1).high' /
"""
COLUMNS = '&output sensitivities=.true. /\n'
TIGHT = '&solver relative_tolerance=1e-12, absolute_tolerance=1e-13 /\n'


def go(program, folder, text, *words, end=1.0, intervals=1, code=0):
    """Table, report and standard error of a run."""
    path, table, report = folder / 'event.nml', folder / 'event.dat', folder / 'event.json'
    path.write_text(f'{text}&time end={end!r}, intervals={intervals} /\n', encoding='utf-8')
    done = run(program, path, '--table', table, '--report', report, *words)
    assert done.returncode == code, done.stderr
    return read_table(table.read_text()) if code == 0 else None, json.loads(report.read_text()), done.stderr


def kinds(report):
    return [(event['kind'], event['number']) for event in report['events']]


def parameters_of(text):
    """Names and targets of the parameters of a data file."""
    return re.findall(r"&parameter name='(\w+)', sets='([^']+)'", text)


def directions_of(sizes):
    """Directions in which all parameters change at once, so that four runs are enough for one.

    Derivatives by each parameter, whose largest have these sizes, add about as much to the one along a direction: an error in any of
    them shows. The factors have no simple ratios, and every other sign is turned in the second direction: two errors do not cancel.
    """
    turns, sizes = np.arange(len(sizes)), np.maximum(1.0, sizes)
    # no step is more than ten times that of the parameter with the largest derivatives
    factors = (1 - 0.5*(turns*(np.sqrt(5) - 1)/2 % 1))*np.minimum(sizes.max()/sizes, 10.0)
    return [factors] if len(sizes) < 2 else [factors, factors*(-1.0)**turns]


def near_runs(checks, program, folder, plain, text, direction, report, step, **times):
    """Table and report of the four runs for a difference of fourth order, by the number of steps, in which the same events happen."""
    near = {}
    for i in (-2, -1, 1, 2):
        words = [word for (_, target), factor in zip(parameters_of(text), direction)
                 for word in ('--set', f'{target}={float(number_of(text, target) + i*step*factor)!r}')]
        table, other, _ = go(program, folder, plain, *words, **times)
        checks.true(kinds(other)[:6] == kinds(report)[:6], 'the same events happen', (i, direction))
        near[i] = table, other
    return near


def slope_of(values, step):
    """The difference of fourth order of values by the number of steps."""
    return (8*(values[1] - values[-1]) - values[2] + values[-2])/(12*step)


def against_differences(checks, program, folder, text, columns, end, intervals, output=COLUMNS, step=1e-5, tol=2e-7):
    """Derivatives of all columns by all parameters against differences of fourth order of runs in which the same events happen."""
    table, report, _ = go(program, folder, text + output + TIGHT, end=end, intervals=intervals)
    plain = re.sub('&parameter.*\n', '', text) + output.replace('sensitivities=.true.', 'sensitivities=.false.') + TIGHT
    by = {column: np.array([table[f'd({column})/d({name})'] for name, _ in parameters_of(text)]) for column in columns}
    sizes = np.max([np.abs(values).max(axis=1) for values in by.values()], axis=0)
    for direction in directions_of(sizes):
        near = near_runs(checks, program, folder, plain, text, direction, report, step, end=end, intervals=intervals)
        for column in columns:
            slope = slope_of({i: one[column] for i, (one, _) in near.items()}, step)
            # tolerance: the error of motions, 1e-12 to 1e-11, over the step
            checks.near(direction @ by[column], slope, tol, f'{column} along {direction}', scale=max(1.0, float(np.abs(slope).max())))
    return report


def quantities_against_differences(checks, program, folder, text, takes, end, intervals, step=1e-5, tol=5e-6):
    """Derivatives of quantities, each a column and what is taken of it, against differences of fourth order, as above."""
    asked = ''.join(f"&quantity name='n{i}', of='{take.split()[0]}', take='{take.split()[1]}' /\n" for i, take in enumerate(takes))
    _, report, _ = go(program, folder, text + asked + '&output gradients=.true., energies=.true. /\n' + TIGHT, end=end, intervals=intervals)
    plain = re.sub('&parameter.*\n', '', text) + asked + '&output energies=.true. /\n' + TIGHT
    by = np.full((len(takes), len(parameters_of(text))), np.nan)
    for i, take in enumerate(takes):
        found = {one['parameter']: one['value'] for one in report['quantities'][i]['gradient']}
        for k, (name, _) in enumerate(parameters_of(text)):
            if checks.true(found[name] is not None, f'{take} by {name}', 'is not known'):
                by[i, k] = found[name]
    for direction in directions_of(np.nan_to_num(np.abs(by)).max(axis=0)):
        near = near_runs(checks, program, folder, plain, text, direction, report, step, end=end, intervals=intervals)
        for i, take in enumerate(takes):
            slope = slope_of({k: other['quantities'][i]['value'] for k, (_, other) in near.items()}, step)
            # tolerance: as above
            checks.near(direction @ by[i], slope, tol, f'{take} along {direction}', scale=max(1.0, abs(slope)))
    return report


def number_of(text, target):
    """A number of a data file by its name."""
    group, number, name, place = re.match(r'(\w+)\((\d+)\)\.(\w+)(?:\((\d+)\))?', target).groups()
    group = re.findall(rf'&{group}\s([^/]*)/', text)[int(number) - 1]
    return float(re.search(rf'\b{name}=([-\d.,e+]+)', group).group(1).strip(',').split(',')[int(place or 1) - 1])
