"""Functions of a mechanism in SciPy, JAX and PyTorch, where these are there: their derivatives, and a design found with them."""
import os

import numpy as np
import pytest

from mech9_cases import TREE

# P.y of the four-bar is highest in its cycle for some crank: the search is for the crank whose top is this high.
WANTED = 0.7


@pytest.fixture(name='top')
def function_of_lengths(mech9):
    m = mech9.read(os.path.join(TREE, 'examples', 'library', 'four_bar.nml'))
    m.add('quantity', name='top', of='P.y', take='max')
    return m.function(['pair(2).point(1)', 'pair(4).point(1)'], ['top'])


def test_optimiser_of_scipy(top):
    optimize = pytest.importorskip('scipy.optimize')
    found = optimize.least_squares(lambda x: top(x) - WANTED, [0.3, 0.9], jac=top.jacobian, bounds=([0.25, 0.8], [0.38, 1.0]), gtol=1e-12)
    assert found.success and abs(top(found.x)[0] - WANTED) < 1e-9


def test_gradient_descent_in_jax(mech9, top):
    jax = pytest.importorskip('jax')
    from mech9 import jax as ours
    jax.config.update('jax_enable_x64', True)
    f = ours.wrap(top)
    x = jax.numpy.array([0.3, 0.9])
    assert np.allclose(jax.jacrev(f)(x), top.jacobian([0.3, 0.9]), rtol=0, atol=1e-14)
    assert np.allclose(jax.jacfwd(f)(x), top.jacobian([0.3, 0.9]), rtol=0, atol=1e-14)
    assert jax.vmap(f)(jax.numpy.stack([x, x])).shape == (2, 1)
    slope = jax.jit(jax.grad(lambda x: 0.5*((f(x) - WANTED)**2).sum()))
    for _ in range(40):
        x = x - 1.0*slope(x)
    assert abs(top(np.asarray(x))[0] - WANTED) < 1e-6


def test_gradient_descent_in_torch(mech9, top):
    torch = pytest.importorskip('torch')
    from mech9 import torch as ours
    f = ours.wrap(top)
    x = torch.tensor([0.3, 0.9], dtype=torch.float64, requires_grad=True)
    assert np.allclose(torch.autograd.functional.jacobian(f, x), top.jacobian([0.3, 0.9]), rtol=0, atol=1e-14)
    descent = torch.optim.SGD([x], lr=1.0)
    for _ in range(40):
        descent.zero_grad()
        (0.5*((f(x) - WANTED)**2).sum()).backward()
        descent.step()
    assert abs(top(x.detach().numpy())[0] - WANTED) < 1e-6
