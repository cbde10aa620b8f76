"""Functions of a mechanism in PyTorch, with exact derivatives."""
from __future__ import annotations

from typing import Any, Callable

from ._function import Function


def wrap(f: Function) -> Callable[[Any], Any]:
    """A `Function` as a function of tensors: x (inputs,) gives (outputs,). It can be differentiated once, backwards."""
    import torch  # type: ignore[import-not-found,unused-ignore]

    class Quantities(torch.autograd.Function):   # type: ignore[misc,name-defined,unused-ignore]
        @staticmethod
        def forward(context: Any, x: Any) -> Any:
            context.save_for_backward(x)
            return torch.as_tensor(f(x.detach().cpu().double().numpy())).to(x)

        @staticmethod
        def backward(context: Any, change: Any) -> Any:
            x, = context.saved_tensors
            slopes = torch.as_tensor(f.jacobian(x.detach().cpu().double().numpy())).to(x)
            return change @ slopes

    return Quantities.apply   # type: ignore[no-any-return,no-untyped-call,unused-ignore]
