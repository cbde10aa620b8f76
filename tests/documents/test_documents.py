"""The documents: their titles, links and places, and the commands that they show, which run in a scratch copy of the tree."""
import glob
import os

import pytest

from document_checks import blocks_of, check_commands, check_document
from mech9_cases import TREE, text_of

DOCUMENTS = sorted({os.path.relpath(path, TREE) for pattern in ('*.md', *(f'{folder}/**/*.md' for folder in ('bench', 'docs', 'tests', 'user_procs')))
                    for path in glob.glob(os.path.join(TREE, pattern), recursive=True)} - {'docs/reference/api.md'})
WITH_COMMANDS = [document for document in DOCUMENTS if any(blocks_of(text_of(os.path.join(TREE, document))))]


@pytest.mark.parametrize('document', DOCUMENTS)
def test_title_links_and_places(checks, document):
    check_document(checks, document)


@pytest.mark.parametrize('document', WITH_COMMANDS)
def test_commands(checks, build, mech9k, mech9d, tmp_path, document):
    check_commands(checks, [document], os.fspath(tmp_path), build.bin)
