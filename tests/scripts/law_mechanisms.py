"""Mechanisms for tests of laws over coordinates, rates and points, and how near their motions come to closed forms."""
import numpy as np

# Errors of steps at 1e-12 add up over some hundred steps of motions that do not enlarge them.
NEAR = 1e-9
DEGREE = np.pi / 180

SLIDER_CRANK = """&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&pair coordinate=2, links=2,3, kind='revolute', point=0.1,0,0, moving_point=0,0,0, axis=0,0,1 /
&pair coordinate=3, links=3,4, kind='revolute', point=0.3,0,0, moving_point=0,0,0, axis=0,0,1 /
&pair coordinate=4, links=1,4, kind='prismatic', axis=1,0,0 /
&initial coordinate=4, position=0.38 /
&body link=4, mass=0.7 /
&point name='B', link=4 /
"""
FOUR_BAR = """&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&pair coordinate=2, links=2,3, kind='revolute', point=0.2,0,0, axis=0,0,1 /
&pair coordinate=3, links=3,4, kind='revolute', point=0.7,0,0, axis=0,0,1, moving_point=1,0,0 /
&pair coordinate=4, links=1,4, kind='revolute', point=0.6,0,0, axis=0,0,1, moving_point=0.6,0,0 /
&initial coordinate=1, position=0.3 /
&initial coordinate=2, position=0.45 /
&initial coordinate=3, position=0.93 /
&initial coordinate=4, position=1.67 /
&body link=2, mass=1, centre=0.05,0.02,0, inertia=0.03,0.03,0.03,0,0,0 /
&body link=3, mass=0.5, centre=0.4,0.1,0, inertia=0.01,0.01,0.01,0,0,0 /
&body link=4, mass=0.8, centre=0.65,0.2,0, inertia=0.02,0.02,0.02,0,0,0 /
&gravity acceleration=0,-9.81,0 /
&point name='P', link=3, position=0.4,0.3,0 /
"""
