"""Conversations with mech9k and mech9d, through a pipe and at a terminal.

A script of a conversation is a list of steps (prompt, answer): the prompt is a part of what is asked, the
answer the line that is typed then.
"""
import os
import pty
import re
import select
import signal
import subprocess
import time

PATIENCE = 60.0    # seconds for one answer of a program: only a hanging one takes so long
# moving the cursor, colours, the terminal's modes: what an editor of lines writes besides the text
ESCAPES = re.compile(rb'\x1b(\[[0-9;?]*[ -/]*[@-~]|[()][0-9A-Za-z]|[=>])')


def has_terminals():
    """Whether this machine can make a pseudo-terminal."""
    try:
        for end in pty.openpty():
            os.close(end)
        return True
    except OSError:
        return False


def answers_of(steps):
    """The answers as the text of a pipe."""
    return ''.join(answer + '\n' for _, answer in steps)


def in_one_line(text):
    """Text without its line ends: where long lines are broken does not matter."""
    return re.sub(r'\s+', ' ', text)


def prompts_in_order(text, steps):
    """The first step whose prompt does not come after those before it; None where all do."""
    at = 0
    text = in_one_line(text)
    for number, (prompt, _) in enumerate(steps):
        found = text.find(prompt, at)
        if found < 0:
            return number, prompt
        at = found + len(prompt)
    return None


class Terminal:
    """A program at a pseudo-terminal of 80 columns and 24 lines; its standard output goes to the terminal too."""

    def __init__(self, program, *arguments, folder, term='dumb'):
        self.heard = b''
        self.at = 0
        environment = dict(os.environ, TERM=term, NO_COLOR='1', COLUMNS='80', LINES='24', HOME=folder)
        environment.pop('XDG_STATE_HOME', None)
        self.child, self.master = pty.fork()
        if self.child == 0:
            try:
                os.chdir(folder)
                os.execve(program, [program, *arguments], environment)
            finally:
                os._exit(127)

    def text(self):
        return ESCAPES.sub(b'', self.heard).replace(b'\r', b'').decode(errors='replace')

    def listen(self, seconds):
        """Take what comes within some seconds; false where the program has gone."""
        ready, _, _ = select.select([self.master], [], [], seconds)
        if not ready:
            return True
        try:
            piece = os.read(self.master, 65536)
        except OSError:
            return False
        self.heard += piece
        return piece != b''

    def wait_for(self, prompt):
        """Wait until something is said, after what was waited for before; false where it never is."""
        end = time.monotonic() + PATIENCE
        while time.monotonic() < end:
            said = in_one_line(self.text())
            found = said.find(prompt, self.at)
            if found >= 0:
                self.at = found + len(prompt)
                return True
            if not self.listen(1.0):
                return in_one_line(self.text()).find(prompt, self.at) >= 0
        return False

    def type(self, keys):
        os.write(self.master, keys.encode())

    def play(self, steps):
        """Answer prompt by prompt; the first prompt that does not come, or None."""
        for prompt, answer in steps:
            if not self.wait_for(prompt):
                return prompt
            self.type(answer + '\n')
        return None

    def hang_up(self):
        """Close the terminal, as when its window is closed."""
        os.close(self.master)
        self.master = None
        return self.end()

    def end(self):
        """Wait for the program; its exit code, or minus the number of the signal that ended it."""
        limit = time.monotonic() + PATIENCE
        while time.monotonic() < limit:
            done, status = os.waitpid(self.child, os.WNOHANG)
            if done:
                if self.master is not None:
                    while self.listen(0.2) and select.select([self.master], [], [], 0)[0]:
                        pass
                    os.close(self.master)
                return os.waitstatus_to_exitcode(status)
            if self.master is not None:
                self.listen(0.05)
            else:
                time.sleep(0.05)
        os.kill(self.child, signal.SIGKILL)
        os.waitpid(self.child, 0)
        return None


def piped(program, *arguments, folder, answers):
    """A conversation through a pipe: the completed process."""
    return subprocess.run([program, *arguments], cwd=folder, input=answers, capture_output=True, text=True,
                          errors='replace', timeout=PATIENCE)
