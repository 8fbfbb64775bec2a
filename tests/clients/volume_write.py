"""Writes one solid in every form that meshio has for it: volume_write.py FOLDER."""

import pathlib
import sys

import meshio
import numpy

folder = pathlib.Path(sys.argv[1])
# A bar of cubes, each split into six tetrahedra.
grid = [(x, y, z) for x in range(3) for y in range(2) for z in range(2)]
number = {p: i for i, p in enumerate(grid)}
tets = []
for x in range(2):
    for order in ((0, 1, 2), (1, 2, 0), (2, 0, 1), (0, 2, 1), (2, 1, 0), (1, 0, 2)):
        at, path = [x, 0, 0], [number[x, 0, 0]]
        for axis in order:
            at[axis] += 1
            path.append(number[tuple(at)])
        if order in ((0, 2, 1), (2, 1, 0), (1, 0, 2)):
            path[2], path[3] = path[3], path[2]
        tets.append(path)
points = numpy.array(grid, float) + 0.1 * numpy.random.default_rng(1).random((len(grid), 3))
mesh = meshio.Mesh(points, [("tetra", tets)], point_data={"form0": points[:, 0]})
meshio.vtu.write(folder / "vtu_binary.vtu", mesh)
meshio.vtu.write(folder / "vtu_ascii.vtu", mesh, binary=False)
meshio.vtu.write(folder / "vtu_plain.vtu", mesh, compression=None)
meshio.vtu.write(folder / "vtu_lzma.vtu", mesh, compression="lzma")
bare = meshio.Mesh(points, [("tetra", tets)])
for version, name in (("gmsh", "msh4"), ("gmsh22", "msh2")):
    for binary in (False, True):
        kind = "binary" if binary else "ascii"
        meshio.write(folder / f"{name}_{kind}.msh", bare, file_format=version, binary=binary)
