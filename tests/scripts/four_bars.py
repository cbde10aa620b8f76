"""Four-bar linkages that several tests share, as parts of data files."""

# the rocker is heavy; the structure and a start of the crank are to be added
HEAVY_ROCKER = """&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1 /
&pair coordinate=2, links=2,3, kind='revolute', point=0.2,0,0, axis=0,0,1 /
&pair coordinate=3, links=3,4, kind='revolute', point=0.7,0,0, axis=0,0,1, moving_point=1,0,0 /
&pair coordinate=4, links=1,4, kind='revolute', point=0.6,0,0, axis=0,0,1 /
&initial coordinate=2, position=0.3 /
&initial coordinate=3, position=1 /
&body link=2, mass=0.2, centre=0.1,0,0, inertia=0,0,0.0006666666666666667,0,0,0 /
&body link=3, mass=0.5, centre=0.45,0,0, inertia=0,0,0.010416666666666667,0,0,0 /
&body link=4, mass=2, centre=0.8,0,0, inertia=0,0,0.026666666666666667,0,0,0 /
&gravity acceleration=0,-9.81,0 /
"""
# all dimensions of the plane, bodies, a spring and a damper; the motion of coordinate 1 is to be added
SPRUNG = """
&mechanism links=4, coordinates=4 /
&structure cq=1 /
&pair coordinate=1, links=1,2, kind='revolute', axis=0,0,1, point=0,0,0, moving_point=0,0,0 /
&pair coordinate=2, links=2,3, kind='revolute', axis=0,0,1, point=0.3,0,0, moving_point=0,0,0 /
&pair coordinate=3, links=3,4, kind='revolute', axis=0,0,1, point=1.1,0,0, moving_point=0.8,0,0 /
&pair coordinate=4, links=1,4, kind='revolute', axis=0,0,1, point=1.0,0.1,0, moving_point=0,0,0 /
&initial coordinate=2, position=0.3 /
&initial coordinate=3, position=0.6 /
&initial coordinate=4, position=1.6 /
&point name='P', link=3, position=0.5,0.2,0 /
&body link=2, mass=1.2, centre=0.15,0,0, inertia=0,0,0.02,0,0,0 /
&body link=3, mass=2.5, centre=0.5,0.1,0, inertia=0,0,0.3,0,0,0 /
&body link=4, mass=1.8, centre=0.4,0,0, inertia=0,0,0.1,0,0,0 /
&gravity acceleration=0,-9.81,0 /
&load kind='coordinate', coordinate=4, stiffness=40, rest=1.2, damping=3 /
"""
# links and pairs with names, for conversations
NAMED_BARS = """&mechanism title='bars', links=4, coordinates=4 /
&link number=2, name='crank' /
&link number=4, name='rocker' /
&structure cq='A' /
&pair coordinate=1, name='A', links=1,'crank', kind='revolute', axis=0,0,1 /
&pair coordinate=2, links='crank',3, kind='revolute', axis=0,0,1, point=0.3,0,0, moving_point=0,0,0 /
&pair coordinate=3, name='C', links=3,'rocker', kind='revolute', axis=0,0,1, point=1,0,0, moving_point=0.8,0,0 /
&pair coordinate=4, name='D', links=1,'rocker', kind='revolute', axis=0,0,1, point=0.9,0,0, moving_point=0,0,0 /
&initial coordinate='D', position=1.2 /
"""
