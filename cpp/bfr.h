// OpenSubdiv's Bfr: its limit surface, evaluated face by face. The yardstick of evaluation at points.
#pragma once

#include <cstdint>
#include <memory>

#include <opensubdiv/bfr/refinerSurfaceFactory.h>

#include "cpp/refiner.h"

namespace formwork {

// The limit surface of the cage of a refiner, which it refers to and must not outlive.
class Bfr {
public:
    Bfr(OpenSubdiv::Far::TopologyRefiner const &refiner,
        OpenSubdiv::Bfr::SurfaceFactory::Options const &options);

    // Evaluates at (u, v) of each of `faces`, uv[2i] and uv[2i + 1]. `positions` has 3 numbers a vertex of the
    // cage, `out` 3 a point, or 9 for the derivatives by u and v behind the position.
    void evaluate(rust::Slice<const double> positions, rust::Slice<const std::uint32_t> faces,
                  rust::Slice<const double> uv, bool derivatives, rust::Slice<double> out) const;

private:
    OpenSubdiv::Bfr::RefinerSurfaceFactory<> factory_;
};

std::unique_ptr<Bfr> new_bfr(Refiner const &refiner, std::uint8_t smooth_level, std::uint8_t sharp_level);

} // namespace formwork
