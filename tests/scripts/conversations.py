"""Conversations with mech9k and mech9d, through a pipe and at a terminal.

A script of a conversation is a list of steps (prompt, answer): the prompt is a part of what is asked, the
answer the line that is typed then.
"""
import re

from mech9_cases import run
from pseudo_terminal import Terminal


def answers_of(steps):
    """The answers as the text of a pipe."""
    return ''.join(answer + '\n' for _, answer in steps)


def in_one_line(text):
    """Text without its line ends: where long lines are broken does not matter."""
    return re.sub(r'\s+', ' ', text)


def first_missing(text, steps):
    """The first step whose prompt does not come after those before it; None where all do."""
    at = 0
    text = in_one_line(text)
    for number, (prompt, _) in enumerate(steps):
        found = text.find(prompt, at)
        if found < 0:
            return number, prompt
        at = found + len(prompt)
    return None


class Talk(Terminal):
    """A conversation at a terminal; what is expected may be broken into lines."""

    def expect(self, text):
        """Wait until a text is said behind what was expected before; whether it was in time."""
        while True:
            said = in_one_line(self.plain())
            found = said.find(text, self.place)
            if found >= 0:
                self.place = found + len(text)
                return True
            if not self.read(self.patience):
                return False

    def play(self, steps):
        """Answer prompt by prompt; the first prompt that does not come, or None."""
        for prompt, answer in steps:
            if not self.expect(prompt):
                return prompt
            self.type(answer + '\n')
        return None


def piped(program, *arguments, folder, answers):
    """A conversation through a pipe: the completed process. It takes a fraction of a second."""
    return run(program, *arguments, folder=folder, stdin=answers, timeout=60)
