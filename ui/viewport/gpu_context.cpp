#include "viewport/gpu_context.h"

#include <epoxy/egl.h>
#include <epoxy/gl.h>

#include <algorithm>
#include <cstring>

#include "base/error.h"
#include "viewport/gl_objects.h"
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

}  // namespace

GpuContext::GpuContext(void* display) : display_(display), context_(EGL_NO_CONTEXT) {
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
        context_ = eglCreateContext(display, configs ? config : EGLConfig(nullptr), EGL_NO_CONTEXT, attributes.data());
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

GpuContext::~GpuContext() { drop(); }

void GpuContext::makeCurrent() {
    eglBindAPI(EGL_OPENGL_API);
    if (eglGetCurrentContext() == context_) return;
    if (!eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_))
        throw Error("the graphics driver refused its context (EGL error {:#x})", eglGetError());
}

void GpuContext::release() {
    eglBindAPI(EGL_OPENGL_API);
    if (eglGetCurrentContext() == context_) eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
}

bool GpuContext::software() const { return isSoftware(renderer_); }

void GpuContext::drop() {
    if (context_ == EGL_NO_CONTEXT) return;
    release();
    eglDestroyContext(display_, context_);
    context_ = EGL_NO_CONTEXT;
}

unsigned GpuContext::build(const std::vector<const char*>& files) {
    std::vector<const char*> sources;
    std::string names;
    for (const char* file : files) {
        sources.push_back(shaderSource(file));
        if (!sources.back()) throw Error("the shader {} is missing from this program", file);
        names += (names.empty() ? "" : ", ") + std::string(file);
    }
    const GLuint shader = glCreateShader(GL_COMPUTE_SHADER);
    glShaderSource(shader, GLsizei(sources.size()), sources.data(), nullptr);
    glCompileShader(shader);
    const GLuint program = glCreateProgram();
    glAttachShader(program, shader);
    glLinkProgram(program);
    GLint good = 0;
    glGetProgramiv(program, GL_LINK_STATUS, &good);
    if (good) {
        glDeleteShader(shader);
        return program;
    }
    std::string log(4096, '\0');
    GLsizei length = 0;
    glGetShaderInfoLog(shader, GLsizei(log.size()), &length, log.data());
    if (!length) glGetProgramInfoLog(program, GLsizei(log.size()), &length, log.data());
    log.resize(size_t(length));
    glDeleteShader(shader);
    glDeleteProgram(program);
    throw Error("the graphics driver refused the shader {}: {}", names, log);
}

void GpuContext::check() {
    if (const bool tells = epoxy_gl_version() >= 45 || epoxy_has_gl_extension("GL_KHR_robustness");
        tells && glGetGraphicsResetStatus() != GL_NO_ERROR)
        throw Error("the graphics driver was reset");
    const GLenum error = glGetError();
    if (error == GL_NO_ERROR) return;
    for (int i = 0; i < 16 && glGetError() != GL_NO_ERROR; ++i) {}
    if (error == GL_OUT_OF_MEMORY) throw Error("no memory is left on the graphics card");
    throw Error("the graphics driver reports error {:#x}", error);
}

void GpuContext::expectRoom(size_t bytes) {
    GLint64 limit = 0;
    glGetInteger64v(GL_MAX_SHADER_STORAGE_BLOCK_SIZE, &limit);
    if (bytes > size_t(limit))
        throw Error("the scene needs {} MiB in one part, the driver takes {} MiB", bytes >> 20, limit >> 20);
}

void GpuBuffer::put(const void* data, size_t bytes, unsigned usage) {
    if (!name_) glGenBuffers(1, &name_);
    glBindBuffer(GL_SHADER_STORAGE_BUFFER, name_);
    glBufferData(GL_SHADER_STORAGE_BUFFER, GLsizeiptr(std::max<size_t>(16, (bytes + 3) / 4 * 4)), nullptr, usage);
    if (data && bytes) glBufferSubData(GL_SHADER_STORAGE_BUFFER, 0, GLsizeiptr(bytes), data);
}

void GpuBuffer::change(size_t offset, const void* data, size_t bytes) {
    glBindBuffer(GL_SHADER_STORAGE_BUFFER, name_);
    glBufferSubData(GL_SHADER_STORAGE_BUFFER, GLintptr(offset), GLsizeiptr(bytes), data);
}

void GpuBuffer::read(void* out, size_t bytes) {
    glBindBuffer(GL_SHADER_STORAGE_BUFFER, name_);
    glGetBufferSubData(GL_SHADER_STORAGE_BUFFER, 0, GLsizeiptr(bytes), out);
}

void GpuBuffer::bind(unsigned place) { glBindBufferBase(GL_SHADER_STORAGE_BUFFER, place, name_); }

std::shared_ptr<GpuContext> openGpuContext(bool force, std::string* why) {
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
                auto context = std::make_shared<GpuContext>(candidate.display);
                if (!context->software() || force) return context;
                note(context->renderer() + " runs on the processor");
            } catch (const Error& error) { note(error.what()); }
        }
        if (reasons.empty()) note("EGL offers no display");
    }
    if (why) *why = reasons;
    return nullptr;
}

}  // namespace relamp::ui
