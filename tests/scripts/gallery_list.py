"""The gallery as examples/list.txt tells it: one Example for each line. Needs nothing but Python."""
import collections
import os

from mech9_cases import TREE

EXAMPLES = os.path.join(TREE, 'examples')

Example = collections.namedtuple('Example', 'name program data procedures sentence')


def examples():
    """All lines of the list; data is the path of the data file, procedures a list of paths within the tree."""
    found = []
    with open(os.path.join(EXAMPLES, 'list.txt'), encoding='utf-8') as file:
        for line in file:
            if not line.startswith('#'):
                name, program, data, procedures, sentence = (part.strip() for part in line.split('|'))
                found.append(Example(name, program, os.path.join(EXAMPLES, name, data), procedures.split(), sentence))
    return found
