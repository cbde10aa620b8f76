"""Forward dynamics of the same mechanisms by hand, by MECH9 and by other programs, where they are installed: MuJoCo and Pinocchio.

usage: accelerations.py PROGRAMS MECH9D FOLDER full|quick
    PROGRAMS   folder of bench_structures and bench_by_hand
    MECH9D     the program mech9d, which closes the chains at the start and gives the accelerations that others are compared with
    FOLDER     for data files and tables
Prints a row for each mechanism and program: the mechanism, its N, the program with its procedure, microseconds an evaluation, and the largest
difference of accelerations from those of mech9d over the largest acceleration. A line `missing` names each program that is not
installed. A program that fails is told on standard error and left out. All programs get the links, pairs and bodies of one data file, and the closed position and rates of its start.
"""
import os
import statistics
import sys
import time

from mechanism import Mechanism, first_row, output_of
from mujoco_model import model_of
from pinocchio_model import Model

TREE = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
# name, kind of bench_structures, plane or space, N
PROBLEMS = [('two_links', 'chain', 'plane', 2), ('four_bar', 'four_bar', 'plane', 1), ('andrews', 'file', 'plane', 1),
            ('chain', 'chain', 'space', 10), ('chain', 'chain', 'space', 50), ('chain', 'chain', 'space', 200),
            ('tip', 'tip', 'space', 10), ('tip', 'tip', 'space', 50), ('tip', 'tip', 'space', 100),
            ('modules', 'modules', 'space', 30), ('legs', 'file', 'space', 1)]
FILES = {'andrews': 'examples/andrews/andrews.nml', 'legs': 'bench/data/legs_fall.nml'}


def time_of(call, quick):
    """Median time of a call [us]."""
    begin = time.perf_counter()
    call()
    once = time.perf_counter() - begin
    calls = max(3, int((0.002 if quick else 0.02) / max(once, 1e-6)))
    times = []
    for _ in range(3 if quick else 15):
        begin = time.perf_counter()
        for _ in range(calls):
            call()
        times.append((time.perf_counter() - begin) / calls)
    return 1e6 * statistics.median(times)


def with_mujoco(mujoco, numpy, mechanism, quick):
    """mj_forward without contacts."""
    model, order = model_of(mujoco, mechanism, mechanism.closing_points())
    data = mujoco.MjData(model)
    forces = mechanism.forces()
    data.qpos[:] = [mechanism.position[k] for k in order]
    data.qvel[:] = [mechanism.rate[k] for k in order]
    data.qfrc_applied[:] = [forces[k] for k in order]
    spent = time_of(lambda: mujoco.mj_forward(model, data), quick)
    found = dict(zip(order, data.qacc))
    yield 'MuJoCo, mj_forward', spent, mechanism.error([found[k] for k in mechanism.tree])


def with_pinocchio(pin, numpy, mechanism, quick):
    """Articulated bodies; with closed chains those with loops, or in versions without them a sparse factorization."""
    ends = mechanism.closing_points()
    made = Model(pin, numpy, mechanism, ends)
    model, data, constraints, of_constraints = made.model, made.data, made.constraints, made.of_constraints
    q, v, tau = numpy.zeros(model.nq), numpy.zeros(model.nv), numpy.zeros(model.nv)
    forces = mechanism.forces()
    for place, k in zip(made.place_of, mechanism.tree):
        q[place], v[place], tau[place] = mechanism.position[k], mechanism.rate[k], forces[k]

    def measured(words, call):
        spent = time_of(call, quick)
        return words, spent, mechanism.error(numpy.array(call())[made.place_of])

    if not ends:
        yield measured('Pinocchio, aba', lambda: pin.aba(model, data, q, v, tau))
        return
    # one step with this weight leaves errors of 1e-7 to 1e-5 here; more steps take longer
    settings = pin.ProximalSettings(1e-12, 1e-6, 1)
    if hasattr(pin, 'lcaba'):
        pin.computeJointMinimalOrdering(model, data, constraints)
        yield measured('Pinocchio, lcaba', lambda: pin.lcaba(model, data, q, v, tau, constraints, of_constraints, settings))
        return
    pin.initConstraintDynamics(model, data, constraints)
    yield measured('Pinocchio, constraintDynamics',
                   lambda: pin.constraintDynamics(model, data, q, v, tau, constraints, of_constraints, settings))


def installed():
    """[(name, function, module, numpy)] of the other programs, and the names of those that are not here."""
    found, missing = [], []
    for words, name, function in (('MuJoCo', 'mujoco', with_mujoco), ('Pinocchio', 'pinocchio', with_pinocchio)):
        try:
            found.append((words, function, __import__(name), __import__('numpy')))
        except (ImportError, OSError):
            missing.append(words)
    return found, missing


def main():
    programs, mech9d, folder, mode = sys.argv[1:]
    quick = mode == 'quick'
    others, missing = installed()
    for words in missing:
        print('missing', words)
    by_hand = {}
    for line in output_of(os.path.join(programs, 'bench_by_hand'), mode).splitlines():
        name, spent, *accelerations = line.split()
        by_hand[name] = float(spent), [float(a) for a in accelerations]
    for name, kind, space, n in PROBLEMS:
        if quick and n > 50:
            continue
        path = os.path.join(folder, 'same.nml')
        if kind == 'file':
            path = os.path.join(TREE, FILES[name])
        row = output_of(os.path.join(programs, 'bench_structures'), kind, space, n, path).split()
        mechanism = Mechanism(path, first_row(mech9d, path, folder))
        rows = []
        if name in by_hand:
            spent, accelerations = by_hand[name]
            largest = max(map(abs, mechanism.acceleration))
            rows.append(('by hand', spent, max(abs(a - b) for a, b in zip(accelerations, mechanism.acceleration)) / largest))
        rows.append(('MECH9', float(row[6]), 0.0))
        for program, function, module, numpy in others:
            # a version that knows other names must not end the run
            try:
                rows += list(function(module, numpy, mechanism, quick))
            except Exception as failure:
                print(f'{program} fails on {name} {n}: {failure}', file=sys.stderr)
        for words, spent, error in rows:
            print(f'{name}\t{n}\t{words}\t{spent:.4f}\t{error:.1e}', flush=True)


if __name__ == '__main__':
    main()
