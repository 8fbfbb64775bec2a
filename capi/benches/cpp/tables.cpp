// Times tables of forms of a refiner that this program owns, or OpenSubdiv's own of S0, and says how much memory they take,
// for the benchmark that runs it (capi/benches/tables.rs).
//
//   tables MESH LEVELS time-s0       milliseconds: refining; the tables of S0
//   tables MESH LEVELS time-forms    milliseconds: refining; reading the refiner; the tables of S1 and S2
//   tables MESH LEVELS memory-none|memory-refiner|memory-s0|memory-forms     the peak of memory, in bytes
//
// Of each task the time of the first round, whose memory is fresh, and the median of those after.
#include <algorithm>
#include <chrono>
#include <fstream>
#include <functional>
#include <iostream>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include <formwork/formStencilTable.h>
#include <opensubdiv/far/stencilTableFactory.h>
#include <opensubdiv/far/topologyDescriptor.h>

#include "../../tests/cpp/readArray.h"

using namespace OpenSubdiv;
using namespace formwork;

#if defined(DOUBLE)
typedef double Real;
#else
typedef float Real;
#endif

struct Mesh {
    int numVertices = 0, scheme = 0;
    std::vector<int> faceSizes, faceVertices, creaseVertices;
    std::vector<float> creaseSharpness;
};

static Mesh
ReadMesh(char const *path) {
    std::ifstream in(path);
    Mesh mesh;
    in >> mesh.numVertices >> mesh.scheme;
    mesh.faceSizes = ReadArray<int>(in);
    mesh.faceVertices = ReadArray<int>(in);
    mesh.creaseVertices = ReadArray<int>(in);
    mesh.creaseSharpness = ReadArray<float>(in);
    return mesh;
}

static std::unique_ptr<Far::TopologyRefiner>
Refine(Mesh const &mesh, int levels) {
    Far::TopologyDescriptor d;
    d.numVertices = mesh.numVertices;
    d.numFaces = static_cast<int>(mesh.faceSizes.size());
    d.numVertsPerFace = mesh.faceSizes.data();
    d.vertIndicesPerFace = mesh.faceVertices.data();
    d.numCreases = static_cast<int>(mesh.creaseSharpness.size());
    d.creaseVertexIndexPairs = mesh.creaseVertices.data();
    d.creaseWeights = mesh.creaseSharpness.data();
    Sdc::Options options;
    options.SetVtxBoundaryInterpolation(Sdc::Options::VTX_BOUNDARY_EDGE_AND_CORNER);
    typedef Far::TopologyRefinerFactory<Far::TopologyDescriptor> Factory;
    std::unique_ptr<Far::TopologyRefiner> refiner(
        Factory::Create(d, Factory::Options(static_cast<Sdc::SchemeType>(mesh.scheme), options)));
    Far::TopologyRefiner::UniformOptions uniform(levels);
    uniform.fullTopologyInLastLevel = true;
    refiner->RefineUniform(uniform);
    return refiner;
}

static std::unique_ptr<Far::StencilTableReal<Real> const>
PerLevelS0(Far::TopologyRefiner const &refiner) {
    typedef Far::StencilTableFactoryReal<Real> Factory;
    typename Factory::Options options;
    options.generateIntermediateLevels = true;
    options.factorizeIntermediateLevels = false;
    options.generateOffsets = true;
    options.maxLevel = refiner.GetMaxLevel();
    return std::unique_ptr<Far::StencilTableReal<Real> const>(Factory::Create(refiner, options));
}

typedef std::vector<std::unique_ptr<FormStencilTableReal<Real> const>> Tables;

static std::vector<Tables>
PerLevelForms(FormRefiner const &forms) {
    typedef FormStencilTableFactoryReal<Real> Factory;
    std::vector<Tables> tables;
    for (int degree : {1, 2}) {
        tables.push_back(Factory::CreatePerLevel(forms, typename Factory::Options(degree)));
    }
    return tables;
}

static long
PeakMemory() {
    std::ifstream status("/proc/self/status");
    for (std::string line; std::getline(status, line);) {
        if (line.compare(0, 6, "VmHWM:") == 0) {
            return std::stol(line.substr(6)) * 1024;
        }
    }
    return 0;
}

// Prints the milliseconds of the tasks, done in turn as for one mesh after the other: the first time, and the median later.
static void
Time(std::vector<std::function<void()>> const &tasks) {
    std::vector<std::vector<double>> times(tasks.size());
    for (int round = 0; round < 6; ++round) {
        for (size_t i = 0; i < tasks.size(); ++i) {
            auto start = std::chrono::steady_clock::now();
            tasks[i]();
            std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - start;
            times[i].push_back(took.count());
        }
    }
    for (std::vector<double> &each : times) {
        std::sort(each.begin() + 1, each.end());
        std::cout << each[0] << " " << each[each.size() / 2] << " ";
    }
    std::cout << "\n";
}

int
main(int argc, char **argv) {
    if (argc != 4) {
        std::cerr << "usage: tables MESH LEVELS time-...|memory-...\n";
        return 2;
    }
    Mesh mesh = ReadMesh(argv[1]);
    int levels = std::stoi(argv[2]);
    std::string what = argv[3];
    std::unique_ptr<Far::TopologyRefiner> refiner;
    std::unique_ptr<FormRefiner> forms;
    std::unique_ptr<Far::StencilTableReal<Real> const> s0;
    std::vector<Tables> tables;
    // What is replaced goes first, as between two meshes; that is a part of what is timed.
    std::function<void()> refine = [&] { refiner.reset(); refiner = Refine(mesh, levels); };
    std::function<void()> makeS0 = [&] { s0.reset(); s0 = PerLevelS0(*refiner); };
    std::function<void()> read = [&] { forms.reset(); forms.reset(new FormRefiner(*refiner)); };
    std::function<void()> makeForms = [&] { tables.clear(); tables = PerLevelForms(*forms); };
    if (what == "time-s0") {
        Time({refine, makeS0});
        return 0;
    }
    if (what == "time-forms") {
        Time({refine, read, makeForms});
        return 0;
    }
    if (what != "memory-none") {
        refine();
    }
    if (what == "memory-s0") {
        makeS0();
    }
    if (what == "memory-forms") {
        read();
        // All that forms need of the refiner is in theirs.
        refiner.reset();
        makeForms();
    }
    std::cout << PeakMemory() << "\n";
    return 0;
}
