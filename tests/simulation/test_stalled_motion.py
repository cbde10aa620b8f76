"""A motion that needs ever shorter steps: it says where it stands, and the rows before are in the file."""
import os
import re
import signal
import subprocess
import time

from free_delta import delta
from mech9_cases import text_of

# two rods whose loads read angles in gimbal lock: the motion needs ever shorter steps
STUCK = ("&load kind='coordinate', coordinate=6, damping=1e-4 /\n"
         "&load kind='coordinate', coordinate=10, stiffness=0.01 /\n")


def test_a_motion_that_makes_no_progress_says_where_it_stands(checks, mech9d, tmp_path):
    path = tmp_path / 'stuck.nml'
    path.write_text(delta(2e-5, more=STUCK), encoding='utf-8')
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
                # the words after ten seconds
                said = ''
                while 'no new row' not in said and time.monotonic() < started + 60 and process.poll() is None:
                    time.sleep(0.5)
                    said = text_of(tmp_path / 'words')
                line = [line for line in said.splitlines() if 'no new row' in line]
                checks.true(len(line) > 0, 'a line says so', said)
                if line:
                    checks.true(re.search(r't = 0\.28\d* s, in steps of \S+ s; q\d+ moves fastest, at \S+ deg/s', line[0]) is not None,
                                'where, with which steps, and which coordinate is fastest', line[0])
            finally:
                process.send_signal(signal.SIGINT)
                process.wait(timeout=60)
        checks.equal(process.returncode, 130, 'the user interrupts it')
