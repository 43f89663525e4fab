"""Arrays inside kernels from addresses, so that one small argument stands for many arrays.

Handing an array from Python to a compiled function costs some 50 ns; a motion cost that is called
a hundred thousand times a second would spend more on that than on a short distance query.
"""

from __future__ import annotations

from typing import Any

from numba.core import types
from numba.extending import intrinsic


def _caster(pointee: types.Type) -> Any:
    def cast(_context, _address):
        def generate(context, builder, signature, arguments):
            return builder.inttoptr(arguments[0], context.get_value_type(signature.return_type))

        return types.CPointer(pointee)(types.int64), generate

    return intrinsic(cast)


float64_at = _caster(types.float64)
float32_at = _caster(types.float32)
int64_at = _caster(types.int64)
