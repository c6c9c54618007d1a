// From scene-linear radiance to display values: OpenColorIO's views. `$OCIO` when it is set and can be read, else the
// configuration that is part of the program. OpenColorIO is named only in the .cpp.
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "base/math.h"
#include "image/image.h"

namespace relamp::ui {

/// A observation table that a view's shader reads.
struct DisplayLut {
    std::string sampler;  ///< name in the shader
    int width = 0, height = 1, depth = 1;
    int dimensions = 2;  ///< 1, 2 or 3
    int channels = 3;
    bool nearest = false;
    std::vector<float> values;
};

/// GLSL 4.0 with `vec4 displayTransform(vec4)`.
struct DisplayShader {
    std::string source;
    std::vector<DisplayLut> luts;
};

class DisplayTransform {
public:
    /// `file` empty: the embedded configuration. Throws Error naming the file when it cannot be used.
    explicit DisplayTransform(const std::string& file);
    ~DisplayTransform();
    const std::vector<std::string>& views() const;
    const std::string& defaultView() const;
    /// "built in" or the file's path.
    const std::string& source() const;
    /// The given view, or the default one when there is no such view.
    DisplayShader shader(const std::string& view) const;
    /// The same on the CPU: exposure in stops first. Not clamped. Thread-safe.
    void apply(const std::string& view, float stops, Rgb* pixels, size_t count) const;
    Image apply(const std::string& view, float stops, Image image) const;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

/// The one in use. `$OCIO` is read at the first call; when it fails a line is logged and the built-in one serves.
const DisplayTransform& displayTransform();

/// False colour: luminance bands one stop wide about middle grey (0.18). Display values.
Rgb falseColour(float luminance);
inline constexpr int falseColourLow = -6, falseColourHigh = 6;  ///< stops of the legend's ends

}  // namespace relamp::ui
