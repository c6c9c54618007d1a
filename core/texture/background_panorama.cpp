#include "texture/background_panorama.h"

#include "base/parallel.h"
#include "base/statistics.h"
#include "image/environment_map.h"
#include "image/pull_push.h"

namespace relamp {
namespace {

constexpr int leastWidth = 1024;    // that of environment.exr
constexpr double leastSeen = 1e-3;  // of all directions
constexpr float feather = 6;        // pixels over which a photograph's edge goes over into the cells
constexpr float cellDegrees = 12;   // over which cells that no photograph shows are evened out
constexpr int block = 16;           // texels a side that share a list of views

/// What a view shows past the mesh.
class OpenView {
public:
    OpenView(const View& view, const ViewGeometry& geometry)
        : view_(&view),
          origin_(view.camera.position()),
          middle_(view.camera.rayDirection(Vec2(view.camera.width, view.camera.height) * 0.5f)),
          mayFold_(view.camera.isDistorted()),
          away_(geometry.triangle.size(), 0),
          width_(geometry.width) {
        const int w = geometry.width, h = geometry.height;
        const auto at = [&](int x, int y) -> float& { return away_[size_t(y) * size_t(w) + size_t(x)]; };
        // Distances to what is not open, by two passes over the neighbours.
        constexpr float diagonal = 1.414f;
        for (int y = 1; y + 1 < h; ++y)
            for (int x = 1; x + 1 < w; ++x) {
                if (!view.image.usableAt(x, y) || !geometry.open(x, y)) continue;
                at(x, y) = 1 + std::min({at(x - 1, y), at(x, y - 1), at(x - 1, y - 1) + diagonal - 1,
                                         at(x + 1, y - 1) + diagonal - 1});
            }
        for (int y = h - 2; y > 0; --y)
            for (int x = w - 2; x > 0; --x) {
                if (!(at(x, y) > 0)) continue;
                at(x, y) = std::min({at(x, y), 1 + at(x + 1, y), 1 + at(x, y + 1), diagonal + at(x + 1, y + 1),
                                     diagonal + at(x - 1, y + 1)});
            }
    }

    /// Where a direction lies in the photograph, in pixels; nothing outside of it.
    std::optional<Vec2> place(const Vec3& direction) const {
        const Camera& camera = view_->camera;
        if (glm::dot(middle_, direction) < 0) return {};
        const auto pixel = camera.project(origin_ + farAway * DVec3(direction));
        // A lens formula beyond the image's corners may come back into it.
        if (!pixel || (mayFold_ && glm::dot(camera.rayDirection(*pixel), direction) < 0.9999f)) return {};
        return pixel;
    }

    struct Look {
        Rgb radiance{0};
        float away = 0;  ///< pixels to the nearest edge
        bool clipped = false;
    };
    /// Bilinear; `away` is 0 where a pixel is not open.
    Look look(const Vec2& pixel) const {
        const Vec2 p = pixel - 0.5f;
        const int x = int(std::floor(p.x)), y = int(std::floor(p.y)), height = int(away_.size()) / width_;
        Look look;
        if (x < 0 || y < 0 || x + 1 >= width_ || y + 1 >= height) return look;
        const float fx = p.x - float(x), fy = p.y - float(y);
        float away = 1e30f;
        for (int k = 0; k < 4; ++k) {
            const int u = x + (k & 1), v = y + (k >> 1);
            const Rgb& there = view_->image.at(u, v);
            away = std::min(away, away_[size_t(v) * size_t(width_) + size_t(u)]);
            look.radiance += (k & 1 ? fx : 1 - fx) * (k >> 1 ? fy : 1 - fy) * there;
            look.clipped |= view_->saturation > 0 && maxChannel(there) >= view_->saturation;
        }
        look.away = away;
        return look;
    }

private:
    static constexpr double farAway = 1e6;
    const View* view_;
    DVec3 origin_;
    Vec3 middle_;   ///< of the photograph: the direction it looks in
    bool mayFold_;  ///< the lens formula may
    std::vector<float> away_;
    int width_;
};

/// As fine as the photographs are in their middle.
int widthFor(const Capture& capture, int most) {
    std::vector<float> wanted;
    for (const View& view : capture.views)
        wanted.push_back(2 * pi * float(std::max(view.camera.focalX, view.camera.focalY)));
    const float middle = medianOf(std::move(wanted));
    int width = leastWidth;
    for (bool power = true; width < most && float(width) < middle; power = !power)
        width = power ? width / 2 * 3 : width / 3 * 4;  // 1024, 1536, 2048, ...: halved often without a rest
    return std::min(width, most);
}

/// A direction's colour, and how far it is known.
struct SeenTexel {
    Rgb radiance{0};
    float weight = 0;
};

class Mosaic {
public:
    Mosaic(std::vector<OpenView> views, const std::vector<Rgb>& cells, const DirectionGrid& grid, int width)
        : views_(std::move(views)), cells_(cells), grid_(grid), width_(width) {
        const float side = float(width) * cellDegrees / 360;
        cellWeight_ = 1 / (side * side);
    }

    Vec3 direction(float x, float y) const { return directionFromLatLong({x / float(width_), 2 * y / float(width_)}); }
    /// The views that may see a texel of a block.
    std::vector<const OpenView*> viewsOf(int left, int top) const {
        constexpr int points = 5;  // a side
        std::vector<const OpenView*> some;
        for (const OpenView& view : views_)
            for (int k = 0; k < points * points; ++k)
                if (view.place(direction(float(left) + float(block * (k % points)) / (points - 1),
                                         float(top) + float(block * (k / points)) / (points - 1)))) {
                    some.push_back(&view);
                    break;
                }
        return some;
    }
    SeenTexel texel(const std::vector<const OpenView*>& views, const Vec3& towards) const {
        Rgb sum(0);
        float total = 0, farthest = 0;
        std::optional<Rgb> cell;
        const auto ofCells = [&] { return cell ? *cell : *(cell = interpolated(cells_, grid_, towards)); };
        for (const OpenView* view : views) {
            const auto pixel = view->place(towards);
            if (!pixel) continue;
            const OpenView::Look look = view->look(*pixel);
            if (!(look.away > 0)) continue;
            const float weight = look.away * look.away * look.away * look.away;
            sum += weight * (look.clipped ? glm::max(look.radiance, ofCells()) : look.radiance);
            total += weight;
            farthest = std::max(farthest, look.away);
        }
        const float known = std::min(1.0f, farthest / feather);
        if (known == 1) return {sum / total, 1};
        const float rest = (1 - known) * cellWeight_;
        return {((total > 0 ? known * sum / total : Rgb(0)) + rest * ofCells()) / (known + rest), known + rest};
    }

private:
    std::vector<OpenView> views_;
    const std::vector<Rgb>& cells_;
    DirectionGrid grid_;
    int width_;
    float cellWeight_;  ///< cells alone are trusted as far as they agree over some degrees
};

/// Whether enough of an environment is seen past the mesh.
bool isSeen(const RadianceSamples& samples, int environment) {
    const size_t cells = size_t(samples.backgroundGrid.cells()), first = size_t(environment) * cells;
    if (samples.backgroundPixels.size() < first + cells) return false;
    const auto begin = samples.backgroundPixels.begin() + std::ptrdiff_t(first);
    const auto open = std::count_if(begin, begin + std::ptrdiff_t(cells), [](uint32_t pixels) { return pixels > 0; });
    return double(open) >= leastSeen * double(cells);
}

}  // namespace

std::shared_ptr<const Panorama> backgroundPanorama(const Capture& capture, const RadianceSamples& samples,
                                                   int environment, const std::vector<Rgb>& cells,
                                                   const DirectionGrid& grid, Progress& progress, int mostWidth) {
    if (samples.geometry.size() != capture.views.size() || !isSeen(samples, environment)) return nullptr;
    std::vector<OpenView> views;
    for (size_t i = 0; i < capture.views.size(); ++i)
        if (samples.environmentOf(samples.stateOf(uint32_t(i))) == environment)
            views.emplace_back(capture.views[i], samples.geometry[i]);
    const int width = widthFor(capture, mostWidth), height = width / 2;
    const Mosaic mosaic(std::move(views), cells, grid, width);
    Image image(width, height);
    std::vector<float> weight(image.pixels.size());
    progress.begin("The background as photographs show it", size_t(height / block));
    parallelFor(
        size_t(height / block), 1,
        [&](size_t band) {
            const int top = int(band) * block;
            for (int left = 0; left < width; left += block) {
                const std::vector<const OpenView*> some = mosaic.viewsOf(left, top);
                for (int y = top; y < top + block; ++y)
                    for (int x = left; x < left + block; ++x) {
                        const SeenTexel seen = mosaic.texel(some, mosaic.direction(float(x) + 0.5f, float(y) + 0.5f));
                        image.at(x, y) = seen.radiance;
                        weight[size_t(y) * size_t(width) + size_t(x)] = seen.weight;
                    }
            }
            progress.advance();
        },
        &progress);
    pullPush(image, std::move(weight));
    return std::make_shared<const Panorama>(std::move(image), mostWidth);
}

}  // namespace relamp
