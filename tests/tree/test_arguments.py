"""Every argument of every procedure is explained: reads the Fortran files of the tree.

An argument stands alone on a declaration of its own, at whose end `!<` tells its meaning, with unit, shape and frame
where these make sense. The rule holds for private procedures and for interfaces too.
"""
import glob
import os
import re

from mech9_cases import TREE, text_of

FOLDERS = ('src', 'bench', 'user_procs', 'tests')

MANY = 7                   # arguments: more are hard to follow, and some of them then belong together in a type
MOST_WITH_MORE = 79        # procedures and interfaces of src that have more; the number only goes down

STRING = re.compile(r"'[^']*'|\"[^\"]*\"")
PROCEDURE = re.compile(r'^(?P<before>[^!]*?)\b(?:subroutine|function)\s+(?P<name>\w+)\s*(?:\((?P<arguments>[^)]*)\))?', re.I)
PREFIX = re.compile(r'^\s*(?:(?:pure|impure|elemental|recursive|module|integer|logical|real|complex|double\s+precision|character|type|class)'
                    r'(?:\s*\((?:[^()]|\([^()]*\))*\))?\s*)*$', re.I)
END = re.compile(r'^\s*end\s*(?:subroutine|function|procedure)\b', re.I)
SEPARATE = re.compile(r'^\s*module\s+procedure\s+\w+\s*$', re.I)
INCLUDE = re.compile(r"^\s*include\s+'([^']+)'", re.I)
BRACKETS = re.compile(r'\([^()]*\)')


def statements(text, folder):
    """(line number, code without strings and comments, comment) of each statement; continued lines are joined, and the
    statements of an included file stand at the line that includes it."""
    code, comment, first = '', '', 0
    for number, line in enumerate(text.split('\n'), 1):
        included = INCLUDE.match(line)
        if included:
            yield from ((number, *rest) for _, *rest in statements(text_of(os.path.join(folder, included.group(1))), folder))
            continue
        masked = STRING.sub(lambda found: '_' * len(found.group()), line)
        at = masked.find('!')
        part, remark = (masked, '') if at < 0 else (masked[:at], line[at:])
        if not part.strip() and code:
            continue                     # a line of comment inside a continued statement
        first = first or number
        code += part.strip()
        comment = (comment + ' ' + remark).strip()
        if code.endswith('&'):
            code = code[:-1] + ' '
            continue
        yield first, code.replace('& ', ' '), comment
        code, comment, first = '', '', 0


def entities(declared):
    """The names after `::`, without shapes and initial values."""
    while BRACKETS.search(declared):
        declared = BRACKETS.sub('', declared)
    return [re.split(r'[\s=*]', name.strip())[0].lower() for name in declared.split(',') if name.strip()]


def explained(comment, name):
    """Whether the comment describes the argument in other words than its name."""
    _, mark, words = comment.partition('!<')
    return bool(mark) and words.strip().lower() not in ('', name)


def unexplained(text, folder=''):
    """(line number, procedure, argument) of the arguments without a declaration and an explanation of their own."""
    found = []
    open_procedures = []      # (line, name, arguments that are still to be declared), the innermost last
    for number, code, comment in statements(text, folder):
        begins = PROCEDURE.match(code)
        if END.match(code):
            if open_procedures:
                line, name, missing = open_procedures.pop()
                found += [(line, name, argument) for argument in sorted(missing)]
        elif SEPARATE.match(code):
            open_procedures.append((number, code.split()[-1], set()))
        elif begins and PREFIX.match(begins.group('before')):
            names = (begins.group('arguments') or '').lower().split(',')
            open_procedures.append((number, begins.group('name'), {name.strip() for name in names if name.strip()} - {'*'}))
        elif '::' in code and open_procedures:
            _, name, missing = open_procedures[-1]
            declared = entities(code.split('::', 1)[1])
            for argument in sorted(missing.intersection(declared)):
                if len(declared) > 1 or not explained(comment, argument):
                    found.append((number, name, argument))
            missing.difference_update(declared)
    return found


def argument_lists(text, folder=''):
    """(line number, procedure, number of its arguments) of the procedures and interfaces that have arguments."""
    for number, code, _ in statements(text, folder):
        begins = PROCEDURE.match(code)
        if begins and not END.match(code) and PREFIX.match(begins.group('before')) and begins.group('arguments'):
            yield number, begins.group('name'), len([name for name in begins.group('arguments').split(',') if name.strip()])


def files_of(path):
    return sorted(glob.glob(os.path.join(path, '**', '*.f90'), recursive=True)
                  + glob.glob(os.path.join(path, '**', '*.f90.in'), recursive=True))


def test_reader_of_sources(checks):
    """The reader itself, on a small source."""
    text = '''
  pure subroutine turn(angle, r, &
                       axis)
    real(wp), intent(in) :: angle   !< from the first position [rad]
    real(wp), intent(out) :: r(3, 3), axis(3)   !< both
    character(len=*), parameter :: words = 'a function b(c)'   ! no procedure
  end subroutine turn
  real(wp) function norm(v)
    real(wp), intent(in) :: v(:)   !< v
  end function norm
'''
    checks.equal(unexplained(text), [(5, 'turn', 'axis'), (5, 'turn', 'r'), (9, 'norm', 'v')],
                 'arguments that share a line, or are explained by their name alone, are found')


def test_argument_lists_are_short(checks):
    long = [f'{os.path.relpath(file, TREE)}:{line} {name}: {count}' for file in files_of(os.path.join(TREE, 'src'))
            for line, name, count in argument_lists(text_of(file), os.path.dirname(file)) if count > MANY]
    checks.equal(len(long), MOST_WITH_MORE, f'as many procedures as are counted here have more than {MANY} arguments: after one that is shorter, '
                 'lower MOST_WITH_MORE')


def test_arguments_are_explained(checks):
    files = [file for folder in FOLDERS for file in files_of(os.path.join(TREE, folder))]
    checks.true(len(files) > 50, 'the sources were found', len(files))
    for file in files:
        missing = [f'line {line}: {argument} of {name}' for line, name, argument in unexplained(text_of(file), os.path.dirname(file))]
        checks.true(not missing, f'{os.path.relpath(file, TREE)}: every argument has a declaration of its own with !<', '\n'.join(missing))
