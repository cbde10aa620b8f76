"""The package mech9 from python/, with the shared library of the build."""
import os
import sys

import pytest

from mech9_cases import TREE


@pytest.fixture(scope='session')
def mech9(build):
    """The package."""
    library = os.path.join(build.folder, 'lib', 'libmech9.so.0')
    if not os.path.exists(library):
        pytest.skip('this build has no libmech9.so')
    os.environ.setdefault('MECH9_LIBRARY', library)
    sys.path.insert(0, os.path.join(TREE, 'python'))
    import mech9 as package
    return package


@pytest.fixture
def four_bar(mech9):
    """The driven four-bar of the library's examples."""
    return mech9.read(os.path.join(TREE, 'examples', 'library', 'four_bar.nml'))
