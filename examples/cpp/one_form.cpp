//
//  Refines a form of degree 1, one number an edge, on a mesh whose TopologyRefiner this program owns. The form is the
//  slope of the height of a cube, so refining it must give the slope of the refined height: OpenSubdiv's own stencil
//  table refines the height, Formwork's the slope, and Osd::CpuEvaluator applies both.
//
//      g++ one_form.cpp $(pkg-config --cflags --libs formwork) -o one_form
//
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <vector>

#include <formwork/formStencilTable.h>
#include <opensubdiv/far/stencilTableFactory.h>
#include <opensubdiv/far/topologyDescriptor.h>
#include <opensubdiv/osd/cpuEvaluator.h>
#include <opensubdiv/osd/cpuVertexBuffer.h>

using namespace OpenSubdiv;

// One value for each stencil of a table: Osd::CpuEvaluator takes tables of forms like any other.
static std::vector<float>
Evaluate(Far::StencilTable const &table, std::vector<float> const &values) {
    std::unique_ptr<Osd::CpuVertexBuffer> src(Osd::CpuVertexBuffer::Create(1, table.GetNumControlVertices()));
    std::unique_ptr<Osd::CpuVertexBuffer> dst(Osd::CpuVertexBuffer::Create(1, table.GetNumStencils()));
    src->UpdateData(values.data(), 0, table.GetNumControlVertices());
    Osd::BufferDescriptor one(0, 1, 1);
    Osd::CpuEvaluator::EvalStencils(src.get(), one, dst.get(), one, &table);
    return std::vector<float>(dst->BindCpuBuffer(), dst->BindCpuBuffer() + table.GetNumStencils());
}

// The slope of a height: for each edge, in its direction, how much higher its end is than its start.
static std::vector<float>
Slope(Far::TopologyLevel const &level, std::vector<float> const &height) {
    std::vector<float> slope(level.GetNumEdges());
    for (int e = 0; e < level.GetNumEdges(); ++e) {
        slope[e] = height[level.GetEdgeVertices(e)[1]] - height[level.GetEdgeVertices(e)[0]];
    }
    return slope;
}

int main() {
    int sizes[6] = {4, 4, 4, 4, 4, 4}, creases[8] = {0, 1, 1, 3, 3, 2, 2, 0};
    int vertices[24] = {0, 1, 3, 2, 2, 3, 5, 4, 4, 5, 7, 6, 6, 7, 1, 0, 1, 7, 5, 3, 6, 0, 2, 4};
    float sharpness[4] = {2.5f, 2.5f, 2.5f, 2.5f};
    std::vector<float> height = {-1, -1, 1, 1, 1, 1, -1, -1};

    Far::TopologyDescriptor cube;
    cube.numVertices = 8, cube.numFaces = 6, cube.numVertsPerFace = sizes, cube.vertIndicesPerFace = vertices;
    cube.numCreases = 4, cube.creaseVertexIndexPairs = creases, cube.creaseWeights = sharpness;
    typedef Far::TopologyRefinerFactory<Far::TopologyDescriptor> Factory;
    std::unique_ptr<Far::TopologyRefiner> refiner(Factory::Create(cube, Factory::Options(Sdc::SCHEME_CATMARK)));
    Far::TopologyRefiner::UniformOptions uniform(4);
    uniform.fullTopologyInLastLevel = true; // for Slope() on the finest level; Formwork does not need it
    refiner->RefineUniform(uniform);

    try {
        auto edges = formwork::FormStencilTableFactory::Create(*refiner); // degree 1, from level 0 to the finest
        Far::StencilTableFactory::Options last;
        last.generateIntermediateLevels = false;
        std::unique_ptr<Far::StencilTable const> points(Far::StencilTableFactory::Create(*refiner, last));

        std::vector<float> refined = Evaluate(*edges, Slope(refiner->GetLevel(0), height));
        std::vector<float> expected = Slope(refiner->GetLevel(4), Evaluate(*points, height));
        float worst = 0;
        for (size_t e = 0; e < refined.size(); ++e) {
            worst = std::max(worst, std::abs(refined[e] - expected[e]));
        }
        std::printf("%zu refined edges; slope of the height and refined slope differ by %.1g at most\n",
                    refined.size(), worst);
        return worst < 1e-6f ? 0 : 1;
    } catch (formwork::Error const &error) {
        std::fprintf(stderr, "%s\n", error.what());
        return 1;
    }
}
