"""Data files that are opened in a conversation: nothing is asked for that they may leave out, only what is there is removed, and words
do not become names of files.
"""
import os

import pytest

from mech9_cases import run, text_of

DATA = """&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&initial coordinate=1, position=1 /
&body link=2, mass=1, centre=0,-0.5,0 /
&gravity acceleration=0,-9.81,0 /
&time end=1, intervals=10 /
"""
SUMMARY = 'number of an answer to change, Enter if all is right:'
NOTHING = 'There is no such answer to remove'


class Edited:
    def __init__(self, checks, program, folder):
        self.checks, self.program, self.folder = checks, program, folder

    def hears(self, *lines, why):
        """Everything that a conversation about the data file says to some lines."""
        with open(self.path('p.nml'), 'w', encoding='utf-8') as file:
            file.write(DATA)
        done = run(self.program, '--edit', 'p.nml', folder=self.folder, stdin=''.join(line + '\n' for line in lines))
        self.checks.equal(done.returncode, 0, f'{why}: ends with 0; {done.stderr}')
        return done.stderr

    def path(self, name):
        return os.path.join(self.folder, name)


@pytest.fixture
def edited(checks, mech9d, tmp_path):
    return Edited(checks, mech9d, os.fspath(tmp_path))


def test_nothing_more_is_needed(edited):
    """A coordinate without a velocity starts at rest."""
    said = edited.hears('time end = 2', '', 'save', '', why='at rest')
    edited.checks.equal(said.count(SUMMARY), 2, 'at rest: no question comes between')
    text = text_of(edited.path('p.nml'))
    edited.checks.true('velocity' not in text and 'end=2' in text, 'at rest: nothing is added', text)


def test_nothing_to_remove(edited):
    lines = ('remove time foo', 'remove initial 1 velocity', 'remove solver', 'remove gravity 2')
    said = edited.hears(*lines, 'quit', why='nothing to remove')
    edited.checks.true(said.count(NOTHING) == len(lines) and 'Removed' not in said, 'nothing to remove: it is said', said)
    said = edited.hears('remove gravity', 'quit', why='gravity')
    edited.checks.true('Removed.' in said and NOTHING not in said, 'gravity: removed', said)


def test_words_are_no_names_of_files(edited):
    """A name with blanks stands in quotes."""
    said = edited.hears('output table = no table please', "'my table.dat'", '', 'both', 'time end = 2', "'my crank.nml'", 'done', why='names')
    edited.checks.equal(said.lower().count('one that has blanks in quotes'), 2, 'names: both are asked for again')
    edited.checks.equal(sorted(os.listdir(edited.folder)), ['my crank.nml', 'my table.dat', 'p.nml'], 'names: the files')
