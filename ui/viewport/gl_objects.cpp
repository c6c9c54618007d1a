#include "viewport/gl_objects.h"

#include "base/error.h"
#include "viewport/shader_sources.h"

namespace relamp::ui {
namespace {

GLuint compile(GLenum kind, const char* file, const std::string& extra) {
    const char* found = shaderSource(file);
    if (!found) throw Error("the shader {} is missing from this program", file);
    std::string text = found;
    if (const size_t place = text.find("//EXTRA"); place != std::string::npos) text.replace(place, 7, extra);
    const GLuint shader = glCreateShader(kind);
    const char* source = text.c_str();
    glShaderSource(shader, 1, &source, nullptr);
    glCompileShader(shader);
    GLint good = 0;
    glGetShaderiv(shader, GL_COMPILE_STATUS, &good);
    if (good) return shader;
    std::string log(4096, '\0');
    GLsizei length = 0;
    glGetShaderInfoLog(shader, GLsizei(log.size()), &length, log.data());
    log.resize(size_t(length));
    glDeleteShader(shader);
    throw Error("the graphics driver refused the shader {}: {}", file, log);
}

void setSampling(GLenum filter, GLenum wrapX) {
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GLint(filter));
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GLint(filter));
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GLint(wrapX));
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
}

}  // namespace

void GlBuffer::upload(GLenum target, const void* bytes, size_t count, GLenum usage) {
    glBindBuffer(target, id());
    if (count == bytes_ && count > 0) {
        glBufferSubData(target, 0, GLsizeiptr(count), bytes);
        return;
    }
    glBufferData(target, GLsizeiptr(count), bytes, usage);
    bytes_ = count;
}

GlProgram::GlProgram(const char* vertexFile, const char* fragmentFile, const std::string& extra) {
    const GLuint vertex = compile(GL_VERTEX_SHADER, vertexFile, {});
    GLuint fragment = 0;
    try {
        fragment = compile(GL_FRAGMENT_SHADER, fragmentFile, extra);
    } catch (...) {
        glDeleteShader(vertex);
        throw;
    }
    id_ = glCreateProgram();
    glAttachShader(id_, vertex);
    glAttachShader(id_, fragment);
    glLinkProgram(id_);
    glDeleteShader(vertex);
    glDeleteShader(fragment);
    GLint good = 0;
    glGetProgramiv(id_, GL_LINK_STATUS, &good);
    if (good) return;
    std::string log(4096, '\0');
    GLsizei length = 0;
    glGetProgramInfoLog(id_, GLsizei(log.size()), &length, log.data());
    log.resize(size_t(length));
    glDeleteProgram(std::exchange(id_, 0));
    throw Error("the graphics driver refused {} with {}: {}", vertexFile, fragmentFile, log);
}

GlProgram::~GlProgram() {
    if (id_) glDeleteProgram(id_);
}

void GlTarget::resize(int newWidth, int newHeight, GLenum format, GLuint depthTexture, GLenum filter) {
    if (newWidth == width && newHeight == height) return;
    width = newWidth, height = newHeight;
    glBindTexture(GL_TEXTURE_2D, colour.id());
    const bool half = format == GL_RGBA16F;
    glTexImage2D(GL_TEXTURE_2D, 0, GLint(format), width, height, 0, GL_RGBA, half ? GL_HALF_FLOAT : GL_UNSIGNED_BYTE,
                 nullptr);
    setSampling(filter, GL_CLAMP_TO_EDGE);
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer.id());
    glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, colour.id(), 0);
    if (depthTexture) glFramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, depthTexture, 0);
    const GLenum status = glCheckFramebufferStatus(GL_FRAMEBUFFER);
    if (status != GL_FRAMEBUFFER_COMPLETE)
        throw Error("the graphics driver cannot draw into an image of {} x {} pixels (status {:#x})", width, height,
                    status);
}

void uploadRgba8(GlTexture& texture, int width, int height, const uint8_t* rgba) {
    glBindTexture(GL_TEXTURE_2D, texture.id());
    glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
    glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, width, height, 0, GL_RGBA, GL_UNSIGNED_BYTE, rgba);
    setSampling(GL_LINEAR, GL_CLAMP_TO_EDGE);
}

void uploadHalf(GlTexture& texture, int width, int height, const float* rgba, bool repeatX) {
    glBindTexture(GL_TEXTURE_2D, texture.id());
    glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
    glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA16F, width, height, 0, GL_RGBA, GL_FLOAT, rgba);
    setSampling(GL_LINEAR, repeatX ? GL_REPEAT : GL_CLAMP_TO_EDGE);
}

void uploadHalf(GlTexture& texture, int width, int height, const uint64_t* rgba) {
    glBindTexture(GL_TEXTURE_2D, texture.id());
    glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
    glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA16F, width, height, 0, GL_RGBA, GL_HALF_FLOAT, rgba);
    setSampling(GL_LINEAR, GL_CLAMP_TO_EDGE);
}

void uploadHalf(GlTexture& texture, int width, int height, const uint16_t* rgb) {
    glBindTexture(GL_TEXTURE_2D, texture.id());
    glPixelStorei(GL_UNPACK_ALIGNMENT, 2);
    glTexImage2D(GL_TEXTURE_2D, 0, GL_RGB16F, width, height, 0, GL_RGB, GL_HALF_FLOAT, rgb);
    setSampling(GL_LINEAR, GL_REPEAT);
}

bool isSoftware(const std::string& renderer) {
    for (const char* name : {"llvmpipe", "softpipe", "swrast", "SWR", "Software"})
        if (renderer.find(name) != std::string::npos) return true;
    return false;
}

bool softwareRenderer() {
    const char* text = reinterpret_cast<const char*>(glGetString(GL_RENDERER));
    return text && isSoftware(text);
}

void requireOpenGl43() {
    const char* version = reinterpret_cast<const char*>(glGetString(GL_VERSION));
    const char* renderer = reinterpret_cast<const char*>(glGetString(GL_RENDERER));
    if (!version) throw Error("there is no OpenGL context; relamp needs OpenGL 4.3");
    if (epoxy_gl_version() < 43)
        throw Error(
            "OpenGL 4.3 is needed, this driver has {} ({}). A newer graphics driver helps, or Mesa's software "
            "renderer: LIBGL_ALWAYS_SOFTWARE=1",
            version, renderer ? renderer : "unknown");
}

}  // namespace relamp::ui
