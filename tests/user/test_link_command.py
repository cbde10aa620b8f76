"""mech9-link, of the build tree and installed: several procedures in one program, and clear words on what is wrong with a call."""
import os
import re
import shutil

import pytest

from mech9_cases import run, text_of

BEYOND = """&mechanism links=2, coordinates=1 /
&structure cq=1 /
&pair coordinate=1, links=1,2, kind='prismatic', axis=1,0,0 /
&initial coordinate=1, position=0.0, velocity=0.0 /
&body link=2, mass=1.0 /
&load kind='user' /
&user parameters=1.0, 1 /
&time start=0.0, end=1.0, intervals=10 /
"""


def expect(checks, code, text, *words, folder=None):
    """The command ends with this code and says this."""
    done = run(*words, folder=folder, timeout=600)
    said = done.stdout + done.stderr
    checks.equal(done.returncode, code, f'{words}: exit code; {said}')
    checks.true(text in said, f'{words}: says {text}', said)


def spoiled(source, old, new, path):
    """A source with other words in it, which must stand there."""
    text = text_of(source)
    assert old in text
    path.write_text(text.replace(old, new), encoding='utf-8')
    return path


@pytest.mark.parametrize('options, names', (
    ([], ('user_pair', 'user_drive', 'user_force', 'user_coupling')),
    (['-v'], ('user_pair_values', 'user_drive_values', 'user_coupling_values'))), ids=('Taylor', 'values'))
def test_several_templates_in_one_program(checks, link, tmp_path, options, names):
    """Names may have blanks, and every template compiles."""
    command, samples = link
    folder = tmp_path / 'with blank'
    shutil.copytree(os.path.join(samples, 'templates'), folder)
    files = [folder / f'{name}.f90' for name in names]
    expect(checks, 0, f"with your {' '.join(sorted(names))})", command, *options, '-o', folder / 'all', *files)


# exit code, words of the message, and the words of the call
WRONG = ((0, 'mech9-link -o NAME FILE...', ['--help']),
         (0, 'mech9-link 0.', ['--version']),
         (2, 'no name given', ['SAMPLES/trammel/trammel.f90']),
         (2, 'mech9-link --auto mechanism.nml -o rig', ['--auto', 'mechanism.nml']),
         (2, 'no file given', ['-o', 'none']),
         (2, '-o needs a name', ['-o']),
         (2, 'unknown option --fast', ['--fast', '-o', 'none', 'SAMPLES/trammel/trammel.f90']),
         (2, 'what is it?', ['-o', 'none', 'SAMPLES/trammel/trammel.nml']),
         (8, 'there is no file nowhere.f90', ['-o', 'none', 'nowhere.f90']),
         (8, 'there is no folder', ['-o', 'nowhere/none', 'SAMPLES/trammel/trammel.f90']),
         (1, 'none of the files holds a user procedure', ['-o', 'none', 'SAMPLES/cam_follower/oldcam.f']))


@pytest.mark.parametrize('code, text, words', WRONG, ids=[text for _, text, _ in WRONG])
def test_calls(checks, link, tmp_path, code, text, words):
    command, samples = link
    expect(checks, code, text, command, *(word.replace('SAMPLES', str(samples)) for word in words), folder=tmp_path)
    checks.equal(os.listdir(tmp_path), [], 'nothing is left behind')


def test_compiler_that_is_not_here(checks, link, tmp_path, monkeypatch):
    command, samples = link
    monkeypatch.setenv('MECH9_FC', 'no-such-compiler')
    expect(checks, 1, 'the compiler no-such-compiler is not here', command, '-o', tmp_path / 'none', os.path.join(samples, 'trammel', 'trammel.f90'))
    checks.equal(os.listdir(tmp_path), [], 'nothing is left behind')


def test_wrong_argument_list(checks, link, tmp_path):
    """The compiler holds the user's argument list against the hook's."""
    command, samples = link
    wrong = spoiled(os.path.join(samples, 'trammel', 'trammel.f90'), 'type(taylor), intent(in) :: q', 'real(wp), intent(in) :: q',
                    tmp_path / 'wrong.f90')
    expect(checks, 1, 'does not compile', command, '-o', tmp_path / 'none', wrong)
    checks.equal(os.listdir(tmp_path), ['wrong.f90'], 'nothing is left behind')


def test_debug(checks, link, tmp_path):
    """Subscripts in the user's code are checked, which a call of a procedure of ours need not be told."""
    command, samples = link
    source = spoiled(os.path.join(samples, 'templates', 'user_force.f90'), 'parameters(1), 0.0_wp, 0.0_wp',
                     'parameters(1)*state%dq(nint(parameters(2))), 0.0_wp, 0.0_wp', tmp_path / 'beyond.f90')
    (tmp_path / 'beyond.nml').write_text(BEYOND, encoding='utf-8')
    expect(checks, 0, 'with your user_force)', command, '--debug', '-o', tmp_path / 'beyond', source)
    expect(checks, 0, '', tmp_path / 'beyond_d', '--no-write', tmp_path / 'beyond.nml')
    expect(checks, 2, "'state%dq' above upper bound", tmp_path / 'beyond_d', '--no-write', tmp_path / 'beyond.nml', '--set', 'user.parameters=1,9')


def test_manual_page(checks, build):
    """The manual page has the words of --help that begin options, and no faults of markup."""
    page = text_of(os.path.join(build.folder, 'pages', 'mech9-link.1')).replace('\\-', '-')
    said = run(build.program('mech9-link'), '--help').stdout
    for word in re.findall(r'(?<![\w-])--?[A-Za-z][\w-]*', said):
        checks.true(word in page, f'the page has {word}')
    if shutil.which('groff'):
        done = run('groff', '-man', '-ww', '-Tascii', os.path.join(build.folder, 'pages', 'mech9-link.1'))
        checks.equal(done.stderr, '', 'markup without warnings')
