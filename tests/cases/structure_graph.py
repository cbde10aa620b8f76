"""The structure drawn by --graph: read back by dot and compared with the links and pairs of the data files.

usage: structure_graph.py MECH9K MECH9D
"""
import os
import re
import shlex
import subprocess
import sys
import tempfile
import xml.etree.ElementTree as xml

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '..', 'scripts'))
from mech9_cases import TREE, Checks, run, text_of
from n_four_bar import data_file

mech9k, mech9d = map(os.path.abspath, sys.argv[1:3])
checks = Checks()


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


def check_graph(program, data, folder, extra=()):
    """The graph that dot reads from the text is that of the data file."""
    name = os.path.basename(data)
    done = run(program, data, '--graph', 'x.dot', *extra, folder=folder)
    if not checks.equal((done.returncode, done.stdout), (0, ''), f'{name}: a graph, and no run'):
        return
    plain = subprocess.run(['dot', '-Tplain', 'x.dot'], cwd=folder, capture_output=True, text=True, timeout=60)
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
    check_blocks(program, data, text_of(os.path.join(folder, 'x.dot')), extra)


def check_blocks(program, data, text, extra):
    """The clusters hold each link but the frame once; an edge ends in its block or is what closes a chain."""
    clusters = re.findall(r'subgraph cluster_\d+ \{(.*?)\n  \}', text, re.S)
    members = [int(link) for cluster in clusters for link in re.findall(r'^ +(\d+) \[', cluster, re.M)]
    checks.equal(len(members), len(set(members)), f'{data}: no link in two blocks')
    checks.equal(set(members) | {1}, set(map(int, re.findall(r'(\d+) --', text))) | set(map(int, re.findall(r'-- (\d+)', text))),
                 f'{data}: each link in a block')
    plan = run(program, data, '--plan', *extra).stdout
    checks.equal(len(clusters), len(re.findall(r'^block \d+:', plan, re.M)), f'{data}: as many blocks as in the plan')


def test_pictures(folder):
    fig1 = os.path.join(TREE, 'examples', 'fig1', 'fig1.nml')
    title = 'it\'s "x" \\N \\ & < {a|b} `touch harm` $(touch harm); // # é'
    setting = "mechanism.title='" + title.replace("'", "''") + "'"
    name = 'a "b" ; $(touch harm)\n`c`'
    done = run(mech9k, fig1, '--set', setting, '--graph', name + '.svg', folder=folder)
    if checks.equal(done.returncode, 0, 'a picture with a hostile name and title'):
        words = [element.text for element in xml.parse(os.path.join(folder, name + '.svg')).getroot().iter()
                 if element.tag.endswith('}text')]
        checks.true(title in words, 'the title as it is', words)
        checks.true('1 frame' in words, 'the frame is marked', words)
        checks.true(os.path.exists(os.path.join(folder, name + '.dot')), 'the text beside it')
    run(mech9k, fig1, '--graph', 'x.png', folder=folder)
    with open(os.path.join(folder, 'x.png'), 'rb') as file:
        checks.true(file.read(4) == b'\x89PNG', 'a PNG')
    checks.true('harm' not in os.listdir(folder), 'nothing was carried out')
    many = os.path.join(folder, 'many.nml')
    with open(many, 'w', encoding='utf-8') as file:
        file.write(data_file(160))
    done = run(mech9d, many, '--graph', 'many.svg', folder=folder)
    checks.true(done.returncode == 0 and text_of(os.path.join(folder, 'many.svg')).count('class="node"') == 322,
                'hundreds of links', done.stderr)


def test_failures(folder):
    fig1 = os.path.join(TREE, 'examples', 'fig1', 'fig1.nml')
    done = run(mech9k, fig1, '--graph', 'no/such/folder.dot', folder=folder)
    checks.true(done.returncode == 8 and 'no/such/folder.dot' in done.stderr, 'a folder that is not there', done.stderr)
    path, os.environ['PATH'] = os.environ['PATH'], folder
    try:
        done = run(mech9k, fig1, '--graph', 'x.svg', folder=folder)
        quiet = run(mech9k, fig1, '--graph', 'x.svg', '--quiet', folder=folder)
    finally:
        os.environ['PATH'] = path
    checks.true(done.returncode == 0 and 'dot -Tsvg -o x.svg x.dot' in done.stderr, 'no dot: a word how to draw it', done.stderr)
    checks.equal(quiet.stderr, done.stderr, 'no dot: told to who wants quiet, too')
    checks.equal(os.listdir(folder), ['x.dot'], 'the text is kept')


with tempfile.TemporaryDirectory() as folder:
    test_failures(folder)
    if checks.has('dot', 'graphviz'):
        for where in ('kinematics_fig1', 'kinematics_fig1_driven_at_q1', 'kinematics_spatial_slider_crank', 'kinematics_bennett'):
            check_graph(mech9k, os.path.join(TREE, 'tests', 'reference', where + '.nml'), folder)
        check_graph(mech9d, os.path.join(TREE, 'tests', 'reference', 'dynamics_open_chain.nml'), folder)
        test_pictures(folder)
checks.finish()
