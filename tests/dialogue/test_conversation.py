"""Whole conversations with mech9k and mech9d: through pipes and at a terminal, with wrong answers, steps back,
corrections, interruptions and resumptions; the saved data files repeat the tables to the last bit."""
import os
import re
import shutil
import signal
import tempfile

import pytest

import dialogue_scripts as scripts
from conversations import Talk, answers_of, first_missing, piped
from mech9_cases import TREE, read_table, run, text_of
from pseudo_terminal import needs_terminal

DONE, USAGE, DATA, FILE, INTERRUPTED = 0, 2, 3, 8, 130
EXAMPLE = {'fig_1': os.path.join(TREE, 'examples', 'fig1', 'fig1.nml'),
           'simple_pendulum': os.path.join(TREE, 'examples', 'pendulum', 'pendulum.nml')}


def rows_of(path):
    """The lines of a table that are no comments, as they are written."""
    with open(path, encoding='utf-8') as file:
        return [line for line in file if not line.startswith('#')]


class Talks:
    """Leads conversations and counts the checks."""

    def __init__(self, checks, mech9k, mech9d):
        self.checks, self.mech9k, self.mech9d = checks, mech9k, mech9d

    def program(self, name):
        return {'mech9k': self.mech9k, 'mech9d': self.mech9d}[name]

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


@pytest.fixture
def talks(checks, mech9k, mech9d):
    return Talks(checks, mech9k, mech9d)


@pytest.fixture
def folder(tmp_path):
    return os.fspath(tmp_path)


FIG1_BY = {'pairs': scripts.FIG1, 'the matrix': scripts.FIG1_BY_MATRIX, 'the second set': scripts.FIG1_BY_VECTORS,
           'errors': scripts.with_errors(scripts.FIG1)}


@pytest.mark.parametrize('way', FIG1_BY)
def test_fig1_through_a_pipe(talks, folder, way):
    why = f'Fig. 1 by {way}'
    talks.pipe(talks.mech9k, FIG1_BY[way], why, folder=folder)
    talks.same_as_example(folder, talks.mech9k, 'fig_1', why)


def test_pendulum_through_a_pipe(talks, folder):
    talks.pipe(talks.mech9d, scripts.PENDULUM, 'the pendulum', folder=folder)
    talks.same_as_example(folder, talks.mech9d, 'simple_pendulum', 'the pendulum')


@pytest.mark.parametrize('program, steps, stem', (('mech9k', scripts.FIG1, 'fig_1'), ('mech9k', scripts.FIG1_BY_MATRIX, 'fig_1'),
                                                  ('mech9d', scripts.PENDULUM, 'simple_pendulum')), ids=('fig1', 'matrix', 'pendulum'))
def test_cut_off_anywhere(talks, tmp_path, program, steps, stem):
    """An input that ends after any answer leaves a file from which the conversation goes on, to the
    same data file."""
    program = talks.program(program)
    talks.pipe(program, steps, 'uninterrupted', folder=tmp_path)
    expected = text_of(tmp_path / f'{stem}.nml')
    for cut in range(1, len(steps) - 3, 4):
        folder, draft = tmp_path / str(cut), stem + '.draft.nml'
        folder.mkdir()
        done = piped(program, folder=folder, answers=answers_of(steps[:cut]))
        talks.checks.true(done.returncode == INTERRUPTED and f'--resume\n  {draft}' in done.stderr.replace(
            f'--resume {draft}', f'--resume\n  {draft}'), f'cut after {cut}: the draft is named', done.stderr)
        talks.pipe(program, steps[cut:], f'{stem} cut after {cut} answers and resumed', folder=folder,
                   arguments=('--resume', draft))
        path = folder / f'{stem}.nml'
        talks.checks.true(path.exists() and text_of(path) == expected, f'{stem} cut after {cut} answers: the same data file')


@needs_terminal
@pytest.mark.parametrize('program, steps, stem', (('mech9k', scripts.with_errors(scripts.FIG1), 'fig_1'),
                                                  ('mech9d', scripts.PENDULUM, 'simple_pendulum')), ids=('fig1', 'pendulum'))
@pytest.mark.parametrize('term', ('dumb', 'xterm'))
def test_at_a_terminal(talks, folder, term, program, steps, stem):
    """The same at a terminal, with and without an editor of lines."""
    program = talks.program(program)
    with Talk([program], folder=folder, term=term, HOME=folder, NO_COLOR='1') as talk:
        why = f'{stem} at a terminal ({term})'
        missing = talk.play(steps)
        talks.checks.true(missing is None, f'{why}: every prompt comes', f'{missing!r}\n{talk.plain()[-1500:]}')
        talks.checks.equal(talk.ends(), DONE, f'{why}: exit code')
        talks.sound(talk.seen, why)
        if term == 'dumb':
            talks.checks.true('\x1b' not in talk.seen, f'{why}: plain text')
        talks.same_as_example(folder, program, stem, why)


@needs_terminal
@pytest.mark.parametrize('how', ('\x03', '\x04', 'closed', 'quit\n'), ids=('Ctrl-C', 'Ctrl-D', 'closed', 'quit'))
def test_interrupted_at_a_terminal(talks, folder, how):
    """Ctrl-C, Ctrl-D and a closed window each leave a draft that can be resumed."""
    half = len(scripts.FIG1)//2
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


def test_document(talks, tmp_path):
    """The conversation in docs/tutorials/conversation.md is this one."""
    path, new = os.path.join(TREE, 'docs', 'tutorials', 'conversation.md'), tmp_path / 'conversation.md'
    done = piped(talks.mech9k, folder=tmp_path, answers=answers_of(scripts.PRESS))
    now = transcript(done.stderr, scripts.PRESS)
    text = text_of(path)
    start = text.index('tests/dialogue/test_conversation.py. -->')
    head = text[:text.index('\n', start) + 1]
    expected = head + '```\n' + now + '\n```\n'
    new.write_text(expected, encoding='utf-8')
    talks.checks.true(text == expected, f'the document shows the conversation as it is; else copy {new} over it')


# structures that cannot be are shown as soon as they are complete, and can be mended
APART = [(p, '2 4' if p == 'links of pair 1' else a) for p, a in scripts.MECHANISM + scripts.BY_PAIRS]
APART = [(p, '2 4' if p == 'links of pair 2' else a) for p, a in APART]
TWO = [(p, '5 6' if p == 'cq: ' else a) for p, a in scripts.MECHANISM + scripts.BY_PAIRS]


def test_link_apart(talks, folder):
    mended = APART + [('link 6 is not connected to link 1', '?'), ('number of another answer', 'zzz'),
                      ('no answer that can be changed', 'pair 1 links'), ('links of pair 1 [2, 4]', '1 6'),
                      ('1 -1- 6 (open)', 'no')]
    done = talks.pipe(talks.mech9k, mended, 'a link apart', INTERRUPTED, folder=folder)
    talks.checks.true('1 = 7 - 2 x 3 in a plane' in done.stderr, 'mobility by the count', done.stderr)
    talks.checks.equal(done.stderr.count('is not connected to link 1'), 1, 'told once: nothing was changed between')


def test_two_independent_coordinates_where_one_is_right(talks, folder):
    """They are refused with the structure, and corrected there."""
    steps = TWO + [('2 are named, and by the count it should be 1', '1 2 3 4 5 6'), ('5 can be at most', '1 2 3 4 5 6'),
                   ('5 can be at most', '5'), ('Independent now: 1.', '')]
    done = talks.pipe(talks.mech9k, steps, 'too many independent coordinates', INTERRUPTED, folder=folder)
    talks.checks.true('dropped' not in done.stderr, 'drives of which nothing was entered go without a word', done.stderr)


def test_all_coordinates_of_open_chains_are_independent(talks, folder):
    arm = [('title', 'Arm'), ('links: ', '3'), ('coordinates: ', '2'), ('angle_unit', ''), ('[pairs]', 'default'),
           ('several freedoms', 'no'), ('links of pair 1', '1-2'), ('links of pair 2', '2-3'), ('cq: ', '1'),
           ('no chain is closed, and so all 2 are', '1 2'), ('which of them', 'default'), ('Pair 1', 'quit')]
    talks.pipe(talks.mech9k, arm, 'too few independent coordinates', folder=folder)


def test_rare_items_by_their_names(talks, folder):
    """Rare items of the mechanism are not asked for, but can be given by their names wherever an answer can be changed."""
    steps = APART + [('link 6 is not connected', 'mechanism data_tolerance = 1e-6'), ('link 6 is not connected', 'list'),
                     ('data_tolerance 1e-6', 'quit')]
    talks.pipe(talks.mech9k, steps, 'a seldom name of the mechanism', folder=folder)


def test_independent_coordinates_insisted_on(talks, folder):
    """They are corrected after the geometry."""
    steps = TWO + [('give the same answer again', '5 6')] + scripts.pairs(False)
    steps += [('Drive of coordinate 5', ''), ('coefficients', '0.5 6'), ('Drive of coordinate 6', ''),
              ('coefficients', '1.8'), ('guesses', ''), ('the mobility is 1', ''), ('cq [5, 6]', '5'), ('drive 6', 'P')]
    done = talks.pipe(talks.mech9k, steps, 'too many insisted on', INTERRUPTED, folder=folder)
    talks.checks.true('Put together at the start' in done.stderr, 'put together after the correction', done.stderr)
    talks.checks.true('drive coordinate=6' not in text_of(os.path.join(folder, 'fig_1.draft.nml')),
                      'the drive of a dependent coordinate is gone')


@pytest.mark.parametrize('name', ('fig1', 'andrews', 'bricard', 'stewart_gough'))
def test_edited_file_is_the_same_mechanism(talks, folder, name):
    folder_of = os.path.join(TREE, 'examples', name)
    shutil.copy(os.path.join(folder_of, name + '.nml'), folder)
    program = talks.mech9k if name in ('fig1', 'stewart_gough') else talks.mech9d
    steps = [('Enter if all is right', ''), ('[both]', 'save'), (f'data file [{name}.nml]', 'copy.nml')]
    talks.pipe(program, steps, f'--edit {name}', arguments=('--edit', name + '.nml'), folder=folder)
    tables = []
    for path in (name + '.nml', 'copy.nml'):
        run(program, path, '--table', path + '.dat', '--set', 'time.intervals=5', '--quiet', folder=folder)
        tables.append(rows_of(os.path.join(folder, path + '.dat')))
    talks.checks.true(tables[0] == tables[1], f'--edit {name}: the same table from the copy')


def test_edit_without_answers(talks, folder):
    done = piped(talks.mech9k, '--edit', os.path.join(TREE, 'examples', 'fig1', 'fig1.nml'), folder=folder, answers='')
    talks.checks.true(done.returncode == USAGE and 'nothing was answered' in done.stderr
                      and 'no data file is given' not in done.stderr, '--edit without answers', done.stderr)


def test_comments_that_get_lost_are_told(talks, folder):
    # this file has no exclamation mark that begins no comment
    shutil.copy(os.path.join(TREE, 'examples', 'fig1', 'fig1.nml'), folder)
    inside = sum('!' in line and not line.startswith('!') for line in text_of(os.path.join(folder, 'fig1.nml')).splitlines())
    done = piped(talks.mech9k, '--edit', 'fig1.nml', folder=folder, answers='time end = 2\nquit\n')
    talks.checks.true(inside > 0 and f'groups, {inside} here, are not kept' in done.stderr,
                      '--edit: comments that get lost are told', done.stderr)
    done = piped(talks.mech9k, '--resume', 'fig1.draft.nml', folder=folder, answers='quit\n')
    talks.checks.true('are not kept' not in done.stderr and '-- Summary --' in done.stderr, '--resume: none is left to lose',
                      done.stderr)


def test_changes(talks, folder):
    """An answer can be changed by its number or name, groups added and removed."""
    shutil.copy(EXAMPLE['simple_pendulum'], os.path.join(folder, 'p.nml'))
    steps = [('Enter if all is right', 'time end'), ('end (s) [10.0]', '2'), ('all is right', 'add load'),
             ('load 1, kind', 'coordinate'), ('coordinate: ', '1'), ('force', ''), ('stiffness', ''), ('rest', ''),
             ('damping', '0.5'), ('all is right', 'add body'), ('body 2, link', '1'), ('mass', '3'), ('centre', ''),
             ('inertia', ''), ('all is right', 'remove body 2'), ('Removed', 'remove point 1'),
             ('Removed', 'remove time start'), ('Removed', '?'),
             ('Give the number', '999'), ('no answer that can be changed', 'zero zero zero zero'),
             ('no answer that can be changed', 'add nothing'),
             ('What can be added: link, drive, body, load, motor, stop, friction, point, contact,', ''),
             ('[both]', 'save'), ('data file [p.nml]', '/'),
             ('exists; overwrite it [no]', 'yes'), ('cannot open', '')]
    talks.pipe(talks.mech9d, steps, 'changes', arguments=('--edit', 'p.nml'), folder=folder)
    text = text_of(os.path.join(folder, 'p.nml'))
    for part in ('end=2', "&load kind='coordinate', coordinate=1, damping=0.5 /", 'planar pendulum of the IFToMM',
                 '! At q1 = 0 the bar points along -x'):
        talks.checks.true(part in text, f'changes: {part} is in the file', text)
    for part in ('&point', 'mass=3', 'start='):
        talks.checks.true(part not in text, f'changes: {part} is not in the file', text)


def test_nothing_changed_nothing_kept(talks, folder):
    shutil.copy(EXAMPLE['simple_pendulum'], os.path.join(folder, 'p.nml'))
    talks.pipe(talks.mech9d, [('all is right', 'quit')], 'quit', arguments=('--edit', 'p.nml'), folder=folder)
    talks.checks.equal(sorted(os.listdir(folder)), ['p.nml'], 'nothing changed, nothing kept')


def test_file_that_exists(talks, folder):
    """It is overwritten only on request."""
    shutil.copy(EXAMPLE['simple_pendulum'], os.path.join(folder, 'p.nml'))
    text = text_of(os.path.join(folder, 'p.nml'))
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


def test_begun_by_mistake(talks):
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


def test_load_that_is_added_and_left_brings_the_end_back(talks, folder):
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


def test_drives_and_motors(talks, folder):
    """In mech9d drives and motors are begun in the conversation, added and removed; what is free then is asked for its start."""
    path = os.path.join(folder, 'arm.nml')
    with open(path, 'w', encoding='utf-8') as file:
        file.write(ARM)
    steps = [('all is right', 'remove initial 1'), ('Removed.', 'add drive'), ('drive 1, coordinate', '7'),
             ('there is no coordinate 7', '1'), ('kind', 'har'), ('mean', ''), ('amplitude', '0.5'),
             ('angular_frequency', '3'), ('phase', ''), ('all is right', 'add motor'), ('motor 1, coordinate', '1'),
             ('has the drive', '2'), ('kind', 'dc'), ('voltage', '12'), ('resistance', '0'), ("'resistance' must be", '0.6'),
             ('inductance', '0.01'), ('constant', '0.3'), ('all is right', 'add stop'), ('stop 1, coordinate', '2'),
             ('low', '0.2'), ('high', ''), ('restitution', '0.5'), ('all is right', ''), ('[both]', 'save'),
             ('data file [arm.nml]', '')]
    talks.pipe(talks.mech9d, steps, 'drive and motor added', arguments=('--edit', 'arm.nml'), folder=folder)
    text = text_of(path)
    talks.checks.true("&drive coordinate=1, kind='harmonic', amplitude=0.5, angular_frequency=3 /" in text
                      and "&motor coordinate=2, kind='dc', voltage=12, resistance=0.6, inductance=0.01, constant=0.3 /" in text
                      and '&stop coordinate=2, low=0.2, restitution=0.5 /' in text
                      and '&initial coordinate=1' not in text, 'the file has drive, motor and stop, and no start of coordinate 1', text)
    steps = [('all is right', 'remove drive 1'), ('Removed.', '0.3'), ('velocity', '1'),
             ('all is right', 'remove motor 1'), ('Removed.', ''), ('[both]', 'save'),
             ('data file [arm.nml]', '')]
    talks.pipe(talks.mech9d, steps, 'drive and motor removed', arguments=('--edit', 'arm.nml'), folder=folder)
    text = text_of(path)
    talks.checks.true('&drive' not in text and '&motor' not in text and '&initial coordinate=1, position=0.3, velocity=1 /' in text,
                      'the file has neither drive nor motor, and the start of coordinate 1', text)


def test_short_answers(talks, folder):
    """A slider-crank with a screw in short answers: the data file has full forms, and a reader of data files takes no
    others. After the slide, Enter means a hinge about the axis of the hinges."""
    steps = [('title', 'Crank'), ('links: ', '4'), ('coordinates: ', '4'), ('angle_unit', 'd'), ('[pairs]', 'p'), ('several freedoms', ''),
             ('links of pair 1', '1-2'), ('links of pair 2', '1 - 4'), ('links of pair 3', '2-3'), ('links of pair 4', '3-4'),
             ('cq: ', '1'), ('or by points [lengths]', 'p'), ('which of them', 'zero'), ('kind [revolute]', 'rev'), ('point', ''), ('axis: ', ''),
             ('This must be given', 'z'), ('zero', '-x'),
             ('kind [revolute]', 'pris'), ('point', ''), ('axis: ', '-x'), ('zero', ''),
             ('kind [revolute]', ''), ('point', '.1 0 0'), ('axis [0, 0, 1]', ''), ('zero', ''),
             ('kind [revolute]', ''), ('point', '.4 0 0'), ('axis [0, 0, 1]', ''), ('zero', ''), ('coupling 1, kind', ''),
             ('kind [polynomial]', 'har'), ('mean (deg) [0]', ''), ('amplitude (deg): ', '?'), ('For example: 30 (', '20'),
             ('angular_frequency (deg/s)', '360'), ('phase (deg) [0]', '?'), ('For example: 90 (begins at', ''),
             ('guesses', ''), ('point 1, name', 'none'), ('start', ''), ('end', ''), ('intervals', '10'),
             ('reaction_axes which of them', 'energies'), ("'energies' is none of these names", ''), ('table [', '')]
    text = text_saved(talks, talks.mech9k, steps, 'short answers')
    for part in ("angle_unit='deg'", "links=1, 4, kind='prismatic', axis=-1, 0, 0 /", "kind='revolute', axis=0, 0, 1, zero=-1, 0, 0",
                 "links=3, 4, kind='revolute', point=.4, 0, 0, axis=0, 0, 1 /", "kind='harmonic'"):
        talks.checks.true(part in text, f'short answers: {part} is in the file', text)
    path = os.path.join(folder, 'short.nml')
    for full, short in (("'revolute'", "'rev'"), ('axis=-1, 0, 0', 'axis=-x'), ('links=3, 4', 'links=3-4')):
        with open(path, 'w', encoding='utf-8') as file:
            file.write(text.replace(full, short))
        done = run(talks.mech9k, path, '--check', folder=folder)
        talks.checks.true(full in text and done.returncode == DATA, f'{short} is none in a data file', done.stderr)


@pytest.mark.parametrize('answer, written', (('-y', '0, -9.81, 0'), ('none', '0, 0, 0'), ('0 0 -1.62', '0, 0, -1.62')))
def test_gravity(talks, answer, written):
    """Gravity is asked for: Enter alone does not leave it out."""
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


@pytest.mark.parametrize('way', CHAIN_BY)
def test_joints_with_several_freedoms(talks, folder, way):
    """A chain with a ball joint and a universal joint gives the table of a data file that is written by hand."""
    rest = [('Drive of coordinate 1', ''), ('coefficients', '0 .3'), ('guesses', ''), ('point 1, name', 'P'), ('link: ', '4'),
            ('position', '1 .5 .2'), ('point 2, name', ''), ('start', ''), ('end', ''), ('intervals', '20'), *scripts.RESULTS,
            *scripts.END]
    why = f'a chain with joints, by {way}'
    with open(os.path.join(folder, 'by_hand.nml'), 'w', encoding='utf-8') as file:
        file.write(CHAIN)
    # the last hinge goes from the rocker to the frame; matrix and second set have its links the other way round
    geometry = CHAIN_GEOMETRY if way == 'pairs' else CHAIN_GEOMETRY[:-2] + [('axis [', '-x'), CHAIN_GEOMETRY[-1]]
    # the report of the run lists six coordinates in a line
    done = talks.pipe(talks.mech9k, CHAIN_COUNTS + CHAIN_BY[way] + geometry + rest, why, folder=folder, width=90)
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


def test_joint_that_becomes_a_hinge(talks, folder):
    """It leaves pairs, whose links are asked for at once."""
    steps = CHAIN_COUNTS + CHAIN_BY['pairs'] + CHAIN_GEOMETRY[:4]
    steps += [('Pair 2 (coordinates', 'rev'), ('links of pair 3', '2-3'), ('links of pair 4', '2-3'), ('point', 'back'),
              ('kind [revolute]', 'ball'), ('coordinates [2, 3, 4]', '2 3 9'), ('there is no coordinate 9', ''),
              ('point', '.3 0 0'), ('Pair 5 (coordinates', 'quit')]
    talks.pipe(talks.mech9k, steps, 'a joint becomes a hinge and a joint again', folder=folder)


# bodies, gravity and loads of a bar, as mech9k asks for them
MASSES = [('body 1, link', '2'), ('mass', '2'), ('centre', '0.5 0 0'), ('inertia', ''), ('body 2, link', ''),
          ('acceleration', '-y'), ('load 1, kind', 'torque'), ('link', '2'), ('torque', '0 0 3'), ('frame', ''), ('load 2, kind', '')]
BAR = [('title [', 'Bar'), ('links: ', '2'), ('coordinates: ', '1'), ('angle_unit', ''), ('[pairs]', ''), ('links of pair 1', '1 2'),
       ('cq: ', '1'), ('which of them', ''), ('kind', ''), ('point', ''), ('axis', 'z'), ('kind [polynomial]', ''),
       ('coefficients', '0'), ('guesses', ''), ('point 1, name', ''), ('start', ''), ('end', ''), ('intervals', '2')]
ASKED = [('nly if you want', 'drive_forces'), ('table [', ''), ('drive_forces [no]', 'yes')]
PLAIN = [('nly if you want', ''), ('table [', '')]


@pytest.mark.parametrize('steps, why', ((BAR + ASKED + MASSES, 'asked for in the course'),
                                        (BAR + PLAIN + [('all is right', 'output drive_forces = yes')] + MASSES, 'asked for in a correction')),
                         ids=('course', 'correction'))
def test_forces_of_drives(talks, folder, steps, why):
    """mech9k asks for bodies, gravity and loads once forces are asked for, in the course of the conversation or in a correction of
    it, and not otherwise. The torque that holds the bar is its weight's moment less the load: 2 kg 9.81 m/s^2 0.5 m - 3 N m."""
    steps = steps + [('all is right', ''), ('[both]', ''), ('data file', 'bar.nml'), ('run or done', '')]
    talks.pipe(talks.mech9k, steps, f'forces {why}', folder=folder)
    table = read_table(text_of(os.path.join(folder, 'bar.dat')))
    talks.checks.near(table['F1'], 2 * 9.81 * 0.5 - 3, 1e-14, f'forces {why}: the torque of the drive')


def test_no_masses_without_forces(talks, folder):
    done = talks.pipe(talks.mech9k, BAR + PLAIN + [
        ('all is right', 'add body'), ('What can be added: link, stop, point, contact, parameter, quantity, study,', 'quit')],
                      'without forces', folder=folder)
    talks.checks.true(not any(word in done.stderr for word in ('Bodies', 'Gravity', 'Loads')), 'no masses without forces',
                      done.stderr)


ARM_OF_STUDY = ("&structure cq=1 /\n&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /\n"
                "&drive coordinate=1, kind='polynomial', coefficients=0.4 /\n&point name='P', link=2, position=1,0,0 /\n&time intervals=0 /\n")
BEGUN = [('all is right', 'add study'), ('there are no parameters yet; begin with: add parameter', 'add parameter'),
         ('parameter 1, name', 'reach'), ('sets: ', 'point.position(1)'), ('value', ''), ('all is right', 'add quantity'),
         ('quantity 1, name', 'place'), ('of: ', 'P.x'), ('take', 'end')]


def test_new_study(talks, folder):
    """A study is begun on request once there are parameters; it asks for what it needs of them, and runs at the end."""
    path = os.path.join(folder, 'arm.nml')
    with open(path, 'w', encoding='utf-8') as file:
        file.write(ARM_OF_STUDY)
    steps = [*BEGUN, ('all is right', 'add study'), ('study, kind [none]', '?'), ('all combinations', 'heap'), ('grid', 'grid'),
             ('low: ', '0.5'), ('high: ', 'back'), ('low [0.5]', ''), ('high: ', '2'), ('count: ', '4'), ('all is right', ''), ('[both]', ''),
             ('data file [arm.nml]', ''), ('study, change', 'study'), ('4 runs: ', 'done')]
    talks.pipe(talks.mech9k, steps, 'a new study on a grid', arguments=('--edit', 'arm.nml'), folder=folder)
    text = text_of(path)
    talks.checks.true("&study kind='grid' /" in text and 'low=0.5, high=2, count=4' in text, 'a new study: the file has it', text)
    # another kind needs other names; a study can be taken away, and begun by mistake
    steps = [('all is right', 'study kind = latin'), ('runs: ', '20'), ('all is right', 'add study'),
             ('What can be added: link, stop, point, contact, parameter, quantity, objective', 'remove study 1'), ('Removed', 'add study'),
             ('study, kind [none]', 'latin'), ('runs: ', 'remove'), ('The group &study is left out.', 'none'),
             ('all is right', 'add study'), ('kind [none]', 'random'), ('runs: ', '50'), ('all is right', ''), ('[both]', 'save'),
             ('data file [arm.nml]', '')]
    talks.pipe(talks.mech9k, steps, 'another study', arguments=('--edit', 'arm.nml'), folder=folder)
    talks.checks.true("&study kind='random', runs=50 /" in text_of(path), 'another study: the file has it', text_of(path))


def test_new_study_that_draws_values(talks, folder):
    path = os.path.join(folder, 'arm.nml')
    with open(path, 'w', encoding='utf-8') as file:
        file.write(ARM_OF_STUDY)
    steps = [*BEGUN, ('all is right', 'add study'), ('kind [none]', 'sobol'), ('runs: ', '16'), ('spread: ', '0.01'), ('all is right', 'add optimum'),
             ('optimum, starts', '?'), ('Each start leads', 'none'), ('all is right', ''), ('[both]', 'save'), ('data file [arm.nml]', '')]
    talks.pipe(talks.mech9k, steps, 'a new study that draws values', arguments=('--edit', 'arm.nml'), folder=folder)
    text = text_of(path)
    talks.checks.true("&study kind='sobol', runs=16 /" in text and 'spread=0.01' in text and '&optimum' not in text,
                      'a new study that draws values: the file has it', text)


def test_unsaved_runs(talks, folder):
    """The end of a conversation says which file holds what was run, and what was changed since."""
    to_run = [*scripts.PENDULUM_TO_THE_END, ('all is right', ''), ('[both]', '?'), ('save writes your answers', 'run')]
    draft = 'simple_pendulum.draft.nml'
    steps = [*to_run, ('run or done: ', 'done'), ('No data file is saved; what was typed is kept in ' + draft, '')]
    talks.pipe(talks.mech9d, steps, 'run, not saved', folder=folder)
    talks.checks.equal(sorted(os.listdir(folder)), ['simple_pendulum.dat', draft], 'as it says')
    steps = [('all is right', ''), ('[both]', ''), ('data file [', ''), ('run or done', 'time intervals = 7'),
             ('[run]', 'run'), ('run or done: ', 'done'), ('The changes are saved in simple_pendulum.nml', '')]
    talks.pipe(talks.mech9d, steps, 'changed, run again', folder=folder, arguments=('--resume', draft))
    talks.checks.true('intervals=7' in text_of(os.path.join(folder, 'simple_pendulum.nml')), 'as it says')
    steps = [('all is right', ''), ('[both]', ''), ('data file [', ''), ('run or done', 'time intervals = 9'),
             ('[run]', 'done'), ('since the last run are kept in ' + draft, '')]
    talks.pipe(talks.mech9d, steps, 'changed, not run', folder=folder, arguments=('--edit', 'simple_pendulum.nml'))
    talks.checks.true('intervals=9' in text_of(os.path.join(folder, draft)), 'as it says')


REFUSED = ((('--edit', 'nowhere.nml'), FILE, 'there is no such file'),
           (('--resume', 'a.nml', '--edit', 'a.nml'), USAGE, 'more than one data file'),
           (('--dialogue', '--check'), USAGE, 'no data file is given'),
           (('--check',), USAGE, 'no data file is given'),
           ((), USAGE, 'no data file is given and nothing was answered'))


@pytest.mark.parametrize('arguments, code, said', REFUSED, ids=[' '.join(arguments) for arguments, _, _ in REFUSED])
def test_refusals(talks, folder, arguments, code, said):
    done = piped(talks.mech9k, *arguments, folder=folder, answers='')
    talks.checks.true(done.returncode == code and said in done.stderr, f'{arguments}: {said}', done)
    talks.sound(done.stderr, str(arguments))


def test_file_that_cannot_be_read(talks, folder):
    with open(os.path.join(folder, 'bad.nml'), 'w', encoding='utf-8') as file:
        file.write("&mechanism links=6, title='open /\n")
    done = piped(talks.mech9k, '--edit', 'bad.nml', folder=folder, answers='')
    talks.checks.true(done.returncode == DATA and 'bad.nml:1:' in done.stderr, 'a file that cannot be read', done)
    done = piped(talks.mech9k, '--resume', 'bad.nml/x', folder=folder, answers='')
    talks.checks.equal(done.returncode, FILE, 'no such file to resume')


def test_file_that_is_too_large(talks, folder):
    with open(os.path.join(folder, 'large.nml'), 'w', encoding='utf-8') as file:
        file.write('&mechanism links=2000000000, coordinates=2000000000 /\n')
    done = piped(talks.mech9k, '--edit', 'large.nml', folder=folder, answers='')
    talks.checks.true(done.returncode == DATA and 'too many to speak of' in done.stderr, 'too large a file', done)


def test_draft_that_leads_to_nowhere(talks, folder):
    """Nothing is kept, and nobody is told that it is."""
    os.symlink(os.path.join('nowhere', 'x'), os.path.join(folder, 'lost.draft.nml'))
    done = piped(talks.mech9k, folder=folder, answers='lost\n3\n')
    talks.checks.true('cannot be kept' in done.stderr and 'could not be kept' in done.stderr and '--resume' not in done.stderr,
                      'a draft that cannot be written', done)
