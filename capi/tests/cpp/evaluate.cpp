// Evaluates forms on a mesh with OpenSubdiv's own evaluators, from tables that Formwork made of a refiner that this
// program owns, and prints the results for the test that runs it (capi/tests/programs.rs).
//
//   evaluate MESH..     every table of the mesh in each file; a line `end` after each
//   evaluate --errors   the message of every misuse
#include <cstdio>
#include <cstring>
#include <fstream>
#include <iostream>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include <formwork/formStencilTable.h>
#include <opensubdiv/far/error.h>
#include <opensubdiv/far/stencilTableFactory.h>
#include <opensubdiv/far/topologyDescriptor.h>
#include <opensubdiv/osd/cpuEvaluator.h>
#include <opensubdiv/osd/cpuVertexBuffer.h>
#include <opensubdiv/osd/ompEvaluator.h>

#include "readArray.h"

using namespace OpenSubdiv;
using namespace formwork;

typedef std::vector<double> Values;

struct Mesh {
    int numVertices = 0, levels = 0, scheme = 0, boundary = 0, creasing = 0, triangles = 0, leftHanded = 0;
    std::vector<int> faceSizes, faceVertices, creaseVertices, cornerVertices, holes;
    std::vector<float> creaseSharpness, cornerSharpness;
    std::map<std::pair<int, int>, Values> forms; // by degree and level
};

static Mesh
ReadMesh(char const *path) {
    std::ifstream in(path);
    Mesh mesh;
    in >> mesh.numVertices >> mesh.levels >> mesh.scheme >> mesh.boundary >> mesh.creasing >> mesh.triangles >>
        mesh.leftHanded;
    mesh.faceSizes = ReadArray<int>(in);
    mesh.faceVertices = ReadArray<int>(in);
    mesh.creaseVertices = ReadArray<int>(in);
    mesh.creaseSharpness = ReadArray<float>(in);
    mesh.cornerVertices = ReadArray<int>(in);
    mesh.cornerSharpness = ReadArray<float>(in);
    mesh.holes = ReadArray<int>(in);
    int degree, level;
    while (in >> degree >> level) {
        mesh.forms[{degree, level}] = ReadArray<double>(in);
    }
    return mesh;
}

static std::unique_ptr<Far::TopologyRefiner>
MakeRefiner(Mesh const &mesh) {
    Far::TopologyDescriptor d;
    d.numVertices = mesh.numVertices;
    d.numFaces = static_cast<int>(mesh.faceSizes.size());
    d.numVertsPerFace = mesh.faceSizes.data();
    d.vertIndicesPerFace = mesh.faceVertices.data();
    d.numCreases = static_cast<int>(mesh.creaseSharpness.size());
    d.creaseVertexIndexPairs = mesh.creaseVertices.data();
    d.creaseWeights = mesh.creaseSharpness.data();
    d.numCorners = static_cast<int>(mesh.cornerSharpness.size());
    d.cornerVertexIndices = mesh.cornerVertices.data();
    d.cornerWeights = mesh.cornerSharpness.data();
    d.numHoles = static_cast<int>(mesh.holes.size());
    d.holeIndices = mesh.holes.data();
    d.isLeftHanded = mesh.leftHanded != 0;
    Sdc::Options options;
    options.SetVtxBoundaryInterpolation(static_cast<Sdc::Options::VtxBoundaryInterpolation>(mesh.boundary));
    options.SetCreasingMethod(static_cast<Sdc::Options::CreasingMethod>(mesh.creasing));
    options.SetTriangleSubdivision(static_cast<Sdc::Options::TriangleSubdivision>(mesh.triangles));
    typedef Far::TopologyRefinerFactory<Far::TopologyDescriptor> Factory;
    Sdc::SchemeType scheme = static_cast<Sdc::SchemeType>(mesh.scheme);
    std::unique_ptr<Far::TopologyRefiner> refiner(Factory::Create(d, Factory::Options(scheme, options)));
    if (mesh.levels > 0) {
        Far::TopologyRefiner::UniformOptions uniform(mesh.levels);
        uniform.fullTopologyInLastLevel = mesh.levels % 2; // either will do
        refiner->RefineUniform(uniform);
    }
    return refiner;
}

// A line of results: their name, then their number and the numbers.
static void
Print(std::string const &name, Values const &values) {
    std::printf("%s %zu", name.c_str(), values.size());
    for (double value : values) {
        std::printf(" %.17g", value);
    }
    std::printf("\n");
}

struct Number {
    void Clear() { value = 0; }
    void AddWithWeight(Number const &other, double weight) { value += weight * other.value; }
    double value = 0;
};

static std::vector<Number>
Numbers(Values const &values) {
    std::vector<Number> numbers(values.size());
    for (size_t i = 0; i < values.size(); ++i) {
        numbers[i].value = values[i];
    }
    return numbers;
}

static Values
Plain(std::vector<Number> const &numbers) {
    Values values;
    for (Number const &number : numbers) {
        values.push_back(number.value);
    }
    return values;
}

// Element WIDTH - 1 of WIDTH interleaved ones, the others being other multiples of it.
template <class EVALUATOR, int WIDTH = 1>
static Values
Evaluate(Far::StencilTable const &table, Values const &values) {
    int count = table.GetNumStencils();
    std::vector<float> interleaved;
    for (double value : values) {
        for (int i = 0; i < WIDTH; ++i) {
            interleaved.push_back(static_cast<float>(value * (WIDTH - i)));
        }
    }
    std::unique_ptr<Osd::CpuVertexBuffer> src(Osd::CpuVertexBuffer::Create(WIDTH, static_cast<int>(values.size())));
    std::unique_ptr<Osd::CpuVertexBuffer> dst(Osd::CpuVertexBuffer::Create(WIDTH, count));
    src->UpdateData(interleaved.data(), 0, static_cast<int>(values.size()));
    Osd::BufferDescriptor all(0, WIDTH, WIDTH);
    EVALUATOR::EvalStencils(src.get(), all, dst.get(), all, &table);
    Values out;
    for (int i = 0; i < count; ++i) {
        out.push_back(dst->BindCpuBuffer()[WIDTH * i + WIDTH - 1]);
    }
    return out;
}

static Values
Evaluate(Far::StencilTableReal<double> const &table, Values const &values) {
    std::vector<Number> out(static_cast<size_t>(table.GetNumStencils()));
    table.UpdateValues(Numbers(values), out);
    return Plain(out);
}

static std::string
Name(char const *what, char const *by, int degree, int from, int to) {
    char name[80];
    std::snprintf(name, sizeof name, "%s %s %d %d %d", what, by, degree, from, to);
    return name;
}

static void
Refine(FormRefiner const &forms, Mesh const &mesh, int degree) {
    typedef FormStencilTableFactory Single;
    typedef FormStencilTableFactoryReal<double> Double;
    int max = forms.GetMaxLevel();
    for (int from = 0; from < max; ++from) {
        Values const &values = mesh.forms.at({degree, from});
        Single::Options options(degree);
        options.fromLevel = from;
        Double::Options precise(degree);
        precise.fromLevel = from;
        auto table = Single::Create(forms, options);
        Print(Name("refine", "float", degree, from, max), Evaluate<Osd::CpuEvaluator>(*table, values));
        Print(Name("refine", "omp", degree, from, max), Evaluate<Osd::OmpEvaluator>(*table, values));
        Print(Name("refine", "wide3", degree, from, max), Evaluate<Osd::CpuEvaluator, 3>(*table, values));
        Print(Name("refine", "wide4", degree, from, max), Evaluate<Osd::CpuEvaluator, 4>(*table, values));
        Print(Name("refine", "omp8", degree, from, max), Evaluate<Osd::OmpEvaluator, 8>(*table, values));
        Print(Name("refine", "double", degree, from, max), Evaluate(*Double::Create(forms, precise), values));

        Values step = values, stepPrecisely = values;
        for (auto const &each : Single::CreatePerLevel(forms, options)) {
            step = Evaluate<Osd::CpuEvaluator>(*each, step);
        }
        Print(Name("refine", "floatsteps", degree, from, max), step);
        for (auto const &each : Double::CreatePerLevel(forms, precise)) {
            stepPrecisely = Evaluate(*each, stepPrecisely);
        }
        Print(Name("refine", "doublesteps", degree, from, max), stepPrecisely);

        // All levels after `from` in one table, told apart by their sizes.
        options.generateIntermediateLevels = true;
        Values all = Evaluate<Osd::CpuEvaluator>(*Single::Create(forms, options), values);
        Values::const_iterator next = all.begin();
        for (int level = from + 1; level <= max; ++level) {
            Values::const_iterator end = next + forms.GetNumValues(degree, level);
            Print(Name("refine", "floatall", degree, from, level), Values(next, end));
            next = end;
        }
        if (next != all.end()) {
            std::printf("a table of all levels has rows of none\n");
        }
    }
}

static void
Limits(FormRefiner const &forms, Mesh const &mesh, int degree) {
    for (int level = 0; level <= forms.GetMaxLevel(); ++level) {
        FormLimitStencilTableFactory::Options options(degree);
        FormLimitStencilTableFactoryReal<double>::Options precise(degree);
        options.level = precise.level = level;
        Values const &values = mesh.forms.at({degree, 0});
        auto single = FormLimitStencilTableFactory::Create(forms, options);
        auto table = FormLimitStencilTableFactoryReal<double>::Create(forms, precise);
        Print(Name("limit", "float", degree, 0, level), Evaluate<Osd::CpuEvaluator>(*single, values));
        Print(Name("limit", "double", degree, 0, level), Evaluate(*table, values));
    }
}

template <class EVALUATOR>
static void
ValuesAndDerivatives(char const *by, std::string const &at, Far::LimitStencilTable const &table, Values const &values,
                     int level) {
    int count = table.GetNumStencils();
    std::vector<float> source(values.begin(), values.end());
    std::unique_ptr<Osd::CpuVertexBuffer> src(Osd::CpuVertexBuffer::Create(1, static_cast<int>(source.size())));
    src->UpdateData(source.data(), 0, static_cast<int>(source.size()));
    std::unique_ptr<Osd::CpuVertexBuffer> out[3];
    for (auto &buffer : out) {
        buffer.reset(Osd::CpuVertexBuffer::Create(1, count));
    }
    Osd::BufferDescriptor one(0, 1, 1);
    EVALUATOR::EvalStencils(src.get(), one, out[0].get(), one, out[1].get(), one, out[2].get(), one, &table);
    char const *names[3] = {"value", "du", "dv"};
    for (int i = 0; i < 3; ++i) {
        float const *data = out[i]->BindCpuBuffer();
        Print(Name((names[i] + at).c_str(), by, 0, 0, level), Values(data, data + count));
    }
}

static void
Points(FormRefiner const &forms, Mesh const &mesh) {
    typedef FormLimitStencilTableFactory Single;
    typedef FormLimitStencilTableFactoryReal<double> Double;
    for (int level = 0; level <= forms.GetMaxLevel(); ++level) {
        for (int corners = 0; corners < 2; ++corners) {
            std::string at = corners ? "@corners" : "@vertices";
            Single::Options options(0);
            options.level = level;
            options.location = corners ? Single::CORNERS : Single::VERTICES;
            Double::Options precise(0);
            precise.level = level;
            precise.location = corners ? Double::CORNERS : Double::VERTICES;

            Values const &values = mesh.forms.at({0, 0});
            auto table = Single::CreateValues(forms, options);
            ValuesAndDerivatives<Osd::CpuEvaluator>("float", at, *table, values, level);
            ValuesAndDerivatives<Osd::OmpEvaluator>("omp", at, *table, values, level);
            auto preciseTable = Double::CreateValues(forms, precise);
            Print(Name(("value" + at).c_str(), "double", 0, 0, level), Evaluate(*preciseTable, values));
            std::vector<Number> du(static_cast<size_t>(preciseTable->GetNumStencils())), dv(du);
            preciseTable->UpdateDerivs(Numbers(values), du, dv);
            Print(Name(("du" + at).c_str(), "double", 0, 0, level), Plain(du));
            Print(Name(("dv" + at).c_str(), "double", 0, 0, level), Plain(dv));

            options.degree = precise.degree = 1;
            Values const &form = mesh.forms.at({1, 0});
            auto vectors = Single::CreateVectors(forms, options);
            Print(Name(("vector" + at).c_str(), "float", 1, 0, level), Evaluate<Osd::CpuEvaluator>(*vectors, form));
            auto preciseVectors = Double::CreateVectors(forms, precise);
            Print(Name(("vector" + at).c_str(), "double", 1, 0, level), Evaluate(*preciseVectors, form));
        }
    }
}

static void
Signs(FormRefiner const &forms) {
    for (int level = 0; level <= forms.GetMaxLevel(); ++level) {
        std::vector<signed char> signs = forms.GetFaceEdgeSigns(level);
        Print(Name("signs", "double", 2, level, level), Values(signs.begin(), signs.end()));
    }
}

// Errors.

static int hostsErrors = 0;

template <class CALL>
static void
Catch(char const *what, CALL const &call) {
    try {
        call();
        std::printf("%s: no error\n", what);
    } catch (Error const &error) {
        std::printf("%s: %s%s\n", what, error.what(), error.GetStatus() == FORMWORK_STATUS_INTERNAL ? " (internal)" : "");
    }
}

static Mesh
Strip(int scheme) { // two quads, or two triangles
    Mesh mesh;
    mesh.scheme = scheme;
    mesh.boundary = 1;
    mesh.faceSizes = scheme == Sdc::SCHEME_LOOP ? std::vector<int>{3, 3} : std::vector<int>{4, 4};
    mesh.faceVertices =
        scheme == Sdc::SCHEME_LOOP ? std::vector<int>{0, 1, 2, 2, 1, 3} : std::vector<int>{0, 1, 2, 3, 1, 4, 5, 2};
    mesh.numVertices = scheme == Sdc::SCHEME_LOOP ? 4 : 6;
    return mesh;
}

static void
Errors() {
    Far::SetErrorCallback([](Far::ErrorType, char const *) { ++hostsErrors; });
    Mesh strip = Strip(Sdc::SCHEME_CATMARK);

    auto adaptive = MakeRefiner(strip);
    adaptive->RefineAdaptive(Far::TopologyRefiner::AdaptiveOptions(2));
    Catch("adaptive", [&] { FormRefiner forms(*adaptive); });

    auto facesFirst = MakeRefiner(strip);
    Far::TopologyRefiner::UniformOptions order(1);
    order.fullTopologyInLastLevel = order.orderVerticesFromFacesFirst = true;
    facesFirst->RefineUniform(order);
    Catch("faces first", [&] { FormRefiner forms(*facesFirst); });

    Mesh bow = strip;
    bow.faceVertices = {0, 1, 2, 1, 1, 4, 5, 2};
    Catch("repeated vertex", [&] { FormRefiner forms(*MakeRefiner(bow)); });
    Mesh digon = strip;
    digon.faceSizes = {4, 2};
    digon.faceVertices = {0, 1, 2, 3, 1, 2};
    Catch("digon", [&] { FormRefiner forms(*MakeRefiner(digon)); });

    FormRefiner flat(*MakeRefiner(strip));
    Catch("unrefined", [&] { FormStencilTableFactory::Create(flat); });
    strip.levels = 2;
    FormRefiner forms(*MakeRefiner(strip)); // the refiner is gone
    FormStencilTableFactory::Options options;
    options.degree = 3;
    Catch("degree 3", [&] { FormStencilTableFactory::Create(forms, options); });
    options.degree = -1;
    Catch("degree -1", [&] { FormStencilTableFactory::Create(forms, options); });
    options = FormStencilTableFactory::Options();
    options.toLevel = 3;
    Catch("level 3", [&] { FormStencilTableFactory::Create(forms, options); });
    Catch("level 3, steps", [&] { FormStencilTableFactory::CreatePerLevel(forms, options); });
    options.fromLevel = options.toLevel = 1;
    Catch("level 1 to 1", [&] { FormStencilTableFactory::Create(forms, options); });
    Catch("level 1 to 1, steps", [&] { FormStencilTableFactory::CreatePerLevel(forms, options); });
    FormLimitStencilTableFactory::Options limit(2);
    Catch("vectors of faces", [&] { FormLimitStencilTableFactory::CreateVectors(forms, limit); });
    Catch("values of faces", [&] { FormLimitStencilTableFactory::CreateValues(forms, limit); });
    limit.level = 0;
    limit.fromLevel = 1;
    Catch("limit of a coarser level", [&] { FormLimitStencilTableFactory::Create(forms, limit); });
    limit.level = 9;
    Catch("limit of level 9", [&] { FormLimitStencilTableFactory::Create(forms, limit); });
    Catch("values of degree 3", [&] { forms.GetNumValues(3, 0); });
    Catch("values of level 3", [&] { forms.GetNumValues(0, 3); });
    Catch("values of level -1", [&] { forms.GetNumValues(0, -1); });
    SchemeOptions scheme;
    scheme.dooSabin = static_cast<SchemeOptions::DooSabin>(2);
    Catch("unknown Doo-Sabin", [&] { FormRefiner(*MakeRefiner(strip), scheme); });

    FormworkHierarchy *handle = nullptr;
    auto refiner = MakeRefiner(strip);
    Catch("other OpenSubdiv", [&] {
        internal::Check(formwork_hierarchy_from_refiner(refiner.get(), 30600, nullptr, &handle));
    });
    Catch("null refiner", [&] {
        internal::Check(formwork_hierarchy_from_refiner(nullptr, OPENSUBDIV_VERSION_NUMBER, nullptr, &handle));
    });
    Catch("null result", [&] {
        internal::Check(formwork_hierarchy_from_refiner(refiner.get(), OPENSUBDIV_VERSION_NUMBER, nullptr, nullptr));
    });
    Catch("null hierarchy", [&] { internal::Check(formwork_hierarchy_counts(nullptr, 0, nullptr)); });
    FormworkCage cage = {};
    Catch("empty cage", [&] {
        internal::Check(formwork_hierarchy_from_cage(&cage, FORMWORK_SCHEME_CATMARK, nullptr, 1, &handle));
    });
    cage.num_vertices = cage.num_faces = 3;
    Catch("null array", [&] {
        internal::Check(formwork_hierarchy_from_cage(&cage, FORMWORK_SCHEME_CATMARK, nullptr, 1, &handle));
    });
    std::printf("handle %s\n", handle ? "set" : "not set");

    // A limit next to a polygon makes refiners of its own; the program's callbacks stay.
    Mesh triangle = strip;
    triangle.faceSizes = {3, 3};
    triangle.faceVertices = {0, 1, 2, 1, 4, 2};
    FormRefiner polygons(*MakeRefiner(triangle));
    FormLimitStencilTableFactory::Options coarse(0);
    coarse.level = 0;
    FormLimitStencilTableFactory::Create(polygons, coarse);
    refiner->RefineUniform(Far::TopologyRefiner::UniformOptions(2)); // a second time: OpenSubdiv objects
    std::printf("callbacks: %d\n", hostsErrors);
}

int main(int argc, char **argv) {
    if (argc == 2 && !std::strcmp(argv[1], "--errors")) {
        Errors();
        return 0;
    }
    for (int i = 1; i < argc; ++i) {
        Mesh mesh = ReadMesh(argv[i]);
        FormRefiner forms(*MakeRefiner(mesh));
        for (int degree = 0; degree < 3; ++degree) {
            Refine(forms, mesh, degree);
            Limits(forms, mesh, degree);
        }
        Points(forms, mesh);
        Signs(forms);
        std::printf("end\n");
    }
    return 0;
}
