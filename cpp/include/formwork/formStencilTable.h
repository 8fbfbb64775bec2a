//
//   Formwork: smooth differential forms on OpenSubdiv surfaces.
//   MIT or Apache-2.0, see LICENSE-MIT and LICENSE-APACHE.
//

#ifndef FORMWORK_FORM_STENCIL_TABLE_H
#define FORMWORK_FORM_STENCIL_TABLE_H

#include <limits>
#include <memory>
#include <type_traits>
#include <utility>
#include <vector>

#include <opensubdiv/far/stencilTable.h>

#include "formRefiner.h"

namespace formwork {

namespace internal {

// Rows of a table, written by the C ABI.
inline void WriteRows(FormworkStencils const *from, uint32_t set, uint32_t first, uint32_t count, uint32_t *sizes,
                      uint32_t *indices, float *weights) {
    Check(formwork_stencils_rows_f32(from, set, first, count, sizes, indices, weights));
}
inline void WriteRows(FormworkStencils const *from, uint32_t set, uint32_t first, uint32_t count, uint32_t *sizes,
                      uint32_t *indices, double *weights) {
    Check(formwork_stencils_rows_f64(from, set, first, count, sizes, indices, weights));
}

// Room in a vector, on huge pages if it is large.
template <typename T>
void Reserve(std::vector<T> &vector, size_t count) {
    vector.reserve(count);
    formwork_prefer_huge_pages(vector.data(), count * sizeof(T));
}

// A table of the C ABI, as the arrays that OpenSubdiv's constructors take.
template <typename REAL>
class Stencils {
public:
    explicit Stencils(FormworkStencils *handle) : _handle(handle) {
        Check(formwork_stencils_counts(handle, &counts));
        weights.resize(counts.weight_sets);
        Reserve(sizes, counts.stencils);
        Reserve(offsets, counts.stencils);
        Reserve(indices, counts.entries);
        for (uint32_t set = 0; set < counts.weight_sets; ++set) {
            Reserve(weights[set], counts.entries);
            read(set);
        }
    }

    FormworkStencilCounts counts;
    std::vector<int> sizes, offsets, indices;
    std::vector<std::vector<REAL> > weights;

private:
    struct Free {
        void operator()(FormworkStencils *stencils) const { formwork_stencils_free(stencils); }
    };

    // By way of arrays that stay in the cache: large ones are touched once, when the rows are appended.
    void read(uint32_t set) {
        uint32_t const run = 8192;
        std::vector<int> someSizes(run), someIndices;
        std::vector<REAL> someWeights;
        for (uint32_t first = 0, count; first < counts.stencils; first += count) {
            count = counts.stencils - first < run ? counts.stencils - first : run;
            uint32_t entries = 0;
            Check(formwork_stencils_entries(_handle.get(), first, count, &entries));
            if (someIndices.size() < entries) {
                someIndices.resize(entries);
                someWeights.resize(entries);
            }
            WriteRows(_handle.get(), set, first, count, reinterpret_cast<uint32_t *>(someSizes.data()),
                      reinterpret_cast<uint32_t *>(someIndices.data()), someWeights.data());
            weights[set].insert(weights[set].end(), someWeights.begin(), someWeights.begin() + entries);
            if (set == 0) {
                indices.insert(indices.end(), someIndices.begin(), someIndices.begin() + entries);
                sizes.insert(sizes.end(), someSizes.begin(), someSizes.begin() + count);
                for (uint32_t i = 0; i < count; ++i) {
                    offsets.push_back(_next);
                    _next += someSizes[i];
                }
            }
        }
    }

    std::unique_ptr<FormworkStencils, Free> _handle;
    int _next = 0;
};

} // end namespace internal

/// \brief A stencil table for forms
///
/// A Far::StencilTable (with double, a Far::StencilTableReal<double>): Osd::CpuEvaluator, Osd::OmpEvaluator and the
/// GPU evaluators take it as it is. Its control values and its results are the values of forms, in the order of the
/// vertices, edges or faces of a level: where OpenSubdiv says vertex, read edge for a form of degree 1.
///
/// Made by FormStencilTableFactoryReal and FormLimitStencilTableFactoryReal.
///
template <typename REAL>
class FormStencilTableReal
    : public std::conditional<std::is_same<REAL, float>::value, OpenSubdiv::Far::StencilTable,
                              OpenSubdiv::Far::StencilTableReal<REAL>>::type {
public:
    /// \brief Takes the arrays of a table of the C ABI
    explicit FormStencilTableReal(internal::Stencils<REAL> &&from) {
        this->_numControlVertices = static_cast<int>(from.counts.control_values);
        this->_weights.swap(from.weights[0]);
        this->_sizes.swap(from.sizes);
        this->_offsets.swap(from.offsets);
        this->_indices.swap(from.indices);
    }
};

typedef FormStencilTableReal<float> FormStencilTable;

/// \brief A stencil table of limit points, with their derivatives
///
/// A Far::LimitStencilTable (with double, a Far::LimitStencilTableReal<double>). The derivatives du and dv of positions
/// span the tangent plane of the limit surface and turn counter-clockwise. Their lengths, and the angle between them,
/// are arbitrary, and differ from vertex to vertex; what is measured against them, as by Sharp(), is not.
///
template <typename REAL>
class FormLimitStencilTableReal
    : public std::conditional<std::is_same<REAL, float>::value, OpenSubdiv::Far::LimitStencilTable,
                              OpenSubdiv::Far::LimitStencilTableReal<REAL>>::type {
    typedef typename std::conditional<std::is_same<REAL, float>::value, OpenSubdiv::Far::LimitStencilTable,
                                      OpenSubdiv::Far::LimitStencilTableReal<REAL>>::type BaseTable;

public:
    /// \brief Takes the arrays of a table of the C ABI
    explicit FormLimitStencilTableReal(internal::Stencils<REAL> &&from)
        : BaseTable(static_cast<int>(from.counts.control_values), from.offsets, from.sizes, from.indices,
                    from.weights[0], from.weights[1], from.weights[2],
                    std::vector<REAL>(), std::vector<REAL>(), std::vector<REAL>(),
                    /*includeCoarseVerts=*/false, /*firstOffset=*/0) {}
};

typedef FormLimitStencilTableReal<float> FormLimitStencilTable;

/// \brief Makes stencil tables that refine forms
///
template <typename REAL>
class FormStencilTableFactoryReal {
public:

    /// \brief Which form, and from where to where
    struct Options {
        explicit Options(int degree_ = 1)
            : degree(degree_), fromLevel(0), toLevel(-1), generateIntermediateLevels(false) {}

        int degree;                      ///< 0 for vertices, 1 for edges, 2 for faces
        int fromLevel;                   ///< level of the control values
        int toLevel;                     ///< level of the results; -1 for the finest
        bool generateIntermediateLevels; ///< also the levels between, coarser ones first (not only toLevel)
    };

    /// \brief Makes one table, factorized: all its stencils refer to the control values
    ///
    /// Throws Error if there is no such degree or level, or toLevel is not finer than fromLevel.
    ///
    static std::unique_ptr<FormStencilTableReal<REAL> const>
    Create(FormRefiner const &refiner, Options options = Options()) {
        FormworkStencils *stencils = nullptr;
        int to = options.toLevel == -1 ? refiner.GetMaxLevel() : options.toLevel;
        internal::Check(formwork_stencils_refine(refiner.GetHandle(), options.degree,
                                                 options.fromLevel,
                                                 to,
                                                 options.generateIntermediateLevels, &stencils));
        return std::unique_ptr<FormStencilTableReal<REAL> const>(
            new FormStencilTableReal<REAL>(internal::Stencils<REAL>(stencils)));
    }

    /// \brief The same for a program that needs one table only
    static std::unique_ptr<FormStencilTableReal<REAL> const>
    Create(OpenSubdiv::Far::TopologyRefiner const &refiner, Options options = Options(),
           SchemeOptions scheme = SchemeOptions()) {
        return Create(FormRefiner(refiner, scheme), options);
    }

    /// \brief Makes one table for each step from a level to the next, from fromLevel to toLevel
    ///
    /// Applied one after the other they do what the table of Create() does, with far fewer weights.
    ///
    static std::vector<std::unique_ptr<FormStencilTableReal<REAL> const>>
    CreatePerLevel(FormRefiner const &refiner, Options options = Options()) {
        std::vector<std::unique_ptr<FormStencilTableReal<REAL> const>> tables;
        int to = options.toLevel == -1 ? refiner.GetMaxLevel() : options.toLevel;
        Options step(options);
        step.generateIntermediateLevels = false;
        do {
            step.toLevel = step.fromLevel + 1 < to ? step.fromLevel + 1 : to;
            tables.push_back(Create(refiner, step));
            step.fromLevel = step.toLevel;
        } while (step.toLevel != to);
        return tables;
    }
};

typedef FormStencilTableFactoryReal<float> FormStencilTableFactory;

/// \brief Makes stencil tables of limits
///
/// These limits are exact: next to creases, corners, boundaries and irregular vertices, and on level 0 too.
///
template <typename REAL>
class FormLimitStencilTableFactoryReal {
public:

    /// \brief The points where values and derivatives are taken
    enum Location {
        VERTICES = FORMWORK_AT_VERTICES, ///< each vertex of the level; on a crease the tangents of one side
        CORNERS = FORMWORK_AT_CORNERS    ///< each vertex of each face, face after face: both sides of creases
    };

    /// \brief Which form, and the limit of which level
    struct Options {
        explicit Options(int degree_ = 1) : degree(degree_), fromLevel(0), level(-1), location(VERTICES) {}

        int degree;        ///< 0 for vertices, 1 for edges, 2 for faces
        int fromLevel;     ///< level of the control values
        int level;         ///< level whose cells are taken to the limit; -1 for the finest
        Location location; ///< used by CreateValues() and CreateVectors()
    };

    /// \brief Makes a table of limit values at vertices (degree 0), circulations along the limits of edges (1), or
    /// integrals over the limits of faces (2)
    static std::unique_ptr<FormStencilTableReal<REAL> const>
    Create(FormRefiner const &refiner, Options options = Options()) {
        FormworkStencils *stencils = nullptr;
        internal::Check(formwork_stencils_limit(refiner.GetHandle(), options.degree,
                                                options.fromLevel,
                                                level(refiner, options), &stencils));
        return std::unique_ptr<FormStencilTableReal<REAL> const>(
            new FormStencilTableReal<REAL>(internal::Stencils<REAL>(stencils)));
    }

    /// \brief Makes a table of a form of degree 0 at limit points, with its derivatives du and dv: for positions, the
    /// limit surface and its tangents. options.degree must be 0.
    ///
    /// The derivatives are 0 where the surface has no tangents: at isolated vertices, and at sharp vertices without
    /// sharp edges.
    ///
    static std::unique_ptr<FormLimitStencilTableReal<REAL> const>
    CreateValues(FormRefiner const &refiner, Options options = Options(0)) {
        if (options.degree != 0) {
            throw Error(FORMWORK_STATUS_INVALID_ARGUMENT, "CreateValues() takes degree 0: use CreateVectors()");
        }
        return std::unique_ptr<FormLimitStencilTableReal<REAL> const>(
            new FormLimitStencilTableReal<REAL>(points(refiner, options)));
    }

    /// \brief Makes a table of a form of degree 1 at limit points: two stencils a point, its values along du and along
    /// dv of the table that CreateValues() makes. options.degree must be 1.
    ///
    /// With a destination of one element a stencil, the results of a point lie side by side. Sharp() makes the
    /// tangent vector of them.
    ///
    static std::unique_ptr<FormStencilTableReal<REAL> const>
    CreateVectors(FormRefiner const &refiner, Options options = Options(1)) {
        if (options.degree != 1) {
            throw Error(FORMWORK_STATUS_INVALID_ARGUMENT, "CreateVectors() takes degree 1: use CreateValues()");
        }
        return std::unique_ptr<FormStencilTableReal<REAL> const>(
            new FormStencilTableReal<REAL>(points(refiner, options)));
    }

private:
    static int level(FormRefiner const &refiner, Options const &options) {
        return options.level == -1 ? refiner.GetMaxLevel() : options.level;
    }

    static internal::Stencils<REAL> points(FormRefiner const &refiner, Options const &options) {
        FormworkStencils *stencils = nullptr;
        internal::Check(formwork_stencils_points(refiner.GetHandle(), options.degree,
                                                 options.fromLevel, level(refiner, options),
                                                 static_cast<uint32_t>(options.location), &stencils));
        return internal::Stencils<REAL>(stencils);
    }
};

typedef FormLimitStencilTableFactoryReal<float> FormLimitStencilTableFactory;

/// \brief The tangent vector of a form of degree 1, from its values along two tangents
///
/// The vector V in the plane of du and dv with V.du = alongDu and V.dv = alongDv; 0 where they are parallel to
/// rounding.
///
template <typename REAL>
void
Sharp(REAL const du[3], REAL const dv[3], REAL alongDu, REAL alongDv, REAL vector[3]) {
    REAL uu = du[0] * du[0] + du[1] * du[1] + du[2] * du[2];
    REAL uv = du[0] * dv[0] + du[1] * dv[1] + du[2] * dv[2];
    REAL vv = dv[0] * dv[0] + dv[1] * dv[1] + dv[2] * dv[2];
    REAL area = uu * vv - uv * uv;
    bool spans = area > 8 * std::numeric_limits<REAL>::epsilon() * uu * vv;
    REAL a = spans ? (vv * alongDu - uv * alongDv) / area : REAL(0);
    REAL b = spans ? (uu * alongDv - uv * alongDu) / area : REAL(0);
    for (int i = 0; i < 3; ++i) {
        vector[i] = a * du[i] + b * dv[i];
    }
}

} // end namespace formwork

#endif // FORMWORK_FORM_STENCIL_TABLE_H
