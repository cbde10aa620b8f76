"""The parts of its arguments that a Fortran procedure reads and changes, itself and through the procedures that it calls."""
import re
from collections import Counter

from fortran_calls import WORD, calls_in, closing, divided, lines_of, parts_of, resolved

READ, CHANGE = 'read', 'change'
WHOLE = re.compile(r'\w*')
ASSIGNMENT = re.compile(r'^(?:if *\(|where *\(|forall *\()')


def variables_in(line):
    """All names with their components and subscripts in a statement, those in subscripts too, as (place, text)."""
    at = 0
    while True:
        found = re.compile(rf'(?<![\w%.]){WORD}').search(line, at)
        if not found:
            return
        begin, at = found.start(), found.end()
        while True:
            more = re.compile(rf' *% *{WORD}').match(line, at)
            if more:
                at = more.end()
                continue
            rest = re.compile(r' *\(').match(line, at)
            if not rest:
                break
            end = closing(line, rest.end() - 1)
            for place, text in variables_in(line[rest.end():end]):
                yield rest.end() + place, text
            at = end + 1
        yield begin, line[begin:at]


def changed_text(line):
    """The part of a statement that changes variables itself: first and last place, and the depth of parentheses in which they stand.

    That is the left side of an assignment, the variable of a loop, or the list of allocate, read and the like.
    """
    condition = ASSIGNMENT.match(line)
    begin = closing(line, condition.end() - 1) + 1 if condition else 0
    begin += len(line[begin:]) - len(line[begin:].lstrip())
    whole = re.match(r'(de)?allocate *\(|nullify *\(|read *\(|inquire *\(|open *\(', line[begin:])
    if whole:
        return begin, len(line), 1
    if line[begin:].startswith('do '):
        return begin, max(begin, line.find('=')), 0
    depth = 0
    for at in range(begin, len(line)):
        depth += (line[at] in '([') - (line[at] in ')]')
        if depth == 0 and line[at] == '=' and line[at - 1] not in '=/<>' and line[at + 1:at + 2] != '=':
            return begin, at, 0
        if depth < 0:
            break
    return begin, begin, 0


class Touches:
    """Reads and changes of parts of arguments by procedures, kept once they are known."""

    def __init__(self, sources):
        self.sources, self.known = sources, {}
        self.lines, self.calls = {}, {}         # statements of procedures, and the calls in them: they are read for each name again

    def of(self, procedure, dummy):
        """Pairs of the names of components, and read or change. Changes through an argument of intent(in) are none."""
        key = procedure, dummy
        if key not in self.known:
            self.known[key] = set()             # a procedure that calls itself adds nothing new
            found = self.in_body(procedure, dummy)
            if not procedure.statements:        # an interface: all may happen
                found = {((), READ), ((), CHANGE)}
            if procedure.intent(dummy) == 'in':
                found = {(path, READ) for path, _ in found}
            self.known[key] = found
        return self.known[key]

    def in_body(self, procedure, name):
        found = set()
        if procedure not in self.lines:
            self.lines[procedure] = [
                (line, aliases, set(WHOLE.findall(line)), [(alias, WHOLE.match(target).group(0)) for level in aliases for alias, target in level.items()])
                for _, line, aliases in lines_of(procedure) if not re.match(r'^(\w+ *: *)?associate *\(', line)]
        for at, (line, aliases, words, heads) in enumerate(self.lines[procedure]):
            if name in words or any(head == name and alias in words for alias, head in heads):
                found |= self.in_statement(procedure, name, at, line, aliases)
        for inner in procedure.internals.values():
            if name not in inner.locals:
                found |= self.in_body(inner, name)
        return found

    def calls_of(self, procedure, at, line, aliases):
        """The calls in a statement of a procedure."""
        if (procedure, at) not in self.calls:
            self.calls[procedure, at] = list(calls_in(self.sources, procedure, 0, line, aliases))
        return self.calls[procedure, at]

    def in_statement(self, procedure, name, at, line, aliases):
        found, passed = set(), Counter()
        unknown = bool(re.search(r'\bcall ', line))
        for call in self.calls_of(procedure, at, line, aliases):
            unknown = False
            for dummy, actual in call.pairs:
                parts = parts_of(actual)
                if parts and parts[0][0] == name and self.sources.is_variable(procedure, parts):
                    path = tuple(part for part, _ in parts[1:])
                    passed[actual.replace(' ', '')] += call.is_first
                    found |= {(path + inner, mode) for inner, mode in self.of(call.meant, dummy)}
        begin, end, depth = changed_text(line)
        for at, text in variables_in(line):
            text = resolved(text, aliases)
            parts = parts_of(text)
            if not parts or parts[0][0] != name:
                continue
            variable = len(parts)
            while variable > 1 and not self.sources.is_variable(procedure, parts[:variable]):
                variable -= 1
            if variable < len(parts):
                continue                        # a reference to a bound procedure, which stands among the calls
            if passed[text.replace(' ', '')] > 0:
                passed[text.replace(' ', '')] -= 1
                continue
            path = tuple(part for part, _ in parts[1:])
            inside = line[begin:at].count('(') - line[begin:at].count(')')
            found.add((path, CHANGE if begin <= at < end and inside <= depth or unknown else READ))
        return found
