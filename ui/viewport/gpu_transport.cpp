#include "viewport/gpu_transport.h"

#include <epoxy/egl.h>
#include <epoxy/gl.h>

#include <algorithm>
#include <cstring>
#include <utility>
#include <vector>

#include "base/error.h"
#include "viewport/shader_sources.h"

namespace relamp::ui {
namespace {

/// Displays are never terminated: there is one for each device in a process, and the window may have the same.
struct Candidate {
    EGLDisplay display = EGL_NO_DISPLAY;
    bool software = false;  ///< known before the driver is started
};

bool listed(const char* extensions, const char* name) {
    const size_t length = std::strlen(name);
    for (const char* at = extensions; at && (at = std::strstr(at, name)); at += length)
        if ((at == extensions || at[-1] == ' ') && (at[length] == ' ' || at[length] == '\0')) return true;
    return false;
}

/// Where a context may be made, graphics cards first. The surfaceless platform is Mesa's alone: where devices can be
/// listed it adds software at most.
std::vector<Candidate> candidates() {
    std::vector<Candidate> found;
    const char* client = eglQueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS);
    eglGetError();
    if (listed(client, "EGL_EXT_platform_base")) {
        const bool enumerates =
            listed(client, "EGL_EXT_device_base") ||
            (listed(client, "EGL_EXT_device_enumeration") && listed(client, "EGL_EXT_device_query"));
        if (enumerates && listed(client, "EGL_EXT_platform_device")) {
            EGLint count = 0;
            EGLDeviceEXT devices[16];
            if (eglQueryDevicesEXT(16, devices, &count))
                for (EGLint d = 0; d < count; ++d) {
                    const bool software =
                        listed(eglQueryDeviceStringEXT(devices[d], EGL_EXTENSIONS), "EGL_MESA_device_software");
                    found.push_back({eglGetPlatformDisplayEXT(EGL_PLATFORM_DEVICE_EXT, devices[d], nullptr), software});
                }
        }
        if (listed(client, "EGL_MESA_platform_surfaceless"))
            found.push_back({eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr),
                             !found.empty()});
    }
    if (found.empty()) found.push_back({eglGetDisplay(EGL_DEFAULT_DISPLAY), false});
    std::erase_if(found, [](const Candidate& c) { return c.display == EGL_NO_DISPLAY; });
    return found;
}

class Context {
public:
    /// Throws Error when the display has no OpenGL 4.3 without a window. It is current on no thread.
    explicit Context(EGLDisplay display) : display_(display) {
        EGLint major = 0, minor = 0;
        if (!eglInitialize(display, &major, &minor))
            throw Error("the driver does not start (EGL error {:#x})", eglGetError());
        if (!epoxy_has_egl_extension(display, "EGL_KHR_surfaceless_context"))
            throw Error("the driver offers no context without a window");
        if (!eglBindAPI(EGL_OPENGL_API)) throw Error("the driver offers no OpenGL");
        const EGLint wanted[] = {EGL_SURFACE_TYPE, 0, EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_NONE};
        EGLConfig config = nullptr;
        EGLint configs = 0;
        if (!eglChooseConfig(display, wanted, &config, 1, &configs)) configs = 0;
        if (!configs && !epoxy_has_egl_extension(display, "EGL_KHR_no_config_context"))
            throw Error("the driver offers no OpenGL");
        const bool tells = major > 1 || minor >= 5;
        for (const bool reset : {true, false}) {
            if (reset && !tells) continue;
            std::vector<EGLint> attributes{EGL_CONTEXT_MAJOR_VERSION,       4,
                                           EGL_CONTEXT_MINOR_VERSION,       3,
                                           EGL_CONTEXT_OPENGL_PROFILE_MASK, EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT};
            if (reset)
                attributes.insert(attributes.end(),
                                  {EGL_CONTEXT_OPENGL_RESET_NOTIFICATION_STRATEGY, EGL_LOSE_CONTEXT_ON_RESET});
            attributes.push_back(EGL_NONE);
            context_ =
                eglCreateContext(display, configs ? config : EGLConfig(nullptr), EGL_NO_CONTEXT, attributes.data());
            if (context_ != EGL_NO_CONTEXT) break;
        }
        if (context_ == EGL_NO_CONTEXT) throw Error("the driver offers no OpenGL 4.3 (EGL error {:#x})", eglGetError());
        try {
            makeCurrent();
            const auto* words = reinterpret_cast<const char*>(glGetString(GL_RENDERER));
            renderer_ = words ? words : "unknown";
            const int version = epoxy_gl_version();
            release();
            if (version < 43) throw Error("the driver offers OpenGL {}.{}, expected 4.3", version / 10, version % 10);
        } catch (...) {
            drop();
            throw;
        }
    }
    ~Context() { drop(); }
    Context(const Context&) = delete;
    Context& operator=(const Context&) = delete;

    void makeCurrent() {
        eglBindAPI(EGL_OPENGL_API);
        if (eglGetCurrentContext() == context_) return;
        if (!eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_))
            throw Error("the graphics driver refused its context (EGL error {:#x})", eglGetError());
    }
    void release() {
        eglBindAPI(EGL_OPENGL_API);
        if (eglGetCurrentContext() == context_)
            eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    }
    const std::string& renderer() const { return renderer_; }
    bool software() const {
        for (const char* name : {"llvmpipe", "softpipe", "swrast", "SWR", "Software"})
            if (renderer_.find(name) != std::string::npos) return true;
        return false;
    }

private:
    EGLDisplay display_;
    EGLContext context_ = EGL_NO_CONTEXT;
    std::string renderer_;

    /// Buffers and program go with the context.
    void drop() {
        if (context_ == EGL_NO_CONTEXT) return;
        release();
        eglDestroyContext(display_, context_);
        context_ = EGL_NO_CONTEXT;
    }
};

class GpuTransport : public TransportDevice {
public:
    explicit GpuTransport(std::unique_ptr<Context> context) : context_(std::move(context)) {}
    std::string name() const override { return context_->renderer(); }

    void apply(const std::array<std::vector<float>, 3>& coefs, std::span<Rgb> out) override {
        if (out.size() != blocks_ * transportLanes)
            throw Error("{} places for the light of {} points", out.size(), blocks_ * transportLanes);
        if (!blocks_) return;
        context_->makeCurrent();
        interleaved_.resize(coefs[0].size() * 4);
        for (size_t i = 0; i < coefs[0].size(); ++i)
            for (size_t k = 0; k < 3; ++k) interleaved_[4 * i + k] = coefs[k][i];
        glUseProgram(program_);
        put(coefsPlace, interleaved_.data(), interleaved_.size() * sizeof(float), GL_STREAM_DRAW);
        for (GLuint place = 0; place < places; ++place)
            glBindBufferBase(GL_SHADER_STORAGE_BUFFER, place, buffers_[place]);
        glUniform1ui(blocksUniform_, GLuint(blocks_));
        glDispatchCompute(GLuint((blocks_ * transportLanes + groupSize - 1) / groupSize), 1, 1);
        glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
        static_assert(sizeof(Rgb) == 3 * sizeof(float));
        glBindBuffer(GL_SHADER_STORAGE_BUFFER, buffers_[lightPlace]);
        glGetBufferSubData(GL_SHADER_STORAGE_BUFFER, 0, GLsizeiptr(out.size_bytes()), out.data());
        check();
    }

protected:
    void take(const TransportStore& store) override {
        context_->makeCurrent();
        blocks_ = 0;
        if (!program_) build();
        GLint64 limit = 0;
        glGetInteger64v(GL_MAX_SHADER_STORAGE_BLOCK_SIZE, &limit);
        GLint groups = 0;
        glGetIntegeri_v(GL_MAX_COMPUTE_WORK_GROUP_COUNT, 0, &groups);
        const size_t vertices = store.blocks() * transportLanes;
        const size_t largest = std::max(store.value().size_bytes(), vertices * sizeof(Rgb));
        if (largest > size_t(limit) || vertices / groupSize >= size_t(groups))
            throw Error("the scene needs {} MiB in one part, the driver takes {} MiB", largest >> 20, limit >> 20);
        put(indexPlace, store.index().data(), store.index().size_bytes(), GL_STATIC_DRAW);
        put(valuePlace, store.value().data(), store.value().size_bytes(), GL_STATIC_DRAW);
        put(startPlace, store.start().data(), store.start().size_bytes(), GL_STATIC_DRAW);
        put(scalePlace, store.scale().data(), store.scale().size_bytes(), GL_STATIC_DRAW);
        put(lightPlace, nullptr, vertices * sizeof(Rgb), GL_DYNAMIC_READ);
        check();
        blocks_ = store.blocks();
    }

private:
    enum Place : GLuint {
        indexPlace,
        valuePlace,
        startPlace,
        scalePlace,
        coefsPlace,
        lightPlace,
        places
    };  // as bound in transport.comp
    static constexpr size_t groupSize = 64;
    std::unique_ptr<Context> context_;
    GLuint program_ = 0;
    GLint blocksUniform_ = -1;
    GLuint buffers_[places]{};
    size_t blocks_ = 0;
    std::vector<float> interleaved_;

    /// New storage each time: the old one may still be in use. Whole words, at least one.
    void put(Place place, const void* bytes, size_t count, GLenum usage) {
        glBindBuffer(GL_SHADER_STORAGE_BUFFER, buffers_[place]);
        glBufferData(GL_SHADER_STORAGE_BUFFER, GLsizeiptr(std::max<size_t>(16, (count + 3) / 4 * 4)), nullptr, usage);
        if (bytes && count) glBufferSubData(GL_SHADER_STORAGE_BUFFER, 0, GLsizeiptr(count), bytes);
    }

    void build() {
        const char* source = shaderSource("transport.comp");
        if (!source) throw Error("the shader transport.comp is missing from this program");
        const GLuint shader = glCreateShader(GL_COMPUTE_SHADER);
        glShaderSource(shader, 1, &source, nullptr);
        glCompileShader(shader);
        const GLuint program = glCreateProgram();
        glAttachShader(program, shader);
        glLinkProgram(program);
        GLint good = 0;
        glGetProgramiv(program, GL_LINK_STATUS, &good);
        if (!good) {
            std::string log(4096, '\0');
            GLsizei length = 0;
            glGetShaderInfoLog(shader, GLsizei(log.size()), &length, log.data());
            if (!length) glGetProgramInfoLog(program, GLsizei(log.size()), &length, log.data());
            log.resize(size_t(length));
            glDeleteShader(shader);
            glDeleteProgram(program);
            throw Error("the graphics driver refused the shader transport.comp: {}", log);
        }
        glDeleteShader(shader);
        program_ = program;
        blocksUniform_ = glGetUniformLocation(program, "blocks");
        glGenBuffers(places, buffers_);
    }

    /// Throws Error with what went wrong since the last check, a reset of the driver included.
    void check() {
        if (const bool tells = epoxy_gl_version() >= 45 || epoxy_has_gl_extension("GL_KHR_robustness");
            tells && glGetGraphicsResetStatus() != GL_NO_ERROR)
            throw Error("the graphics driver was reset");
        const GLenum error = glGetError();
        if (error == GL_NO_ERROR) return;
        for (int i = 0; i < 16 && glGetError() != GL_NO_ERROR; ++i) {}
        if (error == GL_OUT_OF_MEMORY) throw Error("no memory is left on the graphics card");
        throw Error("the graphics driver reports error {:#x}", error);
    }
};

}  // namespace

std::shared_ptr<TransportDevice> makeGpuTransport(bool force, std::string* why) {
    std::string reasons;
    const auto note = [&](const std::string& reason) { reasons += (reasons.empty() ? "" : "; ") + reason; };
    if (!epoxy_has_egl()) {
        note("EGL is not installed");
    } else {
        for (const Candidate& candidate : candidates()) {
            if (candidate.software && !force) {
                note("a software renderer");
                continue;
            }
            try {
                auto context = std::make_unique<Context>(candidate.display);
                if (!context->software() || force) return std::make_shared<GpuTransport>(std::move(context));
                note(context->renderer() + " runs on the processor");
            } catch (const Error& error) { note(error.what()); }
        }
        if (reasons.empty()) note("EGL offers no display");
    }
    if (why) *why = reasons;
    return nullptr;
}

}  // namespace relamp::ui
