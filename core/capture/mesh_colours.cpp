#include "capture/mesh_colours.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace relamp {
namespace {

constexpr size_t mostTexturePixels = size_t(1) << 26;

/// Nearest texel; images repeat.
Rgb texelAt(const Image& image, const Vec2& uv, bool& usable) {
    const auto wrapped = [](float x, int size) {
        const float within = (x - std::floor(x)) * float(size);
        return std::clamp(int(within), 0, size - 1);
    };
    const int x = wrapped(uv.x, image.width), y = wrapped(1 - uv.y, image.height);
    usable = image.usableAt(x, y);
    return image.at(x, y);
}

/// Adds what one image shows to the corners of its faces: ten places a face.
void addImage(const std::vector<TexturedFace>& faces, int number, const Image& image, std::vector<Rgb>& sum,
              std::vector<float>& weight) {
    constexpr int order = 3;
    for (const TexturedFace& face : faces) {
        if (face.image != number) continue;
        const bool inside =
            std::all_of(face.corners.begin(), face.corners.end(), [&](uint32_t v) { return v < sum.size(); });
        const bool finite = std::all_of(face.texcoords.begin(), face.texcoords.end(),
                                        [](const Vec2& t) { return std::abs(t.x) < 1e6f && std::abs(t.y) < 1e6f; });
        if (!inside || !finite) continue;
        for (int i = 0; i <= order; ++i)
            for (int j = 0; i + j <= order; ++j) {
                const std::array<float, 3> part{float(i) / order, float(j) / order, float(order - i - j) / order};
                Vec2 uv(0);
                for (size_t k = 0; k < 3; ++k) uv += part[k] * face.texcoords[k];
                bool usable = true;
                const Rgb texel = texelAt(image, uv, usable);
                for (size_t k = 0; usable && k < 3; ++k) {
                    sum[face.corners[k]] += part[k] * texel;
                    weight[face.corners[k]] += part[k];
                }
            }
    }
}

/// As they stand in the file, or in 255ths; encoded ones are decoded.
Rgb decoded(Vec3 colour, float full, bool linear) {
    colour = glm::clamp(colour / full, Vec3(0), Vec3(1));
    return linear ? Rgb(colour) : Rgb(srgbDecode(colour.x), srgbDecode(colour.y), srgbDecode(colour.z));
}

}  // namespace

MeshColours meshColours(const Capture& capture, Progress& progress) {
    MeshColours result;
    if (!capture.paint || capture.paint->empty()) return result;
    const MeshPaint& paint = *capture.paint;
    const size_t count = capture.mesh.vertexCount();
    std::vector<Rgb> sum(count, Rgb(0));
    std::vector<float> weight(count, 0);
    if (capture.texcoords && !paint.images.empty()) {
        progress.begin("Reading the mesh's texture", paint.images.size());
        std::vector<uint8_t> used(paint.images.size(), 0);
        for (const TexturedFace& face : *capture.texcoords)
            if (face.image >= 0 && size_t(face.image) < used.size()) used[size_t(face.image)] = 1;
        for (size_t i = 0; i < paint.images.size(); ++i) {
            const MeshImage& image = paint.images[i];
            if (!used[i]) continue;
            try {
                const Image read =
                    readImagePart(image.file, image.begin, image.size, mostTexturePixels, [&] { progress.check(); });
                addImage(*capture.texcoords, int(i), read, sum, weight);
                ++result.images;
            } catch (const OutOfResources&) { throw; } catch (const Error& error) {
                result.faults.push_back(error.what());
            }
            progress.advance();
        }
    }
    const bool fromImages = std::any_of(weight.begin(), weight.end(), [](float w) { return w > 0; });
    if (!fromImages && paint.colours.empty()) return result;
    result.linear.assign(count, Rgb(0));
    result.painted.assign(count, 0);
    float full = 1;
    for (const Vec3& c : paint.colours)
        if (maxChannel(c) > 1.5f) full = 255;
    for (size_t v = 0; v < count; ++v) {
        if (weight[v] > 0) result.linear[v] = sum[v] / weight[v];
        else if (v < paint.colours.size() && isFinite(paint.colours[v]))
            result.linear[v] = decoded(paint.colours[v], full, paint.linear);
        else continue;
        result.painted[v] = 1;
    }
    return result;
}

}  // namespace relamp
