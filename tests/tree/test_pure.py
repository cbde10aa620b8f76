"""Pure procedures return nothing whose deallocation might call a procedure that is not pure.

The standard (Fortran 2008 with its corrigenda, C1284a; 2018, C1585 and C1586) forbids a pure function a result, and a pure
procedure an argument of intent(out), that is polymorphic or holds a polymorphic allocatable component; gfortran does not tell.
"""
import os
import re

import pytest

from mech9_cases import TREE

TYPE = re.compile(r'^ *type\b([^\n(]*(?:extends\((\w+)\))?[^\n(]*)::\s*(\w+)\s*(?:!.*)?\n(.*?)^ *end type', re.M | re.S)
OWNED = re.compile(r'^ *class\(\w+\)[^\n:]*\ballocatable\b', re.M)
PURE = re.compile(r'^ *pure\b[^\n]*?\b(subroutine|function)\s+(\w+)(.*?)^ *end \1 \2', re.M | re.S)


def owners(texts):
    """Types that own something polymorphic: themselves, through a component, or through the type they extend."""
    types = {name: (body, parent) for text in texts for _, parent, name, body in TYPE.findall(text)}
    found = {name for name, (body, _) in types.items() if OWNED.search(body)}
    while True:
        inner = '|'.join(sorted(found)) or 'nothing'
        more = {name for name, (body, parent) in types.items()
                if parent in found or re.search(rf'^ *type\((?:{inner})\)(?![^\n:]*\bpointer\b)', body, re.M)} - found
        if not more:
            return found
        found |= more


def forbidden(kind, name, body, types):
    """The declarations in a pure procedure that the standard forbids."""
    result = re.search(r'\bresult\((\w+)\)', body)
    result = result.group(1) if result else name
    found = []
    for match in re.finditer(r'^ *(type|class)\((\w+)\)([^\n:]*)::\s*([^\n!]*)', body, re.M):
        word, of_type, attributes, names = match.groups()
        returned = 'intent(out)' in attributes or (kind == 'function' and re.search(rf'\b{result}\b', names))
        if returned and (word == 'class' or of_type in types):
            found.append(match.group(0).strip())
    return found


@pytest.fixture(scope='module')
def types(sources):
    return owners([text for _, _, text in sources])


def test_types_that_own_something_polymorphic_are_found(checks, types):
    checks.true({'mechanism_type', 'plan_type', 'load_slot_type', 'motion_system_type'} <= types, 'types with pairs, drives or loads',
                types)


def test_pure_procedures_are_pure_by_the_standard(checks, sources, types):
    for _, path, text in sources:
        for kind, name, body in PURE.findall(text):
            wrong = forbidden(kind, name, body, types)
            checks.equal(wrong, [], f'{os.path.relpath(path, TREE)}: {name} is not pure by the standard')
