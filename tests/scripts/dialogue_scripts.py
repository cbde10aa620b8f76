"""The conversations that the tests lead: Fig. 1 of the paper and a pendulum.

A new name of the data file that is asked for in every conversation is one step more here.
"""

TITLE_FIG1 = 'Fig. 1: two closed chains, one degree of freedom'
LINKS = {1: '1 6', 2: '6 5', 3: '3 5', 4: '2 3', 5: '1 2', 6: '1 4', 7: '3 4'}
POINTS = {1: '-1.0 2.5 0', 2: '1.8 0 0', 3: '1.6 1.2 0', 4: '1 0 0', 5: '', 6: '4 0 0', 7: '3.2 0 0'}
MOVING_POINTS = {1: '0 0 0', 2: '0 0 0', 3: '2.0 0 0', 4: '0 0 0', 5: '', 6: '0 0 0', 7: '2.6 0 0'}
GUESSES = {1: '-1', 2: '1.8', 3: '0.1', 4: '0.2', 6: '1.8', 7: '1.1'}
MATRIX = ['0 5 0 6 0 1', '5 0 4 0 0 0', '0 4 0 7 3 0', '6 0 7 0 0 0', '0 0 3 0 0 2', '1 0 0 0 2 0']
SECOND_SET = {'nrg': '1 2 3 4 1 1 6 5 3', 'nws': '0 5 4 7 6 0 1 2 3', 'rdw': '1 1 0 0 0 1 0 0 0',
              'nrw': '0 0 0 0 1 1 1 1 2'}

MECHANISM = [('title [', TITLE_FIG1), ('links: ', '6'), ('coordinates: ', '7'), ('angle_unit [rad]', '')]
BY_PAIRS = [('[pairs]', ''), ('several freedoms [none]', '')] + [(f'links of pair {k}', LINKS[k]) for k in LINKS] + [('cq: ', '5')]
BY_MATRIX = [('[pairs]', 'matrix'), ('several freedoms', '')] + [(f'row {i} of c', row) for i, row in enumerate(MATRIX, 1)] + [('cq: ', '5')]
BY_VECTORS = [('[pairs]', 'vectors'), ('several freedoms', '')] + [(name, values) for name, values in SECOND_SET.items()]


def pairs(with_links):
    """The geometry of the pairs; where the structure is not given by pairs, their links are corrected."""
    steps = [('or by points [lengths]', 'points'), ('which of them', 'moving_point' + (', links' if with_links else ''))]
    for k in LINKS:
        steps += [(f'Pair {k}', '')]     # the kind: revolute
        if with_links:
            steps = steps[:-1] + [(f'Pair {k}', LINKS[k]), ('kind', '')]
        steps += [('point', POINTS[k]), ('axis', '0 0 1' if k == 1 else ''), ('moving_point', MOVING_POINTS[k])]
    return steps + [('coupling 1, kind', '')]


MOTION = [('Drive of coordinate 5', ''), ('coefficients', '0.5, 6'), ('guesses', 'yes')]
MOTION += [(f'Coordinate {k} at the start', value) for k, value in GUESSES.items()]
POINTS_OF_FIG1 = [('point 1, name', 'P'), ('link: ', '5'), ('position', '1 0.3 0'),
                  ('point 2, name', 'Q'), ('link: ', '3'), ('position', '1.6 1.2 0'), ('point 3, name', '')]
TIME = [('start (s)', ''), ('end (s)', ''), ('intervals', '')]
RESULTS = [('nly if you want', ''), ('table [', '')]
END = [('Enter if all is right', ''), ('[both]', ''), ('data file [', ''), ('run or done: ', 'done')]

FIG1_TO_THE_END = MECHANISM + BY_PAIRS + pairs(False) + MOTION + POINTS_OF_FIG1 + TIME + RESULTS
FIG1 = FIG1_TO_THE_END + END
FIG1_BY_MATRIX = MECHANISM + BY_MATRIX + pairs(True) + MOTION + POINTS_OF_FIG1 + TIME + RESULTS + END
FIG1_BY_VECTORS = MECHANISM + BY_VECTORS + pairs(True) + MOTION + POINTS_OF_FIG1 + TIME + RESULTS + END

PENDULUM_TO_THE_END = [
    ('title [', 'Simple pendulum, released from the horizontal'), ('links: ', '2'), ('coordinates: ', '1'),
    ('angle_unit [rad]', ''), ('[pairs]', ''), ('links of pair 1', '1 2'), ('cq: ', '1'), ('which of them', ''),
    ('kind', ''), ('point', ''), ('axis', '0,0,1'), ('drive 1, coordinate', ''), ('position', ''), ('velocity', '0.0'),
    ('body 1, link', '2'), ('mass', '1.0'), ('centre', '-1 0 0'), ('inertia', ''), ('body 2, link', ''),
    ('acceleration', '0 -9.81 0'), ('load 1, kind', ''), ('motor 1, coordinate', ''),
    ('point 1, name', 'P'), ('link: ', '2'), ('position', '-1 0 0'), ('point 2, name', ''),
    ('start', ''), ('end', '10'), ('intervals', ''),
    ('which of them', 'relative_tolerance, absolute_tolerance'), ('method', ''),
    ('relative_tolerance', '1e-10'), ('absolute_tolerance', '1e-10'), *RESULTS]
PENDULUM = PENDULUM_TO_THE_END + END


# a crank press in millimetres, by the lengths of its links, with names: the conversation of the tutorial
PRESS_CRANK, PRESS_ROD, PRESS_OFFSET, PRESS_SPEED = 35, 120, 10, 60     # mm, mm, mm, rpm
PRESS_UNITS = ('length_unit [m], angle_unit [rad]: ', 'mm deg')
PRESS = [
    ('title [', 'Crank press'), ('links: ', '4'), ('coordinates: ', '4'), PRESS_UNITS, ('[pairs]', ''), ('several freedoms', ''),
    ('links of pair 1', '1 2'), ('links of pair 2', '2 3'), ('links of pair 3', '3 4'), ('links of pair 4', '1 4'), ('cq: ', '1'),
    ('or by points [lengths]', ''), ('Pair 1', ''), ('Pair 2', ''), ('on link 2, length from pair 1, or x y (mm): ', str(PRESS_CRANK)),
    ('Pair 3', ''), ('on link 3, length from pair 2, or x y (mm): ', str(PRESS_ROD)), ('Pair 4', 'slide'),
    ('on link 1, length from pair 1, or x y (mm) [0, 0, 0]: ', f'0 {PRESS_OFFSET}'), ('axis: ', 'x'),
    ('on link 4, length from pair 3, or x y (mm) [0, 0, 0]: ', ''), ('coupling 1, kind', ''), ('kind [polynomial]', ''),
    ('coefficients (deg, deg/s, ...): ', f'0, {PRESS_SPEED} rpm'), ('guesses', ''), ('point 1, name', 'ram'), ('link: ', '4'),
    ('position (mm) [0, 0, 0]: ', ''), ('point 2, name', ''), ('start', ''), ('end', ''), ('intervals', ''),
    ('nly if you want', 'links'), ('table [', ''), ('links [none]: ', '3'),
    ('Enter if all is right', 'add link'), ('link 1, number', '2'), ('name', 'crank'),
    ('Enter if all is right', 'add link'), ('link 2, number', '3'), ('name', 'rod'),
    ('Enter if all is right', 'pair 4 name = guide'), *END]


def with_errors(steps):
    """The same conversation with wrong answers, questions, and steps back; each of them ends as before.
    What must be said of each is given as the prompt of the step that follows it."""
    wrong = {
        'links: ': [('', 'six'), ("takes whole numbers, and six is none", '6 5'), ('2 values for', '0'),
                    ("must be >=1", '1000000'), ('too many to speak of', '?'), ('Count every rigid part', None)],
        'links of pair 3': [('', '3 9'), ('the links are 1 to 6', '3 3'), ('to itself', '3 5 6'),
                            ('3 values for', 'back'), ('links of pair 2', ''), ('links of pair 3', 'list'),
                            ('[4] links 1, 6', None)],
        'cq: ': [('', '8'), ('coordinates are 1 to 7', '5 5'), ('twice', None)],
        'Pair 1': [('', 'revolutte'), ("did you mean 'revolute'?", None)],
        'axis': [('', '0 0'), ('2 values for', '0 0 0'), ('it must have a direction', 'x y z'), ('takes numbers', '0 0 nan'), ('not a finite number', None)],
        'guesses': [('', 'perhaps'), ('Answer yes or no', None)],
        'point 2, name': [('', 'P'), ("a second &point for name", 'P Q'), ('of letters', None)],
        'intervals': [('', '0.5'), ('whole numbers', None)],
    }
    spoiled = []
    for prompt, answer in steps:
        if prompt not in wrong:
            spoiled.append((prompt, answer))
            continue
        first, *rest = wrong.pop(prompt)
        spoiled.append((prompt, first[1]))
        spoiled += [(said, answer if reply is None else reply) for said, reply in rest]
    return spoiled
