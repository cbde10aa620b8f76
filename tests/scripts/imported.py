"""Tools for the tests of imported robots: a folder with both programs, robots that are damaged at random, rotations."""
import math
import os
import random
import re

import numpy as np

from mech9_cases import read_table, run, text_of

DONE, USAGE, DATA, STRUCTURE, ASSEMBLY, FILE = 0, 2, 3, 4, 5, 8
# Some ten matrices are multiplied, and numbers of files are rounded to the last digit.
ROUND_OFF = 1e-13


class Session:
    """Both programs in a folder of their own."""

    def __init__(self, checks, folder, mech9k, mech9d):
        self.checks, self.folder, self.mech9k, self.mech9d = checks, folder, os.path.abspath(mech9k), os.path.abspath(mech9d)

    def write(self, name, text):
        mode = {'mode': 'wb'} if isinstance(text, bytes) else {'mode': 'w', 'encoding': 'utf-8'}
        with open(os.path.join(self.folder, name), **mode) as file:
            file.write(text)

    def text(self, name='out.nml'):
        return text_of(os.path.join(self.folder, name))

    def imports(self, robot, loops=None, program=None, name='robot.xml'):
        """The data file that an import makes."""
        self.write(name, robot)
        words = [name]
        if loops is not None:
            self.write('loops.xml', loops)
            words.append('loops.xml')
        done = run(program or self.mech9k, '--import', *words, '--out', 'out.nml', folder=self.folder)
        self.checks.equal(done.returncode, DONE, f'an import of {name} ends well: {done.stderr}')
        self.said = done.stderr
        return self.text()

    def table(self, program, data, *options):
        self.write('run.nml', data)
        done = run(program, 'run.nml', '--table', '-', *options, folder=self.folder)
        self.checks.equal(done.returncode, DONE, f'a run ends well: {done.stderr}')
        return read_table(done.stdout)

    def refuses(self, why, code, says, robot, *words):
        self.write('robot.xml', robot)
        done = run(self.mech9k, '--import', 'robot.xml', *words, folder=self.folder)
        self.checks.equal(done.returncode, code, f'{why}: exit code; {done.stderr}')
        self.checks.true(says in done.stderr, f'{why}: {says}', done.stderr)
        self.checks.equal(done.stdout, '', f'{why}: no data file')

    def without_expat(self):
        """Whether the programs are built without expat; then they tell so, and nothing else can be tested."""
        self.write('robot.xml', '<robot/>')
        done = run(self.mech9k, '--import', 'robot.xml', folder=self.folder)
        if 'without expat' not in done.stderr:
            return False
        self.checks.true(done.returncode == USAGE and 'libexpat1-dev' in done.stderr, 'a build without expat tells so', done.stderr)
        self.checks.left_out('the programs are built without expat (Debian: libexpat1-dev)')
        return True

    def survives(self, robots, trials=120):
        """Files that are cut or changed at random end with a known code and a message, or are imported to a file that is read."""
        source = random.Random(5)
        for trial in range(trials):
            text = bytearray(source.choice(robots).encode())
            how = source.randrange(4)
            at = source.randrange(len(text))
            if how == 0:
                del text[at:]
            elif how == 1:
                for _ in range(source.randrange(1, 6)):
                    text[source.randrange(len(text))] = source.randrange(256)
            elif how == 2:
                del text[at:at + source.randrange(60)]
            else:
                words = re.findall(rb'"[^"]*"', bytes(text))
                text = bytearray(bytes(text).replace(source.choice(words), source.choice(words + [b'"1e99"', b'""', b'"-0"', b'"nan"']), 1))
            self.write('robot.xml', bytes(text))
            done = run(self.mech9k, '--import', 'robot.xml', '--out', 'out.nml', folder=self.folder)
            known = done.returncode in (DONE, USAGE, DATA, STRUCTURE, ASSEMBLY)
            if not self.checks.true(known and 'Backtrace' not in done.stderr and done.stderr != '' and 'that was made' not in done.stderr,
                                 f'damage {trial} ends with a known code and a message', f'{done.returncode}: {done.stderr}\n{bytes(text)}'):
                return


def about(axis, angle):
    """The rotation about an axis of length one."""
    x = np.array([[0, -axis[2], axis[1]], [axis[2], 0, -axis[0]], [-axis[1], axis[0], 0]])
    return np.eye(3) + math.sin(angle) * x + (1 - math.cos(angle)) * x @ x


def rpy(angles):
    return about([0, 0, 1], angles[2]) @ about([0, 1, 0], angles[1]) @ about([1, 0, 0], angles[0])
