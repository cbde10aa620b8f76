"""The same mechanism in metres, millimetres and kilometres, in radians and degrees: the same decisions and, scaled, the
same numbers. The same with units that &mechanism names: the same motion, whose numbers are those in SI in the units of the heads.

Data files of tests/reference and of the examples, and members of the families of the stress test, among them some that
end at dead points, cannot be put together or have wrong inputs.

Compares the program with itself: one mechanism in several units.
"""
import os
import re

import numpy as np
import pytest

import data_file
import families
from gallery_list import examples
from loops import Loops
from mech9_cases import REFERENCE, text_of
from stress import Mechanism
from unit_runs import SHORT, UNITS, Units, power_of

# a pendulum with a spring at its pin, of which no other data file has one
SPRING_AT_PIN = """
&mechanism links=2, coordinates=1 /
&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&initial coordinate=1, position=0.4, velocity=0.3 /
&body link=2, mass=2.0, centre=0.5,0,0, inertia=0.1,0.1,0.1,0,0,0 /
&load kind='coordinate', coordinate=1, stiffness=3.0, rest=0.7, damping=0.2 /
&output table='' /
"""


@pytest.fixture
def units(checks, tmp_path):
    return Units(checks, tmp_path)


NAMES = sorted(name for name in os.listdir(REFERENCE) if name.endswith('.nml'))


@pytest.mark.parametrize('name', NAMES)
def test_data_files_of_the_references(units, mech9k, mech9d, name):
    path = os.path.join(REFERENCE, name)
    if name.startswith('kinematics_'):
        units.file(mech9k, path)
    else:
        units.file(mech9d, path, *SHORT)


# of the gallery, those that need no user procedures and are in SI units
EXAMPLES = [example for example in examples() if not example.procedures and 'length_unit' not in text_of(example.data)]


@pytest.mark.parametrize('example', EXAMPLES, ids=[example.name for example in EXAMPLES])
def test_data_files_of_the_gallery(units, build, example):
    # the times of quantities belong to the whole run
    whole = example.program == 'mech9k' or re.search(r"take='at'", text_of(example.data))
    units.file(build.program(example.program), example.data, *(() if whole else SHORT))


@pytest.mark.parametrize('name', NAMES)
def test_references_with_named_units(units, mech9k, mech9d, name):
    path = os.path.join(REFERENCE, name)
    if name.startswith('kinematics_'):
        units.named(mech9k, path)
    else:
        units.named(mech9d, path, *SHORT)


@pytest.mark.parametrize('example', EXAMPLES, ids=[example.name for example in EXAMPLES])
def test_the_gallery_with_named_units(units, build, example):
    whole = example.program == 'mech9k' or re.search(r"take='at'", text_of(example.data))
    units.named(build.program(example.program), example.data, *(() if whole else SHORT))


def test_a_spring_at_a_pin(units, mech9d):
    spring = os.path.join(units.folder, 'spring.nml')
    with open(spring, 'w', encoding='utf-8') as file:
        file.write(SPRING_AT_PIN)
    units.file(mech9d, spring, *SHORT)
    units.named(mech9d, spring, *SHORT)


FAMILIES = {**families.MOVING, **families.WRONG}


@pytest.mark.parametrize('family, number', [(family, number) for family, variants in FAMILIES.items() for number in range(len(variants))])
def test_members_of_families(units, mech9k, family, number):
    """Right ones and wrong ones."""
    rng = np.random.default_rng([2000, *family.encode(), number])
    links, pairs, inputs = FAMILIES[family][number](rng, 1)
    loops = Loops(links, pairs.point, pairs.axis, pairs.turns, pairs.slides, [k - 1 for k in inputs], rng.uniform(0.5, 2.0, (1, len(inputs))))
    slides = {k + 1 for k, turns in enumerate(pairs.turns[0]) if turns == 0}
    plain, *others = (units.look(mech9k, Mechanism(family, loops, 0, s, 7, np.zeros(len(links))).text()) for s in (1.0, *UNITS))
    for s, other in zip(UNITS, others):
        units.compare(f'{family} {number}, member 0, lengths times {s:g}', plain, other, lambda column, s=s: s ** power_of(column, slides))
