/*
 *  The C ABI of Formwork. Made by cbindgen from the crate formwork-capi (scripts/header); do not edit.
 *
 *  Objects are opaque and freed by the function named after them. Arrays belong to the caller, who asks for the counts
 *  first. Results come through the last parameter; what is returned is a status, and formwork_last_error() has the
 *  message of the last failure on the calling thread. Objects do not change once made: threads may share them.
 *
 *  Formwork: smooth differential forms on OpenSubdiv surfaces. MIT or Apache-2.0, see LICENSE-MIT and LICENSE-APACHE.
 */

#ifndef FORMWORK_H
#define FORMWORK_H

#include <stdint.h>

/**
 * OpenSubdiv's `SCHEME_BILINEAR`: the lowest-order forms.
 */
#define FORMWORK_SCHEME_BILINEAR 0

/**
 * OpenSubdiv's `SCHEME_CATMARK`, with Doo-Sabin on faces.
 */
#define FORMWORK_SCHEME_CATMARK 1

/**
 * OpenSubdiv's `SCHEME_LOOP`, with half-box splines on faces. Triangles only.
 */
#define FORMWORK_SCHEME_LOOP 2

/**
 * Loop with the subdominant eigenvalue 1/2 at every smooth vertex; not in OpenSubdiv. Triangles only.
 */
#define FORMWORK_SCHEME_MODIFIED_LOOP 3

/**
 * The lowest-order forms of the split, all triangles or all quads.
 */
#define FORMWORK_SCHEME_WHITNEY 4

/**
 * Catmull and Clark's weights on faces at irregular vertices, as in Wang's thesis.
 */
#define FORMWORK_DOO_SABIN_THESIS 0

/**
 * Doo and Sabin's own.
 */
#define FORMWORK_DOO_SABIN_ORIGINAL 1

/**
 * Loop's schemes at boundaries and creases: faces reflected evenly.
 */
#define FORMWORK_HALF_BOX_REFLECT 0

/**
 * Appendix B of Wang's thesis.
 */
#define FORMWORK_HALF_BOX_THESIS 1

/**
 * A cosine transform, which dies out fastest along the boundary.
 */
#define FORMWORK_HALF_BOX_DCT 2

/**
 * At every vertex of the level.
 */
#define FORMWORK_AT_VERTICES 0

/**
 * At every corner of every face of the level, so that both sides of a crease are there.
 */
#define FORMWORK_AT_CORNERS 1

/**
 * What a call came to.
 */
typedef enum {
  /**
   * It did what it says.
   */
  FORMWORK_STATUS_OK = 0,
  /**
   * The arguments are at fault, or the mesh; `formwork_last_error` says how, and what to do.
   */
  FORMWORK_STATUS_INVALID_ARGUMENT = 1,
  /**
   * Formwork itself is at fault; `formwork_last_error` says where. Please report it.
   */
  FORMWORK_STATUS_INTERNAL = 2,
} FormworkStatus;

/**
 * A refined mesh with its operators.
 */
typedef struct FormworkHierarchy FormworkHierarchy;

/**
 * Stencils: rows that share their indices among one or more sets of weights.
 */
typedef struct FormworkStencils FormworkStencils;

/**
 * What forms do where OpenSubdiv leaves a choice; all zero is the default.
 */
typedef struct {
  /**
   * `FORMWORK_DOO_SABIN_THESIS` or `_ORIGINAL`: the faces of Catmull-Clark.
   */
  uint32_t doo_sabin;
  /**
   * `FORMWORK_HALF_BOX_REFLECT`, `_THESIS` or `_DCT`: the faces of Loop's schemes at boundaries and creases.
   */
  uint32_t half_box;
} FormworkOptions;

/**
 * A control mesh, as `Far::TopologyDescriptor` has it. Arrays with a count of 0 may be null.
 */
typedef struct {
  /**
   * The number of vertices.
   */
  uint32_t num_vertices;
  /**
   * The number of faces.
   */
  uint32_t num_faces;
  /**
   * For each face its number of vertices.
   */
  const uint32_t *face_sizes;
  /**
   * The vertices of all faces, face after face, counter-clockwise: as many as the sizes add up to.
   */
  const uint32_t *face_vertices;
  /**
   * The number of sharp edges.
   */
  uint32_t num_creases;
  /**
   * Two vertices for each sharp edge.
   */
  const uint32_t *crease_vertices;
  /**
   * For each sharp edge its sharpness, 10 for infinitely sharp.
   */
  const float *crease_sharpness;
  /**
   * The number of sharp vertices.
   */
  uint32_t num_corners;
  /**
   * The sharp vertices.
   */
  const uint32_t *corner_vertices;
  /**
   * For each its sharpness.
   */
  const float *corner_sharpness;
  /**
   * The number of holes.
   */
  uint32_t num_holes;
  /**
   * The faces that are holes.
   */
  const uint32_t *holes;
  /**
   * `Sdc::Options::VtxBoundaryInterpolation`: 0 none, 1 edges only, 2 edges and corners.
   */
  uint32_t boundary;
  /**
   * `Sdc::Options::CreasingMethod`: 0 uniform, 1 Chaikin.
   */
  uint32_t creasing;
  /**
   * `Sdc::Options::TriangleSubdivision`: 0 as Catmull-Clark, 1 smooth.
   */
  uint32_t triangles;
  /**
   * Other than 0 if the vertices of faces run clockwise.
   */
  uint32_t left_handed;
} FormworkCage;

/**
 * The cells of a level.
 */
typedef struct {
  /**
   * Vertices: the values of a 0-form.
   */
  uint32_t vertices;
  /**
   * Edges: the values of a 1-form.
   */
  uint32_t edges;
  /**
   * Faces: the values of a 2-form.
   */
  uint32_t faces;
  /**
   * The sizes of the faces, added up.
   */
  uint32_t corners;
} FormworkCounts;

/**
 * What a table of stencils holds.
 */
typedef struct {
  /**
   * The number of values that go in.
   */
  uint32_t control_values;
  /**
   * The number of rows, which is the number of values that come out.
   */
  uint32_t stencils;
  /**
   * The number of entries of all rows.
   */
  uint32_t entries;
  /**
   * The number of sets of weights: 1, or 3 with the derivatives `du` and `dv`.
   */
  uint32_t weight_sets;
} FormworkStencilCounts;

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

/**
 * The version of Formwork, such as `"0.1.0"`.
 */
const char *formwork_version(void);

/**
 * `OPENSUBDIV_VERSION_NUMBER` of the OpenSubdiv that Formwork was built with.
 */
uint32_t formwork_opensubdiv_version(void);

/**
 * The message of the last call on this thread that failed; it is good until the next one fails.
 */
const char *formwork_last_error(void);

/**
 * A hierarchy of all levels of a C++ program's `OpenSubdiv::Far::TopologyRefiner`, in its own numbering, by
 * the forms that go with its scheme. The refiner must have been refined uniformly, if at all;
 * it is read, not kept. `opensubdiv_version` is `OPENSUBDIV_VERSION_NUMBER` in the program, and must be that of
 * `formwork_opensubdiv_version`. `options` may be null.
 *
 * # Safety
 * `refiner` points to such a refiner, or is null, which is an error; `out` may be written to.
 */
FormworkStatus formwork_hierarchy_from_refiner(const void *refiner,
                                               uint32_t opensubdiv_version,
                                               const FormworkOptions *options,
                                               FormworkHierarchy **out);

/**
 * A hierarchy of a control mesh, refined `levels` times by a `FORMWORK_SCHEME_...`. `options` may be null.
 *
 * # Safety
 * The arrays of `cage` are as long as its counts say; `out` may be written to.
 */
FormworkStatus formwork_hierarchy_from_cage(const FormworkCage *cage,
                                            uint32_t scheme,
                                            const FormworkOptions *options,
                                            int32_t levels,
                                            FormworkHierarchy **out);

/**
 * Frees a hierarchy; null is fine.
 *
 * # Safety
 * `hierarchy` is null or alive, and not used again.
 */
void formwork_hierarchy_free(FormworkHierarchy *hierarchy);

/**
 * The number of the finest level.
 *
 * # Safety
 * `hierarchy` is alive; `out` may be written to.
 */
FormworkStatus formwork_hierarchy_finest_level(const FormworkHierarchy *hierarchy, int32_t *out);

/**
 * The counts of the cells of a level.
 *
 * # Safety
 * `hierarchy` is alive; `out` may be written to.
 */
FormworkStatus formwork_hierarchy_counts(const FormworkHierarchy *hierarchy,
                                         int32_t level,
                                         FormworkCounts *out);

/**
 * The topology of a level; arrays that are null are left out. `edge_vertices` takes two vertices for each edge, in
 * its direction; `face_sizes` one number for each face; `face_vertices` and `face_edges` one for each corner, face
 * after face, edge `i` joining vertices `i` and `i + 1`; `face_edge_signs` +1 for each edge that runs with its
 * face and -1 for each that runs against it.
 *
 * # Safety
 * `hierarchy` is alive; the arrays are as long as `formwork_hierarchy_counts` says.
 */
FormworkStatus formwork_hierarchy_topology(const FormworkHierarchy *hierarchy,
                                           int32_t level,
                                           uint32_t *edge_vertices,
                                           uint32_t *face_sizes,
                                           uint32_t *face_vertices,
                                           uint32_t *face_edges,
                                           int8_t *face_edge_signs);

/**
 * The stencils that refine forms of a degree (0, 1 or 2) from `from_level` to `to_level`. With `intermediate` other
 * than 0 also the rows of the levels between, coarser levels first.
 *
 * # Safety
 * `hierarchy` is alive; `out` may be written to.
 */
FormworkStatus formwork_stencils_refine(const FormworkHierarchy *hierarchy,
                                        int32_t degree,
                                        int32_t from_level,
                                        int32_t to_level,
                                        uint32_t intermediate,
                                        FormworkStencils **out);

/**
 * The stencils that take forms on `from_level` to their limit on `level`: values at its vertices (degree 0),
 * circulations along the limits of its edges (1), integrals over the limits of its faces (2).
 *
 * # Safety
 * `hierarchy` is alive; `out` may be written to.
 */
FormworkStatus formwork_stencils_limit(const FormworkHierarchy *hierarchy,
                                       int32_t degree,
                                       int32_t from_level,
                                       int32_t level,
                                       FormworkStencils **out);

/**
 * The stencils of limit points, at the vertices (`FORMWORK_AT_VERTICES`) or the corners (`FORMWORK_AT_CORNERS`) of
 * `level`, of forms on `from_level`. Degree 0: one row a point, with three sets of weights, for the value and its
 * derivatives along two limit tangents. Degree 1: two rows a point, the values of the form along the same two
 * tangents. Both derivatives are 0 where the surface has no tangents: at isolated vertices, and at sharp vertices
 * without sharp edges. A vertex on a crease has tangents on each side; its corners tell them apart, and
 * `FORMWORK_AT_VERTICES` takes those of one.
 *
 * # Safety
 * `hierarchy` is alive; `out` may be written to.
 */
FormworkStatus formwork_stencils_points(const FormworkHierarchy *hierarchy,
                                        int32_t degree,
                                        int32_t from_level,
                                        int32_t level,
                                        uint32_t place,
                                        FormworkStencils **out);

/**
 * Frees stencils; null is fine.
 *
 * # Safety
 * `stencils` is null or alive, and not used again.
 */
void formwork_stencils_free(FormworkStencils *stencils);

/**
 * The counts of stencils.
 *
 * # Safety
 * `stencils` is alive; `out` may be written to.
 */
FormworkStatus formwork_stencils_counts(const FormworkStencils *stencils,
                                        FormworkStencilCounts *out);

/**
 * The number of entries of `count` rows from `first` on.
 *
 * # Safety
 * `stencils` is alive; `out` may be written to.
 */
FormworkStatus formwork_stencils_entries(const FormworkStencils *stencils,
                                         uint32_t first,
                                         uint32_t count,
                                         uint32_t *out);

/**
 * `count` rows from `first` on, with one set of weights (0 the values, 1 and 2 the derivatives if there are any) in single
 * precision. `sizes` takes the number of entries of each row; `indices` and `weights`, row after row, the control value and
 * the weight of each entry, in no order.
 *
 * # Safety
 * `stencils` is alive; `sizes` is as long as `count` says, `indices` and `weights` as `formwork_stencils_entries` says, and
 * all hold numbers, whichever.
 */
FormworkStatus formwork_stencils_rows_f32(const FormworkStencils *stencils,
                                          uint32_t set,
                                          uint32_t first,
                                          uint32_t count,
                                          uint32_t *sizes,
                                          uint32_t *indices,
                                          float *weights);

/**
 * `formwork_stencils_rows_f32` in double precision.
 *
 * # Safety
 * As there.
 */
FormworkStatus formwork_stencils_rows_f64(const FormworkStencils *stencils,
                                          uint32_t set,
                                          uint32_t first,
                                          uint32_t count,
                                          uint32_t *sizes,
                                          uint32_t *indices,
                                          double *weights);

/**
 * Advice before large fresh memory is touched: it is to lie on huge pages, where the system has them, which costs far fewer
 * page faults. Nothing is read or written, and anything may be refused; any range will do.
 */
void formwork_prefer_huge_pages(const void *start,
                                uint64_t bytes);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* FORMWORK_H */
