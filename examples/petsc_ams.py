#!/usr/bin/env python3
"""Solve a vector problem with the smooth 1-forms on a large surface by PETSc and hypre's AMS.

    formwork masses torus.obj --level 4 -o torus.petsc
    python3 petsc_ams.py torus.petsc [--beta 1]

The system is (d1' M2 d1 + beta M1) w = M1 f, the curl-curl problem with a mass, by conjugate gradients. AMS (auxiliary
space Maxwell solver) wants the discrete gradient d0 and the differentials of the coordinates, which are in the file;
that the smooth forms are a complex with the same d0 is what makes it work. Without petsc4py the same file is read by
numpy and the system solved by SciPy's conjugate gradients with the diagonal: the same answer, slowly.

Debian and Ubuntu: apt install python3-petsc4py-real, and where /usr/bin/python3 does not find it then, set PYTHONPATH to
the folder of `dpkg -L python3-petsc4py-real3.18` that ends with dist-packages. Prints one JSON object.
"""

import argparse
import json
import time

import numpy

NAMES = ["d0", "d1", "M0", "M1", "M2", "K0", "K1", "dx", "dy", "dz"]


def with_petsc(path, beta):
    from petsc4py import PETSc

    viewer = PETSc.Viewer().createBinary(path, "r", comm=PETSc.COMM_SELF)
    objects = {}
    for name in NAMES:
        kind = PETSc.Vec if name in ("dx", "dy", "dz") else PETSc.Mat
        objects[name] = kind().create(comm=PETSc.COMM_SELF).load(viewer)
    system = objects["K1"].copy()
    system.axpy(beta, objects["M1"], structure=PETSc.Mat.Structure.DIFFERENT_NONZERO_PATTERN)
    right = system.createVecLeft()
    objects["M1"].mult(data(objects["dx"]), right)
    solver = PETSc.KSP().create(comm=PETSc.COMM_SELF)
    solver.setOperators(system)
    solver.setType("cg")
    solver.setTolerances(rtol=1e-10, max_it=5000)
    preconditioner = solver.getPC()
    preconditioner.setType("hypre")
    preconditioner.setHYPREType("ams")
    preconditioner.setHYPREDiscreteGradient(objects["d0"])
    preconditioner.setHYPRESetEdgeConstantVectors(objects["dx"], objects["dy"], objects["dz"])
    solver.setFromOptions()
    start = time.time()
    solution = system.createVecRight()
    solver.solve(right, solution)
    residual = right.duplicate()
    system.mult(solution, residual)
    residual.axpy(-1, right)
    return {
        "solver": "petsc cg + hypre ams",
        "unknowns": system.getSize()[0],
        "iterations": solver.getIterationNumber(),
        "converged": solver.getConvergedReason() > 0,
        "residual": residual.norm() / right.norm(),
        "seconds": time.time() - start,
        "norm": solution.norm(),
    }


def data(dx):
    """The data f: dx, bent, so that it is neither closed nor small anywhere."""
    f = dx.copy()
    values = f.getArray()
    values *= 1 + 0.5 * numpy.sin(numpy.arange(len(values)))
    return f


def read_objects(path):
    """The objects of a PETSc binary file: scipy matrices and numpy vectors."""
    import scipy.sparse

    raw = open(path, "rb").read()
    at, objects = 0, []

    def take(kind, count):
        nonlocal at
        values = numpy.frombuffer(raw, kind, count, at)
        at += values.nbytes
        return values

    while at < len(raw):
        kind = take(">i4", 1)[0]
        if kind == 1211216:
            rows, columns, entries = take(">i4", 3)
            starts = numpy.concatenate([[0], numpy.cumsum(take(">i4", rows))])
            indices = take(">i4", entries).astype(numpy.int32)
            values = take(">f8", entries).astype(float)
            objects.append(scipy.sparse.csr_matrix((values, indices, starts), shape=(rows, columns)))
        elif kind == 1211214:
            objects.append(take(">f8", take(">i4", 1)[0]).astype(float))
        else:
            raise SystemExit(f"{path}: byte {at - 4}: neither a matrix nor a vector of PETSc")
    return objects


def with_scipy(path, beta):
    import scipy.sparse
    import scipy.sparse.linalg

    objects = dict(zip(NAMES, read_objects(path)))
    system = (objects["K1"] + beta * objects["M1"]).tocsr()
    f = objects["dx"] * (1 + 0.5 * numpy.sin(numpy.arange(len(objects["dx"]))))
    right = objects["M1"] @ f
    steps = []
    start = time.time()
    inverse = scipy.sparse.diags(1 / system.diagonal())
    solution, info = scipy.sparse.linalg.cg(
        system, right, rtol=1e-10, maxiter=20000, M=inverse, callback=steps.append
    )
    return {
        "solver": "scipy cg + diagonal",
        "unknowns": system.shape[0],
        "iterations": len(steps),
        "converged": info == 0,
        "residual": float(numpy.linalg.norm(system @ solution - right) / numpy.linalg.norm(right)),
        "seconds": time.time() - start,
        "norm": float(numpy.linalg.norm(solution)),
    }


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("file", help="what `formwork masses` wrote, .petsc")
    parser.add_argument("--beta", type=float, default=1.0, help="the weight of the mass")
    parser.add_argument("--scipy", action="store_true", help="do not look for petsc4py")
    options = parser.parse_args()
    solve = with_scipy
    if not options.scipy:
        try:
            import petsc4py.PETSc  # noqa: F401

            solve = with_petsc
        except ImportError:
            pass
    print(json.dumps(solve(options.file, options.beta)))


if __name__ == "__main__":
    main()
