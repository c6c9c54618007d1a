#include "viewport/photograph.h"

#include "base/parallel.h"
#include "display/display_image.h"

namespace relamp::ui {

std::vector<Vec4> straightened(const View& view, int longest, int& width, int& height) {
    const Image& image = view.image;
    if (image.pixels.empty() || image.width <= 0 || image.height <= 0) return {};
    Camera straight = smallerCamera(view.camera, longest);
    straight.model = LensModel::pinhole;
    straight.distortion = {};
    width = straight.width, height = straight.height;
    const LensModel model = view.camera.model;
    const bool flatLens = model == LensModel::simpleRadial || model == LensModel::radial ||
                          model == LensModel::openCv || model == LensModel::fullOpenCv || model == LensModel::brown;
    const bool plain = model == LensModel::pinhole || model == LensModel::simplePinhole ||
                       (flatLens && view.camera.distortion == std::array<double, 8>{});
    // The file's image may be another size than the camera says.
    const Vec2 toImage(float(image.width) / float(view.camera.width), float(image.height) / float(view.camera.height));
    const Vec2 toCamera(float(view.camera.width) / float(width), float(view.camera.height) / float(height));
    // A shrunk image averages a few points a pixel; nobody measures on it.
    const int points = std::clamp(int(std::ceil(toImage.x * toCamera.x)), 1, 4);
    std::vector<Vec4> out(size_t(width) * size_t(height), Vec4(0));
    parallelFor(size_t(height), 8, [&](size_t y) {
        for (int x = 0; x < width; ++x) {
            Vec4 sum(0);
            for (int j = 0; j < points * points; ++j) {
                const Vec2 inside = (Vec2(j % points, j / points) + 0.5f) / float(points);
                Vec2 pixel = (Vec2(float(x), float(y)) + inside) * toCamera;
                if (!plain) {
                    const DVec3 far =
                        straight.position() + 1e3 * DVec3(straight.rayDirection(Vec2(float(x), float(y)) + inside));
                    const auto found = view.camera.project(far);
                    if (!found) continue;
                    pixel = *found;
                }
                const Vec2 at = pixel * toImage - 0.5f;
                if (at.x < -0.5f || at.y < -0.5f || at.x > float(image.width) - 0.5f ||
                    at.y > float(image.height) - 0.5f)
                    continue;
                const int x0 = int(std::floor(at.x)), y0 = int(std::floor(at.y));
                const float fx = at.x - float(x0), fy = at.y - float(y0);
                for (int k = 0; k < 4; ++k) {
                    const int u = std::clamp(x0 + (k & 1), 0, image.width - 1),
                              v = std::clamp(y0 + (k >> 1), 0, image.height - 1);
                    const float weight = (k & 1 ? fx : 1 - fx) * (k >> 1 ? fy : 1 - fy);
                    if (weight > 0 && image.usableAt(u, v))
                        sum += weight * Vec4(glm::clamp(image.at(u, v), Rgb(0), Rgb(60000)), 1);
                }
            }
            out[y * size_t(width) + size_t(x)] = sum / float(points * points);
        }
    });
    return out;
}

void coverSurfaces(const View& view, const ViewGeometry& geometry, const DistantLight& distant, int width, int height,
                   std::vector<Vec4>& pixels) {
    if (geometry.triangle.size() != size_t(geometry.width) * size_t(geometry.height) || geometry.triangle.empty())
        return;
    Camera straight = view.camera;
    straight.model = LensModel::pinhole;
    straight.distortion = {};
    const Vec2 toCamera(float(view.camera.width) / float(width), float(view.camera.height) / float(height));
    const Vec2 toGeometry(float(geometry.width) / float(view.camera.width),
                          float(geometry.height) / float(view.camera.height));
    constexpr int margin = 2;  // photographs mix surface and background along an outline
    parallelFor(size_t(height), 8, [&](size_t y) {
        for (int x = 0; x < width; ++x) {
            const Vec3 direction = straight.rayDirection((Vec2(float(x), float(y)) + 0.5f) * toCamera);
            const auto seen = view.camera.project(straight.position() + 1e3 * DVec3(direction));
            if (!seen) continue;
            const int u = int(seen->x * toGeometry.x), v = int(seen->y * toGeometry.y);
            bool covered = false;
            for (int j = std::max(0, v - margin); j <= std::min(geometry.height - 1, v + margin) && !covered; ++j)
                for (int i = std::max(0, u - margin); i <= std::min(geometry.width - 1, u + margin) && !covered; ++i)
                    covered = geometry.triangle[size_t(j) * size_t(geometry.width) + size_t(i)] != ~0u;
            if (covered)
                pixels[y * size_t(width) + size_t(x)] =
                    Vec4(glm::clamp(distant.background(direction), Rgb(0), Rgb(60000)), 1);
        }
    });
}

GLuint PhotographTextures::find(const std::shared_ptr<const Capture>& capture, int index,
                                const std::shared_ptr<const DistantLight>& distant) {
    ++clock_;
    std::erase_if(entries_, [&](const Entry& e) {
        return e.capture != capture || (distant && e.distant && e.distant != distant);
    });
    for (Entry& e : entries_)
        if (e.index == index && e.distant == distant) {
            e.used = clock_;
            return e.texture.id();
        }
    return 0;
}

GLuint PhotographTextures::keep(const std::shared_ptr<const Capture>& capture, int index,
                                const std::shared_ptr<const DistantLight>& distant, int width, int height,
                                const std::vector<Vec4>& pixels) {
    constexpr size_t kept = 6;
    if (entries_.size() >= kept)
        entries_.erase(std::min_element(entries_.begin(), entries_.end(),
                                        [](const Entry& a, const Entry& b) { return a.used < b.used; }));
    Entry entry{capture, index, distant, clock_, {}};
    uploadHalf(entry.texture, width, height, &pixels[0].x, false);
    entries_.push_back(std::move(entry));
    return entries_.back().texture.id();
}

GLuint PhotographTextures::texture(const std::shared_ptr<const Capture>& capture, int index) {
    if (!capture || index < 0 || index >= int(capture->views.size())) return 0;
    if (const GLuint known = find(capture, index, nullptr)) return known;
    int width = 0, height = 0;
    const std::vector<Vec4> pixels = straightened(capture->views[size_t(index)], 2048, width, height);
    return pixels.empty() ? 0 : keep(capture, index, nullptr, width, height, pixels);
}

GLuint PhotographTextures::backdrop(const std::shared_ptr<const Capture>& capture, int index,
                                    const RadianceSamples& samples,
                                    const std::shared_ptr<const DistantLight>& distant) {
    if (!capture || !distant || index < 0 || index >= int(capture->views.size()) ||
        size_t(index) >= samples.geometry.size())
        return 0;
    if (const GLuint known = find(capture, index, distant)) return known;
    int width = 0, height = 0;
    std::vector<Vec4> pixels = straightened(capture->views[size_t(index)], 2048, width, height);
    if (pixels.empty()) return 0;
    coverSurfaces(capture->views[size_t(index)], samples.geometry[size_t(index)], *distant, width, height, pixels);
    return keep(capture, index, distant, width, height, pixels);
}

}  // namespace relamp::ui
