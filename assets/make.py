#!/usr/bin/env python3
"""Makes the control meshes and fields of this folder. Standard library only, same output everywhere.

    python3 assets/make.py            write the files
    python3 assets/make.py --check    exit 1 if a file differs from what would be written

Every mesh is a list of points and a list of faces (indices from 0, counter-clockwise seen from
outside), with OpenSubdiv's OBJ tags. What each mesh is for: README.md beside this file.
"""

import json
import math
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
INFINITE = 10  # OpenSubdiv: sharpness from 10 up never decays


class Mesh:
    """Points by key, faces by key, tags: everything an OBJ with OpenSubdiv tags can say."""

    def __init__(self, about):
        self.about, self.number, self.points, self.faces, self.tags = about, {}, [], [], []

    def point(self, key, position):
        self.number[key] = len(self.points)
        # The 0.0 turns -0.0 into 0.0.
        self.points.append(tuple(round(x, 4) + 0.0 for x in position))

    def face(self, *keys):
        self.faces.append(tuple(self.number[k] for k in keys))

    def edges(self):
        """Each edge once, lower vertex first, in the order in which the faces meet them."""
        seen = {}
        for face in self.faces:
            for a, b in zip(face, face[1:] + face[:1]):
                seen.setdefault((min(a, b), max(a, b)))
        return list(seen)

    def crease(self, sharpness, *keys):
        """A chain of sharp edges."""
        for a, b in zip(keys, keys[1:]):
            self.tags.append(f"t crease 2/1/0 {self.number[a]} {self.number[b]} {sharpness:g}")

    def loop(self, sharpness, *keys):
        self.crease(sharpness, *keys, keys[0])

    def corner(self, sharpness, *keys):
        self.tags += [f"t corner 1/1/0 {self.number[k]} {sharpness:g}" for k in keys]

    def tag(self, text):
        self.tags.append("t " + text)

    def obj(self):
        lines = [f"# {self.about}", "# made by assets/make.py"]
        lines += ["v " + " ".join(f"{x:g}" for x in p) for p in self.points]
        lines += ["f " + " ".join(str(v + 1) for v in f) for f in self.faces]
        return "\n".join(lines + self.tags) + "\n"


def of_voxels(mesh, voxels, position, skip=lambda lattice_face: False):
    """The boundary of a set of unit cubes, as quads; `position` places the lattice points."""
    voxels = set(voxels)
    quads = []
    for cube in sorted(voxels):
        for axis in range(3):
            for side in (0, 1):
                beyond = list(cube)
                beyond[axis] += 2 * side - 1
                if tuple(beyond) in voxels:
                    continue
                u, v = (axis + 1) % 3, (axis + 2) % 3
                quad = []
                for du, dv in ((0, 0), (1, 0), (1, 1), (0, 1)):
                    corner = list(cube)
                    corner[axis] += side
                    corner[u] += du
                    corner[v] += dv
                    quad.append(tuple(corner))
                quad = quad if side else quad[::-1]
                if not skip(quad):
                    quads.append(quad)
    for key in sorted({key for quad in quads for key in quad}):
        mesh.point(key, position(*key))
    for quad in quads:
        mesh.face(*quad)


def rectangle(i0, i1, j0, j1):
    """The lattice points round a rectangle, counter-clockwise."""
    return (
        [(i, j0) for i in range(i0, i1)]
        + [(i1, j) for j in range(j0, j1)]
        + [(i, j1) for i in range(i1, i0, -1)]
        + [(i0, j) for j in range(j1, j0, -1)]
    )


def circulations(mesh, vector):
    """The 1-form of a vector field: its integral along each edge (Simpson's rule)."""
    entries = []
    for a, b in mesh.edges():
        p, q = mesh.points[a], mesh.points[b]
        step = [y - x for x, y in zip(p, q)]
        total = 0.0
        for weight, t in ((1, 0.0), (4, 0.5), (1, 1.0)):
            at = [x + t * s for x, s in zip(p, step)]
            total += weight / 6 * sum(f * s for f, s in zip(vector(*at), step))
        entries.append([a, b, round(total, 6) + 0.0])
    return entries


def fields_file(**cochains):
    parts = []
    for name, entries in cochains.items():
        parts.append(f'"{name}": [\n' + ",\n".join(json.dumps(e) for e in entries) + "\n]")
    return "{" + ", ".join(parts) + "}\n"


# ---------------------------------------------------------------------------------------- the meshes


def creased_box():
    """A box with a handle through which one can reach, a raised panel, and every kind of crease."""
    mesh = Mesh("A box with a handle (genus 1): sharp foot and panel, semi-sharp rims, a dart, an 18-gon below")
    xs = [-2.1, -1.55, -0.8, 0.0, 0.8, 1.55, 2.1]
    ys = [-1.5, -1.15, -0.38, 0.38, 1.15]
    zs = [0.0, 0.5, 1.15, 1.65, 2.4, 3.05]

    def position(i, j, k):
        x, y, z = xs[i], ys[j], zs[k]
        if k <= 3:
            if i in (0, 6) and j in (1, 4):  # round the upright edges of the box
                x, y = 0.9 * x, 0.88 * y
            flare = 1.12 - 0.12 * k / 3  # a wider foot
            x, y = x * flare, y * flare
        if j == 0:  # taper the panel
            x, z = 0.94 * x, 0.825 + 0.84 * (z - 0.825)
        if k == 5:  # arch the handle
            x, z = 0.86 * x, z + 0.28 * (1 - (x / 1.55) ** 2)
        if k == 4 and i in (2, 3, 4):
            z += 0.2 * (1 - (x / 0.8) ** 2)
        return x, y, z

    box = [(i, j, k) for i in range(6) for j in (1, 2, 3) for k in (0, 1, 2)]
    panel = [(i, 0, 1) for i in (1, 2, 3, 4)]
    handle = [(1, 2, 3), (4, 2, 3)] + [(i, 2, 4) for i in (1, 2, 3, 4)]
    of_voxels(mesh, box + panel + handle, position, skip=lambda quad: all(k == 0 for _, _, k in quad))
    foot = [(i, j, 0) for i, j in rectangle(0, 6, 1, 4)]
    mesh.face(*foot[::-1])

    mesh.loop(INFINITE, *foot)
    mesh.loop(2.5, *[(i, j, 3) for i, j in rectangle(0, 6, 1, 4)])
    face, root = ([(i, j, k) for i, k in rectangle(1, 5, 1, 2)] for j in (0, 1))
    mesh.loop(INFINITE, *face)
    mesh.loop(2.5, *root)
    mesh.corner(INFINITE, *[face[i] for i in (0, 4, 5, 9)])
    mesh.corner(2, *[root[i] for i in (0, 4, 5, 9)])
    for i in (1, 4):
        mesh.loop(1.3, *[(x, y, 3) for x, y in rectangle(i, i + 1, 2, 3)])
    mesh.crease(INFINITE, (6, 2, 0), (6, 2, 1), (6, 2, 2))  # ends inside the side: a dart
    mesh.corner(1.5, (0, 1, 0), (6, 1, 0), (6, 4, 0), (0, 4, 0))
    return mesh


def swirl(x, y, z):
    """A vortex about a leaning axis through the box, and another about the middle of the handle."""
    vortices = (
        ((0.2, -0.3, 0.9), (0.0, -0.2, 1.2), 1.0, 1.6),
        ((1.0, 0.0, 0.0), (0.0, 0.0, 2.7), 1.9, 0.9),
    )  # axis, centre, strength, radius
    sum_ = [0.0, 0.0, 0.0]
    for axis, centre, strength, radius in vortices:
        r = (x - centre[0], y - centre[1], z - centre[2])
        turn = (
            axis[1] * r[2] - axis[2] * r[1],
            axis[2] * r[0] - axis[0] * r[2],
            axis[0] * r[1] - axis[1] * r[0],
        )
        fade = strength / (1 + sum(c * c for c in r) / radius**2) ** 2
        sum_ = [s + fade * t for s, t in zip(sum_, turn)]
    return sum_


def open_polygons():
    """A bounded patch: a hexagon, then triangles and quads, then pentagons and quads."""
    mesh = Mesh("A bounded patch of triangles, quads, pentagons and a hexagon, with semi-sharp creases")

    def place(key, radius, degrees):
        x, y = (radius * f(math.radians(degrees)) for f in (math.cos, math.sin))
        mesh.point(key, (x, y, 0.9 - 0.09 * radius * radius + 0.12 * math.sin(1.7 * x - 0.6 * y)))

    for s in range(6):
        place(("a", s), 1.0, 60 * s)
    for s in range(6):  # the outer corners of the quad on side s of the hexagon
        place(("b", s, 0), 1.95, 60 * s + 15)
        place(("b", s, 1), 1.95, 60 * s + 45)
    for s in range(6):
        place(("c", s, 0), 2.9, 60 * s + 12)
        place(("c", s, 1), 2.9, 60 * s + 48)
        place(("tip", s), 3.5, 60 * s + 30)
    mesh.face(*[("a", s) for s in range(6)])
    for s in range(6):
        t = (s + 1) % 6
        mesh.face(("a", s), ("b", s, 0), ("b", s, 1), ("a", t))
        mesh.face(("a", t), ("b", s, 1), ("b", t, 0))
        mesh.face(("b", s, 0), ("c", s, 0), ("tip", s), ("c", s, 1), ("b", s, 1))
        mesh.face(("b", s, 1), ("c", s, 1), ("c", t, 0), ("b", t, 0))
    mesh.tag("interpolateboundary 1/0/0 1")  # boundary edges are creases, boundary corners sharp
    mesh.tag("creasemethod 0/0/1 chaikin")
    for s in range(6):
        mesh.crease(0.7 + 0.5 * s, ("a", s), ("a", (s + 1) % 6))
    mesh.crease(1.4, ("a", 0), ("b", 0, 0))
    mesh.crease(2.2, ("b", 0, 0), ("c", 0, 0))
    mesh.crease(INFINITE, ("a", 3), ("b", 3, 0), ("c", 3, 0))
    mesh.corner(2.5, ("b", 1, 1))
    mesh.corner(INFINITE, ("b", 4, 0))
    mesh.tag(f"hole 1/0/0 {len(mesh.faces) - 1}")
    return mesh


def genus2():
    """A plate with two windows and a knob on each corner, where vertices of valence 6 arise."""
    mesh = Mesh("A plate with two windows (genus 2) and four knobs: quads, smooth, valences 3 to 6")
    xs = [-2.6, -1.75, -0.85, 0.0, 0.85, 1.75, 2.6]
    ys = [-1.5, -0.5, 0.5, 1.5]

    def position(i, j, k):
        x, y = xs[i], ys[j]
        if i in (0, 6) and j in (0, 3):
            x, y = 0.86 * x, 0.8 * y
        return x, y, (0.5 + 0.12 * math.cos(1.2 * x)) * (2 * min(k, 1) - 1) + 0.7 * (k == 2)

    knobs = [(i, j, 1) for i in (0, 5) for j in (0, 2)]
    plate = [(i, j, 0) for i in range(6) for j in range(3) if (i, j) not in ((1, 1), (4, 1))]
    of_voxels(mesh, plate + knobs, position)
    return mesh


def window_form(mesh):
    """The angle round the left window, in turns: closed, not exact; 1 round the window, 0 round the other.

    Each vertex has an angle of six decimals and an edge the difference, less a whole turn where it
    crosses the cut. So the sum round a face vanishes but for rounding.
    """
    angle = [round(math.atan2(y, x + 1.3) / math.tau, 6) for x, y, _ in mesh.points]
    entries = []
    for a, b in mesh.edges():
        step = angle[b] - angle[a]
        entries.append([a, b, round(step - round(step), 6) + 0.0])
    return entries


def high_valence():
    """A spinning top: 24 triangles at the pole, rings of quads, one 24-gon below."""
    mesh = Mesh("A spinning top: a pole of valence 24, rings of quads, a 24-gon below")
    n, rings = 24, [(0.45, 1.35), (0.6, 0.85), (1.6, 0.45), (1.75, 0.1), (0.9, -0.75), (0.25, -1.25)]
    mesh.point("pole", (0, 0, 1.45))
    for r, (radius, height) in enumerate(rings):
        for s in range(n):
            a = math.tau * s / n
            ripple = 1 + 0.05 * math.cos(6 * a) * (r in (2, 3))
            mesh.point((r, s), (ripple * radius * math.cos(a), ripple * radius * math.sin(a), height))
    for s in range(n):
        mesh.face("pole", (0, s), (0, (s + 1) % n))
    for r in range(len(rings) - 1):
        for s in range(n):
            t = (s + 1) % n
            mesh.face((r, s), (r + 1, s), (r + 1, t), (r, t))
    mesh.face(*[(len(rings) - 1, s) for s in range(n)][::-1])
    mesh.loop(1.8, *[(2, s) for s in range(n)])
    return mesh


def fin():
    """Non-manifold: a fin stands on a plate, and a tetrahedron touches the plate at one vertex."""
    mesh = Mesh("Non-manifold: a fin on a plate (three faces at an edge), a tetrahedron touching a vertex")
    for i in range(5):
        for j in range(4):
            mesh.point((i, j), (i - 2.0, j - 1.5, 0.1 * (i - 2) ** 2))
    for i in range(4):
        for j in range(3):
            mesh.face((i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1))
    for i in range(3):  # the fin ends at (2, 1), inside the plate
        mesh.point(("top", i), (i - 2.0, -0.5, 1.3 - 0.2 * i))
    for i in range(2):
        mesh.face((i, 1), (i + 1, 1), ("top", i + 1), ("top", i))
    for s in range(3):  # the tetrahedron on (3, 2)
        a = math.tau * s / 3
        mesh.point(("tip", s), (1.0 + 0.6 * math.cos(a), 0.5 + 0.6 * math.sin(a), 1.2))
    for s in range(3):
        mesh.face((3, 2), ("tip", (s + 1) % 3), ("tip", s))
    mesh.face(("tip", 0), ("tip", 1), ("tip", 2))
    mesh.crease(2, ("top", 0), ("top", 1), ("top", 2))
    return mesh


def torus():
    """Regular everywhere: the reference for spline values."""
    mesh = Mesh("A torus of 16 x 8 quads, every vertex of valence 4")
    m, n = 16, 8
    for i in range(m):
        for j in range(n):
            a, b = math.tau * i / m, math.tau * j / n
            ring = 1.6 + 0.65 * math.cos(b)
            mesh.point((i, j), (ring * math.cos(a), ring * math.sin(a), 0.65 * math.sin(b)))
    for i in range(m):
        for j in range(n):
            k, l = (i + 1) % m, (j + 1) % n
            mesh.face((i, j), (k, j), (k, l), (i, l))
    return mesh


def gem():
    """Triangles only, for Loop's schemes: poles of valence 7 and 14, and a crease between them."""
    mesh = Mesh("A cut gem of triangles, its girdle semi-sharp")
    n = 7
    mesh.point("top", (0.0, 0.0, 0.7))
    mesh.point("tip", (0.0, 0.0, -1.2))
    for i in range(n):
        turn = math.tau * i / n
        mesh.point(("crown", i), (0.65 * math.cos(turn), 0.65 * math.sin(turn), 0.6))
    for i in range(2 * n):
        turn = math.tau * (i - 0.5) / (2 * n)
        mesh.point(("girdle", i), (1.2 * math.cos(turn), 1.2 * math.sin(turn), 0.1))
    for i in range(n):
        j, a, b, c = (i + 1) % n, 2 * i, 2 * i + 1, (2 * i + 2) % (2 * n)
        mesh.face("top", ("crown", i), ("crown", j))
        mesh.face(("crown", i), ("girdle", a), ("girdle", b))
        mesh.face(("crown", i), ("girdle", b), ("crown", j))
        mesh.face(("crown", j), ("girdle", b), ("girdle", c))
    for i in range(2 * n):
        j = (i + 1) % (2 * n)
        mesh.face("tip", ("girdle", j), ("girdle", i))
    mesh.loop(2.2, *(("girdle", i) for i in range(2 * n)))
    return mesh


def usd(kind, name, values):
    """One attribute of a USD mesh; triples in brackets of their own."""
    each = (f"({', '.join(f'{x:g}' for x in v)})" if isinstance(v, tuple) else f"{v:g}" for v in values)
    return f"{kind}[] {name} = [{', '.join(each)}]"


def scene():
    """A USD stage of two meshes: one moves and has a 1-form, one is left-handed and has tags of every kind."""
    wave, (m, n) = Mesh(""), (6, 4)
    for i in range(m + 1):
        for j in range(n + 1):
            wave.point((i, j), (i, 0, j))
    for i in range(m):
        for j in range(n):
            wave.face((i, j), (i, j + 1), (i + 1, j + 1), (i + 1, j))

    def points(time):
        return [(x, round(0.6 * math.sin(1.1 * x + time), 4) + 0.0, z) for x, _, z in wave.points]

    # Along x the circulation grows with z: a shear, which has a curl.
    along = [round((wave.points[b][0] - wave.points[a][0]) * (1 + wave.points[a][2]) / 4, 4) + 0.0
             for face in wave.faces for a, b in zip(face, face[1:] + face[:1])]
    samples = "\n".join(f"            {t + 1}: {usd('', '', points(t)).split('= ')[1]}," for t in range(3))
    heights = [[y for _, y, _ in points(t)] for t in range(3)]
    extents = "\n".join(f"            {t + 1}: [(0, {min(h):g}, 0), ({m}, {max(h):g}, {n})]," for t, h in enumerate(heights))
    crate = [(x, y, z) for z in (0, 1) for y in (0, 1) for x in (0, 1)]
    faces = [0, 1, 3, 2, 4, 6, 7, 5, 0, 4, 5, 1, 1, 5, 7, 3, 3, 7, 6, 2, 2, 6, 4, 0]
    return f"""#usda 1.0
(
    "made by assets/make.py"
    defaultPrim = "Scene"
    endTimeCode = 3
    metersPerUnit = 0.01
    startTimeCode = 1
    upAxis = "Y"
)

def Xform "Scene" (
    kind = "assembly"
)
{{
    def Mesh "Wave" (
        doc = "Three frames, and a 1-form as signed values of half-edges."
    )
    {{
        float3[] extent.timeSamples = {{
{extents}
        }}
        {usd("int", "faceVertexCounts", [4] * len(wave.faces))}
        {usd("int", "faceVertexIndices", [v for face in wave.faces for v in face])}
        point3f[] points.timeSamples = {{
{samples}
        }}
        {usd("float", "primvars:form1", along)} (
            interpolation = "faceVarying"
        )
        uniform token subdivisionScheme = "catmullClark"
    }}

    def Mesh "Crate" (
        prepend apiSchemas = ["MaterialBindingAPI"]
    )
    {{
        {usd("int", "cornerIndices", [7])}
        {usd("float", "cornerSharpnesses", [2.5])}
        {usd("int", "creaseIndices", [0, 1, 3, 2, 0, 4, 5])}
        {usd("int", "creaseLengths", [5, 2])}
        {usd("float", "creaseSharpnesses", [10, 1.5])}
        {usd("float3", "extent", [(0, 0, 0), (1, 1, 1)])}
        {usd("int", "faceVertexCounts", [4] * 6)}
        {usd("int", "faceVertexIndices", faces)}
        {usd("int", "holeIndices", [4])}
        uniform token interpolateBoundary = "edgeOnly"
        rel material:binding = </Scene/Paint>
        uniform token orientation = "leftHanded"
        {usd("point3f", "points", crate)}
        {usd("color3f", "primvars:displayColor", [(1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 1, 0), (0, 1, 1), (1, 0, 1)])} (
            interpolation = "uniform"
        )
        {usd("texCoord2f", "primvars:st", [(0, 0), (1, 0), (1, 1), (0, 1)] * 6)} (
            interpolation = "faceVarying"
        )
        uniform token subdivisionScheme = "catmullClark"
        uniform token subsetFamily:materialBind:familyType = "nonOverlapping"
        double3 xformOp:translate = (8, 0, 1)
        float xformOp:rotateY = 30
        uniform token[] xformOpOrder = ["xformOp:translate", "xformOp:rotateY"]

        def GeomSubset "lid" (
            prepend apiSchemas = ["MaterialBindingAPI"]
        )
        {{
            uniform token elementType = "face"
            uniform token familyName = "materialBind"
            {usd("int", "indices", [1, 3])}
            rel material:binding = </Scene/Paint>
        }}
    }}

    def Material "Paint"
    {{
        token outputs:surface.connect = </Scene/Paint/Shader.outputs:surface>

        def Shader "Shader"
        {{
            uniform token info:id = "UsdPreviewSurface"
            color3f inputs:diffuseColor = (0.7, 0.2, 0.1)
            token outputs:surface
        }}
    }}

    def DistantLight "Sun" (
        customData = {{
            string note = "kept as it is"
        }}
    )
    {{
        float inputs:intensity = 2.5
    }}
}}
"""


def ball():
    """A ball: a grid of 4 x 4 x 4 cubes of six tetrahedra each, its square shells drawn in to spheres."""
    size = 4
    number, points, tets = {}, [], []
    for key in [(i, j, k) for i in range(size + 1) for j in range(size + 1) for k in range(size + 1)]:
        p = [2 * x / size - 1 for x in key]
        shell, radius = max(map(abs, p)), math.hypot(*p)
        number[key] = len(points)
        points.append([round(x * shell / radius, 5) + 0.0 if radius else 0.0 for x in p])
    for corner in [(i, j, k) for i in range(size) for j in range(size) for k in range(size)]:
        # From one corner of the cube to the opposite one along three sides, in six orders.
        for order in ((0, 1, 2), (1, 2, 0), (2, 0, 1), (0, 2, 1), (2, 1, 0), (1, 0, 2)):
            path, at = [number[corner]], list(corner)
            for axis in order:
                at[axis] += 1
                path.append(number[tuple(at)])
            if order in ((0, 2, 1), (2, 1, 0), (1, 0, 2)):
                path[2], path[3] = path[3], path[2]
            tets.append(path)
    return points, tets


def msh(points, tets):
    """Gmsh 4.1, as text."""
    n = len(points)
    lines = ["$MeshFormat", "4.1 0 8", "$EndMeshFormat", "$Nodes", f"1 {n} 1 {n}", f"3 1 0 {n}"]
    lines += [str(i + 1) for i in range(n)]
    lines += [" ".join(f"{x:g}" for x in p) for p in points]
    m = len(tets)
    lines += ["$EndNodes", "$Elements", f"1 {m} 1 {m}", f"3 1 4 {m}"]
    lines += [" ".join(str(x) for x in [i + 1] + [v + 1 for v in tet]) for i, tet in enumerate(tets)]
    return "\n".join(lines + ["$EndElements"]) + "\n"


def vortices(x, y, z):
    """Two vortices about leaning axes, one either way round, and a flow along the first axis."""
    u, v = x - 0.4, x + 0.4
    a, b = math.exp(-3 * (u * u + y * y)), math.exp(-3 * (v * v + y * y))
    return 0.2 - 3 * y * (a - b), 3 * (u * a - v * b), 0.8 * a + 0.3 * math.sin(3 * z)


def ball_field():
    points, tets = ball()
    edges = sorted({tuple(sorted((a, b))) for tet in tets for a in tet for b in tet if a != b})
    entries = []
    for a, b in edges:
        middle = [(p + q) / 2 for p, q in zip(points[a], points[b])]
        value = sum(f * (q - p) for f, p, q in zip(vortices(*middle), points[a], points[b]))
        entries.append(f"[{a}, {b}, {round(value, 6) + 0.0:g}]")
    rows = [", ".join(entries[i : i + 6]) for i in range(0, len(entries), 6)]
    return '{\n"edges": [\n  ' + ",\n  ".join(rows) + "\n]\n}\n"


def octets():
    """The lattice cells of a cube, 2 x 2 x 2: octahedra as pairs of pyramids, with a 0-form and a 3-form."""
    size = 2
    keys = [(i, j, k) for i in range(size + 1) for j in range(size + 1) for k in range(size + 1)]
    keys = [key for key in keys if sum(key) % 2 == 0]
    number = {key: i for i, key in enumerate(keys)}
    tets, pyramids = [], []
    for x, y, z in [(i, j, k) for i in range(size) for j in range(size) for k in range(size)]:
        even = [(0, 0, 0), (1, 1, 0), (0, 1, 1), (1, 0, 1)]
        odd = [(1, 1, 1), (0, 0, 1), (0, 1, 0), (1, 0, 0)]
        corners = even if (x + y + z) % 2 == 0 else odd
        tets.append([number[x + a, y + b, z + c] for a, b, c in corners])
    steps = [(1, 0, 0), (0, 1, 0), (0, 0, 1), (-1, 0, 0), (0, -1, 0), (0, 0, -1)]
    for x, y, z in [(i, j, k) for i in range(size + 1) for j in range(size + 1) for k in range(size + 1)]:
        around = [(x + a, y + b, z + c) for a, b, c in steps]
        if (x + y + z) % 2 and all(key in number for key in around):
            a, b, c, d, e, f = (number[key] for key in around)
            pyramids += [[a, b, d, e, c], [e, d, b, a, f]]
    cells = tets + pyramids
    ends = [sum(len(cell) for cell in cells[: i + 1]) for i in range(len(cells))]
    array = lambda kind, name, parts, values: (
        f'<DataArray type="{kind}" Name="{name}" NumberOfComponents="{parts}" format="ascii">\n'
        + " ".join(values)
        + "\n</DataArray>"
    )
    form0 = [f"{math.sin(1 + 2 * x + 3 * y - z):.4f}" for x, y, z in keys]
    form3 = [f"{math.cos(i):.4f}" for i in range(len(cells))]
    lines = ['<?xml version="1.0"?>', '<VTKFile type="UnstructuredGrid" version="0.1" byte_order="LittleEndian">']
    lines += ["<UnstructuredGrid>", f'<Piece NumberOfPoints="{len(keys)}" NumberOfCells="{len(cells)}">']
    lines += ["<Points>", array("Float64", "Points", 3, [str(x) for key in keys for x in key]), "</Points>"]
    lines += ["<Cells>", array("Int64", "connectivity", 1, [str(v) for cell in cells for v in cell])]
    lines += [array("Int64", "offsets", 1, [str(end) for end in ends])]
    lines += [array("UInt8", "types", 1, ["10"] * len(tets) + ["14"] * len(pyramids)), "</Cells>"]
    lines += ["<PointData>", array("Float64", "form0", 1, form0), "</PointData>"]
    lines += ["<CellData>", array("Float64", "form3", 1, form3), "</CellData>"]
    return "\n".join(lines + ["</Piece>", "</UnstructuredGrid>", "</VTKFile>"]) + "\n"


def files():
    box, plate = creased_box(), genus2()
    return {
        "creased_box.obj": box.obj(),
        "creased_box.field.json": fields_file(edges=circulations(box, swirl)),
        "open_polygons.obj": open_polygons().obj(),
        "genus2.obj": plate.obj(),
        "genus2.field.json": fields_file(edges=window_form(plate)),
        "high_valence.obj": high_valence().obj(),
        "fin.obj": fin().obj(),
        "torus.obj": torus().obj(),
        "gem.obj": gem().obj(),
        "scene.usda": scene(),
        "ball.msh": msh(*ball()),
        "ball.field.json": ball_field(),
        "octets.vtu": octets(),
    }


def main(arguments):
    if arguments not in ([], ["--check"]):
        sys.exit(__doc__)
    stale = []
    for name, text in files().items():
        path = HERE / name
        if not arguments:
            path.write_text(text)
        elif not path.exists() or path.read_text() != text:
            stale.append(name)
    if stale:
        sys.exit(f"assets/{', assets/'.join(stale)} differ from make.py: run python3 assets/make.py")


if __name__ == "__main__":
    main(sys.argv[1:])
