"""A drive of an independent coordinate is refused in dynamics, where it would be left out: code 3, its place and a remedy.

usage: drives_in_dynamics.py MECH9K MECH9D
"""
import os
import sys
import tempfile

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '..', 'scripts'))
from mech9_cases import TREE, Checks, run, text_of

SLIDER_CRANK = os.path.join(TREE, 'examples', 'slider_crank', 'slider_crank.nml')
BODY = '\n&body link=2, mass=1.0, inertia=0.1,0.1,0.1,0,0,0 /\n&initial coordinate=1, position=0.4, velocity=10.0 /\n'


def main():
    mech9k, mech9d = map(os.path.abspath, sys.argv[1:3])
    checks = Checks()
    lines = text_of(SLIDER_CRANK).splitlines()
    number = 1 + next(i for i, line in enumerate(lines) if line.startswith('&drive'))
    with tempfile.TemporaryDirectory() as folder:
        driven, free, dependent = (os.path.join(folder, name) for name in ('driven.nml', 'free.nml', 'dependent.nml'))
        texts = {driven: '\n'.join(lines) + BODY,
                 free: '\n'.join(line for line in lines if not line.startswith('&drive')) + BODY,
                 dependent: '\n'.join(lines).replace('&drive coordinate=1', '&drive coordinate=2') + BODY}
        for path, text in texts.items():
            with open(path, 'w', encoding='utf-8') as file:
                file.write(text)
        for arguments in ((), ('--check',), ('--plan',)):
            done = run(mech9d, driven, '--no-write', *arguments, folder=folder)
            checks.equal(done.returncode, 3, f'{arguments}: a driven independent coordinate is refused')
            checks.true(f'driven.nml:{number}:1:' in done.stderr, f'{arguments}: with the place of its drive', done.stderr)
            checks.true('cannot be driven' in done.stderr and 'take this &drive away' in done.stderr
                        and 'mech9k' in done.stderr, f'{arguments}: with what to do', done.stderr)
        checks.equal(run(mech9d, driven, '--structure', folder=folder).returncode, 0, 'the structure alone is shown')
        checks.equal(run(mech9k, driven, '--no-write', folder=folder).returncode, 0, 'mech9k computes the same file')
        checks.equal(run(mech9d, free, '--no-write', folder=folder).returncode, 0, 'without the drive mech9d does')
        done = run(mech9d, dependent, '--no-write', folder=folder)
        checks.equal(done.returncode, 3, 'the drive of a dependent coordinate is a mistake in any program')
        checks.equal(done.stderr.count('dependent.nml:'), 1, 'which is told once')
    checks.finish()


main()
