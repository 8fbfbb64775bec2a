// The stencil table of a form of degree 1 in OpenSubdiv's GL evaluators, as it is, on whatever EGL finds without a
// display: a software driver will do. Compares with Osd::CpuEvaluator.
//
//   gl          exit code 0: the same; 1: not the same; 77: there is no GL here that can be asked
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <vector>

#include <EGL/egl.h>
#include <EGL/eglext.h>
#define GL_GLEXT_PROTOTYPES
#include <GL/gl.h>
#include <GL/glext.h>

#include <formwork/formStencilTable.h>
#include <opensubdiv/far/topologyDescriptor.h>
#include <opensubdiv/osd/cpuEvaluator.h>
#include <opensubdiv/osd/cpuVertexBuffer.h>
#include <opensubdiv/osd/glComputeEvaluator.h>
#include <opensubdiv/osd/glVertexBuffer.h>
#include <opensubdiv/osd/glXFBEvaluator.h>

using namespace OpenSubdiv;

static int const SKIPPED = 77;

// A context without a window, or the reason why there is none.
static char const *
MakeContext() {
    auto getPlatformDisplay =
        reinterpret_cast<PFNEGLGETPLATFORMDISPLAYEXTPROC>(eglGetProcAddress("eglGetPlatformDisplayEXT"));
    if (!getPlatformDisplay) {
        return "EGL has no platform displays";
    }
    EGLDisplay display = getPlatformDisplay(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
    if (display == EGL_NO_DISPLAY || !eglInitialize(display, nullptr, nullptr)) {
        return "EGL has no surfaceless display";
    }
    if (!eglBindAPI(EGL_OPENGL_API)) {
        return "EGL has no desktop GL";
    }
    EGLint const any[] = {EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_NONE};
    EGLint const version[] = {EGL_CONTEXT_MAJOR_VERSION, 4, EGL_CONTEXT_MINOR_VERSION, 3,
                              EGL_CONTEXT_OPENGL_PROFILE_MASK, EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT, EGL_NONE};
    EGLConfig config = nullptr;
    EGLint count = 0;
    eglChooseConfig(display, any, &config, 1, &count);
    EGLContext context = eglCreateContext(display, count ? config : nullptr, EGL_NO_CONTEXT, version);
    if (context == EGL_NO_CONTEXT || !eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context)) {
        return "there is no driver for GL 4.3";
    }
    return nullptr;
}

// A grid of n x n quads on a torus, with a crease once round it.
static std::unique_ptr<Far::TopologyRefiner>
MakeRefiner(int n, int levels) {
    std::vector<int> sizes(static_cast<size_t>(n * n), 4), vertices, creases;
    auto at = [n](int i, int j) { return (i % n) * n + j % n; };
    for (int i = 0; i < n; ++i) {
        for (int j = 0; j < n; ++j) {
            vertices.insert(vertices.end(), {at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)});
        }
        creases.insert(creases.end(), {at(i, 0), at(i + 1, 0)});
    }
    std::vector<float> sharpness(static_cast<size_t>(n), 1.5f);
    Far::TopologyDescriptor torus;
    torus.numVertices = torus.numFaces = n * n;
    torus.numVertsPerFace = sizes.data();
    torus.vertIndicesPerFace = vertices.data();
    torus.numCreases = n;
    torus.creaseVertexIndexPairs = creases.data();
    torus.creaseWeights = sharpness.data();
    typedef Far::TopologyRefinerFactory<Far::TopologyDescriptor> Factory;
    std::unique_ptr<Far::TopologyRefiner> refiner(Factory::Create(torus, Factory::Options(Sdc::SCHEME_CATMARK)));
    Far::TopologyRefiner::UniformOptions uniform(levels);
    uniform.fullTopologyInLastLevel = true;
    refiner->RefineUniform(uniform);
    return refiner;
}

static std::vector<float>
ReadBack(Osd::GLVertexBuffer &buffer) {
    std::vector<float> values(static_cast<size_t>(buffer.GetNumElements() * buffer.GetNumVertices()));
    glMemoryBarrier(GL_ALL_BARRIER_BITS);
    glBindBuffer(GL_ARRAY_BUFFER, buffer.BindVBO());
    glGetBufferSubData(GL_ARRAY_BUFFER, 0, static_cast<GLsizeiptr>(values.size() * sizeof(float)), values.data());
    return values;
}

template <class EVALUATOR, class TABLE>
static float
Difference(char const *name, Far::StencilTable const &table, std::vector<float> const &values, int width,
           std::vector<float> const &expected) {
    int inputs = table.GetNumControlVertices(), outputs = table.GetNumStencils();
    Osd::BufferDescriptor all(0, width, width);
    std::unique_ptr<Osd::GLVertexBuffer> src(Osd::GLVertexBuffer::Create(width, inputs));
    std::unique_ptr<Osd::GLVertexBuffer> dst(Osd::GLVertexBuffer::Create(width, outputs));
    src->UpdateData(values.data(), 0, inputs);
    std::unique_ptr<TABLE> onDevice(TABLE::Create(&table));
    std::unique_ptr<EVALUATOR> evaluator(
        EVALUATOR::Create(all, all, Osd::BufferDescriptor(), Osd::BufferDescriptor()));
    float worst = INFINITY;
    if (evaluator && EVALUATOR::EvalStencils(src.get(), all, dst.get(), all, onDevice.get(), evaluator.get())) {
        std::vector<float> found = ReadBack(*dst);
        worst = 0;
        for (size_t i = 0; i < found.size(); ++i) {
            float difference = std::abs(found[i] - expected[i]);
            worst = difference <= worst ? worst : difference; // NaN is kept
        }
    }
    std::printf("%s, width %d: %d edges from %d, differ from CpuEvaluator by %.3g at most\n", name, width, outputs,
                inputs, worst);
    return worst;
}

int main() {
    if (char const *reason = MakeContext()) {
        std::printf("skipped: %s\n", reason);
        return SKIPPED;
    }
    std::printf("%s, %s\n", reinterpret_cast<char const *>(glGetString(GL_VERSION)),
                reinterpret_cast<char const *>(glGetString(GL_RENDERER)));
    // Transform feedback draws, and wants something to draw to.
    GLuint frame = 0, target = 0;
    glGenFramebuffers(1, &frame);
    glGenRenderbuffers(1, &target);
    glBindRenderbuffer(GL_RENDERBUFFER, target);
    glRenderbufferStorage(GL_RENDERBUFFER, GL_RGBA8, 4, 4);
    glBindFramebuffer(GL_FRAMEBUFFER, frame);
    glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, target);

    auto refiner = MakeRefiner(16, 3);
    auto table = formwork::FormStencilTableFactory::Create(*refiner);
    float worst = 0;
    for (int width : {1, 3}) {
        std::vector<float> values;
        for (int i = 0; i < width * table->GetNumControlVertices(); ++i) {
            values.push_back(std::sin(0.7f * static_cast<float>(i)));
        }
        std::unique_ptr<Osd::CpuVertexBuffer> src(Osd::CpuVertexBuffer::Create(width, table->GetNumControlVertices()));
        std::unique_ptr<Osd::CpuVertexBuffer> dst(Osd::CpuVertexBuffer::Create(width, table->GetNumStencils()));
        src->UpdateData(values.data(), 0, table->GetNumControlVertices());
        Osd::BufferDescriptor all(0, width, width);
        Osd::CpuEvaluator::EvalStencils(src.get(), all, dst.get(), all, table.get());
        float const *data = dst->BindCpuBuffer();
        std::vector<float> expected(data, data + width * table->GetNumStencils());
        worst = std::max({worst,
                          Difference<Osd::GLComputeEvaluator, Osd::GLStencilTableSSBO>(
                              "GLComputeEvaluator", *table, values, width, expected),
                          Difference<Osd::GLXFBEvaluator, Osd::GLStencilTableTBO>("GLXFBEvaluator", *table, values,
                                                                                  width, expected)});
    }
    return worst <= 1e-6f ? 0 : 1;
}
