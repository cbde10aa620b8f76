"""Components of forces that equilibrium determines, where the equations of the links are badly conditioned.

Two planar pairs with one normal join the same links beside a chain of four pairs, whose axes are parallel but for some 1e-5: its loop has
six independent equations, which determine the chain's wrenches. Only the shares of both planar pairs are not determined, in the force
along the normal and in the moments across it.
"""
from mech9_cases import report_of

ALL = ['fx', 'fy', 'fz', 'mx', 'my', 'mz']
IN_PLANE = ['fx', 'fy', 'mz']
CHAIN = """&pair coordinate=1, links=1,2, kind='revolute', axis=-0.28863580033079467,0.8829539324661481,0.3702430176267507, point=-0.6385523421559205,-0.7202216569491726,-0.913433836588204 /
&pair coordinate=2, links=2,3, kind='revolute', axis=-0.2886335011717229,0.8829564821933629,0.3702413935811672, point=0.009950578391825497,0.0023707409424409587,-0.00651705962294106 /
&pair coordinate=3, links=3,4, kind='revolute', axis=-0.2886343048701185,0.8829556633737082,0.37024326392220863, point=-0.871867547710898,-1.5584176062984267,0.13383443067301773 /
&pair coordinate=4, links=4,5, kind='revolute', axis=-0.2887728387287152,0.8829953618622812,0.3701261388112479, point=-0.9600764172080476,1.395789779118826,-1.19862880899594 /
&pair coordinates=5,6,7, links=1,5, kind='planar', axis=-0.28863336540937023,0.882955680837832,0.3702432255270327, point=-0.9995055882274086,0.5917495448364299,0.43135228646828533 /
&pair coordinates=8,9,10, links=1,5, kind='planar', axis=-0.28863336540937023,0.882955680837832,0.3702432255270327, point=-0.0051877362516311405,-0.020423231438143067,-0.01753665680256099 /
"""
REST = """&structure cq=1 /
&drive coordinate=1, kind='polynomial', coefficients=0, 1 /
&output reactions=.true. /
&time end=1e-9, intervals=1 /
"""


def test_two_planar_pairs_beside_a_chain(checks, mech9k, tmp_path):
    path = tmp_path / 'case.nml'
    path.write_text(CHAIN + REST, encoding='utf-8')
    reactions = report_of(mech9k, path)['reactions']
    checks.equal(len(reactions), 6, 'all pairs are there')
    for k in range(4):
        checks.equal(reactions[k]['unique'], ALL, f'pair {k + 1} of the chain')
    for k in 4, 5:
        checks.equal(reactions[k]['unique'], IN_PLANE, f'planar pair {k - 3}')
