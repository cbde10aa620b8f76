"""No procedure changes a variable that it also knows by another name (Fortran 2008, 12.5.2.13).

Compilers trust this rule and do not check it. A call breaks it in three ways. Two actual arguments are, or hold, the same variable.
One of them is a part of the other one. An internal procedure sees in its host the variable that is its argument. The check tells a call
where the procedure, or one that it calls, changes a part by one name and reads or changes it by the other one.

Seen are designators with components and subscripts, names of `associate`, functions and type-bound procedures. An expression is a copy,
also a name in parentheses. Two elements count as different where their subscripts have different texts, and two ranges where one ends
before the other begins by the text of their bounds. A procedure that changes one part of an object, and knows another part by another name,
is not told: the standard forbids that too.

Not seen are pointers, variables of modules, procedures that are arguments or components, C procedures, arrays whose dummy goes beyond the
element that is passed, and variables that a statement both reads and changes by functions.
"""
import os
import re

from fortran_calls import Sources, calls, parts_of
from fortran_touches import CHANGE, Touches
from mech9_cases import TREE

# The values of fronts stand one behind the other, those of a parent behind those of its fronts: the ranges are apart.
APART = {('front_factors.f90', 'self%values(front%value + 1:last)', 'self%values(parent%value + 1:)')}

EXAMPLE = """
module example
  type :: robot_type
    integer :: n = 0
    integer :: links(9) = 0
    integer, allocatable :: names(:)
  contains
    procedure :: grow
    procedure :: note
  end type robot_type
contains
  recursive subroutine read_body(link, robot)
    integer, intent(in) :: link
    type(robot_type), intent(inout) :: robot
    call robot%grow(link)
    robot%links(link) = 1
  end subroutine read_body
  subroutine grow(self, by)
    class(robot_type), intent(inout) :: self
    integer, intent(in) :: by
    self%n = self%n + by
  end subroutine grow
  subroutine note(self, place)
    class(robot_type), intent(inout) :: self
    integer, intent(in) :: place
    self%links(1) = place
  end subroutine note
  subroutine add(a, b, c)
    integer, intent(in) :: a(:)
    integer, intent(in) :: b(:)
    integer, intent(out) :: c(:)
    c = a + b
  end subroutine add
  subroutine caller(robot, x)
    type(robot_type), intent(inout) :: robot
    integer, intent(inout) :: x(:)
    integer :: k
    {}
  contains
    subroutine inner(number)
      integer, intent(inout) :: number
      number = k
    end subroutine inner
    subroutine counts(number)
      integer, intent(in) :: number
      k = k + number
    end subroutine counts
  end subroutine caller
end module example
"""
BROKEN = ('call read_body(robot%n, robot)', 'call robot%grow(robot%n)', 'call note(robot, robot%links(1))', 'call inner(k)', 'call counts(k)',
          'call add(x, robot%links, x)', 'call add(x(2:), robot%links, x(:3))', 'call add(c=x, a=x, b=robot%links)',
          'if (k > 0) call robot%grow(robot%n)', 'associate (n => robot%n)\n call robot%grow(n)\n end associate')
KEPT = ('call read_body((robot%n), robot)', 'call read_body(robot%n + 0, robot)', 'call robot%note(robot%n)', 'call robot%grow(robot%links(1))',
        'call add(x(:3), robot%links, x(4:))', 'call add(x(k:k + 2), robot%links, x(k + 3:))', 'call add(x, x, robot%links)', 'call inner(x(1))')


def bound(text):
    """A bound of a range as (text without its last number, number)."""
    found = re.match(r'^(?:(.*\S) *([+-]) *)?(\d+)$', text.strip())
    return (found.group(1) or '', int((found.group(2) or '') + found.group(3))) if found else (text.strip(), 0)


def are_apart(first, second):
    """Whether two lists of subscripts mean different elements."""
    for one, other in zip(first, second):
        if ':' not in one and ':' not in other and one != other:
            return True
        for low, high in ((one, other), (other, one)):
            (end, after), (begin, before) = bound(low.rsplit(':', 1)[-1]), bound(high.split(':')[0])
            if end == begin and after < before:
                return True
    return False


def overlap(first, second):
    """Whether two variables are the same, or one is a part of the other."""
    return all(name == other and not are_apart(subscripts, others) for (name, subscripts), (other, others) in zip(first, second))


def meet(first, ways, second, other_ways):
    """Whether a part is changed by one way and touched by the other."""
    base = min(len(first), len(second))
    one, other = (tuple(name for name, _ in parts[base:]) for parts in (first, second))
    return any(CHANGE in (mode, other_mode) and all(a == b for a, b in zip(one + path, other + other_path))
               for path, mode in ways for other_path, other_mode in other_ways)


def host_of(procedure, name):
    """The procedure whose variable a name is."""
    while procedure and name not in procedure.locals:
        procedure = procedure.host
    return procedure


def aliases_of(call, read, touches):
    """Pairs of names of one variable in a call."""
    known = [(actual, parts_of(actual), touches.of(call.meant, dummy)) for dummy, actual in call.pairs if call.meant.intent(dummy) != 'value']
    known = [entry for entry in known if entry[1] and read.is_variable(call.procedure, entry[1])]
    for i, (actual, parts, ways) in enumerate(known):
        for other, other_parts, other_ways in known[i + 1:]:
            if overlap(parts, other_parts) and meet(parts, ways, other_parts, other_ways):
                yield actual, other
        name = parts[0][0]
        if call.meant.host and name not in call.meant.locals and host_of(call.procedure, name) is host_of(call.meant, name):
            if meet(parts, ways, parts[:1], touches.in_body(call.meant, name)):
                yield actual, f'{name} of the host'


def broken_calls(files):
    """All calls that break the rule, as texts, and the number of calls."""
    read = Sources(files)
    touches = Touches(read)
    count, found = 0, set()
    for call in calls(read):
        count += 1
        for pair in aliases_of(call, read, touches):
            if (os.path.basename(call.path), *pair) not in APART:
                found.add(f'{call.path}:{call.number}: {call.name} knows {pair[0]} and {pair[1]}')
    return sorted(found), count


def test_the_check_finds_aliases(checks):
    for statement in BROKEN:
        checks.equal(len(broken_calls([('example.f90', EXAMPLE.replace('{}', statement))])[0]), 1, f'found: {statement}')
    for statement in KEPT:
        checks.equal(broken_calls([('example.f90', EXAMPLE.replace('{}', statement))])[0], [], f'kept: {statement}')


def test_no_call_in_src_has_aliases(checks, sources):
    found, count = broken_calls([(os.path.relpath(path, TREE), text) for _, path, text in sources])
    checks.equal(found, [], 'no variable is changed that has another name')
    # there are some 19000 references to known procedures in src; far fewer mean that the reader does not understand it any more
    checks.true(count > 15000, 'the calls of src are read', count)
