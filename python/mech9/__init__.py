"""Kinematic and dynamic analysis of spatial mechanisms with closed chains.

A mechanism is read from a data file, or built from nothing by its groups::

    import mech9
    m = mech9.read('four_bar.nml')
    r = m.kinematics(end=2, intervals=500)
    r.t, r['q1'], r['P.x']

Numbers are in the units of the data file. Names of groups, words and numbers are those of the data file and of the option --set.
"""
from ._errors import (AssemblyError, DataError, Error, FileError, Finding, IntegrationError, SingularError, StructureError,
                      UsageError)
from ._equations import Equations
from ._function import Function
from ._library import version as _version
from ._mechanism import Check, Mechanism, Optimum, Positions, import_robot, read, read_text
from ._pictures import Picture
from ._procedures import Loads, Motion
from ._results import Branches, Exponents, Gradients, Linear, LinearMotion, Matrix, Periodic, Results, Section
from ._simulation import Simulation, Simulations

__all__ = ['read', 'read_text', 'import_robot', 'Mechanism', 'Results', 'Section', 'Gradients', 'Positions', 'Check', 'Linear', 'LinearMotion', 'Exponents', 'Periodic', 'Branches', 'Optimum', 'Matrix', 'Picture', 'Function', 'Equations',
           'Simulation', 'Simulations', 'Motion', 'Loads', 'Error', 'Finding',
           'UsageError', 'DataError', 'StructureError', 'AssemblyError', 'SingularError', 'IntegrationError', 'FileError']
__version__ = _version()
