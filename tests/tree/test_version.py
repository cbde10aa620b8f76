"""The version stands once, in CMakeLists.txt; others that name it agree."""
import os
import re

from mech9_cases import TREE, run, text_of


def test_version(checks, build, mech9k, mech9d):
    version = re.search(r'project\(MECH9 VERSION ([0-9.]+)', text_of(os.path.join(TREE, 'CMakeLists.txt'))).group(1)
    citation = re.search(r'^version: (\S+)$', text_of(os.path.join(TREE, 'CITATION.cff')), re.M).group(1)
    changes = re.search(r'^## ([0-9.]+)', text_of(os.path.join(TREE, 'CHANGELOG.md')), re.M).group(1)
    checks.equal((citation, changes, build.version), (version, version, version), 'CITATION.cff, CHANGELOG.md and the build')
    for program in (mech9k, mech9d):
        # a commit follows where the sources are in a repository and git is there
        checks.true(re.search(rf' {re.escape(version)}[ ,]', run(program, '--version').stdout), f'{os.path.basename(program)} --version')
    wanted = f"find_package(mech9 {'.'.join(version.split('.')[:2])} REQUIRED)"
    asking = ('docs/how-to/user-procedures.md', 'docs/how-to/library.md', 'examples/library/CMakeLists.txt',
              'examples/c/CMakeLists.txt', 'tests/user/user_project/CMakeLists.txt')
    checks.true(f'mech9-{version}-py3-none-' in text_of(os.path.join(TREE, 'README.md')), 'README.md names the wheel of this version')
    for name in asking:
        checks.true(wanted in text_of(os.path.join(TREE, name)), f'{name} asks for this version')
