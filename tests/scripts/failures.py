"""The kinds of failures: the modules that hold them, by the table of ranges in src/base/failure.f90, and their constants."""
import os
import re

from mech9_cases import TREE, text_of

BASE = 'base/failure.f90'
RANGE = re.compile(r'^!> +(\d+) to +(\d+)   src/(\S+)$', re.M)
KIND = re.compile(r'^  integer, parameter :: (failure_\w+) = (\d+)', re.M)
LAST = re.compile(r'^  integer, parameter :: (last_\w+) = (failure_\w+)$', re.M)


def source(path):
    """The text of a module of kinds; its path is told from src."""
    return text_of(os.path.join(TREE, 'src', *path.split('/')))


def ranges():
    """(path from src, first number, last number) of each module of kinds."""
    return [(path, int(first), int(last)) for first, last, path in RANGE.findall(source(BASE))]


def kinds():
    """(name, number, path from src) of each kind."""
    return [(name, int(number), path) for path, _, _ in ranges() for name, number in KIND.findall(source(path))]


def last_kinds(path):
    """(name, kind) of the constants by which a module tells its last kind."""
    return LAST.findall(source(path))
