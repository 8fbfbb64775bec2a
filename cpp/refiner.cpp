#include "cpp/refiner.h"

#include <algorithm>
#include <atomic>
#include <mutex>
#include <stdexcept>
#include <string>
#include <vector>

#include <opensubdiv/far/error.h>
#include <opensubdiv/far/primvarRefiner.h>
#include <opensubdiv/far/stencilTableFactory.h>
#include <opensubdiv/far/topologyDescriptor.h>
#include <opensubdiv/sdc/scheme.h>
#include <opensubdiv/version.h>

#include "formwork/src/osd/bridge.rs.h"

namespace formwork {

namespace Far = OpenSubdiv::Far;
namespace Sdc = OpenSubdiv::Sdc;

namespace {

// OpenSubdiv reports failure by a null pointer and a message to one global callback, which prints to
// stdout unless replaced. Keep the message, for the thread that caused it.
thread_local std::string last_message;

// A program that lends its refiner has OpenSubdiv to itself: its callbacks stay.
std::atomic<bool> callbacks_are_the_hosts{false};

void install_message_callbacks() {
    static std::once_flag once;
    if (callbacks_are_the_hosts) {
        return;
    }
    std::call_once(once, [] {
        Far::SetErrorCallback([](Far::ErrorType, char const *message) { last_message = message; });
        Far::SetWarningCallback([](char const *message) { last_message = message; });
    });
}

[[noreturn]] void fail(std::string const &what) {
    std::string message = what;
    if (!last_message.empty()) {
        message += ": " + last_message;
    }
    last_message.clear();
    throw std::runtime_error(message);
}

template <class T>
void check_length(rust::Slice<T> const &array, std::size_t length, char const *what) {
    if (array.size() != length) {
        throw std::runtime_error(std::string(what) + ": an array of " + std::to_string(array.size()) +
                                 " entries where " + std::to_string(length) + " belong");
    }
}

template <class Source, class Target>
Target *append(Source const &source, Target *target) {
    for (int i = 0; i < source.size(); ++i) {
        *target++ = static_cast<Target>(source[i]);
    }
    return target;
}

std::uint8_t rule_number(Sdc::Crease::Rule rule) {
    switch (rule) {
    case Sdc::Crease::RULE_SMOOTH: return 0;
    case Sdc::Crease::RULE_DART: return 1;
    case Sdc::Crease::RULE_CREASE: return 2;
    case Sdc::Crease::RULE_CORNER: return 3;
    default: fail("OpenSubdiv gave a vertex no rule");
    }
}

// The neighbourhoods that Sdc::Scheme asks its questions of, answered from the public levels.

struct EdgeNeighbourhood {
    Far::TopologyLevel const &parent;
    int edge;

    int GetNumFaces() const { return parent.GetEdgeFaces(edge).size(); }
    float GetSharpness() const { return parent.GetEdgeSharpness(edge); }
    void GetChildSharpnesses(Sdc::Crease const &, float sharpness[2]) const {
        // Never asked: the caller names the rule of the child.
        sharpness[0] = sharpness[1] = 0.0f;
    }
    void GetNumVerticesPerFace(int sizes[]) const {
        Far::ConstIndexArray faces = parent.GetEdgeFaces(edge);
        for (int i = 0; i < faces.size(); ++i) {
            sizes[i] = parent.GetFaceVertices(faces[i]).size();
        }
    }
};

struct VertexNeighbourhood {
    Far::TopologyLevel const &parent;
    Far::TopologyLevel const &child;
    int vertex;

    int GetNumEdges() const { return parent.GetVertexEdges(vertex).size(); }
    int GetNumFaces() const { return parent.GetVertexFaces(vertex).size(); }
    float GetSharpness() const { return parent.GetVertexSharpness(vertex); }
    float *GetSharpnessPerEdge(float sharpness[]) const {
        Far::ConstIndexArray edges = parent.GetVertexEdges(vertex);
        for (int i = 0; i < edges.size(); ++i) {
            sharpness[i] = parent.GetEdgeSharpness(edges[i]);
        }
        return sharpness;
    }
    float GetChildSharpness(Sdc::Crease const &) const {
        return child.GetVertexSharpness(parent.GetVertexChildVertex(vertex));
    }
    float *GetChildSharpnessPerEdge(Sdc::Crease const &crease, float sharpness[]) const {
        std::vector<float> parents(GetNumEdges());
        GetSharpnessPerEdge(parents.data());
        crease.SubdivideEdgeSharpnessesAroundVertex(GetNumEdges(), parents.data(), sharpness);
        return sharpness;
    }
};

struct Mask {
    typedef double Weight;

    double *vertices;
    double *edges;
    double *faces;
    int num_vertices = 0, num_edges = 0, num_faces = 0;
    bool face_centres = false;

    Mask(double *v, double *e, double *f) : vertices(v), edges(e), faces(f) {}

    int GetNumVertexWeights() const { return num_vertices; }
    int GetNumEdgeWeights() const { return num_edges; }
    int GetNumFaceWeights() const { return num_faces; }
    void SetNumVertexWeights(int count) { num_vertices = count; }
    void SetNumEdgeWeights(int count) { num_edges = count; }
    void SetNumFaceWeights(int count) { num_faces = count; }
    double const &VertexWeight(int i) const { return vertices[i]; }
    double const &EdgeWeight(int i) const { return edges[i]; }
    double const &FaceWeight(int i) const { return faces[i]; }
    double &VertexWeight(int i) { return vertices[i]; }
    double &EdgeWeight(int i) { return edges[i]; }
    double &FaceWeight(int i) { return faces[i]; }
    bool AreFaceWeightsForFaceCenters() const { return face_centres; }
    void SetFaceWeightsForFaceCenters(bool on) { face_centres = on; }
};

template <Sdc::SchemeType SCHEME>
void fill_masks(Sdc::Options options, Far::TopologyLevel const &parent, Far::TopologyLevel const &child,
                rust::Slice<const bool> known_regular, MaskArrays &out) {
    Sdc::Scheme<SCHEME> scheme(options);
    Sdc::Crease crease(options);
    // Through plain pointers: indexing a slice is a call.
    double *vertex_self = out.vertex_self.data(), *vertex_edge = out.vertex_edge.data(),
           *vertex_face = out.vertex_face.data(), *edge_end = out.edge_end.data(), *edge_face = out.edge_face.data(),
           *parent_weight = out.parent_weight.data();
    std::uint8_t *parent_rules = out.parent_rule.data(), *child_rules = out.child_rule.data();
    bool *parent_sharp = out.parent_sharp.data(), *child_sharp = out.child_sharp.data();

    std::vector<int> first_corner(parent.GetNumFaces() + 1, 0);
    for (int f = 0; f < parent.GetNumFaces(); ++f) {
        first_corner[f + 1] = first_corner[f] + parent.GetFaceVertices(f).size();
    }

    // The mask of a smooth edge between two faces is the same everywhere, but next to triangles if those are
    // smoothed; OpenSubdiv is asked once.
    bool all_alike = options.GetTriangleSubdivision() != Sdc::Options::TRI_SUB_SMOOTH;
    bool asked = false;
    double smooth[4] = {};

    bool const *known = known_regular.empty() ? nullptr : known_regular.data();
    std::vector<double> faces;
    for (int e = 0; e < parent.GetNumEdges(); ++e) {
        if (known) {
            Far::ConstIndexArray ends = parent.GetEdgeVertices(e);
            if (known[ends[0]] && known[ends[1]]) {
                continue;
            }
        }
        Far::ConstIndexArray edge_faces = parent.GetEdgeFaces(e);
        Far::ConstLocalIndexArray places = parent.GetEdgeFaceLocalIndices(e);
        bool is_smooth = all_alike && edge_faces.size() == 2 && parent.GetEdgeSharpness(e) == 0.0f;
        auto corner = [&](int i) { return first_corner[edge_faces[i]] + places[i]; };
        if (is_smooth && asked) {
            edge_end[2 * e] = smooth[0];
            edge_end[2 * e + 1] = smooth[1];
            edge_face[corner(0)] = smooth[2];
            edge_face[corner(1)] = smooth[3];
            continue;
        }
        parent_sharp[e] = parent.GetEdgeSharpness(e) > 0.0f;
        faces.assign(edge_faces.size(), 0.0);
        double ends[2];
        Mask mask(ends, nullptr, faces.data());
        Sdc::Crease::Rule rule =
            parent_sharp[e] ? Sdc::Crease::RULE_CREASE : Sdc::Crease::RULE_SMOOTH;
        scheme.ComputeEdgeVertexMask(EdgeNeighbourhood{parent, e}, mask, rule,
                                     child.GetVertexRule(parent.GetEdgeChildVertex(e)));
        edge_end[2 * e] = ends[0];
        edge_end[2 * e + 1] = ends[1];
        for (int i = 0; i < edge_faces.size(); ++i) {
            edge_face[corner(i)] = mask.num_faces ? faces[i] : 0.0;
        }
        if (is_smooth) {
            asked = true;
            smooth[0] = ends[0];
            smooth[1] = ends[1];
            smooth[2] = edge_face[corner(0)];
            smooth[3] = edge_face[corner(1)];
        }
    }

    // The mask of a smooth vertex depends on its valence only, and gives all edges and all faces the same weight;
    // OpenSubdiv is asked once for each valence.
    struct SmoothMask {
        bool known = false;
        double self, edge, face;
    };
    std::vector<SmoothMask> smooth_masks;

    std::vector<double> edges;
    std::vector<float> sharpness, child_sharpness;
    for (int v = 0; v < parent.GetNumVertices(); ++v) {
        if (known && known[v]) {
            continue;
        }
        VertexNeighbourhood hood{parent, child, v};
        Far::ConstIndexArray vertex_edges = parent.GetVertexEdges(v);
        Far::ConstIndexArray vertex_faces = parent.GetVertexFaces(v);
        Far::ConstLocalIndexArray edge_places = parent.GetVertexEdgeLocalIndices(v);
        Far::ConstLocalIndexArray face_places = parent.GetVertexFaceLocalIndices(v);
        Sdc::Crease::Rule parent_rule = parent.GetVertexRule(v);
        bool is_smooth = parent_rule == Sdc::Crease::RULE_SMOOTH && vertex_edges.size() > 0 &&
                         vertex_faces.size() == vertex_edges.size();
        if (is_smooth) {
            std::size_t valence = static_cast<std::size_t>(vertex_edges.size());
            if (smooth_masks.size() <= valence) {
                smooth_masks.resize(valence + 1);
            }
            SmoothMask &mask = smooth_masks[valence];
            if (!mask.known) {
                edges.assign(valence, 0.0);
                faces.assign(valence, 0.0);
                Mask asked(&mask.self, edges.data(), faces.data());
                scheme.ComputeVertexVertexMask(hood, asked, parent_rule, parent_rule);
                mask.edge = asked.num_edges ? edges[0] : 0.0;
                mask.face = asked.num_faces ? faces[0] : 0.0;
                mask.known = true;
            }
            vertex_self[v] = mask.self;
            parent_rules[v] = rule_number(parent_rule);
            child_rules[v] = rule_number(child.GetVertexRule(parent.GetVertexChildVertex(v)));
            parent_weight[v] = 1.0;
            for (int i = 0; i < vertex_edges.size(); ++i) {
                vertex_edge[2 * vertex_edges[i] + edge_places[i]] = mask.edge;
                child_sharp[2 * vertex_edges[i] + edge_places[i]] = false;
                vertex_face[first_corner[vertex_faces[i]] + face_places[i]] = mask.face;
            }
            continue;
        }
        // OpenSubdiv's masks write as many weights of either kind as there are faces, or edges.
        int most = std::max(vertex_faces.size(), vertex_edges.size());
        edges.assign(most, 0.0);
        faces.assign(most, 0.0);
        sharpness.resize(vertex_edges.size());
        child_sharpness.resize(vertex_edges.size());

        Sdc::Crease::Rule child_rule = child.GetVertexRule(parent.GetVertexChildVertex(v));
        Mask mask(&vertex_self[v], edges.data(), faces.data());
        scheme.ComputeVertexVertexMask(hood, mask, parent_rule, child_rule);

        hood.GetSharpnessPerEdge(sharpness.data());
        hood.GetChildSharpnessPerEdge(crease, child_sharpness.data());
        parent_rules[v] = rule_number(parent_rule);
        child_rules[v] = rule_number(child_rule);
        bool parent_smooth = parent_rule == Sdc::Crease::RULE_SMOOTH || parent_rule == Sdc::Crease::RULE_DART;
        parent_weight[v] =
            parent_smooth || parent_rule == child_rule
                ? 1.0
                : crease.ComputeFractionalWeightAtVertex(hood.GetSharpness(), hood.GetChildSharpness(crease),
                                                         vertex_edges.size(), sharpness.data(),
                                                         child_sharpness.data());
        for (int i = 0; i < vertex_edges.size(); ++i) {
            int half_edge = 2 * vertex_edges[i] + edge_places[i];
            vertex_edge[half_edge] = mask.num_edges ? edges[i] : 0.0;
            child_sharp[half_edge] = child_sharpness[i] > 0.0f;
        }
        for (int i = 0; i < vertex_faces.size(); ++i) {
            int corner = first_corner[vertex_faces[i]] + face_places[i];
            vertex_face[corner] = mask.num_faces ? faces[i] : 0.0;
        }
    }
}

// The masks of one vertex as a sparse row over the vertices of its level. Face weights are those of the
// vertices opposite, two corners on.
void append_limit_row(Far::TopologyLevel const &level, int v, Mask const &mask, Stencils &out) {
    std::size_t before = out.indices.size();
    auto add = [&out](int index, double weight) {
        out.indices.push_back(static_cast<std::uint32_t>(index));
        out.weights.push_back(weight);
    };
    add(v, mask.vertices[0]);
    Far::ConstIndexArray edges = level.GetVertexEdges(v), faces = level.GetVertexFaces(v);
    Far::ConstLocalIndexArray places = level.GetVertexFaceLocalIndices(v);
    for (int i = 0; i < std::min(mask.num_edges, edges.size()); ++i) {
        Far::ConstIndexArray ends = level.GetEdgeVertices(edges[i]);
        add(ends[0] == v ? ends[1] : ends[0], mask.edges[i]);
    }
    for (int i = 0; i < std::min(mask.num_faces, faces.size()); ++i) {
        Far::ConstIndexArray corners = level.GetFaceVertices(faces[i]);
        add(corners[(places[i] + 2) % corners.size()], mask.faces[i]);
    }
    out.sizes.push_back(static_cast<std::uint32_t>(out.indices.size() - before));
}

// The limit masks of every vertex: 0 position, 1 and 2 the tangents.
//
// Not by PrimvarRefiner::Limit: it sizes its tangent masks by the most edges at a vertex, and writes past
// them at non-manifold vertices that have more faces than edges (OpenSubdiv 3.5 and 3.6).
template <Sdc::SchemeType SCHEME>
Stencils limit_rows(Sdc::Options options, Far::TopologyLevel const &at, std::uint8_t which) {
    Sdc::Scheme<SCHEME> scheme(options);
    Stencils out;
    std::vector<double> weights;
    for (int v = 0; v < at.GetNumVertices(); ++v) {
        int edges = at.GetVertexEdges(v).size(), faces = at.GetVertexFaces(v).size();
        int most = std::max(edges, faces) + 2;
        weights.assign(3 * (2 * most + 1), 0.0);
        auto mask = [&weights, most](int i) {
            double *w = weights.data() + i * (2 * most + 1);
            return Mask(w, w + 1, w + 1 + most);
        };
        Mask masks[3] = {mask(0), mask(1), mask(2)};
        if (edges == 0) {
            masks[0].vertices[0] = 1.0; // an isolated vertex stays where it is and has no tangents
        } else {
            VertexNeighbourhood hood{at, at, v};
            scheme.ComputeVertexLimitMask(hood, masks[0], masks[1], masks[2], at.GetVertexRule(v));
        }
        append_limit_row(at, v, masks[which % 3], out);
    }
    return out;
}

struct Scalar {
    double value;
    void Clear() { value = 0.0; }
    void AddWithWeight(Scalar const &source, double weight) { value += weight * source.value; }
};
static_assert(sizeof(Scalar) == sizeof(double), "an array of Scalar is an array of double");

template <class T>
void fill(rust::Vec<T> &target, T const *source, std::size_t count) {
    target.reserve(count);
    for (std::size_t i = 0; i < count; ++i) {
        target.push_back(source[i]);
    }
}

Sdc::SchemeType scheme_of(std::uint8_t number) {
    switch (number) {
    case 0: return Sdc::SCHEME_BILINEAR;
    case 1: return Sdc::SCHEME_CATMARK;
    case 2: return Sdc::SCHEME_LOOP;
    default: throw std::runtime_error("unknown scheme");
    }
}

std::uint8_t scheme_number(Sdc::SchemeType scheme) {
    switch (scheme) {
    case Sdc::SCHEME_BILINEAR: return 0;
    case Sdc::SCHEME_CATMARK: return 1;
    case Sdc::SCHEME_LOOP: return 2;
    }
    throw std::runtime_error("unknown scheme");
}

Sdc::Options options_of(CageArrays const &cage) {
    Sdc::Options options;
    Sdc::Options::VtxBoundaryInterpolation const boundary[] = {Sdc::Options::VTX_BOUNDARY_NONE,
                                                               Sdc::Options::VTX_BOUNDARY_EDGE_ONLY,
                                                               Sdc::Options::VTX_BOUNDARY_EDGE_AND_CORNER};
    options.SetVtxBoundaryInterpolation(boundary[cage.boundary % 3]);
    options.SetCreasingMethod(cage.creasing ? Sdc::Options::CREASE_CHAIKIN : Sdc::Options::CREASE_UNIFORM);
    options.SetTriangleSubdivision(cage.triangles ? Sdc::Options::TRI_SUB_SMOOTH
                                                  : Sdc::Options::TRI_SUB_CATMARK);
    return options;
}

} // namespace

std::unique_ptr<Refiner> new_refiner(CageArrays const &cage) {
    install_message_callbacks();
    last_message.clear();
    check_length(cage.crease_vertices, 2 * cage.crease_sharpness.size(), "crease vertices");
    check_length(cage.corner_vertices, cage.corner_sharpness.size(), "corner vertices");

    // OpenSubdiv's indices are int; ours are unsigned and, as the cage promises, below 2^31.
    auto as_int = [](std::uint32_t const *p) { return reinterpret_cast<int const *>(p); };
    Far::TopologyDescriptor descriptor;
    descriptor.numVertices = static_cast<int>(cage.num_vertices);
    descriptor.numFaces = static_cast<int>(cage.face_sizes.size());
    descriptor.numVertsPerFace = as_int(cage.face_sizes.data());
    descriptor.vertIndicesPerFace = as_int(cage.face_vertices.data());
    descriptor.numCreases = static_cast<int>(cage.crease_sharpness.size());
    descriptor.creaseVertexIndexPairs = as_int(cage.crease_vertices.data());
    descriptor.creaseWeights = cage.crease_sharpness.data();
    descriptor.numCorners = static_cast<int>(cage.corner_sharpness.size());
    descriptor.cornerVertexIndices = as_int(cage.corner_vertices.data());
    descriptor.cornerWeights = cage.corner_sharpness.data();
    descriptor.numHoles = static_cast<int>(cage.holes.size());
    descriptor.holeIndices = as_int(cage.holes.data());
    descriptor.isLeftHanded = cage.left_handed;

    typedef Far::TopologyRefinerFactory<Far::TopologyDescriptor> Factory;
    std::unique_ptr<Far::TopologyRefiner> refiner(
        Factory::Create(descriptor, Factory::Options(scheme_of(cage.scheme), options_of(cage))));
    if (!refiner) {
        fail("OpenSubdiv refused the cage");
    }
    last_message.clear();
    return std::make_unique<Refiner>(std::move(refiner));
}

std::unique_ptr<Refiner> borrow_refiner(FarRefiner const *refiner) {
    if (!refiner) {
        throw std::runtime_error("no refiner was given");
    }
    callbacks_are_the_hosts = true;
    return std::make_unique<Refiner>(*refiner);
}

std::uint32_t opensubdiv_version() { return OPENSUBDIV_VERSION_NUMBER; }

Refiner::Refiner(std::unique_ptr<FarRefiner> refiner) : owned_(std::move(refiner)), refiner_(owned_.get()) {}

Refiner::Refiner(FarRefiner const &refiner) : refiner_(&refiner) {}

Description Refiner::description() const {
    Sdc::Options options = refiner_->GetSchemeOptions();
    Far::TopologyRefiner::UniformOptions uniform = refiner_->GetUniformOptions();
    bool refined = refiner_->GetMaxLevel() > 0;
    Description out;
    out.scheme = scheme_number(refiner_->GetSchemeType());
    out.boundary = static_cast<std::uint8_t>(options.GetVtxBoundaryInterpolation());
    out.creasing = options.GetCreasingMethod() == Sdc::Options::CREASE_CHAIKIN;
    out.triangles = options.GetTriangleSubdivision() == Sdc::Options::TRI_SUB_SMOOTH;
    out.levels = static_cast<std::uint32_t>(refiner_->GetMaxLevel());
    out.uniform = refiner_->IsUniform();
    out.faces_first = refined && uniform.orderVerticesFromFacesFirst;
    return out;
}

void Refiner::refine_uniform(std::uint32_t levels, bool full_last_level) {
    if (!owned_) {
        throw std::runtime_error("this refiner is its owner's to refine");
    }
    if (levels < 1 || levels > 15) {
        throw std::runtime_error("OpenSubdiv refines 1 to 15 levels");
    }
    if (refiner_->GetMaxLevel() > 0) {
        throw std::runtime_error("this refiner has been refined already");
    }
    Far::TopologyRefiner::UniformOptions options(static_cast<int>(levels));
    options.fullTopologyInLastLevel = full_last_level;
    owned_->RefineUniform(options);
}

Far::TopologyLevel Refiner::level(std::uint32_t level, bool with_child) const {
    std::uint32_t max = static_cast<std::uint32_t>(refiner_->GetMaxLevel());
    if (level > max || (with_child && level == max)) {
        throw std::runtime_error("level " + std::to_string(level) + " of a refiner of " + std::to_string(max) +
                                 " levels" + (with_child ? " has no children" : ""));
    }
    return refiner_->GetLevel(static_cast<int>(level));
}

bool Refiner::has_edges(std::uint32_t l) const {
    return static_cast<int>(l) < refiner_->GetMaxLevel() || l == 0 ||
           refiner_->GetUniformOptions().fullTopologyInLastLevel;
}

Counts Refiner::counts(std::uint32_t l) const {
    Far::TopologyLevel at = level(l, false);
    auto size = [](int n) { return static_cast<std::size_t>(n); };
    return {size(at.GetNumVertices()), size(at.GetNumEdges()), size(at.GetNumFaces()),
            size(at.GetNumFaceVertices())};
}

void Refiner::topology(std::uint32_t l, TopologyArrays out) const {
    Far::TopologyLevel at = level(l, false);
    Counts n = counts(l);
    check_length(out.face_sizes, n.faces, "face sizes");
    check_length(out.face_vertices, n.corners, "face vertices");
    check_length(out.face_edges, n.corners, "face edges");
    check_length(out.edge_vertices, 2 * n.edges, "edge vertices");
    if (!has_edges(l)) {
        throw std::runtime_error("level " + std::to_string(l) + " was refined without its edges");
    }
    std::uint32_t *vertices = out.face_vertices.data(), *edges = out.face_edges.data();
    std::uint32_t *sizes = out.face_sizes.data();
    for (int f = 0; f < at.GetNumFaces(); ++f) {
        sizes[f] = static_cast<std::uint32_t>(at.GetFaceVertices(f).size());
        vertices = append(at.GetFaceVertices(f), vertices);
        edges = append(at.GetFaceEdges(f), edges);
    }
    std::uint32_t *ends = out.edge_vertices.data();
    for (int e = 0; e < at.GetNumEdges(); ++e) {
        ends = append(at.GetEdgeVertices(e), ends);
    }
}

TagLists Refiner::tags(std::uint32_t l) const {
    Far::TopologyLevel at = level(l, false);
    TagLists out;
    auto number = [](int i) { return static_cast<std::uint32_t>(i); };
    for (int e = 0; e < at.GetNumEdges(); ++e) {
        if (float sharpness = at.GetEdgeSharpness(e)) {
            out.edges.push_back(number(e));
            out.edge_sharpness.push_back(sharpness);
        }
    }
    for (int v = 0; v < at.GetNumVertices(); ++v) {
        float sharpness = at.GetVertexSharpness(v);
        Sdc::Crease::Rule rule = at.GetVertexRule(v);
        if (sharpness != 0.0f || rule != Sdc::Crease::RULE_SMOOTH) {
            out.vertices.push_back(number(v));
            out.vertex_sharpness.push_back(sharpness);
            out.vertex_rule.push_back(rule_number(rule));
        }
    }
    for (int f = 0; f < at.GetNumFaces(); ++f) {
        if (at.IsFaceHole(f)) {
            out.holes.push_back(number(f));
        }
    }
    return out;
}

void Refiner::masks(std::uint32_t l, rust::Slice<const bool> known, MaskArrays out) const {
    Far::TopologyLevel parent = level(l, true), child = level(l + 1, false);
    Counts n = counts(l);
    check_length(known, known.empty() ? 0 : n.vertices, "known vertices");
    check_length(out.vertex_self, n.vertices, "vertex weights");
    check_length(out.vertex_edge, 2 * n.edges, "spoke weights");
    check_length(out.vertex_face, n.corners, "corner weights");
    check_length(out.edge_end, 2 * n.edges, "edge end weights");
    check_length(out.edge_face, n.corners, "edge face weights");
    check_length(out.parent_rule, n.vertices, "parent rules");
    check_length(out.child_rule, n.vertices, "child rules");
    check_length(out.parent_weight, n.vertices, "parent rule weights");
    check_length(out.parent_sharp, n.edges, "parent sharpness");
    check_length(out.child_sharp, 2 * n.edges, "child sharpness");
    Sdc::Options options = refiner_->GetSchemeOptions();
    switch (refiner_->GetSchemeType()) {
    case Sdc::SCHEME_BILINEAR: return fill_masks<Sdc::SCHEME_BILINEAR>(options, parent, child, known, out);
    case Sdc::SCHEME_CATMARK: return fill_masks<Sdc::SCHEME_CATMARK>(options, parent, child, known, out);
    case Sdc::SCHEME_LOOP: return fill_masks<Sdc::SCHEME_LOOP>(options, parent, child, known, out);
    }
}

void Refiner::children(std::uint32_t l, ChildArrays out) const {
    Far::TopologyLevel at = level(l, true);
    Counts n = counts(l);
    check_length(out.vertex_vertex, n.vertices, "children of vertices");
    check_length(out.edge_vertex, n.edges, "child vertices of edges");
    Counts child = counts(l + 1);
    bool centres = refiner_->GetSchemeType() != Sdc::SCHEME_LOOP;
    check_length(out.face_vertex, centres ? n.faces : 0, "child vertices of faces");
    check_length(out.edge_edges, 2 * n.edges, "child edges of edges");
    check_length(out.face_edges, n.corners, "child edges of faces");
    check_length(out.face_faces, child.faces, "child faces of faces");
    for (int v = 0; v < at.GetNumVertices(); ++v) {
        out.vertex_vertex[v] = static_cast<std::uint32_t>(at.GetVertexChildVertex(v));
    }
    std::uint32_t *edges = out.edge_edges.data();
    for (int e = 0; e < at.GetNumEdges(); ++e) {
        out.edge_vertex[e] = static_cast<std::uint32_t>(at.GetEdgeChildVertex(e));
        edges = append(at.GetEdgeChildEdges(e), edges);
    }
    edges = out.face_edges.data();
    std::uint32_t *faces = out.face_faces.data();
    for (int f = 0; f < at.GetNumFaces(); ++f) {
        if (centres) { // asking for them where there are none crashes
            out.face_vertex[f] = static_cast<std::uint32_t>(at.GetFaceChildVertex(f));
        }
        edges = append(at.GetFaceChildEdges(f), edges);
        faces = append(at.GetFaceChildFaces(f), faces);
    }
}

bool Refiner::numbers_children_in_order(std::uint32_t l, bool centres) const {
    Far::TopologyLevel at = level(l, true), below = level(l + 1, false);
    int vertices = at.GetNumVertices(), faces = at.GetNumFaces(), edges = at.GetNumEdges();
    int corners = at.GetNumFaceVertices();
    int first_midpoint = vertices + (centres ? faces : 0);
    bool directed = has_edges(l + 1);
    auto runs = [&](int edge, int from, int to) {
        Far::ConstIndexArray ends = below.GetEdgeVertices(edge);
        return ends[0] == from && ends[1] == to;
    };
    if (below.GetNumVertices() != first_midpoint + edges || below.GetNumEdges() != corners + 2 * edges ||
        below.GetNumFaces() != (centres ? corners : 4 * faces)) {
        return false;
    }
    for (int v = 0; v < vertices; ++v) {
        if (at.GetVertexChildVertex(v) != v) {
            return false;
        }
    }
    for (int e = 0; e < edges; ++e) {
        Far::ConstIndexArray halves = at.GetEdgeChildEdges(e), ends = at.GetEdgeVertices(e);
        int middle = first_midpoint + e;
        for (int j = 0; j < 2; ++j) {
            int half = corners + 2 * e + j;
            if (at.GetEdgeChildVertex(e) != middle || halves[j] != half ||
                (directed && !runs(half, middle, ends[j]))) {
                return false;
            }
        }
    }
    int corner = 0, child = 0;
    for (int f = 0; f < faces; ++f) {
        Far::ConstIndexArray inside = at.GetFaceChildEdges(f), children = at.GetFaceChildFaces(f);
        Far::ConstIndexArray boundary = at.GetFaceEdges(f), around = at.GetFaceVertices(f);
        if (centres && at.GetFaceChildVertex(f) != vertices + f) {
            return false;
        }
        for (int i = 0; i < children.size(); ++i, ++child) {
            if (children[i] != child) {
                return false;
            }
            int place = around.size() == 4 || !centres ? i : 0;
            bool at_corner = i < around.size();
            if (at_corner && below.GetFaceVertices(child)[place] != around[i]) {
                return false;
            }
        }
        for (int i = 0; i < inside.size(); ++i, ++corner) {
            int leaving = first_midpoint + boundary[i];
            int reaching = first_midpoint + boundary[(i + inside.size() - 1) % inside.size()];
            if (inside[i] != corner ||
                (directed && !(centres ? runs(corner, vertices + f, leaving) : runs(corner, leaving, reaching)))) {
                return false;
            }
        }
    }
    return true;
}

Stencils Refiner::stencils(std::uint32_t l) const {
    if (l == 0) {
        throw std::runtime_error("level 0 is not refined from anything");
    }
    level(l, false);
    typedef Far::StencilTableFactoryReal<double> Factory;
    Factory::Options options;
    options.generateControlVerts = false;
    options.generateIntermediateLevels = true;
    options.factorizeIntermediateLevels = false; // indices are those of the level before
    options.generateOffsets = true;
    options.maxLevel = l;
    std::unique_ptr<Far::StencilTableReal<double> const> table(Factory::Create(*refiner_, options));
    if (!table) {
        fail("OpenSubdiv made no stencil table");
    }
    std::size_t count = counts(l).vertices, total = static_cast<std::size_t>(table->GetNumStencils());
    if (total < count) {
        fail("OpenSubdiv's stencil table is shorter than its level");
    }
    std::size_t first = total - count;
    Stencils out;
    out.sizes.reserve(count);
    // The weight array may be longer than the index array: only offsets and sizes can be trusted.
    std::size_t entries = 0;
    for (std::size_t i = first; i < total; ++i) {
        out.sizes.push_back(static_cast<std::uint32_t>(table->GetSizes()[i]));
        entries += static_cast<std::size_t>(table->GetSizes()[i]);
    }
    std::size_t offset = count ? static_cast<std::size_t>(table->GetOffsets()[first]) : 0;
    fill(out.indices, reinterpret_cast<std::uint32_t const *>(table->GetControlIndices().data() + offset), entries);
    fill(out.weights, table->GetWeights().data() + offset, entries);
    return out;
}

Stencils Refiner::limit_stencils(std::uint8_t which) const {
    Far::TopologyLevel at = refiner_->GetLevel(refiner_->GetMaxLevel());
    Sdc::Options options = refiner_->GetSchemeOptions();
    switch (refiner_->GetSchemeType()) {
    case Sdc::SCHEME_BILINEAR: return limit_rows<Sdc::SCHEME_BILINEAR>(options, at, which);
    case Sdc::SCHEME_CATMARK: return limit_rows<Sdc::SCHEME_CATMARK>(options, at, which);
    case Sdc::SCHEME_LOOP: return limit_rows<Sdc::SCHEME_LOOP>(options, at, which);
    }
    fail("OpenSubdiv has a scheme that is not known here");
}

std::size_t Refiner::per_level_tables() const {
    typedef Far::StencilTableFactoryReal<double> Factory;
    Factory::Options options;
    options.generateIntermediateLevels = true;
    options.factorizeIntermediateLevels = false;
    options.generateOffsets = true;
    options.maxLevel = refiner_->GetMaxLevel();
    std::unique_ptr<Far::StencilTableReal<double> const> table(Factory::Create(*refiner_, options));
    if (!table) {
        fail("OpenSubdiv made no stencil table");
    }
    return table->GetControlIndices().size();
}

void Refiner::interpolate(std::uint32_t l, rust::Slice<const double> source, rust::Slice<double> out) const {
    if (l == 0) {
        throw std::runtime_error("level 0 is not refined from anything");
    }
    check_length(out, counts(l).vertices, "refined values");
    check_length(source, counts(l - 1).vertices, "values");
    std::vector<Scalar> from(source.size()), to(out.size());
    for (std::size_t i = 0; i < from.size(); ++i) {
        from[i].value = source[i];
    }
    Far::PrimvarRefinerReal<double>(*refiner_).Interpolate(static_cast<int>(l), from, to);
    for (std::size_t i = 0; i < to.size(); ++i) {
        out[i] = to[i].value;
    }
}

} // namespace formwork
