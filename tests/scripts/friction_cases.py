"""Data files of mechanisms whose frictions have no answer, or none that is decided."""
RUBBING = """&structure cq=1 /
&pair coordinate=1, links=1,2, kind='prismatic', axis=1,0,0 /
&body link=2, mass=1 /
&initial coordinate=1, position=0, velocity=1 /
&friction coordinate=1, dynamic=0.1, preload=1 /
&time end=1, intervals=10 /
"""
LADDER = """&structure cq=2 /
&pair coordinate=1, links=1,2, kind='prismatic', axis=1,0,0, point=0,0,0 /
&pair coordinate=2, links=2,3, kind='revolute', axis=0,0,1, point=0,0,0 /
&pair coordinate=3, links=3,4, kind='revolute', axis=0,0,1, point=0,2,0 /
&pair coordinate=4, links=4,1, kind='prismatic', axis=0,1,0, point=0,2,0 /
&initial coordinate=2, position=0.7853981633974483, velocity=0.3 /
&initial coordinate=1, position=1.4 /
&initial coordinate=3, position=-0.8 /
&initial coordinate=4, position=0.6 /
&body link=3, mass=3, centre=0,1,0, inertia=1,0,1,0,0,0 /
&gravity acceleration=0,-9.81,0 /
&friction coordinate=1, dynamic=1.4 /
&time end=1, intervals=10 /
"""
BARS = """&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1, point=0,0,0 /
&pair coordinate=2, links=2,3, kind='revolute', axis=0,0,1, point=-0.2,1,0 /
&pair coordinate=3, links=3,4, kind='revolute', axis=0,0,1, point=0.5,1.6,0 /
"""
MASSES = '&body link=2, mass=1, centre=0,0.5,0, inertia=1,1,1,0,0,0 /\n&body link=3, mass=1, centre=0,1.2,0, inertia=1,1,1,0,0,0 /\n'
FOUR_RUBBING = BARS + """&pair coordinate=4, links=4,1, kind='revolute', axis=0,0,1, point=1,0,0 /
&structure cq=1 /
&initial coordinate=1, position=0, velocity=1 /
&gravity acceleration=0,-9.81,1 /
&friction coordinate=1, dynamic=0.1, face_radius=0.01 /
&time end=1, intervals=10 /
""" + MASSES
FIVE_RUBBING = BARS + """&pair coordinate=4, links=4,5, kind='revolute', axis=0,0,1, point=1.2,1,0 /
&pair coordinate=5, links=5,1, kind='revolute', axis=0,0,1, point=1,0,0 /
&structure cq=1,5 /
&initial coordinate=1, position=0, velocity=0 /
&initial coordinate=5, position=0, velocity=0 /
&body link=4, mass=1, centre=1,1.2,0, inertia=1,1,1,0,0,0 /
&body link=5, mass=1, centre=1,0.5,0, inertia=1,1,1,0,0,0 /
""" + MASSES + ''.join(f'&friction coordinate={k}, dynamic=0.1, preload=1 /\n' for k in (1, 2, 5)) + '&time end=1, intervals=10 /\n'
# a wedge of 20 degrees is driven by the block on it
WEDGE = """&structure cq=3 /
&pair coordinate=1, links=1,2, kind='prismatic', axis=1,0,0 /
&pair coordinate=2, links=2,3, kind='prismatic', axis=-2,1,0 /
&pair coordinate=3, links=1,3, kind='prismatic', axis=0,1,0 /
&drive coordinate=3, kind='polynomial', coefficients=0,-0.1 /
&load kind='coordinate', coordinate=1, force=30 /
&friction coordinate=2, dynamic=0.6 /
&output drive_forces=.true. /
&time end=1, intervals=10 /
"""
