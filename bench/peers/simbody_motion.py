"""Motions by Simbody (Debian: libsimbody-dev, g++): joint coordinates, chains closed by ball constraints, Runge-Kutta-Merson method."""
import os
import subprocess

HEADERS = '/usr/include/simbody'
NAME = 'Simbody'
WORDS = "Runge-Kutta-Merson method with error control, whose constraints are projected to a tenth of the accuracy"

if not os.path.exists(os.path.join(HEADERS, 'Simbody.h')):
    raise ImportError('libsimbody-dev is not installed')
VERSION = subprocess.run(['dpkg-query', '-W', '-f', '${Version}', 'libsimbody-dev'], capture_output=True, text=True, check=False).stdout
HERE = os.path.dirname(os.path.abspath(__file__))


def build(folder):
    """Compile the program in a folder, if it is not there."""
    global PROGRAM
    PROGRAM = os.path.join(folder, 'simbody_motion')
    if not os.path.exists(PROGRAM):
        subprocess.run(['g++', '-w', '-O2', '-march=native', '-I', HEADERS, os.path.join(HERE, 'simbody_motion.cpp'), '-o', PROGRAM,
                        '-lSimTKsimbody', '-lSimTKmath', '-lSimTKcommon'], check=True, capture_output=True)


def settings(mechanism, problem, end):
    return [10.0 ** -power for power in range(2, 13)]


def words(*numbers):
    return ' '.join(repr(float(number)) for number in numbers)


class Run:
    """The numbers of a mechanism, as the program reads them."""

    def __init__(self, mechanism, problem, end, accuracy):
        self.mechanism = mechanism
        lines = [words(end, accuracy, *mechanism.gravity)]
        for k in mechanism.tree:
            pair = mechanism.pairs[k]
            mass, centre, inertia = mechanism.bodies[pair.moving]
            lines += [f'body {words(mass, *centre, *inertia[:3])}',
                      f'joint {int(pair.turns)} {pair.reference} {pair.moving} '
                      + words(*pair.point, *pair.moving_point, *pair.axis, mechanism.position[k], mechanism.rate[k])]
        for reference, point, moving, moving_point in mechanism.closing_points():
            lines.append(f'ball {reference} {words(*point)} {moving} {words(*moving_point)}')
        for spring in mechanism.springs:
            first, second = (int(link) for link in spring['links'])
            lines.append(f'spring {first} {words(*spring["position"])} {second} {words(*spring["second_position"])} '
                         + words(spring['stiffness'][0], spring.get('damping', [0.0])[0], spring['free_length'][0]))
        for link, torque in mechanism.torques.items():
            lines.append(f'torque {link} {words(*torque)}')
        self.text = '\n'.join([*lines, 'end', ''])

    def go(self):
        ended = subprocess.run([PROGRAM], input=self.text, capture_output=True, text=True, check=False)
        if ended.returncode != 0:
            raise RuntimeError(ended.stderr.strip())
        # seconds of the integration alone
        self.seconds, work, *self.coordinates = map(float, ended.stdout.split())
        return int(work)

    def places(self):
        position = [0.0] * len(self.mechanism.pairs)
        for k, value in zip(self.mechanism.tree, self.coordinates):
            position[k] = value
        return self.mechanism.places(position)


prepare = Run
