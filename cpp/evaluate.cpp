#include "cpp/refiner.h"

#include <stdexcept>

#include <opensubdiv/far/stencilTableFactory.h>
#include <opensubdiv/osd/bufferDescriptor.h>
#include <opensubdiv/osd/cpuEvaluator.h>

#include "formwork/src/osd/bridge.rs.h"

namespace formwork {

namespace Far = OpenSubdiv::Far;
namespace Osd = OpenSubdiv::Osd;

std::unique_ptr<FloatStencilTable> float_stencil_table(Refiner const &refiner) {
    Far::StencilTableFactory::Options options;
    options.generateIntermediateLevels = false;
    options.generateOffsets = true;
    std::unique_ptr<Far::StencilTable const> table(Far::StencilTableFactory::Create(refiner.get(), options));
    if (!table) {
        throw std::runtime_error("OpenSubdiv made no stencil table");
    }
    return std::make_unique<FloatStencilTable>(std::move(table));
}

namespace {

// OpenSubdiv lets derived classes fill a table.
struct FilledTable : Far::StencilTable {
    FilledTable(int columns, rust::Slice<const std::uint64_t> row_ends, rust::Slice<const std::uint32_t> indices,
                rust::Slice<const double> weights)
        : Far::StencilTable(columns) {
        _indices.assign(indices.begin(), indices.end());
        _weights.assign(weights.begin(), weights.end());
        std::uint64_t begin = 0;
        for (std::uint64_t end : row_ends) {
            _sizes.push_back(static_cast<int>(end - begin));
            begin = end;
        }
        generateOffsets();
    }
};

} // namespace

std::unique_ptr<FloatStencilTable> float_table_of(std::uint32_t columns, rust::Slice<const std::uint64_t> row_ends,
                                                  rust::Slice<const std::uint32_t> indices,
                                                  rust::Slice<const double> weights) {
    if (indices.size() != weights.size() || (row_ends.size() && row_ends[row_ends.size() - 1] != indices.size())) {
        throw std::runtime_error("arrays that are no sparse rows");
    }
    return std::make_unique<FloatStencilTable>(
        std::make_unique<FilledTable>(static_cast<int>(columns), row_ends, indices, weights));
}

FloatStencilTable::FloatStencilTable(std::unique_ptr<Far::StencilTable const> table)
    : table_(std::move(table)) {}

std::size_t FloatStencilTable::num_stencils() const {
    return static_cast<std::size_t>(table_->GetNumStencils());
}

void FloatStencilTable::evaluate(rust::Slice<const float> source, std::uint32_t width,
                                 rust::Slice<float> out) const {
    std::size_t sources = static_cast<std::size_t>(table_->GetNumControlVertices());
    if (source.size() != sources * width || out.size() != num_stencils() * width) {
        throw std::runtime_error("arrays that do not fit the stencil table");
    }
    Osd::BufferDescriptor layout(0, static_cast<int>(width), static_cast<int>(width));
    Osd::CpuEvaluator::EvalStencils(source.data(), layout, out.data(), layout, &table_->GetSizes()[0],
                                    &table_->GetOffsets()[0], &table_->GetControlIndices()[0],
                                    &table_->GetWeights()[0], 0, table_->GetNumStencils());
}

} // namespace formwork
