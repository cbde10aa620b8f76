"""The documents of the examples: their titles, links and places, and the commands that they show, which run in one scratch copy of the tree."""
import glob
import os

import pytest

from document_checks import check_commands, check_document
from mech9_cases import TREE

DOCUMENTS = ['examples/README.md'] + sorted(os.path.relpath(path, TREE) for path in glob.glob(os.path.join(TREE, 'examples', '*', 'README.md')))


@pytest.mark.parametrize('document', DOCUMENTS)
def test_title_links_and_places(checks, document):
    check_document(checks, document)


def test_commands(checks, build, mech9k, mech9d, tmp_path):
    check_commands(checks, DOCUMENTS, os.fspath(tmp_path), build.bin)
