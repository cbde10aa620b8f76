"""Calls in Fortran sources, with the intents of the dummy arguments that their actual arguments meet.

A reader of the Fortran of this project and not of the whole language: free form, one declaration of a dummy argument a line, no `include`.
Names are resolved by the module and its `use` statements; a type-bound name stands for all procedures that any type binds to it, since
types of expressions are not worked out.
"""
import re

WORD = r'[a-z]\w*'
DECLARED = re.compile(r'^(integer|real|logical|character|complex|type *\(|class *\(|procedure *\()[^:]*?::(.*)$')
UNIT = re.compile(r'^(?:module|submodule *\( *[\w:]+ *\)|program) +(\w+)$')
PROCEDURE = re.compile(r'^(?:[\w() =*:,]*\b)?(subroutine|function) +(\w+) *(?:\(([^()]*)\))?(.*)$')
SUBMODULE = re.compile(r'^submodule *\( *(?:\w+ *: *)?(\w+) *\) *(\w+)$')


def statements(text):
    """Logical lines in small letters: (number of the first line, text), without comments and with empty strings."""
    found, parts, first, quote = [], [], 0, ''
    for number, line in enumerate(text.splitlines(), 1):
        line, quote = without_strings(line, quote)
        line = line.strip()
        if not line or line.startswith('#'):
            continue
        if not parts:
            first = number
        line = line.removeprefix('&').strip() if parts else line
        if quote or line.endswith('&'):
            parts.append(line.removesuffix('&'))
            continue
        parts.append(line)
        for piece in ' '.join(parts).split(';'):
            found.append((first, ' '.join(piece.split()).lower()))
        parts = []
    return found


def without_strings(line, quote):
    """A line without its comment, each string in it empty, and the quote of a string that the next line goes on with."""
    out = ''
    for letter in line:
        if quote:
            if letter == quote:
                quote = ''
                out += letter
        elif letter in '\'"':
            quote = letter
            out += letter
        elif letter == '!':
            break
        else:
            out += letter
    return out, quote


def closing(text, start):
    """The place of the parenthesis that closes the one at `start`."""
    depth = 0
    for at in range(start, len(text)):
        depth += (text[at] in '([') - (text[at] in ')]')
        if depth == 0:
            return at
    raise ValueError(f'an open parenthesis: {text}')


def divided(text):
    """The parts of a list between commas of the outermost level."""
    parts, depth, last = [], 0, 0
    for at, letter in enumerate(text):
        depth += (letter in '([') - (letter in ')]')
        if letter == ',' and depth == 0:
            parts.append(text[last:at].strip())
            last = at + 1
    parts.append(text[last:].strip())
    return [part for part in parts if part]


class Procedure:
    """A procedure: its dummy arguments with their intents, its own names, its statements and its internal procedures."""

    def __init__(self, name, unit, host, dummies, is_function, path):
        self.name, self.unit, self.host, self.dummies, self.is_function, self.path = name, unit, host, dummies, is_function, path
        self.intents = {}                    # in, out, inout or none, of each dummy that is no copy
        self.locals = set(dummies)
        self.types = {}                      # names of derived types of its variables and of its result
        self.result = name
        self.statements = []
        self.internals = {}

    def intent(self, dummy):
        return self.intents.get(dummy, 'none')


class Type:
    """A derived type: its components with their derived types, its bindings, its parent and the types that extend it."""

    def __init__(self, unit, parent):
        self.unit, self.parent, self.children = unit, parent, []
        self.components = {}                 # name to the name of the derived type; empty for others
        self.bound = {}                      # name to (procedure or interface, place of the passed object or None)
        self.generics = {}


class Sources:
    """All procedures of some files."""

    def __init__(self, files):
        self.units = {}                      # names of units to their procedures by name
        self.uses = {}                       # names of units to their names from others: local name to (unit, name)
        self.parents = {}                    # submodules to the module that they belong to
        self.types = {}                      # derived types by unit and name
        self.generics = {}                   # (unit, generic name) to specific names
        self.procedures = []
        self.bound = {}                      # answers of `bindings`, which are asked for again and again
        for path, text in files:
            self.read(path, text)

    def read(self, path, text):
        unit, stack, in_type, interface = None, [], None, None
        for number, line in statements(text):
            begins = UNIT.match(line)
            if begins and not line.startswith('module procedure'):
                unit = begins.group(1)
                owner = SUBMODULE.match(line)
                if owner:
                    self.parents[unit] = owner.group(1)
                self.units.setdefault(unit, {})
                self.uses.setdefault(unit, {})
            elif line.startswith('use ') and ' only' in line:
                self.read_use(unit, line)
            elif re.match(r'^(abstract )?interface\b', line):
                interface = line.removeprefix('abstract ').removeprefix('interface').strip()
                in_interface = True
            elif line.startswith('end interface'):
                interface = None
            elif interface is not None and re.match(r'^(module )?procedure\b', line) and not stack:
                names = line.split('procedure', 1)[1].replace('::', ' ')
                self.generics.setdefault((unit, interface), []).extend(divided(names))
            elif re.match(r'^type\b(?! *\()', line) and not stack:
                parent = re.search(r'extends *\( *(\w+)', line)
                in_type = self.types[unit, re.search(r'(\w+)$', line).group(1)] = Type(unit, parent.group(1) if parent else '')
            elif line.startswith('end type'):
                in_type = None
            elif in_type:
                self.read_binding(in_type, line)
            elif re.match(r'^end *(subroutine|function|procedure)\b', line) and stack:
                stack.pop()
            elif line.startswith('module procedure ') and interface is None:
                stack.append(self.implementation(unit, line.split()[-1], path))
            elif PROCEDURE.match(line) and not line.startswith('end') and '=' not in line.split('(')[0] and not line.startswith('call '):
                stack.append(self.begin(unit, line, stack, interface, path))
            elif stack:
                self.read_statement(stack[-1], number, line)

    def read_use(self, unit, line):
        found = re.match(r'use (\w+) *,', line)
        if not found:
            return
        other = found.group(1)
        for piece in divided(line.split('only', 1)[1].split(':', 1)[1]):
            local, _, name = piece.replace(' ', '').partition('=>')
            self.uses[unit][local] = other, name or local

    @staticmethod
    def read_binding(derived, line):
        declared = DECLARED.match(line)
        bound = re.match(r'^(procedure|generic)(?: *\( *(\w+) *\))?([^:]*)::(.*)$', line)
        if bound and 'pointer' not in bound.group(3):
            kind, form, attributes, names = bound.groups()
            passed = None if 'nopass' in attributes else (re.search(r'pass *\( *(\w+) *\)', attributes) or [0, ''])[1]
            if kind == 'generic':
                name, _, targets = names.partition('=>')
                derived.generics.setdefault(name.strip(), []).extend(divided(targets))
                return
            for piece in divided(names):
                name, _, target = piece.replace(' ', '').partition('=>')
                derived.bound[name] = form or target or name, passed
        elif declared:
            of_type = re.match(r'^(?:type|class) *\( *(\w+)', line)
            for piece in divided(declared.group(2)):
                derived.components[re.match(WORD, piece).group(0)] = of_type.group(1) if of_type else ''

    def implementation(self, unit, name, path):
        """The body of a procedure whose interface stands in the module that the submodule belongs to."""
        known = self.lookup(self.parents.get(unit, unit), name)
        new = Procedure(name, unit, None, known.dummies if known else [], known.is_function if known else False, path)
        new.intents = known.intents if known else {}
        self.units[unit].setdefault(name, new)
        self.procedures.append(new)
        return new

    def begin(self, unit, line, stack, interface, path):
        kind, name, dummies, tail = PROCEDURE.match(line).groups()
        host = stack[-1] if stack and interface is None else None
        new = Procedure(name, unit, host, divided(dummies or ''), kind == 'function', path)
        if kind == 'function':
            new.result = (re.search(r'result *\( *(\w+)', tail) or [0, name])[1]
            new.locals.add(new.result)
        if host:
            host.internals[name] = new
        else:
            self.units[unit][name] = new
        self.procedures.append(new)
        return new

    @staticmethod
    def read_statement(procedure, number, line):
        declared = DECLARED.match(line)
        if not declared or re.match(r'^(type|class) *is\b', line):
            procedure.statements.append((number, line))
            return
        names = [re.match(WORD, piece).group(0) for piece in divided(declared.group(2))]
        procedure.locals.update(names)
        of_type = re.match(r'^(?:type|class) *\( *(\w+)', line)
        if of_type:
            procedure.types.update((name, of_type.group(1)) for name in names)
        attributes = line.split('::')[0]
        intent = re.search(r'intent *\( *(in out|inout|in|out) *\)', attributes)
        for name in names:
            if name in procedure.dummies and not re.search(r'\bvalue\b', attributes):
                procedure.intents[name] = intent.group(1).replace(' ', '') if intent else 'none'
            elif name in procedure.dummies:
                procedure.intents[name] = 'value'
        if '=' in declared.group(2):
            procedure.statements.append((number, declared.group(2)))

    def lookup(self, unit, name):
        """The procedure of a name in a unit, in the module that it belongs to, or where one of both takes it from."""
        while unit:
            if name in self.units.get(unit, {}):
                return self.units[unit][name]
            if name in self.uses.get(unit, {}):
                other, original = self.uses[unit][name]
                return self.units.get(other, {}).get(original)
            unit = self.parents.get(unit)
        return None

    def specifics(self, unit, name):
        """All procedures that a plain name may mean in a unit."""
        own = unit
        while own:
            if (own, name) in self.generics:
                return [p for p in (self.lookup(own, n) for n in self.generics[own, name]) if p]
            if name in self.uses.get(own, {}):
                other, original = self.uses[own][name]
                if (other, original) in self.generics:
                    return [p for p in (self.lookup(other, n) for n in self.generics[other, original]) if p]
            own = self.parents.get(own)
        found = self.lookup(unit, name)
        return [found] if found else []

    def candidates(self, procedure, name):
        """All procedures that a name before a parenthesis may mean, each with the place of the passed object, or None."""
        if '%' in name or '(' in name:
            parts = parts_of(name)
            return self.bindings(self.type_of(procedure, written(parts[:-1])), parts[-1][0]) if parts and parts[1:] else []
        host = procedure
        while host:
            if name in host.internals:
                return [(host.internals[name], None)]
            host = host.host
        host = procedure
        while host:
            if name in host.locals:
                return []
            host = host.host
        return [(meant, None) for meant in self.specifics(procedure.unit, name)]


    def find_type(self, unit, name):
        """The derived type of a name in a unit; None where it is not known."""
        while unit:
            if (unit, name) in self.types:
                return self.types[unit, name]
            if name in self.uses.get(unit, {}):
                return self.types.get(self.uses[unit][name])
            unit = self.parents.get(unit)
        return None

    def ancestors(self, derived):
        """A type and those that it extends."""
        while derived:
            yield derived
            derived = self.find_type(derived.unit, derived.parent) if derived.parent else None

    def descendants(self, derived):
        """A type and all types that extend it."""
        return [other for other in self.types.values() if derived in self.ancestors(other)]

    def bindings(self, derived, last):
        """The procedures that a type and those that extend it bind to a name, each with the place of the passed object, or None."""
        if (derived, last) not in self.bound:
            self.bound[derived, last] = self.find_bindings(derived, last)
        return self.bound[derived, last]

    def find_bindings(self, derived, last):
        names = [last, *(specific for one in self.ancestors(derived) for specific in one.generics.get(last, []))]
        found = {}
        for binding in names:
            own = next((one for one in self.ancestors(derived) if binding in one.bound), None)
            for one in [own, *self.descendants(derived)] if own else []:
                target, passed = one.bound.get(binding, ('', None))
                meant = self.lookup(one.unit, target)
                if meant:
                    found[meant] = None if passed is None else meant.dummies.index(passed) if passed else 0
        # an interface alone tells less than the procedures that are bound in its place
        bodies = {meant: place for meant, place in found.items() if meant.statements}
        return list((bodies or found).items())

    def type_of(self, procedure, designator):
        """The derived type of a designator, which may refer to functions; None where it is not known."""
        parts = parts_of(designator)
        if not parts:
            return None
        derived, host = None, procedure
        while host and not derived:
            derived = self.find_type(host.unit, host.types[parts[0][0]]) if parts[0][0] in host.types else None
            host = host.host
        if not derived:
            derived = self.result_type([meant for meant, _ in self.candidates(procedure, parts[0][0])])
        for part, _ in parts[1:]:
            # a type that it extends is a component, too
            inner = [self.find_type(one.unit, one.components.get(part) or part) for one in self.ancestors(derived)
                     if part in one.components or part == one.parent]
            derived = inner[0] if inner else self.result_type([meant for meant, _ in self.bindings(derived, part)])
        return derived

    def result_type(self, functions):
        first = functions[0] if functions else None
        return self.find_type(first.unit, first.types[first.result]) if first and first.result in first.types else None

    def is_variable(self, procedure, parts):
        """Whether the parts of a designator are a variable with its components, and refer to no function."""
        host = procedure
        while host and parts[0][0] not in host.locals:
            host = host.host
        if not host:
            return False
        return not any(self.bindings(self.type_of(procedure, written(parts[:k])), parts[k][0]) for k in range(1, len(parts)))


def parts_of(designator):
    """Names and subscripts of a designator: [(name, [subscripts]), ...]; None for another expression."""
    parts, at = [], 0
    while True:
        name = re.match(rf' *({WORD}) *', designator[at:])
        if not name:
            return None
        at += name.end()
        lists = []
        while at < len(designator) and designator[at] == '(':
            end = closing(designator, at)
            lists.append(divided(designator[at + 1:end]))
            at = end + 1
            at += len(designator[at:]) - len(designator[at:].lstrip())
        # the bounds of a substring follow the subscripts of its element
        parts.append((name.group(1), lists[0] if lists else []))
        if at == len(designator):
            return parts
        if designator[at] != '%':
            return None
        at += 1


def written(parts):
    """The text of the parts of a designator."""
    return '%'.join(name + (f"({', '.join(subscripts)})" if subscripts else '') for name, subscripts in parts)


def designators(line):
    """Names with components before a parenthesis that is no subscript of a component: (name, text in the parenthesis)."""
    for found in re.finditer(rf'(?<![\w%)]){WORD}', line):
        at, path = found.end(), found.group(0)
        while at < len(line):
            rest = line[at:]
            blank = len(rest) - len(rest.lstrip())
            if rest.lstrip().startswith('('):
                start = at + blank
                end = closing(line, start)
                yield path, line[start + 1:end]
                path += line[start:end + 1]
                at = end + 1
            elif rest.lstrip().startswith('%'):
                more = re.match(rf' *% *({WORD})', rest)
                path += '%' + more.group(1)
                at += more.end()
            else:
                break
        if '%' in path and line.startswith('call ') and not path.endswith(')') and line[5:5 + len(path)].replace(' ', '') == path:
            yield path, ''


class Call:
    """A reference to a procedure: actual arguments with the dummies that they meet."""

    def __init__(self, path, number, name, procedure, meant, pairs, is_first):
        self.path, self.number, self.name, self.procedure, self.meant, self.pairs = path, number, name, procedure, meant, pairs
        self.is_first = is_first             # of all procedures that the same reference may mean


def calls(sources):
    """All references to procedures that are known, once for each procedure that may be meant."""
    for procedure in sources.procedures:
        for number, line, aliases in lines_of(procedure):
            yield from calls_in(sources, procedure, number, line, aliases)


def lines_of(procedure):
    """Statements of a procedure with the names of `associate` that hold in them."""
    aliases = []
    for number, line in procedure.statements:
        if re.match(r'^(\w+ *: *)?(associate|select type) *\(', line):
            start = line.index('(')
            aliases = [*aliases, {}]
            for piece in divided(line[start + 1:closing(line, start)]):
                name, arrow, target = (part.strip() for part in piece.partition('=>'))
                if arrow:
                    aliases[-1][name] = resolved(target, aliases[:-1])
        elif re.match(r'^end *(associate|select)\b', line) and aliases:
            aliases = aliases[:-1]
        elif re.match(r'^(\w+ *: *)?select case\b', line):
            aliases = [*aliases, {}]
        yield number, line, aliases


def calls_in(sources, procedure, number, line, aliases):
    """The references to procedures in a statement."""
    for name, inside in designators(line):
        name = resolved(name, aliases)
        is_first = True
        for meant, object_at in sources.candidates(procedure, name):
            pairs = matched(meant, object_at, name, divided(inside))
            if pairs is not None:
                pairs = [(dummy, resolved(actual, aliases)) for dummy, actual in pairs]
                yield Call(procedure.path, number, name, procedure, meant, pairs, is_first)
                is_first = False


def resolved(designator, aliases):
    """A designator with the names of `associate` replaced."""
    for level in reversed(aliases):
        head = re.match(WORD, designator)
        if head and head.group(0) in level:
            designator = level[head.group(0)] + designator[head.end():]
    return designator


def matched(meant, object_at, name, actuals):
    """Pairs of dummy and actual argument; None where they do not fit."""
    dummies = list(meant.dummies)
    pairs = []
    if object_at is not None:
        pairs.append((dummies.pop(object_at), written(parts_of(name)[:-1])))
    for at, actual in enumerate(actuals):
        keyword = re.match(rf'^({WORD}) *= *(?!=)(.*)$', actual)
        if keyword and keyword.group(1) in dummies:
            pairs.append((keyword.group(1), keyword.group(2)))
        elif at < len(dummies):
            pairs.append((dummies[at], actual))
        else:
            return None
    return pairs
