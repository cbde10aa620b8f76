"""docs/tutorials/python.md: every line does what the page shows."""
import doctest
import os
import re

import pytest

from mech9_cases import TREE, text_of


def test_every_line(checks, mech9, tmp_path, monkeypatch, capsys):
    pytest.importorskip('xarray')
    monkeypatch.chdir(tmp_path)
    lines = '\n'.join(re.findall(r'```pycon\n(.*?)```', text_of(os.path.join(TREE, 'docs', 'tutorials', 'python.md')), re.S))
    runner = doctest.DocTestRunner(optionflags=doctest.ELLIPSIS | doctest.IGNORE_EXCEPTION_DETAIL | doctest.NORMALIZE_WHITESPACE)
    runner.run(doctest.DocTestParser().get_doctest(lines, {}, 'python.md', 'python.md', 0))
    checks.equal(runner.failures, 0, capsys.readouterr().out)
    checks.true(runner.tries > 40, 'the page has its lines')
