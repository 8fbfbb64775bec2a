#!/usr/bin/env python3
"""The C ABI from another language: the operators of a cube, refined twice, as SciPy matrices, through ctypes alone.

    python3 examples/ctypes_stencils.py /usr/local/lib/libformwork.so
"""

import ctypes
import sys
from ctypes import POINTER, byref, c_char_p, c_float, c_int32, c_uint32, c_void_p

import numpy
import scipy.sparse


class Cage(ctypes.Structure):
    """FormworkCage in formwork.h."""

    _fields_ = [
        ("num_vertices", c_uint32),
        ("num_faces", c_uint32),
        ("face_sizes", POINTER(c_uint32)),
        ("face_vertices", POINTER(c_uint32)),
        ("num_creases", c_uint32),
        ("crease_vertices", POINTER(c_uint32)),
        ("crease_sharpness", POINTER(c_float)),
        ("num_corners", c_uint32),
        ("corner_vertices", POINTER(c_uint32)),
        ("corner_sharpness", POINTER(c_float)),
        ("num_holes", c_uint32),
        ("holes", POINTER(c_uint32)),
        ("boundary", c_uint32),
        ("creasing", c_uint32),
        ("triangles", c_uint32),
        ("left_handed", c_uint32),
    ]


formwork = ctypes.CDLL(sys.argv[1])
formwork.formwork_last_error.restype = c_char_p


def call(name, *arguments):
    """Calls a function of the C ABI; its status becomes an exception."""
    if getattr(formwork, "formwork_" + name)(*arguments) != 0:
        raise RuntimeError(formwork.formwork_last_error().decode())


def pointer(array):
    return array.ctypes.data_as(c_void_p)


def hierarchy(sizes, vertices, levels, scheme=1):
    """A mesh refined by Catmull-Clark (1), Loop (2) or another scheme."""
    arrays = [(c_uint32 * len(values))(*values) for values in (sizes, vertices)]
    cage = Cage(max(vertices) + 1, len(sizes), *arrays, boundary=1)
    handle = c_void_p()
    call("hierarchy_from_cage", byref(cage), c_uint32(scheme), None, c_int32(levels), byref(handle))
    return handle


def stencils(mesh, degree, start, end):
    """The operator on forms of a degree, from one level to another, as a sparse matrix."""
    handle = c_void_p()
    call("stencils_refine", mesh, *map(c_int32, (degree, start, end)), c_uint32(0), byref(handle))
    counts = numpy.empty(4, numpy.uint32)  # FormworkStencilCounts
    call("stencils_counts", handle, pointer(counts))
    columns, rows, entries, _ = map(int, counts)
    sizes, indices = numpy.zeros(rows, numpy.uint32), numpy.zeros(entries, numpy.uint32)
    weights = numpy.zeros(entries)
    arrays = map(pointer, (sizes, indices, weights))
    call("stencils_rows_f64", handle, *map(c_uint32, (0, 0, rows)), *arrays)
    formwork.formwork_stencils_free(handle)
    offsets = numpy.concatenate([[0], numpy.cumsum(sizes)])
    return scipy.sparse.csr_matrix((weights, indices, offsets), shape=(rows, columns))


def d0(mesh, level):
    """The exterior derivative of values at vertices: differences along edges."""
    counts = numpy.empty(4, numpy.uint32)  # FormworkCounts
    call("hierarchy_counts", mesh, c_int32(level), pointer(counts))
    vertices, edges = int(counts[0]), int(counts[1])
    ends = numpy.empty((edges, 2), numpy.uint32)
    call("hierarchy_topology", mesh, c_int32(level), pointer(ends), None, None, None, None)
    rows = numpy.repeat(numpy.arange(edges), 2)
    return scipy.sparse.csr_matrix((numpy.tile([-1.0, 1.0], edges), (rows, ends.ravel())), (edges, vertices))


cube = [0, 1, 3, 2, 2, 3, 5, 4, 4, 5, 7, 6, 6, 7, 1, 0, 1, 7, 5, 3, 6, 0, 2, 4]
mesh = hierarchy([4] * 6, cube, 2)
S0, S1 = (stencils(mesh, degree, 0, 2) for degree in (0, 1))
worst = abs(d0(mesh, 2) @ S0 - S1 @ d0(mesh, 0)).max()
formwork.formwork_hierarchy_free(mesh)

try:
    hierarchy([4, 4], [0, 1, 2, 3, 1, 4, 5, 5], 1)
    raise SystemExit("a face that repeats a vertex was taken")
except RuntimeError as error:
    assert "vertex 5" in str(error), error

print(f"{S1.shape[0]} edges from {S1.shape[1]}; d S - S d is at most {worst:.1g}")
