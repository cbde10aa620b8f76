"""The programs mech9k and mech9d that come with the package."""
from __future__ import annotations

import os
import sys
from typing import NoReturn


def _run(name: str) -> NoReturn:
    # one file, which is the program by whose name it is called
    program = os.path.join(os.path.dirname(os.path.abspath(__file__)), 'bin', 'mech9')
    if not os.path.exists(program):
        sys.exit(f'{name} is not part of this installation')
    os.execv(program, [name, *sys.argv[1:]])


def mech9k() -> NoReturn:
    """Kinematics."""
    _run('mech9k')


def mech9d() -> NoReturn:
    """Dynamics."""
    _run('mech9d')
