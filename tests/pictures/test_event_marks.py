"""Marks of events in plots over the time: each event of the report has its mark, which says what happens, and other plots have none."""
import json
import re
import subprocess
import xml.etree.ElementTree as ElementTree

import numpy as np
import pytest

from mech9_cases import PATIENCE, run, text_of
from svg_pictures import SVG, example


@pytest.fixture
def gnuplot(checks):
    """Tests that take it are left out where gnuplot is not installed."""
    if not checks.has('gnuplot', 'gnuplot-nox'):
        pytest.skip(checks.missing[-1])


def plotted(checks, program, name, folder, *requests):
    """The events of a run whose plots are drawn in a folder."""
    options = [word for request in requests for word in ('--plot', request)]
    done = run(program, example(name), '--quiet', '--table', 'run.dat', '--report', 'run.json', *options, folder=folder)
    checks.equal(done.returncode, 0, f'{name}: drawn; {done.stderr}')
    return json.loads(text_of(folder / 'run.json')).get('events', [])


def marks_of(script):
    """The time, the text and the symbol of each mark, the times of lines, and those of ticks."""
    labels = re.findall(r"^set label '(.*?)' at (\S+), graph 0 hypertext point pt (\d+)", script, re.M)
    lines = re.findall(r'^set arrow from (\S+), graph 0 to \1, graph (\S+) nohead', script, re.M)
    return ([(float(t), text, int(symbol)) for text, t, symbol in labels], [float(t) for t, top in lines if top == '1'],
            [float(t) for t, top in lines if top != '1'])


def key_of(script):
    """The kinds of events in the key with their symbols."""
    return {kind: int(symbol) for symbol, kind in re.findall(r"NaN with points pt (\d+) .*? title '(\w+)'", script)}


WORDS = {'impact': 'is hit, impulse', 'close': 'closes', 'open': 'opens', 'stick': 'sticks', 'slip': 'slips'}


@pytest.mark.parametrize('name, columns, kinds', (('four_bar_stop', 'q4,S1', {'impact', 'close'}), ('block_on_belt', 'q2', {'stick', 'slip'})),
                         ids=('stop', 'friction'))
def test_each_event_has_its_mark(checks, gnuplot, mech9d, tmp_path, name, columns, kinds):
    events = plotted(checks, mech9d, name, tmp_path, f'run.svg:{columns}')
    script = text_of(tmp_path / 'run.gp')
    marks, lines, ticks = marks_of(script)
    checks.equal(set(key_of(script)), kinds, 'the key has the kinds that occur')
    checks.equal(sorted(lines), sorted(t for t, _, _ in marks), 'a line at each mark')
    checks.equal(ticks, [], 'and no ticks')
    told = sum(1 + int((re.search(r'and (\d+) more events? of this kind', text) or [0, 0])[1]) for _, text, _ in marks)
    checks.equal(told, len(events), 'the marks tell as many events as the report')
    for t, text, symbol in marks:
        event = min(events, key=lambda one: abs(one['time'] - t) + 10 * (WORDS[one['kind']] not in text))
        checks.near(t, event['time'], 1e-8, 'at its time')
        checks.true(text.startswith(f"t = {event['time']:.8g} s: {event['group']} {event['number']} {WORDS[event['kind']]}"), 'with what happens', text)
        checks.equal(symbol, key_of(script)[event['kind']], 'by the symbol of its kind')
    svg = ElementTree.parse(tmp_path / 'run.svg').getroot()
    titles = [title.text for title in svg.iter(SVG + 'title') if (title.text or '').startswith('t = ')]
    checks.equal(set(titles), {text for _, text, _ in marks}, 'the picture has the texts as titles')
    checks.true(not re.search('onmouse|showHypertext', text_of(tmp_path / 'run.svg')), 'and calls no script')
    written = [' '.join(''.join(text.itertext()).split()) for text in svg.iter(SVG + 'text')]
    checks.true(all(written.count(kind) == 1 for kind in kinds), 'the key stands once', written)
    again = subprocess.run(['gnuplot', 'run.gp'], cwd=tmp_path, capture_output=True, text=True, timeout=60 * PATIENCE)
    checks.equal((again.returncode, again.stderr), (0, ''), 'gnuplot draws the script again')


def test_marks_have_names(checks, gnuplot, mech9d, tmp_path):
    """The mark of an impact on a stop tells the name of the pair."""
    path = tmp_path / 'named.nml'
    text = text_of(example('four_bar_stop'))
    path.write_text(text.replace('&pair coordinate=4,', "&pair coordinate=4, name='hip',", 1), encoding='utf-8')
    done = run(mech9d, path, '--quiet', '--plot', 'run.svg:hip.q', folder=tmp_path)
    checks.equal(done.returncode, 0, f'drawn; {done.stderr}')
    marks = marks_of(text_of(tmp_path / 'run.gp'))[0]
    checks.true(marks and all(' s: stop 1 (hip) ' in text for _, text, _ in marks), 'marks have the name', marks[:2])


def test_many_events_have_ticks(checks, gnuplot, mech9d, tmp_path):
    """A slider that bounces hits its stop more than a hundred times."""
    events = plotted(checks, mech9d, 'bouncing_slider', tmp_path, 'run.svg:q1')
    marks, lines, ticks = marks_of(text_of(tmp_path / 'run.gp'))
    checks.true(len(events) > 100, 'there are many', len(events))
    checks.equal(lines, [], 'no line')
    checks.equal(sorted(ticks), sorted(t for t, _, _ in marks), 'a tick at each mark')
    told = sum(1 + int((re.search(r'and (\d+) more events? of this kind', text) or [0, 0])[1]) for _, text, _ in marks)
    checks.equal(told, len(events), 'which tell all events')
    impacts = np.sort([t for t, text, _ in marks if WORDS['impact'] in text])
    checks.true(np.diff(impacts).min() >= 10 / 400, 'and are apart', np.diff(impacts).min())


def test_paths_have_no_marks(checks, gnuplot, mech9d, tmp_path):
    plotted(checks, mech9d, 'four_bar_stop', tmp_path, 'path.svg:C.x:C.y', 'both.svg:q4,C.x:C.y')
    checks.equal(marks_of(text_of(tmp_path / 'path.gp')), ([], [], []), 'a path has no marks')
    before, behind = text_of(tmp_path / 'both.gp').split('unset arrow; unset label\n')
    checks.true(marks_of(before)[0] and marks_of(behind) == ([], [], []), 'they are taken off before the panel of a path')
    checks.equal(key_of(behind), {}, 'whose key has no kinds')


def test_smooth_motions_have_no_marks(checks, gnuplot, mech9d, tmp_path):
    events = plotted(checks, mech9d, 'pendulum', tmp_path, 'run.svg:q1')
    script = text_of(tmp_path / 'run.gp')
    checks.equal((events, marks_of(script), key_of(script)), ([], ([], [], []), {}), 'no event, no mark')


def test_unit_of_friction(checks, gnuplot, mech9d, tmp_path):
    plotted(checks, mech9d, 'block_on_belt', tmp_path, 'run.svg:R2.friction')
    checks.true("set ylabel 'R2.friction [N]'" in text_of(tmp_path / 'run.gp'), 'no blank behind the unit')
