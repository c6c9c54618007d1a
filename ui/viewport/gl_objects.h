// OpenGL objects that free themselves, with the driver's own words in errors. Needs a current context, also when they
// go away.
#pragma once
#include <epoxy/gl.h>

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace relamp::ui {

/// An object name with its deleter.
template <void (*Make)(GLuint&), void (*Drop)(GLuint&)>
class GlHandle {
public:
    GlHandle() = default;
    ~GlHandle() { reset(); }
    GlHandle(GlHandle&& other) noexcept : id_(std::exchange(other.id_, 0)) {}
    GlHandle& operator=(GlHandle&& other) noexcept {
        if (this != &other) reset(), id_ = std::exchange(other.id_, 0);
        return *this;
    }
    /// Makes the object at the first call.
    GLuint id() {
        if (!id_) Make(id_);
        return id_;
    }
    bool made() const { return id_ != 0; }
    void reset() {
        if (id_) Drop(id_);
        id_ = 0;
    }

private:
    GLuint id_ = 0;
};

namespace gl {
inline void makeBuffer(GLuint& id) { glGenBuffers(1, &id); }
inline void dropBuffer(GLuint& id) { glDeleteBuffers(1, &id); }
inline void makeTexture(GLuint& id) { glGenTextures(1, &id); }
inline void dropTexture(GLuint& id) { glDeleteTextures(1, &id); }
inline void makeVertexArray(GLuint& id) { glGenVertexArrays(1, &id); }
inline void dropVertexArray(GLuint& id) { glDeleteVertexArrays(1, &id); }
inline void makeFramebuffer(GLuint& id) { glGenFramebuffers(1, &id); }
inline void dropFramebuffer(GLuint& id) { glDeleteFramebuffers(1, &id); }
}  // namespace gl

using GlTexture = GlHandle<gl::makeTexture, gl::dropTexture>;
using GlVertexArray = GlHandle<gl::makeVertexArray, gl::dropVertexArray>;
using GlFramebuffer = GlHandle<gl::makeFramebuffer, gl::dropFramebuffer>;

/// A buffer of vertices or indices; uploads reuse its storage when the size stays.
class GlBuffer {
public:
    GLuint id() { return handle_.id(); }
    void upload(GLenum target, const void* bytes, size_t count, GLenum usage);
    template <class T>
    void upload(GLenum target, const std::vector<T>& values, GLenum usage = GL_DYNAMIC_DRAW) {
        upload(target, values.data(), values.size() * sizeof(T), usage);
    }

private:
    GlHandle<gl::makeBuffer, gl::dropBuffer> handle_;
    size_t bytes_ = 0;
};

/// A vertex and a fragment shader, linked. Sources are files of shaders/; `extra` is put where the fragment shader says
/// //EXTRA.
class GlProgram {
public:
    GlProgram() = default;
    /// Throws Error with the driver's log.
    GlProgram(const char* vertexFile, const char* fragmentFile, const std::string& extra = {});
    ~GlProgram();
    GlProgram(GlProgram&& other) noexcept : id_(std::exchange(other.id_, 0)) {}
    GlProgram& operator=(GlProgram&& other) noexcept {
        std::swap(id_, other.id_);
        return *this;
    }
    void use() const { glUseProgram(id_); }
    GLint uniform(const char* name) const { return glGetUniformLocation(id_, name); }

private:
    GLuint id_ = 0;
};

/// A colour texture with a depth buffer that may belong to another target of the same size.
struct GlTarget {
    GlTexture colour;
    GlFramebuffer framebuffer;
    int width = 0, height = 0;
    /// Makes it this large; nothing happens when it is. Throws Error when the driver refuses.
    void resize(int newWidth, int newHeight, GLenum format, GLuint depthTexture, GLenum filter);
};

/// Uploads an image: display values as bytes, or floats kept as half floats. Row 0 is the top row.
void uploadRgba8(GlTexture& texture, int width, int height, const uint8_t* rgba);
void uploadHalf(GlTexture& texture, int width, int height, const float* rgba, bool repeatX);
/// The same of halves, four a pixel.
void uploadHalf(GlTexture& texture, int width, int height, const uint64_t* rgba);
/// Of halves, three a pixel; repeats from left to right.
void uploadHalf(GlTexture& texture, int width, int height, const uint16_t* rgb);

/// The driver of this name draws on the processor.
bool isSoftware(const std::string& renderer);
/// So does that of the present context.
bool softwareRenderer();

/// Throws Error with the version found unless the context is OpenGL 4.3 or later.
void requireOpenGl43();

}  // namespace relamp::ui
