"""Lanes: vectors of doubles, one arc in each, as a type of values in compiled kernels.

Numba's loop vectoriser gives up on the many arrays of a force model. So the kernels declare their vectors: a
`lanes` value is one LLVM vector of `WIDTH` doubles, and the formulas of the force modules read as for a
single arc. All lanes go through the same operations, so a lane's result depends neither on its place nor on
its neighbours.
"""

import operator
from itertools import product
from typing import Any, ClassVar

import numpy as np
from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.core.datamodel import models, register_default
from numba.core.typing.templates import AbstractTemplate, infer_global, signature
from numba.extending import intrinsic, lower_builtin

from opml.base.compiled import decorators
from opml.base.constants import LANES

WIDTH = LANES  # lanes in one vector

FLAGS = ("contract", "nsz")
"""Freedoms of the compiler with a formula: to fuse multiply and add, and to ignore the sign of zero."""

OPTIONS: dict[str, Any] = {
    "error_model": "numpy",
    "boundscheck": False,
    "nogil": True,
    "fastmath": set(FLAGS),
    "_nrt": False,
}
"""Numba's options for the kernels.

They allocate nothing, so references to arrays need no counts: Numba's atomic increments took a fifth of the
time, and threads waited for each other.
"""

compiled, entry = decorators(**OPTIONS)
"""Decorators of kernels that other kernels call, and of kernels that Python calls."""

_CACHE_LINE = 64

_VECTOR = ir.VectorType(ir.DoubleType(), WIDTH)
_BITS = ir.VectorType(ir.IntType(64), WIDTH)
_TRUTH = ir.VectorType(ir.IntType(1), WIDTH)


class Vector(types.Type):
    """Numba type of a vector of `WIDTH` values, with LLVM's type of it."""

    def __init__(self, name, llvm):
        super().__init__(name=f"{name}{WIDTH}")
        self.llvm = llvm


lanes = Vector("lanes", _VECTOR)  # of doubles
mask = Vector("mask", _TRUTH)  # of truth values


@register_default(Vector)
class _VectorModel(models.PrimitiveModel):
    def __init__(self, dmm, fe_type):
        super().__init__(dmm, fe_type, fe_type.llvm)


def rows(count: int) -> np.ndarray:
    """Return zeros (count, WIDTH) for lanes, aligned in memory so that a register is one cache line."""
    block = np.zeros(count * WIDTH + _CACHE_LINE // 8)
    start = -block.ctypes.data % _CACHE_LINE // 8
    return block[start : start + count * WIDTH].reshape(count, WIDTH)


def _splat(builder, scalar, vector=_VECTOR):
    first = builder.insert_element(ir.Constant(vector, ir.Undefined), scalar, ir.Constant(ir.IntType(32), 0))
    index = ir.Constant(ir.VectorType(ir.IntType(32), WIDTH), [0] * WIDTH)
    return builder.shuffle_vector(first, ir.Constant(vector, ir.Undefined), index)


def _as_vector(context, builder, value, typ):
    if isinstance(typ, Vector):
        return value
    return _splat(builder, context.cast(builder, value, typ, types.float64))


_NUMBERS = (types.Float, types.Integer)


def _operator(symbol, emit, result, vector, others=(), arity=2):
    """Define an operator of which at least one operand is a vector.

    emit: makes its LLVM instruction
    result, vector, others: Numba's types, of the operands beside a vector, too
    arity: number of operands

    An `overload` would compile a function for each combination of types.
    """

    @infer_global(symbol)
    class _Operator(AbstractTemplate):
        metadata: ClassVar = {"target": "cpu"}  # tried before Numba's own, of which there are a dozen

        def generic(self, args, kws):
            fit = vector in args and all(typ == vector or isinstance(typ, others) for typ in args)
            return signature(result, *args) if fit else None

    def lower(context, builder, signature, args):
        given = zip(args, signature.args, strict=True)
        return emit(builder, *(_as_vector(context, builder, value, typ) for value, typ in given))

    for operands in product((vector, *others), repeat=arity):
        if vector in operands:
            lower_builtin(symbol, *operands)(lower)


_operator(operator.add, lambda b, x, y: b.fadd(x, y, flags=FLAGS), lanes, lanes, _NUMBERS)
_operator(operator.sub, lambda b, x, y: b.fsub(x, y, flags=FLAGS), lanes, lanes, _NUMBERS)
_operator(operator.mul, lambda b, x, y: b.fmul(x, y, flags=FLAGS), lanes, lanes, _NUMBERS)
_operator(operator.truediv, lambda b, x, y: b.fdiv(x, y, flags=FLAGS), lanes, lanes, _NUMBERS)
_operator(operator.neg, lambda b, x: b.fneg(x, flags=FLAGS), lanes, lanes, arity=1)
_operator(operator.lt, lambda b, x, y: b.fcmp_ordered("<", x, y), mask, lanes, _NUMBERS)
_operator(operator.gt, lambda b, x, y: b.fcmp_ordered(">", x, y), mask, lanes, _NUMBERS)
_operator(operator.and_, lambda b, x, y: b.and_(x, y), mask, mask)
_operator(operator.or_, lambda b, x, y: b.or_(x, y), mask, mask)


def _unary(name):
    @intrinsic
    def operate(typingctx, a):
        def codegen(context, builder, signature, args):
            function = cgutils.get_or_insert_function(
                builder.module, ir.FunctionType(_VECTOR, [_VECTOR]), f"llvm.{name}.v{WIDTH}f64"
            )
            return builder.call(function, args)

        return lanes(a), codegen

    return operate


sqrt = _unary("sqrt")
absolute = _unary("fabs")
nearest = _unary("rint")


@intrinsic
def select(typingctx, condition, yes, no):
    """Return `yes` in the lanes where `condition` holds, else `no` (lanes or numbers)."""

    def codegen(context, builder, signature, args):
        chosen = [_as_vector(context, builder, args[k], signature.args[k]) for k in (1, 2)]
        return builder.select(args[0], *chosen)

    return lanes(condition, yes, no), codegen


@intrinsic
def lanes_set(typingctx, condition):
    """Return the lanes in which `condition` holds, as the bits of an integer."""

    def codegen(context, builder, signature, args):
        bits = builder.bitcast(args[0], ir.IntType(WIDTH))
        return builder.zext(bits, ir.IntType(64))

    return types.int64(condition), codegen


@intrinsic
def splat(typingctx, number):
    """Return lanes that all hold the same number."""

    def codegen(context, builder, signature, args):
        return _as_vector(context, builder, args[0], signature.args[0])

    return lanes(number), codegen


def _row_pointer(context, builder, array_type, array, row):
    data = context.make_array(array_type)(context, builder, array).data
    start = builder.mul(row, ir.Constant(row.type, WIDTH))
    return builder.bitcast(builder.gep(data, [start]), _VECTOR.as_pointer())


@intrinsic
def load(typingctx, array, row):
    """Return row `row` of a contiguous float64 array (n, WIDTH) as lanes."""

    def codegen(context, builder, signature, args):
        pointer = _row_pointer(context, builder, signature.args[0], *args)
        return builder.load(pointer, align=8)

    return lanes(array, types.intp), codegen


@intrinsic
def store(typingctx, array, row, value):
    """Write lanes to row `row` of a contiguous float64 array (n, WIDTH)."""

    def codegen(context, builder, signature, args):
        pointer = _row_pointer(context, builder, signature.args[0], args[0], args[1])
        builder.store(args[2], pointer, align=8)
        return context.get_dummy_value()

    return types.void(array, types.intp, value), codegen


@intrinsic
def _scale_by_power_of_two(typingctx, value, exponent):
    """Return value * 2**exponent; exponents are lanes of whole numbers from -1022 to 1023."""

    def codegen(context, builder, signature, args):
        whole = builder.fptosi(args[1], _BITS)
        biased = builder.add(whole, ir.Constant(_BITS, [1023] * WIDTH))
        power = builder.bitcast(builder.shl(biased, ir.Constant(_BITS, [52] * WIDTH)), _VECTOR)
        return builder.fmul(args[0], power)

    return lanes(value, exponent), codegen


@intrinsic
def _split_exponent(typingctx, value):
    """Return mantissa, in [sqrt(1/2), sqrt(2)), and exponent of lanes of positive normal numbers."""

    def codegen(context, builder, signature, args):
        def whole(number):
            return ir.Constant(_BITS, [number] * WIDTH)

        bits = builder.bitcast(args[0], _BITS)
        # Subtracting the bit pattern of sqrt(1/2) makes the exponent change there.
        shifted = builder.sub(bits, whole(0x3FE6A09E667F3BCD))
        exponent = builder.ashr(shifted, whole(52))
        mantissa = builder.bitcast(builder.sub(bits, builder.shl(exponent, whole(52))), _VECTOR)
        pair = [mantissa, builder.sitofp(exponent, _VECTOR)]
        return context.make_tuple(builder, signature.return_type, pair)

    return types.UniTuple(lanes, 2)(value), codegen


_LN2_HIGH = 6.93147180369123816490e-01
_LN2_LOW = 1.90821492927058770002e-10
_LOG2_E = 1.44269504088896338700


@compiled
def exp(x):
    """Return exp(x) of lanes up to 700, to 2 units in the last place; values below -700 count as -700.

    Cody and Waite's reduction to |r| <= ln(2)/2, then the Taylor series to degree 13, whose remainder there
    is 4e-18 (Muller, Elementary Functions, 2016, ch. 11).
    """
    x = select(x < -700.0, splat(-700.0), x)
    k = nearest(x * _LOG2_E)
    r = x - k * _LN2_HIGH - k * _LN2_LOW
    r2 = r * r
    r4 = r2 * r2
    low = (
        (1.0 + r)
        + r2 * (0.5 + r * (1.0 / 6.0))
        + r4 * ((1.0 / 24.0 + r * (1.0 / 120.0)) + r2 * (1.0 / 720.0 + r * (1.0 / 5040.0)))
    )
    high = (
        (1.0 / 40320.0 + r * (1.0 / 362880.0))
        + r2 * (1.0 / 3628800.0 + r * (1.0 / 39916800.0))
        + r4 * (1.0 / 479001600.0 + r * (1.0 / 6227020800.0))
    )
    return _scale_by_power_of_two(low + (r4 * r4) * high, k)


@compiled
def log(x):
    """Return the natural logarithm of lanes of positive normal numbers, to 2 units in the last place.

    ln(m) = 2 artanh((m - 1)/(m + 1)) by its series, and ln(2) for each power of two.
    """
    m, k = _split_exponent(x)
    s = (m - 1.0) / (m + 1.0)
    s2 = s * s
    tail = splat(1.0 / 23.0)
    tail = tail * s2 + 1.0 / 21.0
    tail = tail * s2 + 1.0 / 19.0
    tail = tail * s2 + 1.0 / 17.0
    tail = tail * s2 + 1.0 / 15.0
    tail = tail * s2 + 1.0 / 13.0
    tail = tail * s2 + 1.0 / 11.0
    tail = tail * s2 + 1.0 / 9.0
    tail = tail * s2 + 1.0 / 7.0
    tail = tail * s2 + 1.0 / 5.0
    tail = tail * s2 + 1.0 / 3.0
    return k * _LN2_HIGH + (2.0 * s + (2.0 * s * s2 * tail + k * _LN2_LOW))
