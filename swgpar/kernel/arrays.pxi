# Checks of the arrays that Python hands to a kernel, for all modules of kernels: type, shape, order, range of indices.
# The kernels read and write by these shapes and indices without further checks.

import numpy as np

cimport numpy as cnp

cnp.import_array()

DOUBLE, INT32, INT64, UINT8 = np.dtype("f8"), np.dtype("i4"), np.dtype("i8"), np.dtype("u1")

cdef enum:
    ANY = -1  # a size that is free
    SIXTHS = 6  # flags of images are below it: angles in sixths of a turn


cdef str shape_text(tuple shape):
    return "(" + ", ".join(["any" if size == ANY else str(size) for size in shape]) + ("," if len(shape) == 1 else "") + ")"


cdef object refusal(str function, str name, array, dtype, tuple shape, bint written):
    """The ValueError for an array that does not fit."""
    cdef str given = type(array).__name__
    if isinstance(array, np.ndarray):
        given = f"{array.dtype} {shape_text(array.shape)}"
        if not array.flags.c_contiguous:
            given += ", not C-ordered"
        if written and not array.flags.writeable:
            given += ", read-only"
    cdef str kind = str(dtype) if dtype.names is None else f"records of {', '.join(dtype.names)}"
    return ValueError(f"{function}: {name} is {given}; expected {kind} {shape_text(shape)}, C-ordered")


cdef object checked(str function, str name, array, dtype, tuple shape, bint written=False):
    """The array, where it has the type and the shape; raises ValueError. written : the kernel writes to it"""
    cdef bint fits = isinstance(array, cnp.ndarray)
    cdef Py_ssize_t k
    cdef cnp.ndarray known
    if fits:
        known = array
        fits = known.ndim == len(shape) and cnp.PyArray_IS_C_CONTIGUOUS(known) and cnp.PyArray_ISALIGNED(known)
        fits = fits and (known.dtype is dtype or known.dtype == dtype)
        fits = fits and (not written or cnp.PyArray_ISWRITEABLE(known))
        for k in range(len(shape)):
            fits = fits and (shape[k] == ANY or shape[k] == known.shape[k])
    if not fits:
        raise refusal(function, name, array, dtype, shape, written)
    return array


cdef object indices(str function, str name, array, dtype, tuple shape, low, end):
    """The array of indices, where it has the type and the shape, and values from `low` to below `end`.

    low : None where negative values stand for nothing. Raises ValueError.
    """
    checked(function, name, array, dtype, shape)
    if array.size and (array.max() >= end or (low is not None and array.min() < low)):
        allowed = f"below {end}" if low is None else f"from {low} to below {end}"
        raise ValueError(
            f"{function}: {name} {shape_text(array.shape)} has values from {array.min()} to {array.max()}; expected {allowed}"
        )
    return array
