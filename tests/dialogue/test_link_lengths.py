"""Planar mechanisms by the lengths of their links: the motion against closed forms of the loops."""
import os

import numpy as np
import pytest

from conversations import answers_of, first_missing, piped
from mech9_cases import read_table, run, text_of

# R. L. Norton, Design of Machinery, example 6-7: lengths 40, 120, 80 and 100 mm, a crank angle of 40 degrees and 25 rad/s.
CRANK, COUPLER, ROCKER, FRAME = 0.04, 0.12, 0.08, 0.1
ANGLE_3, RATE_3, RATE_4 = 20.298, -4.121, 6.998
BEGIN = [('links: ', '4'), ('coordinates: ', '4'), ('angle_unit', 'deg'), ('[pairs]', ''), ('several freedoms', '')]
REST = [('coupling 1, kind', ''), ('kind [polynomial]', ''), ('coefficients', '40, 1432.394487827058'), ('guesses', ''),
        ('point 1, name', ''), ('start', ''), ('end', '0.2'), ('intervals', '40'), ('nly if you want', ''), ('table [', '')]
SAVE = [('Enter if all is right', ''), ('[both]', 'save'), ('data file [', '')]
FOUR_BAR = [('title', 'bars')] + BEGIN + [
    ('links of pair 1', '1 2'), ('links of pair 2', '2 3'), ('links of pair 3', '1 4'), ('links of pair 4', '3 4'), ('cq: ', '1'),
    ('or by points [lengths]', '?'), ('how far apart', 'bars'), ('Answer lengths or points.', ''), ('x leads to its next pair', ''),
    ('Pair 2', ''), ('on link 2, length from pair 1, or x y (m): ', ''), ('This must be given', 'long'), ('on link 2', str(CRANK)),
    ('Pair 3', ''), ('on link 1, length from pair 1', f'{FRAME} 0'), ('Pair 4', 'rev'), ('on link 3, length from pair 2', '0.2'),
    ('on link 4, length from pair 3', 'back'), ('on link 3, length from pair 2, or x y (m) [0.2, 0, 0]', str(COUPLER)),
    ('on link 4', f'{ROCKER}, 0, 0')] + REST
SLIDER_CRANK = [('title', 'slide')] + BEGIN + [
    ('links of pair 1', '1 2'), ('links of pair 2', '2 3'), ('links of pair 3', '3 4'), ('links of pair 4', '1 4'), ('cq: ', '1'),
    ('or by points [lengths]', 'len'), ('Pair 1', ''), ('Pair 2', ''), ('on link 2', '0.05'), ('Pair 3', ''), ('on link 3', '.15'),
    ('Pair 4', 'slide'), ('on link 1, length from pair 1, or x y (m) [0, 0, 0]', '0 0.02'), ('axis: ', 'x'),
    ('on link 4, length from pair 3, or x y (m) [0, 0, 0]', '')] + REST


def saved(checks, program, steps, stem, folder, arguments=()):
    """The text of the data file of a conversation."""
    done = piped(program, *arguments, folder=folder, answers=answers_of(steps + SAVE))
    checks.equal(done.returncode, 0, f'{stem}: exit code')
    missing = first_missing(done.stderr, steps + SAVE)
    checks.true(missing is None, f'{stem}: every prompt comes in its turn', f'{missing} is missing\n{done.stderr}')
    return text_of(os.path.join(folder, stem + '.nml'))


def table_of_file(program, stem, folder):
    run(program, stem + '.nml', '--table', stem + '.dat', folder=folder)
    return read_table(text_of(os.path.join(folder, stem + '.dat')))


@pytest.fixture
def folder(tmp_path):
    return os.fspath(tmp_path)


def test_four_bar(checks, mech9k, folder):
    """Angles of coupler and rocker by the loop's triangle, their rates by the components of its velocities."""
    saved(checks, mech9k, FOUR_BAR, 'bars', folder)
    found = table_of_file(mech9k, 'bars', folder)
    crank = np.radians(found['q1'])
    tip = CRANK * np.exp(1j * crank)
    diagonal = FRAME - tip
    # the triangle of diagonal, rocker and coupler, whose corner lies to the left of the diagonal
    corner = np.arccos((abs(diagonal)**2 + COUPLER**2 - ROCKER**2) / (2 * COUPLER * abs(diagonal)))
    coupler = np.angle(diagonal) + corner
    rocker = np.angle(tip + COUPLER * np.exp(1j * coupler) - FRAME)
    rate = np.radians(found['dq1'])
    rate_3 = rate * CRANK / COUPLER * np.sin(rocker - crank) / np.sin(coupler - rocker)
    rate_4 = rate * CRANK / ROCKER * np.sin(crank - coupler) / np.sin(rocker - coupler)
    # degrees, to the digits of the table and the round-off of the loop
    checks.near(found['q1'] + found['q2'], np.degrees(coupler), 1e-12, 'angle of the coupler')
    checks.near(found['q3'], np.degrees(rocker), 1e-12, 'angle of the rocker')
    checks.near(found['dq1'] + found['dq2'], np.degrees(rate_3), 1e-12, 'its rate')
    checks.near(found['dq3'], np.degrees(rate_4), 1e-12, 'rate of the rocker')
    # the digits that the book prints
    checks.near(found['q1'][0] + found['q2'][0], ANGLE_3, 5e-4 / ANGLE_3, "the book's angle of the coupler")
    checks.near(np.radians([found['dq1'][0] + found['dq2'][0], found['dq3'][0]]), [RATE_3, RATE_4], 5e-4 / 4, "the book's rates")


def test_slider_crank(checks, mech9k, folder):
    """The slider is where a circle of the rod's length about the crank pin meets the line of the slide."""
    saved(checks, mech9k, SLIDER_CRANK, 'slide', folder)
    found = table_of_file(mech9k, 'slide', folder)
    crank = np.radians(found['q1'])
    place = 0.05 * np.cos(crank) + np.sqrt(0.15**2 - (0.02 - 0.05 * np.sin(crank))**2)
    checks.near(found['q4'], place, 1e-14, 'place of the slider')


def test_resumed(checks, mech9k, folder):
    """A conversation that was cut off within the lengths goes on with lengths."""
    cut = [prompt for prompt, _ in FOUR_BAR].index('Pair 4')
    whole = saved(checks, mech9k, FOUR_BAR, 'bars', folder)
    os.remove(os.path.join(folder, 'bars.nml'))
    piped(mech9k, folder=folder, answers=answers_of(FOUR_BAR[:cut]))
    text = saved(checks, mech9k, FOUR_BAR[cut:], 'bars', folder, ('--resume', 'bars.draft.nml'))
    checks.equal(text, whole, 'the same data file')


def test_corrected(checks, mech9k, folder):
    """Names that the systems of the links settle can be changed at the end, and lengths given up for points."""
    steps = FOUR_BAR + [('Enter if all is right', 'pair 1 moving_point = -0.04 0 0'), ('Enter if all is right', 'pair 4 point'),
                        ('on link 3, length from pair 2, or x y (m) [0.12, 0, 0]', '0.1 0.05')]
    text = saved(checks, mech9k, steps, 'bars', folder)
    checks.true('moving_point=-0.04 0 0' in text or 'moving_point=-0.04, 0, 0' in text, 'a settled point is changed', text)
    checks.true('point=0.1 0.05, 0' in text or 'point=0.1, 0.05, 0' in text, 'two numbers are a point of the plane', text)
