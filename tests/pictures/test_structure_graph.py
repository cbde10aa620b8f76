"""The structure drawn by --graph: read back by dot and compared with the links and pairs of the data files."""
import os
import re
import shlex
import subprocess
import xml.etree.ElementTree as xml

import pytest

from mech9_cases import PATIENCE, REFERENCE, TREE, run, text_of
from n_four_bar import data_file

FIG1 = os.path.join(TREE, 'examples', 'fig1', 'fig1.nml')
CASES = [('mech9k', 'kinematics_fig1'), ('mech9k', 'kinematics_fig1_driven_at_q1'), ('mech9k', 'kinematics_spatial_slider_crank'),
         ('mech9k', 'kinematics_bennett'), ('mech9d', 'dynamics_open_chain')]


@pytest.fixture
def dot(checks):
    """Tests that take it are left out where Graphviz is not installed."""
    if not checks.has('dot', 'graphviz'):
        pytest.skip(checks.missing[-1])


def pairs_of(data):
    """{coordinate: (links, kind, independent)} of a data file with plain &pair groups."""
    text = re.sub(r'!.*', '', text_of(data))
    cq = re.search(r'cq\s*=\s*([\d\s,]+)', text).group(1)
    independent = {int(word) for word in re.findall(r'\d+', cq)}
    found = {}
    for group in re.findall(r'&pair(.*?)/', text, re.S):
        k = int(re.search(r'coordinate\s*=\s*(\d+)', group).group(1))
        links = frozenset(map(int, re.search(r'links\s*=\s*(\d+)\s*,\s*(\d+)', group).groups()))
        kind = re.search(r"kind\s*=\s*'(\w+)'", group).group(1)
        found[k] = links, kind, k in independent
    return found


@pytest.mark.parametrize('program, name', CASES)
def test_graph_is_that_of_the_data_file(checks, dot, build, tmp_path, program, name):
    """As dot reads it from the text."""
    program, data = build.program(program), os.path.join(REFERENCE, name + '.nml')
    done = run(program, data, '--graph', 'x.dot', folder=tmp_path)
    if not checks.equal((done.returncode, done.stdout), (0, ''), f'{name}: a graph, and no run'):
        return
    plain = subprocess.run(['dot', '-Tplain', 'x.dot'], cwd=tmp_path, capture_output=True, text=True, timeout=60 * PATIENCE)
    if not checks.equal(plain.returncode, 0, f'{name}: dot reads it'):
        return
    expected, nodes, drawn = pairs_of(data), set(), {}
    # an edge in plain form: edge tail head n x1 y1 .. xn yn [label xl yl] style color
    for words in map(lambda line: shlex.split(line, posix=True), plain.stdout.splitlines()):
        if words[0] == 'node':
            nodes.add(int(words[1]))
        elif words[0] == 'edge':
            label = words[4 + 2 * int(words[3])]
            match = re.fullmatch(r' +q(\d+) (\w+)\\?l( +independent\\?l)?', label)
            if checks.true(match, f'{name}: an edge is labelled', label):
                drawn[int(match.group(1))] = frozenset(map(int, words[1:3])), match.group(2), bool(match.group(3))
    checks.equal(drawn, expected, f'{name}: pairs, kinds and independent coordinates')
    checks.equal(nodes, set().union(*(links for links, _, _ in expected.values())), f'{name}: links')
    check_blocks(checks, program, data, text_of(tmp_path / 'x.dot'))


def check_blocks(checks, program, data, text):
    """The clusters hold each link but the frame once; an edge ends in its block or is what closes a chain."""
    clusters = re.findall(r'subgraph cluster_\d+ \{(.*?)\n  \}', text, re.S)
    members = [int(link) for cluster in clusters for link in re.findall(r'^ +(\d+) \[', cluster, re.M)]
    checks.equal(len(members), len(set(members)), f'{data}: no link in two blocks')
    checks.equal(set(members) | {1}, set(map(int, re.findall(r'(\d+) --', text))) | set(map(int, re.findall(r'-- (\d+)', text))),
                 f'{data}: each link in a block')
    plan = run(program, data, '--plan').stdout
    checks.equal(len(clusters), len(re.findall(r'^block \d+:', plan, re.M)), f'{data}: as many blocks as in the plan')


def test_hostile_name_and_title(checks, dot, mech9k, tmp_path):
    title = 'it\'s "x" \\N \\ & < {a|b} `touch harm` $(touch harm); // # é'
    setting = "mechanism.title='" + title.replace("'", "''") + "'"
    name = 'a "b" ; $(touch harm)\n`c`'
    done = run(mech9k, FIG1, '--set', setting, '--graph', name + '.svg', folder=tmp_path)
    if checks.equal(done.returncode, 0, 'a picture with a hostile name and title'):
        words = [element.text for element in xml.parse(tmp_path / (name + '.svg')).getroot().iter()
                 if element.tag.endswith('}text')]
        checks.true(title in words, 'the title as it is', words)
        checks.true('1 frame' in words, 'the frame is marked', words)
        checks.true((tmp_path / (name + '.dot')).exists(), 'the text beside it')
    checks.true('harm' not in os.listdir(tmp_path), 'nothing was carried out')


def test_png(checks, dot, mech9k, tmp_path):
    run(mech9k, FIG1, '--graph', 'x.png', folder=tmp_path)
    checks.true((tmp_path / 'x.png').read_bytes()[:4] == b'\x89PNG', 'a PNG')


def test_hundreds_of_links(checks, dot, mech9d, tmp_path):
    (tmp_path / 'many.nml').write_text(data_file(160), encoding='utf-8')
    done = run(mech9d, 'many.nml', '--graph', 'many.svg', folder=tmp_path)
    checks.true(done.returncode == 0 and text_of(tmp_path / 'many.svg').count('class="node"') == 322,
                'hundreds of links', done.stderr)


def test_no_folder(checks, mech9k, tmp_path):
    done = run(mech9k, FIG1, '--graph', 'no/such/folder.dot', folder=tmp_path)
    checks.true(done.returncode == 8 and 'no/such/folder.dot' in done.stderr, 'a folder that is not there', done.stderr)


def test_no_dot(checks, mech9k, tmp_path, monkeypatch):
    monkeypatch.setenv('PATH', os.fspath(tmp_path))
    done = run(mech9k, FIG1, '--graph', 'x.svg', folder=tmp_path)
    quiet = run(mech9k, FIG1, '--graph', 'x.svg', '--quiet', folder=tmp_path)
    checks.true(done.returncode == 0 and 'dot -Tsvg -o x.svg x.dot' in done.stderr, 'no dot: a word how to draw it', done.stderr)
    checks.equal(quiet.stderr, done.stderr, 'no dot: told to who wants quiet, too')
    checks.equal(os.listdir(tmp_path), ['x.dot'], 'the text is kept')
