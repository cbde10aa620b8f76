"""A motion that needs ever shorter steps: it says where it stands, and the rows before are in the file. Where no step leads on, since a
ball joint with loaded angles is in gimbal lock or closed chains are singular, the motion ends and says why."""
import os
import re
import signal
import subprocess
import time

import pytest

from free_delta import delta
from mech9_cases import run, text_of

# a slide on a spring whose damper grows from 0.28 s on to 1e13 N s/m: an explicit method needs steps of 1e-13 s
STUCK = """&mechanism angle_unit='deg' /
&structure cq=1,2 /
&pair coordinate=1, links=1,2, kind='prismatic', axis=1,0,0 /
&pair coordinate=2, links=2,3, kind='revolute', axis=0,0,1 /
&body link=2, mass=1 /
&body link=3, mass=1, centre=0,-1,0 /
&load kind='coordinate', coordinate=1, stiffness=100 /
&load kind='coordinate', coordinate=1, damping=1e13, law='segments', times=0,0.281,0.3,1, values=0,0,1,1, laws='cycloidal' /
&gravity acceleration=0,-9.81,0 /
&initial coordinate=1, position=0.1, velocity=0 /
&initial coordinate=2, position=20, velocity=0 /
&time end=0.33, intervals=33 /
&solver method='prince-dormand', maximum_steps=1000000000 /
"""
# rods of a free delta robot whose angles are loaded in gimbal lock: stiffness at 0, so that the motion comes to the lock itself
LOADS = {
    'stiffness on the third angle': ("&load kind='coordinate', coordinate=6, stiffness=0.01 /\n", 6),
    'damping on the second angle': ("&load kind='coordinate', coordinate=5, damping=1e-3 /\n", 5),
    'two balls': ("&load kind='coordinate', coordinate=6, damping=1e-4 /\n"
                  "&load kind='coordinate', coordinate=10, stiffness=0.01 /\n", 6),
}


def interrupt(process):
    process.send_signal(signal.SIGINT)
    process.wait(timeout=60)


def pass_ten_seconds(started, processes):
    """Stop programs until ten seconds have passed by the clock, so that they do not take the processor for it; then let them go on."""
    for process in processes:
        process.send_signal(signal.SIGSTOP)
    time.sleep(max(0.0, started + 10.5 - time.monotonic()))
    for process in processes:
        process.send_signal(signal.SIGCONT)


# a four-bar whose crank makes 1.6e9 turns from one output to the next
ENDLESS = """&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&pair coordinate=2, links=2,3, kind='revolute', axis=0,0,1, point=0.05,0,0 /
&pair coordinate=3, links=1,4, kind='revolute', axis=0,0,1, point=0.2,0,0 /
&pair coordinate=4, links=3,4, kind='revolute', axis=0,0,1, point=0.2,0.2,0 /
&drive coordinate=1, kind='polynomial', coefficients=0,1e6 /
&time end=2e4, intervals=2 /
&parameter name='rate', sets='drive(1).coefficients(2)', low=1e6, high=2e6, count=3 /
&quantity name='top', take='max', of='q4' /
&study kind='grid' /
&objective kind='quantity', of='top', goal=0.1 /
"""
# options, and the words before the place
WITHOUT_ROWS = {
    'a driven motion': ([], r'no new row for 1\d s: the motion'),
    'a study': (['--study'], r'no result of run 1 after 1\d s: it'),
    'a search': (['--optimize', '--starts', '1'], None),
    'a silent run': (['--quiet'], None),
}


def test_a_motion_that_makes_no_progress_says_where_it_stands(checks, mech9d, tmp_path):
    path = tmp_path / 'stuck.nml'
    path.write_text(STUCK, encoding='utf-8')
    table = tmp_path / 'stuck.dat'
    started = time.monotonic()
    with open(tmp_path / 'words', 'w+', encoding='utf-8') as words:
        with subprocess.Popen([mech9d, os.fspath(path), '--table', os.fspath(table)], cwd=tmp_path, stderr=words) as process:
            try:
                # the rows before: ten times the second in which they shall be there, since the machine may be busy
                rows = 0
                while rows < 29 and time.monotonic() < started + 10:
                    time.sleep(0.2)
                    files = [name for name in os.listdir(tmp_path) if 'stuck.dat' in name]
                    rows = max([sum(line[:1] not in '#' for line in text_of(tmp_path / name).splitlines() if line) - 1 for name in files],
                               default=0)
                checks.true(rows >= 29, 'the rows before stand in the file while none follows', rows)
                pass_ten_seconds(time.monotonic(), [process])
                said = ''
                while 'no new row' not in said and time.monotonic() < started + 60 and process.poll() is None:
                    time.sleep(0.5)
                    said = text_of(tmp_path / 'words')
                line = [line for line in said.splitlines() if 'no new row' in line]
                checks.true(len(line) > 0, 'a line says so', said)
                if line:
                    checks.true(re.search(r't = 0\.28\d* s, in steps of \S+ s; q2 moves fastest, at \S+ deg/s', line[0]) is not None,
                                'where, with which steps, and which coordinate is fastest', line[0])
            finally:
                interrupt(process)
        checks.equal(process.returncode, 130, 'the user interrupts it')


def test_runs_for_an_accuracy_say_where_they_stand(checks, mech9d, tmp_path):
    """No row can be there before these runs have ended: ten thousand oscillations of a kilohertz take longer than ten seconds."""
    path = tmp_path / 'slow.nml'
    path.write_text("""&structure cq=1 /
&pair coordinate=1, links=1,2, kind='prismatic', axis=1,0,0 /
&body link=2, mass=1 /
&load kind='coordinate', coordinate=1, stiffness=4e7 /
&initial coordinate=1, position=1, velocity=0 /
&time end=100, intervals=10 /
&solver accuracy=1e-6 /
""", encoding='utf-8')
    with open(tmp_path / 'words', 'w+', encoding='utf-8') as words:
        started = time.monotonic()
        with subprocess.Popen([mech9d, os.fspath(path), '--table', 'slow.dat'], cwd=tmp_path, stderr=words) as process:
            try:
                said = ''
                time.sleep(1)
                pass_ten_seconds(started, [process])
                while 'no row yet' not in said and time.monotonic() < started + 60 and process.poll() is None:
                    time.sleep(0.5)
                    said = text_of(tmp_path / 'words')
                checks.true(re.search(r'mech9d: no row yet after 1\d s: a run that tells the accuracy is at t = \S+ s, in steps of \S+ s', said)
                            is not None, 'a line says where the run stands', said)
            finally:
                interrupt(process)
        checks.equal(process.returncode, 130, 'the user interrupts it')


def test_long_ways_between_two_outputs_say_where_they_stand(checks, mech9k, tmp_path):
    """All at once, because ten seconds pass before each speaks. Each ends soon after the user has interrupted it, though no output comes."""
    path = tmp_path / 'endless.nml'
    path.write_text(ENDLESS, encoding='utf-8')
    processes, said = {}, dict.fromkeys(WITHOUT_ROWS, '')
    started = time.monotonic()
    try:
        for k, (name, (options, _)) in enumerate(WITHOUT_ROWS.items()):
            with open(tmp_path / f'words{k}', 'w', encoding='utf-8') as words:
                processes[name] = subprocess.Popen([mech9k, os.fspath(path), '--table', f'{k}.dat', *options], cwd=tmp_path, stderr=words)
        time.sleep(2)
        pass_ten_seconds(time.monotonic(), processes.values())
        while time.monotonic() < started + 100:
            said = {name: text_of(tmp_path / f'words{k}') for k, name in enumerate(WITHOUT_ROWS)}
            if all(' is at t = ' in said[name] for name, (_, words) in WITHOUT_ROWS.items() if words):
                break
            time.sleep(0.5)
    finally:
        for process in processes.values():
            process.send_signal(signal.SIGINT)
        for process in processes.values():
            process.wait(timeout=60)
    for name, (_, words) in WITHOUT_ROWS.items():
        checks.equal(processes[name].returncode, 130, f'{name}: the user interrupts it')
        if words:
            checks.true(re.search(rf'mech9k: {words} is at t = \S+ s, in steps of \S+ s; q[12] moves fastest, at -?[12]\S*e6 rad/s\n', said[name])
                        is not None, f'{name}: a line says where it stands', said[name])
    checks.equal(said['a silent run'], '', 'a silent run says nothing')
    rows = [line for line in text_of(tmp_path / '0.dat').splitlines() if line.split()[0][:1].isdigit()]
    checks.equal(len(rows), 1, 'the row at the start is in the table')


@pytest.mark.parametrize('load', LOADS)
def test_a_load_on_an_angle_in_gimbal_lock_ends_the_motion(checks, mech9d, tmp_path, load):
    """The torque of such a load has no limit in the lock: T a1 = 0 and T a3 = Q contradict each other where both axes are parallel."""
    more, coordinate = LOADS[load]
    path = tmp_path / 'locked.nml'
    path.write_text(delta(2e-5, more=more), encoding='utf-8')
    done = run(mech9d, path, '--table', 'locked.dat', folder=tmp_path)
    checks.equal(done.returncode, 6, f'{load}: it ends by the code of singular positions')
    checks.true(re.search(rf'the ball joint of coordinates 4, 5, 6 comes to gimbal lock at t = 0\.28\d* s: .*A load on coordinate {coordinate} '
                          'determines no torque', done.stderr) is not None, f'{load}: it names the joint and the load', done.stderr)
    checks.true(sum(line[:1] not in '#' for line in text_of(tmp_path / 'locked.dat').splitlines() if line) - 1 == 29,
                f'{load}: the rows before are there')


@pytest.mark.parametrize('spin', [0.0, 2e-5])
@pytest.mark.parametrize('start', [-20, 1])
def test_a_free_delta_with_vertical_rods_names_the_singular_position(checks, mech9d, tmp_path, spin, start):
    """Rods that are all vertical let the platform turn about the vertical while the arms stand still: the chains have lost a rank there,
    whatever coordinates are independent. Neither a held angle nor gimbal lock is the cause. The fall begins above, or close by."""
    path = tmp_path / 'vertical.nml'
    text = re.sub(r'(&initial coordinate=[123], position=)0', rf'\g<1>{start}', delta(spin, vertical=True))
    path.write_text(text, encoding='utf-8')
    done = run(mech9d, path, '--table', 'vertical.dat', folder=tmp_path)
    checks.equal(done.returncode, 6, 'it ends by the code of singular positions')
    checks.true(re.search(r'closed chains 1, 2, 3, 4, 5 together .* comes? to a singular position at t = \S+ s', done.stderr) is not None,
                'it names the chains', done.stderr)
    checks.true('held at' not in done.stderr.splitlines()[-1] and 'gimbal' not in done.stderr, 'and nothing else', done.stderr)
