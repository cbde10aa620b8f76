"""Values of Python as the text of a data file."""
from __future__ import annotations

import keyword
import math
from typing import Any, Mapping

import numpy as np

from ._errors import UsageError

# The groups of the words that a run takes.
_RUN_GROUPS = {
    'time': ('start', 'end', 'intervals', 'at'),
    'solver': ('method', 'accuracy', 'relative_tolerance', 'absolute_tolerance', 'maximum_steps'),
    'output': ('coordinates', 'derivatives', 'energies', 'reactions', 'reaction_pairs', 'drive_forces', 'sensitivities', 'gradients',
               'poses', 'conditioning', 'links', 'poles', 'reaction_magnitudes', 'reaction_axes'),
}


def written(value: Any) -> str:
    """A value as a data file has it: numbers with all their digits, texts in quotes, lists with commas."""
    if isinstance(value, (bool, np.bool_)):
        return '.true.' if value else '.false.'
    if isinstance(value, (int, np.integer)):
        return str(int(value))
    if isinstance(value, (float, np.floating)):
        if not math.isfinite(value):
            raise UsageError(f'{value} is no number that a data file can have', 2)
        return repr(float(value))
    if isinstance(value, str):
        if any(ord(letter) < 32 for letter in value):
            raise UsageError('a text of a data file cannot have line ends', 2)
        return "'" + value.replace("'", "''") + "'"
    if isinstance(value, np.ndarray):
        value = value.ravel().tolist()
    if isinstance(value, (list, tuple, range)):
        if not value:
            raise UsageError('a list of values must not be empty', 2)
        return ','.join(written(one) for one in value)
    raise UsageError(f'{value!r} is no number, text, truth value or list of these', 2)


def name_of(word: str) -> str:
    """A name of a data file; a word of Python may be written with an underscore behind it: is_, from_."""
    return word[:-1] if word.endswith('_') and keyword.iskeyword(word[:-1]) else word


def group(name: str, words: Mapping[str, Any]) -> str:
    """A group with its names and values."""
    if not name.isidentifier():
        raise UsageError(f'{name!r} is no name of a group', 2)
    return f'&{name} ' + ', '.join(f'{name_of(word)}={written(value)}' for word, value in words.items()) + ' /'


def run_setting(word: str, value: Any) -> str:
    """A word of a run as a setting of its group."""
    for name, words in _RUN_GROUPS.items():
        if word in words:
            return f'{name}.{word}={written(value)}'
    raise UsageError(f'a run has no word {word!r}; it takes '
                     + ', '.join(one for words in _RUN_GROUPS.values() for one in words), 2)
