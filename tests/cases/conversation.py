"""Whole conversations with mech9k and mech9d: through pipes and at a terminal, with wrong answers, steps back,
corrections, interruptions and resumptions; the saved data files repeat the tables to the last bit.

usage: conversation.py MECH9K MECH9D
"""
import os
import re
import shutil
import signal
import sys
import tempfile

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '..', 'scripts'))
import dialogue_scripts as scripts
from dialogue import Talk, answers_of, first_missing, piped
from mech9_cases import TREE, Checks, read_table, run, text_of
from terminal import available

DONE, USAGE, DATA, FILE, INTERRUPTED = 0, 2, 3, 8, 130
EXAMPLE = {'fig_1': os.path.join(TREE, 'examples', 'fig1', 'fig1.nml'),
           'simple_pendulum': os.path.join(TREE, 'examples', 'pendulum', 'pendulum.nml')}


def rows_of(path):
    """The lines of a table that are no comments, as they are written."""
    with open(path, encoding='utf-8') as file:
        return [line for line in file if not line.startswith('#')]


class Talks:
    """Leads conversations, each in an empty folder, and counts the checks."""

    def __init__(self, mech9k, mech9d):
        self.mech9k, self.mech9d, self.checks = os.path.abspath(mech9k), os.path.abspath(mech9d), Checks()

    def sound(self, text, why):
        trouble = ('Backtrace', 'Fortran runtime error', 'SIGSEGV', 'AddressSanitizer', 'runtime error:')
        self.checks.true(not any(word in text for word in trouble), f'{why}: no crash', text[-2000:])

    def pipe(self, program, steps, why, code=DONE, arguments=(), folder=None, width=80):
        """A conversation through a pipe, all of whose prompts come in order."""
        done = piped(program, *arguments, folder=folder, answers=answers_of(steps))
        self.checks.true(done.returncode == code, f'{why}: exit code {code}', f'it was {done.returncode}\n{done.stderr}')
        missing = first_missing(done.stderr, steps)
        self.checks.true(missing is None, f'{why}: every prompt comes in its turn', f'{missing} is missing\n{done.stderr}')
        self.checks.true(max(map(len, done.stderr.splitlines())) < width, f'{why}: lines fit {width} columns',
                         max(done.stderr.splitlines(), key=len))
        self.sound(done.stderr, why)
        return done

    def same_as_example(self, folder, program, stem, why):
        """The table of the conversation, of its data file run again, and of the example are the same."""
        again = os.path.join(folder, 'again.dat')
        for path in (os.path.join(folder, stem + '.nml'), EXAMPLE[stem]):
            done = run(program, path, '--table', again, '--quiet', folder=folder)
            self.checks.true(done.returncode == DONE and done.stderr == '', f'{why}: {path} runs', done.stderr)
            table = os.path.join(folder, stem + '.dat')
            self.checks.true(os.path.exists(table) and rows_of(table) == rows_of(again),
                             f'{why}: the table of {path} is the same to the last bit')
        self.checks.true(not any(name.endswith('.draft.nml') for name in os.listdir(folder)),
                         f'{why}: no draft is left', os.listdir(folder))


def through_pipes(talks):
    for name, steps in (('pairs', scripts.FIG1), ('the matrix', scripts.FIG1_BY_MATRIX),
                        ('the second set', scripts.FIG1_BY_VECTORS), ('errors', scripts.with_errors(scripts.FIG1))):
        with tempfile.TemporaryDirectory() as folder:
            why = f'Fig. 1 by {name}'
            talks.pipe(talks.mech9k, steps, why, folder=folder)
            talks.same_as_example(folder, talks.mech9k, 'fig_1', why)
    with tempfile.TemporaryDirectory() as folder:
        talks.pipe(talks.mech9d, scripts.PENDULUM, 'the pendulum', folder=folder)
        talks.same_as_example(folder, talks.mech9d, 'simple_pendulum', 'the pendulum')


def cut_off_anywhere(talks):
    """An input that ends after any answer leaves a file from which the conversation goes on, to the
    same data file."""
    for program, steps, stem in ((talks.mech9k, scripts.FIG1, 'fig_1'),
                                 (talks.mech9k, scripts.FIG1_BY_MATRIX, 'fig_1'),
                                 (talks.mech9d, scripts.PENDULUM, 'simple_pendulum')):
        with tempfile.TemporaryDirectory() as folder:
            talks.pipe(program, steps, 'uninterrupted', folder=folder)
            expected = text_of(os.path.join(folder, stem + '.nml'))
        for cut in range(1, len(steps) - 3, 4):
            with tempfile.TemporaryDirectory() as folder:
                draft = stem + '.draft.nml'
                done = piped(program, folder=folder, answers=answers_of(steps[:cut]))
                talks.checks.true(done.returncode == INTERRUPTED and f'--resume\n  {draft}' in done.stderr.replace(
                    f'--resume {draft}', f'--resume\n  {draft}'), f'cut after {cut}: the draft is named', done.stderr)
                talks.pipe(program, steps[cut:], f'{stem} cut after {cut} answers and resumed', folder=folder,
                           arguments=('--resume', draft))
                path = os.path.join(folder, stem + '.nml')
                talks.checks.true(os.path.exists(path) and text_of(path) == expected,
                                  f'{stem} cut after {cut} answers: the same data file')


def at_a_terminal(talks):
    """The same at a terminal, with and without an editor of lines."""
    for term in ('dumb', 'xterm'):
        for program, steps, stem in ((talks.mech9k, scripts.with_errors(scripts.FIG1), 'fig_1'),
                                     (talks.mech9d, scripts.PENDULUM, 'simple_pendulum')):
            with tempfile.TemporaryDirectory() as folder, \
                    Talk([program], folder=folder, term=term, HOME=folder, NO_COLOR='1') as talk:
                why = f'{stem} at a terminal ({term})'
                missing = talk.play(steps)
                talks.checks.true(missing is None, f'{why}: every prompt comes', f'{missing!r}\n{talk.plain()[-1500:]}')
                talks.checks.equal(talk.ends(), DONE, f'{why}: exit code')
                talks.sound(talk.seen, why)
                if term == 'dumb':
                    talks.checks.true('\x1b' not in talk.seen, f'{why}: plain text')
                talks.same_as_example(folder, program, stem, why)


def interrupted_at_a_terminal(talks):
    """Ctrl-C, Ctrl-D and a closed window each leave a draft that can be resumed."""
    half = len(scripts.FIG1)//2
    for how in ('\x03', '\x04', 'closed', 'quit\n'):
        with tempfile.TemporaryDirectory() as folder:
            with Talk([talks.mech9k], folder=folder, term='dumb') as talk:
                missing = talk.play(scripts.FIG1[:half])
                talks.checks.true(missing is None and talk.expect(scripts.FIG1[half][0]), 'half of Fig. 1', talk.plain())
                if how == 'closed':
                    talk.hang_up()
                    code = talk.ends()
                    talks.checks.true(code in (INTERRUPTED, -signal.SIGHUP), 'a closed terminal ends it', code)
                else:
                    talk.type(how)
                    code = talk.ends()
                    talks.checks.equal(code, DONE if how == 'quit\n' else INTERRUPTED, f'{how!r}: exit code')
                    talks.checks.true('--resume' in talk.plain(), f'{how!r}: says how to go on', talk.plain()[-500:])
            talks.checks.equal(os.listdir(folder), ['fig_1.draft.nml'], f'{how!r}: the draft is there')
            with Talk([talks.mech9k, '--resume', 'fig_1.draft.nml'], folder=folder, term='dumb') as talk:
                missing = talk.play(scripts.FIG1[half:])
                talks.checks.true(missing is None, f'{how!r}: resumed', f'{missing!r}\n{talk.plain()[-1500:]}')
                talks.checks.equal(talk.ends(), DONE, f'{how!r}: resumed to the end')
            talks.same_as_example(folder, talks.mech9k, 'fig_1', f'{how!r}, then resumed')


def transcript(said, steps):
    """The conversation through a pipe, with the answers behind their prompts, up to the saved file."""
    answers = [answer for _, answer in steps]
    lines = []
    for line in said.splitlines():
        if line.endswith(': ') and answers:      # a prompt, and nothing else, ends so
            line += answers.pop(0)
        lines.append(line.rstrip())
        if 'Saved in' in line:
            break
    return '\n'.join(lines)


def the_document(talks):
    """The conversation in the document is this one."""
    path = os.path.join(TREE, 'docs', 'conversation.md')
    with tempfile.TemporaryDirectory() as folder:
        done = piped(talks.mech9k, folder=folder, answers=answers_of(scripts.FIG1))
    now = transcript(done.stderr, scripts.FIG1)
    text = text_of(path)
    start = text.index('tests/cases/conversation.py. -->')
    head = text[:text.index('\n', start) + 1]
    expected = head + '```\n' + now + '\n```\n'
    if not talks.checks.true(text == expected, 'the document shows the conversation as it is; else copy conversation.md of the '
                             'current folder over it'):
        with open('conversation.md', 'w', encoding='utf-8') as file:
            file.write(expected)


def structure_and_start(talks):
    """Structures and starts that cannot be are shown as soon as they are complete, and can be mended."""
    apart = [(p, '2 4' if p == 'links of pair 1' else a) for p, a in scripts.MECHANISM + scripts.BY_PAIRS]
    apart = [(p, '2 4' if p == 'links of pair 2' else a) for p, a in apart]
    mended = apart + [('link 6 is not connected to link 1', '?'), ('number of another answer', 'zzz'),
                      ('no answer that can be changed', 'pair 1 links'), ('links of pair 1 [2, 4]', '1 6'),
                      ('1 -1- 6 (open)', 'no')]
    with tempfile.TemporaryDirectory() as folder:
        done = talks.pipe(talks.mech9k, mended, 'a link apart', INTERRUPTED, folder=folder)
        talks.checks.true('1 = 7 - 2 x 3 in a plane' in done.stderr, 'mobility by the count', done.stderr)
        talks.checks.equal(done.stderr.count('is not connected to link 1'), 1, 'told once: nothing was changed between')
    # two independent coordinates where one is right: refused with the structure, and corrected there
    two = [(p, '5 6' if p == 'cq: ' else a) for p, a in scripts.MECHANISM + scripts.BY_PAIRS]
    steps = two + [('2 are named, and by the count it should be 1', '1 2 3 4 5 6'), ('5 can be at most', '1 2 3 4 5 6'),
                   ('5 can be at most', '5'), ('Independent now: 1.', '')]
    with tempfile.TemporaryDirectory() as folder:
        done = talks.pipe(talks.mech9k, steps, 'too many independent coordinates', INTERRUPTED, folder=folder)
        talks.checks.true('dropped' not in done.stderr, 'drives of which nothing was entered go without a word', done.stderr)
    # in open chains all coordinates are independent
    arm = [('title', 'Arm'), ('links: ', '3'), ('coordinates: ', '2'), ('angle_unit', ''), ('[pairs]', 'default'),
           ('several freedoms', 'no'), ('links of pair 1', '1-2'), ('links of pair 2', '2-3'), ('cq: ', '1'),
           ('no chain is closed, and so all 2 are', '1 2'), ('which of them', 'default'), ('Pair 1', 'quit')]
    with tempfile.TemporaryDirectory() as folder:
        talks.pipe(talks.mech9k, arm, 'too few independent coordinates', folder=folder)
    # rare items of the mechanism are not asked for, but can be given by their names wherever an answer can be changed
    steps = apart + [('link 6 is not connected', 'mechanism data_tolerance = 1e-6'), ('link 6 is not connected', 'list'),
                     ('data_tolerance 1e-6', 'quit')]
    with tempfile.TemporaryDirectory() as folder:
        talks.pipe(talks.mech9k, steps, 'a seldom name of the mechanism', folder=folder)
    # insisted on, and corrected after the geometry
    steps = two + [('give the same answer again', '5 6')] + scripts.pairs(False)
    steps += [('Drive of coordinate 5', ''), ('coefficients', '0.5 6'), ('Drive of coordinate 6', ''),
              ('coefficients', '1.8'), ('guesses', ''), ('the mobility is 1', ''), ('cq [5, 6]', '5'), ('drive 6', 'P')]
    with tempfile.TemporaryDirectory() as folder:
        done = talks.pipe(talks.mech9k, steps, 'too many insisted on', INTERRUPTED, folder=folder)
        talks.checks.true('Put together at the start' in done.stderr, 'put together after the correction', done.stderr)
        talks.checks.true('drive coordinate=6' not in text_of(os.path.join(folder, 'fig_1.draft.nml')),
                          'the drive of a dependent coordinate is gone')


def edited_files(talks):
    """Data files opened with --edit and saved are the same mechanism; an answer can be changed by its number
    or name, groups added and removed."""
    for name in ('fig1', 'andrews', 'bricard', 'stewart_gough'):
        folder_of = os.path.join(TREE, 'examples', name)
        with tempfile.TemporaryDirectory() as folder:
            shutil.copy(os.path.join(folder_of, name + '.nml'), folder)
            program = talks.mech9k if name in ('fig1', 'stewart_gough') else talks.mech9d
            steps = [('Enter if all is right', ''), ('[both]', 'save'), (f'data file [{name}.nml]', 'copy.nml')]
            talks.pipe(program, steps, f'--edit {name}', arguments=('--edit', name + '.nml'), folder=folder)
            tables = []
            for path in (name + '.nml', 'copy.nml'):
                run(program, path, '--table', path + '.dat', '--set', 'time.intervals=5', '--quiet', folder=folder)
                tables.append(rows_of(os.path.join(folder, path + '.dat')))
            talks.checks.true(tables[0] == tables[1], f'--edit {name}: the same table from the copy')
    with tempfile.TemporaryDirectory() as folder:
        done = piped(talks.mech9k, '--edit', os.path.join(TREE, 'examples', 'fig1', 'fig1.nml'), folder=folder, answers='')
        talks.checks.true(done.returncode == USAGE and 'nothing was answered' in done.stderr
                          and 'no data file is given' not in done.stderr, '--edit without answers', done.stderr)
        # this file has no exclamation mark that begins no comment
        shutil.copy(os.path.join(TREE, 'examples', 'fig1', 'fig1.nml'), folder)
        inside = sum('!' in line and not line.startswith('!') for line in text_of(os.path.join(folder, 'fig1.nml')).splitlines())
        done = piped(talks.mech9k, '--edit', 'fig1.nml', folder=folder, answers='time end = 2\nquit\n')
        talks.checks.true(inside > 0 and f'groups, {inside} here, are not kept' in done.stderr,
                          '--edit: comments that get lost are told', done.stderr)
        done = piped(talks.mech9k, '--resume', 'fig1.draft.nml', folder=folder, answers='quit\n')
        talks.checks.true('are not kept' not in done.stderr and '-- Summary --' in done.stderr, '--resume: none is left to lose',
                          done.stderr)
    with tempfile.TemporaryDirectory() as folder:
        shutil.copy(EXAMPLE['simple_pendulum'], os.path.join(folder, 'p.nml'))
        steps = [('Enter if all is right', 'time end'), ('end (s) [10.0]', '2'), ('all is right', 'add load'),
                 ('load 1, kind', 'coordinate'), ('coordinate: ', '1'), ('force', ''), ('stiffness', ''), ('rest', ''),
                 ('damping', '0.5'), ('all is right', 'add body'), ('body 2, link', '1'), ('mass', '3'), ('centre', ''),
                 ('inertia', ''), ('all is right', 'remove body 2'), ('Removed', 'remove point 1'),
                 ('Removed', 'remove time start'), ('Removed', '?'),
                 ('Give the number', '999'), ('no answer that can be changed', 'zero zero zero zero'),
                 ('no answer that can be changed', 'add nothing'), ('What can be added: drive, body, load, motor, point, parameter, quantity, study, objective,', ''),
                 ('[both]', 'save'), ('data file [p.nml]', '/'),
                 ('exists; overwrite it [no]', 'yes'), ('cannot open', '')]
        talks.pipe(talks.mech9d, steps, 'changes', arguments=('--edit', 'p.nml'), folder=folder)
        text = text_of(os.path.join(folder, 'p.nml'))
        for part in ('end=2', "&load kind='coordinate', coordinate=1, damping=0.5 /", 'planar pendulum of the IFToMM',
                     '! At q1 = 0 the bar points along -x'):
            talks.checks.true(part in text, f'changes: {part} is in the file', text)
        for part in ('&point', 'mass=3', 'start='):
            talks.checks.true(part not in text, f'changes: {part} is not in the file', text)
        # without an answer nothing is written, and an existing file is overwritten only on request
        talks.pipe(talks.mech9d, [('all is right', 'quit')], 'quit', arguments=('--edit', 'p.nml'), folder=folder)
        talks.checks.equal(sorted(os.listdir(folder)), ['p.nml'], 'nothing changed, nothing kept')
        steps = [('title [', 'P'), *[(p, a) for p, a in scripts.PENDULUM_TO_THE_END[1:]], ('all is right', ''), ('[both]', 'save'),
                 ('data file [p.nml]', ''), ('exists; overwrite it [no]', '?'), ('no asks for another name', ''),
                 ('data file [p.nml]', '?'), ('The name of the file', 'q.nml')]
        talks.pipe(talks.mech9d, steps, 'a file that exists', folder=folder)
        talks.checks.true(text_of(os.path.join(folder, 'p.nml')) == text, 'it is as it was')


def text_saved(talks, program, steps, why):
    """The data file that a conversation saves as x.nml."""
    with tempfile.TemporaryDirectory() as folder:
        talks.pipe(program, [*steps, ('all is right', ''), ('[both]', 'save'), ('data file [', 'x.nml')], why, folder=folder)
        path = os.path.join(folder, 'x.nml')
        done = run(program, path, '--check', folder=folder)
        talks.checks.equal(done.returncode, DONE, f'{why}: the data file is right')
        return text_of(path) if os.path.exists(path) else ''


def begun_by_mistake(talks):
    """A body, a load, a point begun by mistake is left by going back or by `remove`; `none` begins none."""
    steps = []
    for prompt, answer in scripts.PENDULUM_TO_THE_END:
        steps.append((prompt, {'body 2, link': '1', 'load 1, kind': 'force', 'point 2, name': 'Q'}.get(prompt, answer)))
        if prompt == 'body 2, link':
            steps += [('mass', 'back'), ('link [1]', 'back'), ('Body 2 is left out.', 'none')]
        elif prompt == 'load 1, kind':
            steps += [('link: ', '2'), ('position', 'remove'), ('Load 1 is left out.', 'spring'), ('links: ', 'back'),
                      ('kind [spring]', 'back'), ('Load 1 is left out.', 'no')]
        elif prompt == 'point 2, name':
            steps += [('link: ', '?'), ('remove leaves out the point', '2'), ('position', 'remove'),
                      ('Point 2 is left out.', 'no more')]
    steps = [*steps[:2], ('coordinates: ', 'remove'), ('Nothing can be left out here', '1'), *steps[3:]]
    text = text_saved(talks, talks.mech9d, steps, 'begun by mistake')
    expected = text_saved(talks, talks.mech9d, scripts.PENDULUM_TO_THE_END, 'the pendulum')
    talks.checks.true(text == expected and '&load' not in text, 'nothing is left of what was begun by mistake', text)
    # a load that is added at the end and left brings the end back
    with tempfile.TemporaryDirectory() as folder:
        shutil.copy(EXAMPLE['simple_pendulum'], os.path.join(folder, 'p.nml'))
        steps = [('all is right', 'add load'), ('load 1, kind', 'torque'), ('link: ', 'remove'), ('load 1, kind', ''),
                 ('all is right', 'quit')]
        talks.pipe(talks.mech9d, steps, 'an added load left out', arguments=('--edit', 'p.nml'), folder=folder)


ARM = """&structure cq=1,2 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&pair coordinate=2, links=2,3, kind='revolute', point=0.5,0,0, axis=0,0,1 /
&initial coordinate=1, position=0 /
&initial coordinate=2, position=0.4 /
&body link=3, mass=1, centre=0.8,0,0, inertia=0,0,0.03,0,0,0 /
"""


def drives_and_motors(talks):
    """In mech9d drives and motors are begun in the conversation, added and removed; what is free then is asked for its start."""
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, 'arm.nml')
        with open(path, 'w', encoding='utf-8') as file:
            file.write(ARM)
        steps = [('all is right', 'remove initial 1'), ('Removed.', 'add drive'), ('drive 1, coordinate', '7'),
                 ('there is no coordinate 7', '1'), ('kind', 'har'), ('mean', ''), ('amplitude', '0.5'),
                 ('angular_frequency', '3'), ('phase', ''), ('velocity', ''), ('all is right', 'add motor'), ('motor 1, coordinate', '1'),
                 ('has the drive', '2'), ('kind', 'dc'), ('voltage', '12'), ('resistance', '0'), ("'resistance' must be", '0.6'),
                 ('inductance', '0.01'), ('constant', '0.3'), ('all is right', ''), ('[both]', 'save'),
                 ('data file [arm.nml]', '')]
        talks.pipe(talks.mech9d, steps, 'drive and motor added', arguments=('--edit', 'arm.nml'), folder=folder)
        text = text_of(path)
        talks.checks.true("&drive coordinate=1, kind='harmonic', amplitude=0.5, angular_frequency=3 /" in text
                          and "&motor coordinate=2, kind='dc', voltage=12, resistance=0.6, inductance=0.01, constant=0.3 /" in text
                          and '&initial coordinate=1' not in text, 'the file has drive and motor, and no start of coordinate 1', text)
        steps = [('all is right', 'remove drive 1'), ('Removed.', '0.3'), ('velocity', '1'),
                 ('all is right', 'remove motor 1'), ('Removed.', ''), ('[both]', 'save'),
                 ('data file [arm.nml]', '')]
        talks.pipe(talks.mech9d, steps, 'drive and motor removed', arguments=('--edit', 'arm.nml'), folder=folder)
        text = text_of(path)
        talks.checks.true('&drive' not in text and '&motor' not in text and '&initial coordinate=1, position=0.3, velocity=1 /' in text,
                          'the file has neither drive nor motor, and the start of coordinate 1', text)


def short_answers(talks):
    """A slider-crank with a screw in short answers: the data file has full forms, and a reader of data files takes no
    others. After the slide, Enter means a hinge about the axis of the hinges."""
    steps = [('title', 'Crank'), ('links: ', '4'), ('coordinates: ', '4'), ('angle_unit', 'd'), ('[pairs]', 'p'), ('several freedoms', ''),
             ('links of pair 1', '1-2'), ('links of pair 2', '1 - 4'), ('links of pair 3', '2-3'), ('links of pair 4', '3-4'),
             ('cq: ', '1'), ('which of them', 'zero'), ('kind [revolute]', 'rev'), ('point', ''), ('axis: ', ''),
             ('This must be given', 'z'), ('zero', '-x'),
             ('kind [revolute]', 'pris'), ('point', ''), ('axis: ', '-x'), ('zero', ''),
             ('kind [revolute]', ''), ('point', '.1 0 0'), ('axis [0, 0, 1]', ''), ('zero', ''),
             ('kind [revolute]', ''), ('point', '.4 0 0'), ('axis [0, 0, 1]', ''), ('zero', ''), ('coupling 1, kind', ''),
             ('kind [polynomial]', 'har'), ('mean (deg) [0]', ''), ('amplitude (deg): ', '?'), ('For example: 30 (', '20'),
             ('angular_frequency (deg/s)', '360'), ('phase (deg) [0]', '?'), ('For example: 90 (begins at', ''),
             ('guesses', ''), ('point 1, name', 'none'), ('start', ''), ('end', ''), ('intervals', '10'),
             ('force_arrows which of them', 'energies'), ("'energies' is none of these names", ''), ('table [', '')]
    text = text_saved(talks, talks.mech9k, steps, 'short answers')
    for part in ("angle_unit='deg'", "links=1, 4, kind='prismatic', axis=-1, 0, 0 /", "kind='revolute', axis=0, 0, 1, zero=-1, 0, 0",
                 "links=3, 4, kind='revolute', point=.4, 0, 0, axis=0, 0, 1 /", "kind='harmonic'"):
        talks.checks.true(part in text, f'short answers: {part} is in the file', text)
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, 'short.nml')
        for full, short in (("'revolute'", "'rev'"), ('axis=-1, 0, 0', 'axis=-x'), ('links=3, 4', 'links=3-4')):
            with open(path, 'w', encoding='utf-8') as file:
                file.write(text.replace(full, short))
            done = run(talks.mech9k, path, '--check', folder=folder)
            talks.checks.true(full in text and done.returncode == DATA, f'{short} is none in a data file', done.stderr)


def gravity(talks):
    """Gravity is asked for: Enter alone does not leave it out."""
    for answer, written in (('-y', '0, -9.81, 0'), ('none', '0, 0, 0'), ('0 0 -1.62', '0, 0, -1.62')):
        steps = []
        for prompt, usual in scripts.PENDULUM_TO_THE_END:
            is_gravity = prompt == 'acceleration'
            steps += [(prompt, ''), ('Gravity must be given', answer)] if is_gravity else [(prompt, usual)]
        text = text_saved(talks, talks.mech9d, steps, f'gravity {answer}')
        talks.checks.true(f'&gravity acceleration={written} /' in text, f'gravity: {answer} is {written}', text)


CHAIN = '''&mechanism links=4, coordinates=7 /
&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&pair coordinates=2,3,4, links=2,3, kind='spherical', point=0.3,0,0 /
&pair coordinates=5,6, links=3,4, kind='universal', point=1,0.5,0.2, axis=1,0,0, moving_axis=0,0,1 /
&pair coordinate=7, links=4,1, kind='revolute', point=1,0,0.2, axis=1,0,0 /
&drive coordinate=1, kind='polynomial', coefficients=0,0.3 /
&point name='P', link=4, position=1,0.5,0.2 /
&time intervals=20 /
'''
CHAIN_COUNTS = [('title', 'chain'), ('links: ', '4'), ('coordinates: ', '7'), ('angle_unit', '')]
CHAIN_BY = {'pairs': [('[pairs]', ''), ('freedoms [none]', '2 sphere'), ('Answer none, or', '?'), ('a ball joint', '5 free'),
                      ('has the coordinates 5 to 10', '2 ball, 3 universal'), ('belong to another joint', '2 ball, 5 univ'),
                      ('links of pair 1', 'back'), ('[2 spherical, 5 universal]', ''), ('links of pair 1', '1-2'),
                      ('links of pair 2, 3, 4', '2-3'), ('links of pair 5, 6', '3-4'), ('links of pair 7', '4-1'), ('cq: ', '1')],
            'matrix': [('[pairs]', 'm'), ('freedoms [none]', '2 ball 5 universal'), ('row 1 of c', '0 1 0 7'),
                       ('row 2 of c', '1 0 2 0'), ('row 3 of c', '0 2 0 5'), ('row 4 of c', '7 0 5 0'), ('cq: ', '1')],
            'vectors': [('[pairs]', 'v'), ('freedoms [none]', '2 ball, 5 universal'), ('cq [', '1'), ('nrg', '1 2 3 4 1'),
                        ('nws', '0 1 2 5 7'), ('rdw', '1 1 0 0 0'), ('nrw', '')]}
CHAIN_GEOMETRY = [('which of them', ''), ('Pair 1, from', ''), ('point', ''), ('axis: ', 'z'),
                  ('Pair 2 (coordinates 2, 3, 4)', ''), ('coordinates [2, 3, 4]', ''), ('point', '0.3 0 0'),
                  ('Pair 5 (coordinates 5, 6)', ''), ('coordinates [5, 6]', ''), ('point', '1 .5 .2'), ('axis: ', 'x'),
                  ('moving_axis: ', 'z'), ('Pair 7, from', ''), ('point', '1 0 .2'), ('axis [', 'x'), ('coupling 1', '')]


def joints_with_several_freedoms(talks):
    """A chain with a ball joint and a universal joint gives the table of a data file that is written by hand. A joint that
    becomes a hinge leaves pairs, whose links are asked for at once."""
    rest = [('Drive of coordinate 1', ''), ('coefficients', '0 .3'), ('guesses', ''), ('point 1, name', 'P'), ('link: ', '4'),
            ('position', '1 .5 .2'), ('point 2, name', ''), ('start', ''), ('end', ''), ('intervals', '20'), *scripts.RESULTS,
            *scripts.END]
    for way, structure in CHAIN_BY.items():
        with tempfile.TemporaryDirectory() as folder:
            why = f'a chain with joints, by {way}'
            with open(os.path.join(folder, 'by_hand.nml'), 'w', encoding='utf-8') as file:
                file.write(CHAIN)
            # the last hinge goes from the rocker to the frame; matrix and second set have its links the other way round
            geometry = CHAIN_GEOMETRY if way == 'pairs' else CHAIN_GEOMETRY[:-2] + [('axis [', '-x'), CHAIN_GEOMETRY[-1]]
            # the report of the run lists six coordinates in a line
            done = talks.pipe(talks.mech9k, CHAIN_COUNTS + structure + geometry + rest, why, folder=folder, width=90)
            steps = {step for line in done.stderr.splitlines() for step in re.findall(r' ([-=][0-9,=]+[-=]) ', line)}
            talks.checks.true({'=1=', '-2,3,4-', '-5,6-', '-7-'} <= steps, f'{why}: the sketch names all coordinates of a joint', steps)
            for path in ('by_hand.nml', 'chain.nml'):
                done = run(talks.mech9k, path, '--table', 'again.dat', '--quiet', folder=folder)
                talks.checks.true(done.returncode == DONE and done.stderr == '', f'{why}: {path} runs', done.stderr)
                table, again = (read_table(text_of(os.path.join(folder, name))) for name in ('chain.dat', 'again.dat'))
                # links named in the other order change the round-off
                talks.checks.near(table['P.z'], again['P.z'], 1e-13, f'{why}: the table of {path}')
            if way == 'pairs':
                run(talks.mech9k, 'by_hand.nml', '--table', 'again.dat', '--quiet', folder=folder)
                same = rows_of(os.path.join(folder, 'chain.dat')) == rows_of(os.path.join(folder, 'again.dat'))
                talks.checks.true(same, f'{why}: the table is the same to the last bit')
            text = text_of(os.path.join(folder, 'chain.nml'))
            talks.checks.true('coordinates=2, 3, 4' in text and 'coordinate=2' not in text and 'coordinate=3' not in text,
                              f'{why}: a joint is one group', text)
    steps = CHAIN_COUNTS + CHAIN_BY['pairs'] + CHAIN_GEOMETRY[:4]
    steps += [('Pair 2 (coordinates', 'rev'), ('links of pair 3', '2-3'), ('links of pair 4', '2-3'), ('point', 'back'),
              ('kind [revolute]', 'ball'), ('coordinates [2, 3, 4]', '2 3 9'), ('there is no coordinate 9', ''),
              ('point', '.3 0 0'), ('Pair 5 (coordinates', 'quit')]
    with tempfile.TemporaryDirectory() as folder:
        talks.pipe(talks.mech9k, steps, 'a joint becomes a hinge and a joint again', folder=folder)


# bodies, gravity and loads of a bar, as mech9k asks for them
MASSES = [('body 1, link', '2'), ('mass', '2'), ('centre', '0.5 0 0'), ('inertia', ''), ('body 2, link', ''),
          ('acceleration', '-y'), ('load 1, kind', 'torque'), ('link', '2'), ('torque', '0 0 3'), ('frame', ''), ('load 2, kind', '')]
BAR = [('title [', 'Bar'), ('links: ', '2'), ('coordinates: ', '1'), ('angle_unit', ''), ('[pairs]', ''), ('links of pair 1', '1 2'),
       ('cq: ', '1'), ('which of them', ''), ('kind', ''), ('point', ''), ('axis', 'z'), ('kind [polynomial]', ''),
       ('coefficients', '0'), ('guesses', ''), ('point 1, name', ''), ('start', ''), ('end', ''), ('intervals', '2')]


def forces_of_drives(talks):
    """mech9k asks for bodies, gravity and loads once forces are asked for, in the course of the conversation or in a correction of
    it, and not otherwise. The torque that holds the bar is its weight's moment less the load: 2 kg 9.81 m/s^2 0.5 m - 3 N m."""
    asked = [('nly if you want', 'drive_forces'), ('table [', ''), ('drive_forces [no]', 'yes')]
    plain = [('nly if you want', ''), ('table [', '')]
    for steps, why in ((BAR + asked + MASSES, 'asked for in the course'),
                       (BAR + plain + [('all is right', 'output drive_forces = yes')] + MASSES, 'asked for in a correction')):
        with tempfile.TemporaryDirectory() as folder:
            steps += [('all is right', ''), ('[both]', ''), ('data file', 'bar.nml'), ('run or done', '')]
            talks.pipe(talks.mech9k, steps, f'forces {why}', folder=folder)
            table = read_table(text_of(os.path.join(folder, 'bar.dat')))
            talks.checks.near(table['F1'], 2 * 9.81 * 0.5 - 3, 1e-14, f'forces {why}: the torque of the drive')
    with tempfile.TemporaryDirectory() as folder:
        done = talks.pipe(talks.mech9k, BAR + plain + [('all is right', 'add body'), ('What can be added: point, parameter, quantity, study, objective, limit, optimum;', 'quit')],
                          'without forces', folder=folder)
        talks.checks.true(not any(word in done.stderr for word in ('Bodies', 'Gravity', 'Loads')), 'no masses without forces',
                          done.stderr)


def new_study(talks):
    """A study is begun on request once there are parameters; it asks for what it needs of them, and runs at the end."""
    arm = ("&structure cq=1 /\n&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /\n"
           "&drive coordinate=1, kind='polynomial', coefficients=0.4 /\n&point name='P', link=2, position=1,0,0 /\n&time intervals=0 /\n")
    begun = [('all is right', 'add study'), ('there are no parameters yet; begin with: add parameter', 'add parameter'),
             ('parameter 1, name', 'reach'), ('sets: ', 'point.position(1)'), ('value', ''), ('all is right', 'add quantity'),
             ('quantity 1, name', 'place'), ('of: ', 'P.x'), ('take', 'end')]
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, 'arm.nml')
        with open(path, 'w', encoding='utf-8') as file:
            file.write(arm)
        steps = [*begun, ('all is right', 'add study'), ('study, kind [none]', '?'), ('all combinations', 'heap'), ('grid', 'grid'),
                 ('low: ', '0.5'), ('high: ', 'back'), ('low [0.5]', ''), ('high: ', '2'), ('count: ', '4'), ('all is right', ''), ('[both]', ''),
                 ('data file [arm.nml]', ''), ('study, change', 'study'), ('4 runs: ', 'done')]
        talks.pipe(talks.mech9k, steps, 'a new study on a grid', arguments=('--edit', 'arm.nml'), folder=folder)
        text = text_of(path)
        talks.checks.true("&study kind='grid' /" in text and 'low=0.5, high=2, count=4' in text, 'a new study: the file has it', text)
        # another kind needs other names; a study can be taken away, and begun by mistake
        steps = [('all is right', 'study kind = latin'), ('runs: ', '20'), ('all is right', 'add study'),
                 ('What can be added: point, parameter, quantity, objective', 'remove study 1'), ('Removed', 'add study'),
                 ('study, kind [none]', 'latin'), ('runs: ', 'remove'), ('The group &study is left out.', 'none'),
                 ('all is right', 'add study'), ('kind [none]', 'random'), ('runs: ', '50'), ('all is right', ''), ('[both]', 'save'),
                 ('data file [arm.nml]', '')]
        talks.pipe(talks.mech9k, steps, 'another study', arguments=('--edit', 'arm.nml'), folder=folder)
        talks.checks.true("&study kind='random', runs=50 /" in text_of(path), 'another study: the file has it', text_of(path))
        with open(path, 'w', encoding='utf-8') as file:
            file.write(arm)
        steps = [*begun, ('all is right', 'add study'), ('kind [none]', 'sobol'), ('runs: ', '16'), ('spread: ', '0.01'), ('all is right', 'add optimum'),
                 ('optimum, starts', '?'), ('Each start leads', 'none'), ('all is right', ''), ('[both]', 'save'), ('data file [arm.nml]', '')]
        talks.pipe(talks.mech9k, steps, 'a new study that draws values', arguments=('--edit', 'arm.nml'), folder=folder)
        text = text_of(path)
        talks.checks.true("&study kind='sobol', runs=16 /" in text and 'spread=0.01' in text and '&optimum' not in text,
                          'a new study that draws values: the file has it', text)


def unsaved_runs(talks):
    """The end of a conversation says which file holds what was run, and what was changed since."""
    to_run = [*scripts.PENDULUM_TO_THE_END, ('all is right', ''), ('[both]', '?'), ('save writes your answers', 'run')]
    draft = 'simple_pendulum.draft.nml'
    with tempfile.TemporaryDirectory() as folder:
        steps = [*to_run, ('run or done [done]', 'done'), ('No data file is saved; what was typed is kept in ' + draft, '')]
        talks.pipe(talks.mech9d, steps, 'run, not saved', folder=folder)
        talks.checks.equal(sorted(os.listdir(folder)), ['simple_pendulum.dat', draft], 'as it says')
        steps = [('all is right', ''), ('[both]', ''), ('data file [', ''), ('run or done', 'time intervals = 7'),
                 ('[run]', 'run'), ('run or done [done]', ''), ('The changes are saved in simple_pendulum.nml', '')]
        talks.pipe(talks.mech9d, steps, 'changed, run again', folder=folder, arguments=('--resume', draft))
        talks.checks.true('intervals=7' in text_of(os.path.join(folder, 'simple_pendulum.nml')), 'as it says')
        steps = [('all is right', ''), ('[both]', ''), ('data file [', ''), ('run or done', 'time intervals = 9'),
                 ('[run]', 'done'), ('since the last run are kept in ' + draft, '')]
        talks.pipe(talks.mech9d, steps, 'changed, not run', folder=folder, arguments=('--edit', 'simple_pendulum.nml'))
        talks.checks.true('intervals=9' in text_of(os.path.join(folder, draft)), 'as it says')


def refusals(talks):
    with tempfile.TemporaryDirectory() as folder:
        for arguments, code, said in ((('--edit', 'nowhere.nml'), FILE, 'there is no such file'),
                                      (('--resume', 'a.nml', '--edit', 'a.nml'), USAGE, 'more than one data file'),
                                      (('--dialogue', '--check'), USAGE, 'no data file is given'),
                                      (('--check',), USAGE, 'no data file is given'),
                                      ((), USAGE, 'no data file is given and nothing was answered')):
            done = piped(talks.mech9k, *arguments, folder=folder, answers='')
            talks.checks.true(done.returncode == code and said in done.stderr, f'{arguments}: {said}', done)
            talks.sound(done.stderr, str(arguments))
        with open(os.path.join(folder, 'bad.nml'), 'w', encoding='utf-8') as file:
            file.write("&mechanism links=6, title='open /\n")
        done = piped(talks.mech9k, '--edit', 'bad.nml', folder=folder, answers='')
        talks.checks.true(done.returncode == DATA and 'bad.nml:1:' in done.stderr, 'a file that cannot be read', done)
        with open(os.path.join(folder, 'large.nml'), 'w', encoding='utf-8') as file:
            file.write('&mechanism links=2000000000, coordinates=2000000000 /\n')
        done = piped(talks.mech9k, '--edit', 'large.nml', folder=folder, answers='')
        talks.checks.true(done.returncode == DATA and 'too many to speak of' in done.stderr, 'too large a file', done)
        done = piped(talks.mech9k, '--resume', 'bad.nml/x', folder=folder, answers='')
        talks.checks.equal(done.returncode, FILE, 'no such file to resume')
        # a draft that leads to nowhere: nothing is kept, and nobody is told that it is
        os.symlink(os.path.join('nowhere', 'x'), os.path.join(folder, 'lost.draft.nml'))
        done = piped(talks.mech9k, folder=folder, answers='lost\n3\n')
        talks.checks.true('cannot be kept' in done.stderr and 'could not be kept' in done.stderr and '--resume' not in done.stderr,
                          'a draft that cannot be written', done)


def main():
    talks = Talks(*sys.argv[1:3])
    through_pipes(talks)
    the_document(talks)
    structure_and_start(talks)
    edited_files(talks)
    begun_by_mistake(talks)
    drives_and_motors(talks)
    short_answers(talks)
    gravity(talks)
    forces_of_drives(talks)
    joints_with_several_freedoms(talks)
    new_study(talks)
    unsaved_runs(talks)
    refusals(talks)
    cut_off_anywhere(talks)
    if available():
        at_a_terminal(talks)
        interrupted_at_a_terminal(talks)
    else:
        talks.checks.left_out('there are no pseudo-terminals here')
    talks.checks.finish()


if __name__ == '__main__':
    main()
