#include "cpp/bfr.h"

#include <stdexcept>
#include <string>
#include <vector>

#include <opensubdiv/bfr/surface.h>

#include "formwork/src/osd/bridge.rs.h"

namespace formwork {

namespace {

// Whether (u, v) is on a face. Outside OpenSubdiv extrapolates, or indexes faces that are not there.
bool is_inside(OpenSubdiv::Bfr::Parameterization const &face, double const uv[2]) {
    typedef OpenSubdiv::Bfr::Parameterization Parameterization;
    double const round_off = 1e-15;
    double u = uv[0], v = uv[1];
    switch (face.GetType()) {
    case Parameterization::QUAD: return u >= 0 && v >= 0 && u <= 1 && v <= 1;
    case Parameterization::TRI: return u >= 0 && v >= 0 && u + v <= 1 + round_off;
    case Parameterization::QUAD_SUBFACES: {
        double size = face.GetFaceSize();
        if (!(u >= 0 && v >= 0 && u <= size && v <= size)) {
            return false;
        }
        double st[2];
        int sub_face = face.ConvertCoordToNormalizedSubFace(uv, st);
        return sub_face < face.GetFaceSize() && st[0] >= 0 && st[1] >= 0 && st[0] <= 1 && st[1] <= 1;
    }
    }
    return false;
}

} // namespace

std::unique_ptr<Bfr> new_bfr(Refiner const &refiner, std::uint8_t smooth_level, std::uint8_t sharp_level) {
    // OpenSubdiv keeps them in four bits.
    if (smooth_level < 1 || smooth_level > 15 || sharp_level < 1 || sharp_level > 15) {
        throw std::runtime_error("Bfr refines 1 to 15 levels");
    }
    OpenSubdiv::Bfr::SurfaceFactory::Options options;
    options.SetApproxLevelSmooth(smooth_level).SetApproxLevelSharp(sharp_level);
    return std::make_unique<Bfr>(refiner.get(), options);
}

Bfr::Bfr(OpenSubdiv::Far::TopologyRefiner const &refiner,
         OpenSubdiv::Bfr::SurfaceFactory::Options const &options)
    : factory_(refiner, options) {}

void Bfr::evaluate(rust::Slice<const double> positions, rust::Slice<const std::uint32_t> faces,
                   rust::Slice<const double> uv, bool derivatives, rust::Slice<double> out) const {
    std::size_t vertices = static_cast<std::size_t>(factory_.GetMesh().GetLevel(0).GetNumVertices());
    std::size_t width = derivatives ? 9 : 3;
    if (positions.size() != 3 * vertices || uv.size() != 2 * faces.size() || out.size() != width * faces.size()) {
        throw std::runtime_error("arrays that do not fit the cage or each other");
    }
    typedef OpenSubdiv::Bfr::Surface<double> Surface;
    Surface surface;
    Surface::PointDescriptor const layout(3);
    std::vector<double> points;
    for (std::size_t i = 0; i < faces.size(); ++i) {
        if (i == 0 || faces[i] != faces[i - 1]) {
            bool exists = faces[i] < static_cast<std::uint32_t>(factory_.GetNumFaces());
            if (!exists || !factory_.InitVertexSurface(static_cast<int>(faces[i]), &surface)) {
                throw std::runtime_error("face " + std::to_string(faces[i]) +
                                         (exists ? " has no limit surface" : ": there is no such face"));
            }
            points.resize(3 * static_cast<std::size_t>(surface.GetNumPatchPoints()));
            surface.PreparePatchPoints(positions.data(), layout, points.data(), layout);
        }
        double const *at = uv.data() + 2 * i;
        if (!is_inside(surface.GetParameterization(), at)) {
            throw std::runtime_error("a point is outside face " + std::to_string(faces[i]));
        }
        double *to = out.data() + width * i;
        if (derivatives) {
            surface.Evaluate(at, points.data(), layout, to, to + 3, to + 6);
        } else {
            surface.Evaluate(at, points.data(), layout, to);
        }
    }
}

} // namespace formwork
