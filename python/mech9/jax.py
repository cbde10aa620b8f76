"""Functions of a mechanism in JAX, with exact derivatives."""
from __future__ import annotations

from typing import Any, Callable

import numpy as np

from ._function import Function


def wrap(f: Function) -> Callable[[Any], Any]:
    """A `Function` as a function of JAX arrays: x (inputs,) gives (outputs,). It can be differentiated once, forwards and backwards,
    and mapped and compiled with others; the mechanism itself runs in the library."""
    import jax

    def value(x: Any) -> np.ndarray:
        return np.asarray(f(np.asarray(x)), dtype=x.dtype)

    def slopes(x: Any) -> np.ndarray:
        return np.asarray(f.jacobian(np.asarray(x)), dtype=x.dtype)

    def ask(answer: Callable[[Any], np.ndarray], shape: tuple[int, ...], x: Any) -> Any:
        result: Any = jax.ShapeDtypeStruct   # has no types in JAX
        return jax.pure_callback(answer, result(shape, x.dtype), x, vmap_method='sequential')

    @jax.custom_jvp
    def wrapped(x: Any) -> Any:
        return ask(value, (len(f.outputs),), x)

    @wrapped.defjvp
    def derivative(primals: Any, tangents: Any) -> Any:
        (x,), (change,) = primals, tangents
        return wrapped(x), ask(slopes, (len(f.outputs), len(f.inputs)), x) @ change

    return wrapped   # type: ignore[no-any-return,unused-ignore]
