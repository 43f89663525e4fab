"""Ask the processor to fetch an array element before it is needed."""

from __future__ import annotations

from typing import Any

from numba.core import cgutils, types
from numba.extending import intrinsic
from numba.np import arrayobj

_READ, _KEEP, _DATA = 0, 3, 1


def _prefetch(_context, array, _row, _column):
    """Start loading ``array[row, column]`` of a C-contiguous array; waits for nothing."""

    def generate(context, builder, signature, arguments):
        layout = signature.args[0]
        view = arrayobj.make_array(layout)(context, builder, arguments[0])
        pointer = cgutils.get_item_pointer(
            context, builder, layout, view, [arguments[1], arguments[2]], wraparound=False
        )
        ir = cgutils.ir  # pyright: ignore[reportPrivateImportUsage]
        name = "llvm.prefetch.p0i8"
        function_type = ir.FunctionType(
            ir.VoidType(), [cgutils.voidptr_t, cgutils.int32_t, cgutils.int32_t, cgutils.int32_t]
        )
        function = cgutils.get_or_insert_function(builder.module, function_type, name)
        hint = [cgutils.int32_t(k) for k in (_READ, _KEEP, _DATA)]
        builder.call(function, [builder.bitcast(pointer, cgutils.voidptr_t), *hint])
        return context.get_dummy_value()

    return types.none(array, types.intp, types.intp), generate


prefetch: Any = intrinsic(_prefetch)
