"""An optional array that may be absent is handed on only where it is present.

gfortran forms the bounds of an optional array of assumed shape at the start of a procedure. Where the array is absent, a call that hands it on
reads these bounds from memory that was never set. Programs with checks of arithmetic stop there, now and then.
Allocatable arrays and pointers are handed on as they are.
"""
import os
import re

from fortran_calls import PROCEDURE, divided, statements
from mech9_cases import TREE

END = re.compile(r'^end (subroutine|function|procedure)\b')
OPTIONAL = re.compile(r'^(?:integer|real|logical|complex|character|type|class)\b(?=[^:]*\boptional\b)(?![^:]*\b(?:allocatable|pointer)\b)'
                      r'.*?:: *(\w+) *\([^)]*:')
EXAMPLE = """
subroutine hand_on(a, b, c, d)
  real, intent(in), optional :: a(:)
  real, intent(in), optional :: b(2)
  real, allocatable, intent(in), optional :: c(:)
  real, intent(in), optional :: d(:, :)
  call take(a, b, c)
  call take(x, &
            values=d)
  if (present(a)) then
    if (size(a) > 1) call take(a)
  else
    call take(a)
  end if
  if (present(d)) call take(d)
end subroutine hand_on
"""


def handed_on(text):
    """(line, name) of each call that hands on an optional array outside of what is done where it is present."""
    found, optional, blocks = [], set(), []
    for number, line in statements(text):
        begins = PROCEDURE.match(line)
        if begins and not END.match(line):
            optional, blocks = set(), []
            continue
        declared = OPTIONAL.match(line)
        if declared:
            optional.add(declared.group(1))
            continue
        if re.match(r'^(?:\w+ *: *)?if *\(.*\) *then$', line):
            blocks.append(line)
        elif re.match(r'^else *if\b', line) and blocks:
            blocks[-1] = line
        elif line == 'else' and blocks:
            blocks[-1] = ''
        elif re.match(r'^end *if\b', line) and blocks:
            blocks.pop()
        call = re.search(r'\bcall [\w%() :,]*?\w *\((.*)\)$', line)
        if not call:
            continue
        conditions = ' '.join(blocks) + line[:call.start()]
        for argument in divided(call.group(1)):
            name = re.sub(r'^\w+ *= *', '', argument)
            if name in optional and not re.search(rf'\bpresent *\( *{name} *\)', conditions):
                found.append((number, name))
    return found


def test_calls_that_hand_on_absent_arrays_are_found(checks):
    checks.equal(handed_on(EXAMPLE), [(7, 'a'), (8, 'd'), (13, 'a')], 'calls of the example')


def test_absent_arrays_are_not_handed_on(checks, sources):
    for _, path, text in sources:
        checks.equal(handed_on(text), [], f'{os.path.relpath(path, TREE)}: absent arrays are handed on')
