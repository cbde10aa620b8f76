"""The report of the five-bar robot at its instant, in closed form: Jacobians, mass matrix, forces by kind, and what the rates add, by the
derivatives of the mass matrix."""
import json
import os
import re

import numpy as np
import pytest

from mech9_cases import TREE, read_table, run, text_of

PATH = os.path.join(TREE, 'examples', 'five_bar_robot', 'five_bar_robot.nml')
BASE, CRANK, ROD = 125.0, 200.0, 320.0
CRANK_MASS, ROD_MASS, TOOL_MASS = 1.2, 0.9, 1.5
DEGREE = np.pi/180
G = 9.81
PUSH = np.array([-20.0, -40.0])


class Robot:
    """Places and Jacobians of both elbows and the tool, in mm and mm/rad; angles may be complex, for derivatives."""

    def __init__(self, q):
        self.elbows = np.array([[side*BASE + CRANK*np.cos(angle), CRANK*np.sin(angle)] for side, angle in zip((-1, 1), q)])
        self.by_elbow = [np.zeros((2, 2), complex), np.zeros((2, 2), complex)]
        for i, angle in enumerate(q):
            self.by_elbow[i][:, i] = CRANK*np.array([-np.sin(angle), np.cos(angle)])
        chord = self.elbows[1] - self.elbows[0]
        length = np.sqrt(chord @ chord)
        height = np.sqrt(ROD**2 - length**2/4)
        self.tool = self.elbows.mean(axis=0) + height*np.array([-chord[1], chord[0]])/length
        self.rods = self.tool - self.elbows
        right = np.array([self.rods[i] @ self.by_elbow[i] for i in range(2)])
        self.by_tool = np.linalg.solve(self.rods, right)

    def mass(self):
        m = np.zeros((2, 2), complex)
        for elbow in self.by_elbow:
            m += CRANK_MASS/3*elbow.T @ elbow
            both = elbow.T @ self.by_tool
            m += ROD_MASS/3*(elbow.T @ elbow + self.by_tool.T @ self.by_tool + (both + both.T)/2)
        return m + TOOL_MASS*self.by_tool.T @ self.by_tool

    def turnings(self):
        """Derivatives of the angles of both rods."""
        return np.array([(self.rods[i][0]*(self.by_tool - self.by_elbow[i])[1] - self.rods[i][1]*(self.by_tool - self.by_elbow[i])[0])/ROD**2
                         for i in range(2)])


def rates_alone(q, dq):
    """Forces that the rates need [kg mm^2/s^2]: dM/dt dq less half the derivatives of dq' M dq, by complex steps."""
    step = 1e-30
    slopes = np.array([Robot(np.array(q, complex) + 1j*step*unit).mass().imag/step for unit in np.eye(2)])
    return np.einsum('kij,k,j->i', slopes, dq, dq) - np.einsum('ijk,j,k->i', slopes, dq, dq)/2


@pytest.mark.parametrize('degrees, rates', [((140, 60), (30, -45)), ((110, 75), (-200, 120)), ((160, 35), (0, 0))])
def test_report_in_closed_form(checks, mech9d, tmp_path, degrees, rates):
    settings = [f'initial({name}).{word}={value}' for name, *values in (('left', degrees[0], rates[0]), ('right', degrees[1], rates[1]))
                for word, value in zip(('position', 'velocity'), values)]
    done = run(mech9d, PATH, '--quiet', '--report', 'r.json', '--table', 'r.dat', *[word for s in settings for word in ('--set', s)], folder=tmp_path)
    checks.equal(done.returncode, 0, done.stderr)
    report = json.loads(text_of(tmp_path / 'r.json'))
    robot = Robot(DEGREE*np.array(degrees))
    tool, dq = robot.by_tool.real, DEGREE*np.array(rates)
    checks.near(np.array(report['point_jacobians']['P'])[:2], tool*DEGREE, 1e-12, 'Jacobian of the tool, by degrees')
    turnings = robot.turnings().real
    dependent = np.array([turnings[0] - [1, 0], turnings[1] - [0, 1], turnings[1] - turnings[0]])
    checks.near(report['dependent_jacobian'], dependent, 1e-12, 'Jacobian of the dependent coordinates')
    mass = robot.mass().real
    checks.near(np.array(report['mass_matrix'])/1e5, mass/1e5, 1e-12, 'mass matrix')
    up = [elbow.real[1] for elbow in robot.by_elbow]
    gravity = -G*sum((CRANK_MASS/2 + ROD_MASS/2)*elbow + ROD_MASS/2*tool[1] for elbow in up) - G*TOOL_MASS*tool[1]
    forces = report['generalized_forces']
    checks.near(np.array(forces['gravity'])/1e3, gravity/1e3, 1e-12, 'weights')
    checks.near(np.array(forces['loads'])/1e3, PUSH @ tool/1e3, 1e-12, 'the push at the tool')
    bias = rates_alone(DEGREE*np.array(degrees), dq)/1e3 - gravity - PUSH @ tool
    checks.near(np.array(report['bias'])/1e3, bias/1e3, 1e-11, 'bias')
    table = read_table(text_of(tmp_path / 'r.dat'))
    acceleration = np.linalg.solve(mass, -1e3*bias)/DEGREE
    checks.near(np.array([table['ddq1'][0], table['ddq2'][0]])/1e4, acceleration/1e4, 1e-10, 'the robot falls by M ddq + bias = 0')
    checks.near(np.array(forces['inertia'])/1e3, -(gravity + PUSH @ tool)/1e3, 1e-11, 'inertia balances weights and push')


def test_numbers_of_the_page(checks, mech9d, tmp_path):
    """The README tells the numbers of the report, rounded."""
    run(mech9d, PATH, '--quiet', '--report', 'r.json', '--no-write', folder=tmp_path)
    report = json.loads(text_of(tmp_path / 'r.json'))
    page = text_of(os.path.join(os.path.dirname(PATH), 'README.md'))
    forces = report['generalized_forces']
    for name, numbers, digits in (('point_jacobians', np.ravel(report['point_jacobians']['P'])[:4], 3),
                                  ('dependent_jacobian', report['dependent_jacobian'][0], 3), ('mass_matrix', np.ravel(report['mass_matrix']), 0),
                                  ('`gravity`', forces['gravity'], 0), ('`loads`', forces['loads'], 0), ('`bias`', report['bias'], 0)):
        line, = [line for line in page.splitlines() if line.startswith('|') and name in line.split('|')[1]]
        told = [float(text) for text in re.findall(r'-?\d+\.?\d*', line.split('|')[2])]
        checks.near(told, np.round(numbers, digits), 1e-9, f'the page tells {name}')
