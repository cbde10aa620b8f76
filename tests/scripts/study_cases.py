"""Studies in a folder of their own, as the tests of their files make them."""
import os

from mech9_cases import run


class StudyCases:
    """A folder for the files of studies, and the checks. Studies are made with the options that all of them have."""

    def __init__(self, checks, folder, *options):
        self.checks, self.folder, self.options = checks, folder, options

    def path(self, name):
        return os.path.join(self.folder, name)

    def write(self, text, name='case.nml'):
        with open(self.path(name), 'w', encoding='utf-8') as file:
            file.write(text)
        return self.path(name)

    def study(self, program, text, *more, why, code=0):
        """The messages of a study."""
        done = run(program, self.write(text), '--study', *self.options, *more, folder=self.folder)
        self.checks.true(done.returncode == code, f'{why}: ends with {code}', f'{done.returncode}: {done.stderr}')
        return done.stderr
