"""Every module has the same head, and says what it offers: reads the Fortran files of src.

The head: one sentence on what the module is, as a comment, without a list of used modules; `use` statements; implicit none;
private; the list of public names. Above each public procedure, type and interface block stands a comment
that begins with !>. Operators, and intrinsic functions extended to other types, explain themselves; a type that
has its module's name is explained by the head.

No name in an `only` list is left unused, in the tests neither. No comment begins with a word such as "what" or "where" in place of
its subject, in whatever language.
"""
import glob
import os
import re
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from check_floors import sources
from mech9_cases import TREE, Checks

MODULE = re.compile(r'\A((?:!>[^\n]*\n)+)module (mech9\w*)\n(.*?)^end module \2\n?\Z', re.S | re.M)
DEFINITION = re.compile(
    r'^\s*(?:(?:pure|impure|elemental|recursive|module|integer|logical|real\(\w+\)|character\([^)]*\)|type\(\w+\))\s+)*'
    r'(?:(?:subroutine|function)\s+(\w+)\b|type(?:\s*,[^:]*)?\s*::\s*(\w+)\s*$|interface\s+(\w+)\s*$)')
METADATA = re.compile(r'!> [\w-]+:\s')
ONLY = re.compile(r'^\s*use\b[^\n]*?\bonly\s*:(.*)$', re.M)
STRING = re.compile(r"'[^'\n]*'|\"[^\"\n]*\"")
# a comment that begins a block of them, or stands behind code; a docstring
COMMENT = {'.f90': r'!+[<>]?[ \t]*(.*)', '.nml': r'!+[ \t]*(.*)', '': r'(?:#+[ \t]+|""")(.*)'}
NO_SUBJECT = re.compile(r'(?:what|where|that|which|whose|likewise|as good as)\b', re.I)
INTRINSIC = set('sqrt exp log sin cos tan asin acos atan atan2 sinh cosh tanh abs min max'.split())


def public_names(body):
    """The names in the lists after `public ::`, continued lines joined."""
    joined = re.sub(r'&\s*(?:!.*)?\n\s*&?', ' ', body)
    names = []
    for listed in re.findall(r'^\s*public\s*::(.*)$', joined, re.M):
        names += re.findall(r'\b\w+\b(?!\s*\()', re.sub(r'(operator|assignment)\([^)]*\)', '', listed.split('!')[0]))
    return names


def statements(text):
    """The text without comments and strings, continued lines joined."""
    return re.sub(r'&\s*\n\s*&?', ' ', re.sub(r'!.*', '', STRING.sub("''", text)))


def unused_names(text):
    """Names in the `only` lists of a file that stand nowhere else in it; a kind stands behind a number too: 1.0_wp."""
    code = statements(text)
    rest = ONLY.sub('', code)
    names = re.findall(r'(\w+)\s*(?:=>[^,]*)?(?:,|$)', ','.join(ONLY.findall(code)))
    return sorted({name for name in names if not re.search(rf'(?:\b|\d_){name}\b', rest, re.I)})


def beginnings(path, text):
    """The first lines of all comments of a file, with their numbers. Lines of comments only that follow others go on with them."""
    kind = os.path.splitext(re.sub(r'\.in$', '', path))[1]
    pattern = COMMENT.get(kind, COMMENT[''])
    goes_on = False
    for number, line in enumerate(text.split('\n'), 1):
        match = re.search(pattern, STRING.sub('', line) if kind in COMMENT else line)
        if match and not goes_on:
            yield number, match[1]
        goes_on = bool(match) and re.match(r'\s*[!#]', line) is not None and match[1] != ''


def explained(lines, number):
    """Whether a comment stands above this line, with no line between but other comments."""
    above = number - 1
    while above >= 0 and lines[above].lstrip().startswith('!') and not lines[above].lstrip().startswith('!>'):
        above -= 1
    return above >= 0 and lines[above].lstrip().startswith('!>')


def definitions(body):
    """Line numbers where names are defined, and the lines."""
    lines = body.split('\n')
    found = {}
    for number, line in enumerate(lines):
        match = DEFINITION.match(line.split('!')[0].rstrip())
        if match and not line.lstrip().startswith('end'):
            name = next(group for group in match.groups() if group).lower()
            found.setdefault(name, []).append(number)
    return lines, found


def check_module(checks, path, text):
    match = MODULE.match(text)
    if not checks.true(match, f'{path}: begins with its head and holds one module'):
        return
    head, name, body = match.groups()
    checks.true(not re.search(r'\bUses\b', head), f'{path}: the head leaves it to the use statements which modules are used')
    checks.true(not METADATA.match(head), f'{path}: begins with a sentence; "word:" would be metadata to FORD')
    order = [re.search(pattern, body, re.M) for pattern in (r'^  implicit none$', r'^  private$', r'^  public ::')]
    if checks.true(all(order), f'{path}: implicit none, private and a list of public names'):
        places = [found.start() for found in order]
        checks.true(places == sorted(places), f'{path}: in this order')
        checks.true(not re.search(r'^  use\b', body[places[0]:], re.M), f'{path}: `use` stands before them')
    lines, defined = definitions(body)
    for public in public_names(body):
        if public.lower() in INTRINSIC or public.lower() not in defined:
            continue   # constants, and what is handed on from elsewhere
        if f'mech9_{public.lower()}' == f'{name}_type':
            continue
        checks.true(any(explained(lines, number) for number in defined[public.lower()]),
                    f'{path}: a comment above {public}')


def main():
    checks = Checks()
    found = list(sources(os.path.join(TREE, 'src')))
    modules = {name for _, _, text in found for name in re.findall(r'^module (mech9_\w+)$', text, re.M)}
    for floor, path, text in found:
        if floor != 'programs' and not re.search(r'^submodule\b', text, re.M):
            check_module(checks, os.path.relpath(path, TREE), text)
    checks.true(len(modules) > 50, 'the modules were found')
    for folder in ('src', 'tests', 'bench', 'user_procs'):
        for path in glob.glob(os.path.join(TREE, folder, '**', '*.f90'), recursive=True):
            with open(path, encoding='utf-8') as file:
                checks.equal(unused_names(file.read()), [], f'{path}: every name in an only list is used')
    for folder in ('src', 'tests', 'bench', 'cmake', 'user_procs', 'examples'):
        for path in glob.glob(os.path.join(TREE, folder, '**', '*'), recursive=True):
            if not re.search(r'\.(f90|py|sh|cmake|f90\.in|nml)$|CMakeLists\.txt$|expected\.txt$|mech9-link\.in$', path):
                continue
            with open(path, encoding='utf-8', errors='replace') as file:
                for number, comment in beginnings(path, file.read()):
                    if NO_SUBJECT.match(comment):
                        checks.true(False, f'{path}:{number}: the comment begins with its subject: {comment}')
    checks.finish()


if __name__ == '__main__':
    main()
