"""Threads of Python that use the library at the same time.

The run-time check of recursion takes two threads in one procedure for one, so that the debug build cannot be used.
"""
import os
import threading

import numpy as np
import pytest

from mech9_cases import TREE

FOUR_BAR = os.path.join(TREE, 'examples', 'library', 'four_bar.nml')


@pytest.fixture(autouse=True)
def without_check_of_recursion(build):
    if build.kind == 'Debug':
        pytest.skip('the debug build checks recursion')


def test_threads_side_by_side(mech9, four_bar):
    expected = four_bar.kinematics(intervals=200).table
    found = []

    def work():
        found.append(mech9.read(FOUR_BAR).kinematics(intervals=200).table)
    threads = [threading.Thread(target=work) for _ in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(found) == 8 and all((table == expected).all() for table in found)


def test_positions_in_threads(mech9, four_bar):
    q = np.linspace(-20.0, 20.0, 1001)
    assert np.abs(four_bar.positions(q, threads=3) - four_bar.positions(q)).max() < 1e-12


def test_imports_in_threads(mech9, tmp_path):
    rod = '<link name="rod"><inertial><mass value="{}"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>'
    names = [str(tmp_path / 'light.urdf'), str(tmp_path / 'heavy.urdf')]
    for mass, name in enumerate(names, 1):
        with open(name, 'w', encoding='utf-8') as file:
            file.write('<robot name="arm"><link name="base"/>' + rod.format(mass) + '<joint name="pin" type="continuous">'
                       '<parent link="base"/><child link="rod"/><axis xyz="0 0 1"/></joint></robot>')
    try:
        expected = [mech9.import_robot(name).imported_text for name in names]
    except mech9.Error as reason:
        assert 'expat' in str(reason)
        pytest.skip('this build imports no robots')
    found = []

    def work(which):
        found.extend(mech9.import_robot(names[which]).imported_text == expected[which] for _ in range(20))
    threads = [threading.Thread(target=work, args=(which,)) for which in (0, 1, 0)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert expected[0] != expected[1] and found == [True]*60
