//! What `--help` says after the options: how it works, and examples that run.

// Lines of at most 79 characters: clap breaks longer ones in a narrow terminal, code and all.
pub const EXAMPLES: &str = "\
Start here, from the folder of the sources:
  Look at a smooth tangent field on a creased cage; open box.html in a browser:
    formwork view assets/creased_box.obj \\
        --field assets/creased_box.field.json -o box.html

  Refine the cage and the 1-form on its edges; any glTF viewer opens the result:
    formwork subdivide assets/creased_box.obj \\
        --field assets/creased_box.field.json --levels 3 -o box.glb

  Measure that d S = S d, against OpenSubdiv's own weights:
    formwork validate assets/creased_box.obj --levels 3

`formwork COMMAND --help` tells more. Exit codes: 0 fine, 2 the input or the
arguments are at fault (one line on stderr says where and what to do), 3 a law
does not hold, 1 some assets of a batch failed.";

pub const SUBDIVIDE: &str = "\
The field file is JSON. Indices start at 0; cells not listed have the value 0:
  {\"edges\": [[a, b, value], ...],    1-form: circulation from vertex a to b
   \"vertices\": [[v, value], ...],    0-form
   \"faces\": [[f, value], ...]}       2-form: flux, counter-clockwise side positive
Any of the three may be left out. Without --field, the forms that the mesh file
holds itself are refined: primvars form0, form1, form2 in USD, extras in glTF.

What is written, by the extension of -o:
  .usda  the stage of the input with the mesh refined in its place, or a stage
         of its own; forms as primvars, the field as primvars:form1Vector
  .glb, .gltf  triangles with normals; the forms as vertex attributes _FORM0
         and _FORM1 (the tangent vector of the 1-form), all of them in extras,
         and a node of line segments that shows the field as arrows
  .json  everything: positions, polygons, edges, forms, a vector for each face
  .obj   the polygons; OBJ has no place for forms, so they go to a second file,
         X.fields.json beside X.obj, in the format above
  .npz   arrays for NumPy: see formwork limit --help
With --limit the vertices lie on the limit surface, and normals, vectors,
circulations and fluxes are those of the limit: see formwork limit --help.
Faces that are holes are left out. --levels 0 writes the cage itself with its
tags and holes: that turns one format into another.

Examples:
  formwork subdivide assets/creased_box.obj \\
      --field assets/creased_box.field.json -o box.glb
  formwork subdivide assets/creased_box.obj --limit \\
      --field assets/creased_box.field.json -o box.glb
  formwork subdivide assets/creased_box.obj \\
      --field assets/creased_box.field.json --levels 2 -o box.usda
  formwork subdivide assets/scene.usda --prim /Scene/Wave --frames all -o fine.usda
  formwork subdivide assets/open_polygons.obj --levels 0 -o open.usda
  formwork subdivide assets/open_polygons.obj --boundary none -o open.json";

pub const LIMIT: &str = "\
Nothing is approximated: every vertex of the refined mesh is moved to where
refining for ever would take it, and every form gets its limit there.
  positions       the vertices on the limit surface
  normals         exact unit normals
  0-form          limit values at the vertices
  1-form          limit circulations along the limits of the edges, and its
                  tangent vectors at the vertices; at a crease every face corner
                  has the vector of its own side, and the vertex their mean
  2-form          integrals over the limits of the faces
Vectors are in the units of the 1-form's values per unit of length. Level 0 is
the cage's own vertices, edges and faces. The field file is that of subdivide.

What is written, by the extension of -o:
  .npz    arrays for NumPy: edges, face_sizes, face_vertices, positions, normals,
          values, circulations, fluxes, vertex_vectors, corner_vectors
  .json   the same as JSON
  .usda   as formwork subdivide writes it, with exact normals and vectors
  .glb, .gltf   triangles with exact normals, _FORM0, _FORM1 and arrows
  .obj    positions and normals; the forms beside it in X.fields.json

Examples:
  formwork limit assets/creased_box.obj --level 2 -o limit.obj
  formwork limit assets/creased_box.obj --level 0 \\
      --field assets/creased_box.field.json -o limit.json
  formwork limit assets/gem.obj --scheme modified-loop --level 3 -o gem.npz";

pub const EVALUATE: &str = "\
The points file is JSON. Indices start at 0:
  {\"points\": [[face, s, t], [face, corner, s, t], ...]}
On a quad with corners v, a, q, b the point is at s from v to a and t from v
to b, both from 0 to 1; on a triangle v, a, b of Loop's schemes at 1 - s - t, s, t.
v is the face's first vertex, or the corner that the entry names. Polygons with
more or fewer corners than four, split into quads, need the corner: (1, 1) is
then the centre of the polygon, (1, 0) the midpoint of the edge that leaves.

With --per-face K, K x K points in every face (in every corner of a polygon; in
a triangle the centres of K x K triangles) instead.

Every point gets: position, tangents (derivatives of the position by s and t),
and of the forms in --field: form0 (value), form1 (components along s and t),
form1_derivatives (of component i by parameter k), vector (the tangent vector),
curl (component of d form1), form2 (density per ds dt). At an irregular vertex
tangents and components are those along its limit tangents, and what does not
exist there is null in JSON, NaN in NumPy.

Examples:
  formwork evaluate assets/creased_box.obj --per-face 3 \\
      --field assets/creased_box.field.json -o points.json
  formwork evaluate assets/gem.obj --per-face 4 -o points.npz";

pub const OPERATORS: &str = "\
For each level l the archive has l{l}/edges (E, 2), l{l}/face_sizes,
l{l}/face_vertices and the matrices l{l}/d0 and l{l}/d1; for l >= 1 also the
matrices l{l}/S0, l{l}/S1, l{l}/S2 from level l - 1 to level l, and
l{l}/vertex_parent_kind (0 vertex, 1 edge, 2 face), l{l}/vertex_parent_index.
A matrix M is four arrays, M_data, M_indices, M_indptr and M_shape (compressed
sparse rows). With npz = numpy.load(\"box.npz\"), SciPy reads it by

  def matrix(npz, name):
      parts = (npz[f\"{name}_{part}\"] for part in (\"data\", \"indices\", \"indptr\"))
      return scipy.sparse.csr_matrix(tuple(parts), shape=npz[f\"{name}_shape\"])

Faces that are holes belong to the complex and are here.

Examples:
  formwork operators assets/creased_box.obj --levels 2 -o box.npz
  formwork operators assets/open_polygons.obj --doo-sabin original -o open.npz
  formwork operators assets/creased_box.obj --json -o box.npz";

pub const VALIDATE: &str = "\
For each level: the largest entry of d0 S0 - S1 d0, with OpenSubdiv's own S0,
and of d1 S1 - S2 d1; how far the column sums of S2 are from 1; the largest
difference between our S0 and OpenSubdiv's. For the limits L0, L1, L2 of each
level: L1 d0 - d0 L0, L2 d1 - d1 L1, R L' S - L with R summing children into
parents, and on the last level the difference of L0 to OpenSubdiv's limit
masks where those are exact. Then, for a random 0-form, its refined
differential summed along each control edge, against the difference of
OpenSubdiv's refined values (equal to rounding) and the limit circulation
(approached by the rate shown, 2 on regular meshes). Schemes that
OpenSubdiv does not have are compared with their own S0.

Examples:
  formwork validate assets/creased_box.obj --levels 3
  formwork validate assets/open_polygons.obj --json
  formwork validate assets/creased_box.obj --boundary edge-and-corner
  formwork validate assets/gem.obj --scheme modified-loop";

pub const INSPECT: &str = "\
Examples:
  formwork inspect assets/creased_box.obj
  formwork inspect assets/open_polygons.obj --boundary none
  formwork inspect assets/open_polygons.obj --json";
