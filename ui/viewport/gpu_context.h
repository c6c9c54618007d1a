// An OpenGL context of its own on a graphics card, through EGL: it needs no window and no display.
#pragma once
#include <cstddef>
#include <memory>
#include <string>
#include <vector>

namespace relamp::ui {

/// Current on a thread only while that thread computes on it. Buffers and programs go with it.
class GpuContext {
public:
    /// Throws Error when the display (an EGLDisplay) has no OpenGL 4.3 without a window. It is current on no thread.
    explicit GpuContext(void* display);
    ~GpuContext();
    GpuContext(const GpuContext&) = delete;
    GpuContext& operator=(const GpuContext&) = delete;

    /// Throws Error when the driver refuses.
    void makeCurrent();
    void release();
    const std::string& renderer() const { return renderer_; }
    bool software() const;
    /// A compute program of the named files of shaders/, one behind the other. Throws Error with the driver's words.
    unsigned build(const std::vector<const char*>& files);
    /// Throws Error with what went wrong since the last check, a reset of the driver included.
    void check();
    /// Throws Error where the driver does not take a buffer of `bytes`.
    void expectRoom(size_t bytes);

private:
    void* display_;
    void* context_;
    std::string renderer_;

    void drop();
};

/// A shader storage buffer of a current context.
class GpuBuffer {
public:
    /// Holds `bytes` bytes of `data`, or of nothing where it is null. New storage each time: the old one may still be
    /// in use. Whole words, at least four.
    void put(const void* data, size_t bytes, unsigned usage);
    /// Overwrites a part.
    void change(size_t offset, const void* data, size_t bytes);
    void read(void* out, size_t bytes);
    void bind(unsigned place);

private:
    unsigned name_ = 0;
};

/// The first graphics card that offers OpenGL 4.3 through EGL; null where there is none. Software renderers are no
/// faster than the processor and are passed over unless `force`. The thread that makes the first call of it keeps it:
/// not the window's, whose context it would push aside. `why`: for a null answer, in words.
std::shared_ptr<GpuContext> openGpuContext(bool force, std::string* why);

}  // namespace relamp::ui
