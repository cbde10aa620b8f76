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

import pytest

from floors import with_included
from mech9_cases import TREE, text_of

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


@pytest.fixture(scope='module')
def modules(sources):
    """(path, head, name, body) of every module of src; head, name and body are None where a file does not begin with its head and
    hold one module."""
    found = []
    for floor, path, text in sources:
        if floor != 'programs' and not re.search(r'^submodule\b', text, re.M):
            match = MODULE.match(text)
            found.append((os.path.relpath(path, TREE), *(match.groups() if match else (None, None, None))))
    assert len(found) > 50, 'the modules were found'
    return found


def test_file_begins_with_its_head_and_holds_one_module(checks, modules):
    for path, head, _, _ in modules:
        checks.true(head, f'{path}: begins with its head and holds one module')


def test_head_is_a_sentence(checks, modules):
    for path, head, _, _ in modules:
        checks.true(not re.search(r'\bUses\b', head or ''), f'{path}: the head leaves it to the use statements which modules are used')
        checks.true(not METADATA.match(head or ''), f'{path}: begins with a sentence; "word:" would be metadata to FORD')


def test_order_of_declarations(checks, modules):
    """`use`, implicit none, private, the list of public names."""
    for path, _, _, body in modules:
        order = [re.search(pattern, body or '', re.M) for pattern in (r'^  implicit none$', r'^  private$', r'^  public ::')]
        if checks.true(all(order), f'{path}: implicit none, private and a list of public names'):
            places = [found.start() for found in order]
            checks.true(places == sorted(places), f'{path}: in this order')
            checks.true(not re.search(r'^  use\b', body[places[0]:], re.M), f'{path}: `use` stands before them')


def test_public_names_are_explained(checks, modules):
    for path, _, name, body in modules:
        lines, defined = definitions(body or '')
        for public in public_names(body or ''):
            if public.lower() in INTRINSIC or public.lower() not in defined:
                continue   # constants, and what is handed on from elsewhere
            if f'mech9_{public.lower()}' == f'{name}_type':
                continue
            checks.true(any(explained(lines, number) for number in defined[public.lower()]), f'{path}: a comment above {public}')


def test_names_of_only_lists_are_used(checks):
    for folder in ('src', 'tests', 'bench', 'user_procs'):
        for path in glob.glob(os.path.join(TREE, folder, '**', '*.f90'), recursive=True):
            checks.equal(unused_names(with_included(path, text_of(path))), [], f'{path}: every name in an only list is used')


def test_comments_begin_with_their_subjects(checks):
    read = 0
    for folder in ('src', 'tests', 'bench', 'cmake', 'user_procs', 'examples'):
        for path in glob.glob(os.path.join(TREE, folder, '**', '*'), recursive=True):
            if not re.search(r'\.(f90|py|sh|cmake|f90\.in|nml)$|CMakeLists\.txt$|expected\.txt$|mech9-link\.in$', path):
                continue
            read += 1
            with open(path, encoding='utf-8', errors='replace') as file:
                for number, comment in beginnings(path, file.read()):
                    if NO_SUBJECT.match(comment):
                        checks.true(False, f'{path}:{number}: the comment begins with its subject: {comment}')
    checks.true(read > 50, 'the files were found', read)
