// The C++ side of the bridge: a thin owner of OpenSubdiv's topology refiner that answers in flat arrays.
//
// Every function checks the level and the lengths of the arrays it is given and throws
// std::runtime_error; cxx turns that into a Rust Err. A malformed cage cannot be checked here: the
// caller hands over only cages that formwork::topology::Cage has accepted.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>

#include <opensubdiv/far/stencilTable.h>
#include <opensubdiv/far/topologyRefiner.h>

#include "rust/cxx.h"

namespace formwork {

struct CageArrays;
struct Counts;
struct Description;
struct TopologyArrays;
struct TagLists;
struct MaskArrays;
struct ChildArrays;
struct Stencils;

// A name without the version number that OpenSubdiv puts in its namespace.
using FarRefiner = OpenSubdiv::Far::TopologyRefiner;

class Refiner {
public:
    // Owns the refiner,
    explicit Refiner(std::unique_ptr<FarRefiner> refiner);
    // or reads that of a caller, which outlives this.
    explicit Refiner(FarRefiner const &refiner);

    // With edges and vertex rings on the finest level, or with what refining values needs.
    void refine_uniform(std::uint32_t levels, bool full_last_level);

    // The scheme, its options, and how the refiner was refined.
    Description description() const;

    Counts counts(std::uint32_t level) const;
    void topology(std::uint32_t level, TopologyArrays out) const;
    TagLists tags(std::uint32_t level) const;
    // But for vertices that are `known`, and edges between two of those. None is known if it is empty.
    void masks(std::uint32_t level, rust::Slice<const bool> known, MaskArrays out) const;
    void children(std::uint32_t level, ChildArrays out) const;
    // Whether the children of a level are numbered, and directed as far as the next level knows its edges, by
    // the rule of formwork::topology::Split. `centres` says whether faces have child vertices.
    bool numbers_children_in_order(std::uint32_t level, bool centres) const;

    // OpenSubdiv's own S0 from level - 1 to level, as its stencil table has it.
    Stencils stencils(std::uint32_t level) const;
    // Builds OpenSubdiv's S0 of all levels, each from the level before, and drops it: the yardstick of the
    // benchmarks. The number of entries.
    std::size_t per_level_tables() const;
    // Limit masks on the finest level: 0 position, 1 and 2 the tangents.
    Stencils limit_stencils(std::uint8_t which) const;
    // One value a vertex, from level - 1 to level, by OpenSubdiv's primvar refiner.
    void interpolate(std::uint32_t level, rust::Slice<const double> source, rust::Slice<double> out) const;

    FarRefiner const &get() const { return *refiner_; }

private:
    OpenSubdiv::Far::TopologyLevel level(std::uint32_t level, bool with_child) const;
    // Whether a level has more than what refining values needs: asking for edges where there are none crashes.
    bool has_edges(std::uint32_t level) const;

    std::unique_ptr<FarRefiner> owned_; // null if the refiner is a caller's
    FarRefiner const *refiner_;
};

std::unique_ptr<Refiner> new_refiner(CageArrays const &cage);
std::unique_ptr<Refiner> borrow_refiner(FarRefiner const *refiner);
// OPENSUBDIV_VERSION_NUMBER of the headers that this side was compiled with.
std::uint32_t opensubdiv_version();

// OpenSubdiv's factorised single-precision table, applied by its CpuEvaluator: the yardstick of the
// benchmarks.
class FloatStencilTable {
public:
    explicit FloatStencilTable(std::unique_ptr<OpenSubdiv::Far::StencilTable const> table);

    std::size_t num_stencils() const;
    void evaluate(rust::Slice<const float> source, std::uint32_t width, rust::Slice<float> out) const;

private:
    std::unique_ptr<OpenSubdiv::Far::StencilTable const> table_;
};

std::unique_ptr<FloatStencilTable> float_stencil_table(Refiner const &refiner);
// The same of any rows; row i ends at row_ends[i].
std::unique_ptr<FloatStencilTable> float_table_of(std::uint32_t columns, rust::Slice<const std::uint64_t> row_ends,
                                                  rust::Slice<const std::uint32_t> indices,
                                                  rust::Slice<const double> weights);

} // namespace formwork
