#include "scan/range_image.h"

#include <optional>

#include "base/parallel.h"
#include "base/statistics.h"
#include "scan/affine_fit.h"

namespace relamp {
namespace {

/// Nearest points of two rays: distance along the first, of the rays' smallest distance, sine^2 of their angle.
struct Nearest {
    double along = 0, gap = 0, sine2 = 0;
};

std::optional<Nearest> nearestOf(const DVec3& origin, const DVec3& direction, const DVec3& other, const DVec3& toward) {
    const DVec3 between = other - origin;
    const double cosine = glm::dot(direction, toward), sine2 = 1 - cosine * cosine;
    if (!(sine2 > 1e-4)) return std::nullopt;
    const double a = glm::dot(between, direction), b = glm::dot(between, toward);
    const double along = (a - b * cosine) / sine2, off = (a * cosine - b) / sine2;
    if (!(along > 0 && off > 0)) return std::nullopt;
    return Nearest{along, glm::length(origin + along * direction - other - off * toward), sine2};
}

/// What one source says of every pixel of a view; distance 0 where it says nothing.
struct SourceRange {
    std::vector<float> along, gap, sine2;
};

template <class RayOf>
SourceRange rangeFrom(const RangeSource& self, const std::vector<DVec3>& directions, const DVec3& origin, RayOf&& rayOf,
                      Progress& progress) {
    const size_t count = directions.size();
    SourceRange out{std::vector<float>(count), std::vector<float>(count), std::vector<float>(count)};
    const DVec3 own = self.camera->position();
    progress.begin("Triangulating", count);
    parallelFor(
        count, 4096,
        [&](size_t i) {
            if (!self.view->at(i)) return;
            const std::optional<DVec3> toward = rayOf(self.view->places[i]);
            if (!toward) return;
            const auto nearest = nearestOf(own, directions[i], origin, *toward);
            if (!nearest) return;
            out.along[i] = float(nearest->along);
            out.gap[i] = float(nearest->gap);
            out.sine2[i] = float(nearest->sine2);
        },
        &progress);
    return out;
}

PairFigures figuresOf(const SourceRange& range, double mostGap, const Camera& camera) {
    PairFigures figures;
    std::vector<float> gaps, along;
    for (size_t i = 0; i < range.along.size(); ++i)
        if (range.along[i] > 0) {
            gaps.push_back(range.gap[i]);
            along.push_back(range.along[i]);
        }
    figures.matches = gaps.size();
    figures.medianGap = double(medianOf(gaps));
    const double pixel = double(medianOf(std::move(along))) / std::max(1e-9, std::min(camera.focalX, camera.focalY));
    figures.mostGap = mostGap > 0 ? mostGap : std::max(4 * figures.medianGap, 2 * pixel);
    for (float gap : gaps) figures.used += double(gap) <= figures.mostGap;
    return figures;
}

}  // namespace

size_t RangeImage::count() const {
    size_t known = 0;
    for (float d : distance) known += d > 0;
    return known;
}

RangeImage measureRange(const std::vector<RangeSource>& views, size_t self, const Camera* projector,
                        const RangeOptions& options, std::vector<PairFigures>& figures, Progress& progress) {
    const RangeSource& own = views[self];
    RangeImage out;
    out.width = own.view->width;
    out.height = own.view->height;
    const size_t count = size_t(out.width) * size_t(out.height);
    out.directions.resize(count);
    parallelFor(count, 4096, [&](size_t i) {
        const auto width = size_t(out.width);
        out.directions[i] = DVec3(own.camera->rayDirection(Vec2(float(i % width) + 0.5f, float(i / width) + 0.5f)));
    });
    std::vector<double> weight(count), sum(count);
    out.gap.assign(count, 0);
    figures.assign(views.size() + 1, {});
    const auto take = [&](const SourceRange& range, const Camera& other, PairFigures& pair) {
        pair = figuresOf(range, options.mostGap, other);
        const double floor = 1e-9 + pair.medianGap;
        for (size_t i = 0; i < count; ++i) {
            if (!(range.along[i] > 0) || double(range.gap[i]) > pair.mostGap) continue;
            const double w = double(range.sine2[i]) / (floor * floor);
            weight[i] += w;
            sum[i] += w * double(range.along[i]);
            out.gap[i] = std::max(out.gap[i], range.gap[i]);
        }
    };
    for (size_t v = 0; v < views.size(); ++v) {
        if (v == self) continue;
        const auto rayOf = [&](const Vec2& place) -> std::optional<DVec3> {
            const auto pixel = views[v].index->pixelOf(place);
            if (!pixel) return std::nullopt;
            return DVec3(views[v].camera->rayDirection(Vec2(*pixel)));
        };
        take(rangeFrom(own, out.directions, views[v].camera->position(), rayOf, progress), *views[v].camera,
             figures[v]);
    }
    if (projector) {
        const auto rayOf = [&](const Vec2& place) -> std::optional<DVec3> {
            return DVec3(projector->rayDirection(place));
        };
        take(rangeFrom(own, out.directions, projector->position(), rayOf, progress), *projector, figures.back());
    }
    out.distance.resize(count);
    for (size_t i = 0; i < count; ++i) out.distance[i] = weight[i] > 0 ? float(sum[i] / weight[i]) : 0;
    return out;
}

namespace {

/// Distances around a pixel that are similar to one of them.
struct Around {
    std::optional<double> plane;  ///< value at the pixel of the plane through them; none with few
    bool enclosed = false;        ///< they lie on all sides
};

Around planeAt(const RangeImage& range, const Camera& camera, int x, int y, int radius, double own, double slope,
               double noise) {
    const auto width = size_t(range.width);
    AffineFit<double> sums;
    for (int j = std::max(0, y - radius); j <= std::min(range.height - 1, y + radius); ++j)
        for (int i = std::max(0, x - radius); i <= std::min(range.width - 1, x + radius); ++i) {
            const auto d = double(range.distance[size_t(j) * width + size_t(i)]);
            const double dx = i - x, dy = j - y, apart = std::max(std::abs(dx), std::abs(dy));
            if (!(d > 0) || std::abs(d - own) > mostStep(camera, own, slope, apart, noise)) continue;
            sums.add(dx, dy, d - own);
        }
    const double count = sums.w;
    if (count < 0.4 * (2 * radius + 1) * (2 * radius + 1)) return {};
    const auto plane = sums.solved();
    if (!plane) return {};
    return {own + plane->at, std::max(std::abs(sums.x), std::abs(sums.y)) < 0.2 * radius * count};
}

/// The middle one of the distances around a pixel; 0 with few.
double middleAround(const RangeImage& range, int x, int y, int radius) {
    // Most pixels without a distance are far from any.
    size_t corners = 0;
    for (const int dy : {-radius, 0, radius})
        for (const int dx : {-radius, 0, radius}) {
            const int i = std::clamp(x + dx, 0, range.width - 1), j = std::clamp(y + dy, 0, range.height - 1);
            corners += range.distance[size_t(j) * size_t(range.width) + size_t(i)] > 0;
        }
    if (corners < 3) return 0;
    std::vector<float> found;
    for (int j = std::max(0, y - radius); j <= std::min(range.height - 1, y + radius); ++j)
        for (int i = std::max(0, x - radius); i <= std::min(range.width - 1, x + radius); ++i)
            if (const float d = range.distance[size_t(j) * size_t(range.width) + size_t(i)]; d > 0) found.push_back(d);
    if (found.size() * 5 < size_t(2 * (2 * radius + 1) * (2 * radius + 1))) return 0;
    return double(medianOf(std::move(found)));
}

/// Gives pixels without a distance that of the plane through those around them.
size_t fillHoles(RangeImage& range, const Camera& camera, int radius, double slope, double noise) {
    std::vector<float> filled(range.distance.size());
    parallelFor(size_t(range.height), 8, [&](size_t y) {
        for (int x = 0; x < range.width; ++x) {
            const size_t i = y * size_t(range.width) + size_t(x);
            if (range.distance[i] > 0) continue;
            const double own = middleAround(range, x, int(y), radius);
            if (!(own > 0)) continue;
            const Around around = planeAt(range, camera, x, int(y), radius, own, slope, noise);
            if (around.plane && around.enclosed) filled[i] = float(*around.plane);
        }
    });
    size_t count = 0;
    for (size_t i = 0; i < filled.size(); ++i)
        if (filled[i] > 0) {
            range.distance[i] = filled[i];
            ++count;
        }
    return count;
}

/// Median difference of distance from a pixel to the next: noise and slope together.
double medianStep(const RangeImage& range) {
    std::vector<float> steps;
    for (size_t i = 1; i < range.distance.size(); ++i)
        if (i % size_t(range.width) != 0 && range.distance[i] > 0 && range.distance[i - 1] > 0)
            steps.push_back(std::abs(range.distance[i] - range.distance[i - 1]));
    return double(medianOf(std::move(steps)));
}

void removeLoners(RangeImage& range, const Camera& camera, double slope, double noise) {
    std::vector<uint8_t> kept(range.distance.size());
    const auto width = size_t(range.width);
    parallelFor(size_t(range.height), 16, [&](size_t row) {
        const int y = int(row);
        for (int x = 0; x < range.width; ++x) {
            const size_t here = row * width + size_t(x);
            const auto own = double(range.distance[here]);
            int similar = 0;
            if (own > 0)
                for (int j = std::max(0, y - 1); j <= std::min(range.height - 1, y + 1); ++j)
                    for (int i = std::max(0, x - 1); i <= std::min(range.width - 1, x + 1); ++i) {
                        const auto d = double(range.distance[size_t(j) * width + size_t(i)]);
                        similar += d > 0 && std::abs(d - own) <= mostStep(camera, own, slope, 1, noise);
                    }
            kept[here] = similar >= 4;  // itself among them
        }
    });
    for (size_t i = 0; i < kept.size(); ++i)
        if (!kept[i]) range.distance[i] = 0;
}

}  // namespace

Smoothing smoothRange(RangeImage& range, const Camera& camera, int radius, double slope, Progress& progress) {
    const double first = medianStep(range);
    removeLoners(range, camera, slope, first);
    std::vector<float> fitted(range.distance.size());
    const auto width = size_t(range.width);
    progress.begin("Smoothing distances", 2 * size_t(range.height));
    const auto fit = [&](double noise) {
        parallelFor(
            size_t(range.height), 8,
            [&](size_t y) {
                for (int x = 0; x < range.width; ++x) {
                    const size_t i = y * width + size_t(x);
                    fitted[i] = 0;
                    if (!(range.distance[i] > 0)) continue;
                    const auto own = double(range.distance[i]);
                    const auto plane = planeAt(range, camera, x, int(y), radius, own, slope, noise).plane;
                    if (plane) fitted[i] = float(*plane);
                }
            },
            &progress);
    };
    fit(first);
    std::vector<float> off;
    for (size_t i = 0; i < fitted.size(); ++i)
        if (fitted[i] > 0) off.push_back(std::abs(fitted[i] - range.distance[i]));
    const double noise = 1.4826 * double(medianOf(std::move(off)));
    fit(noise);
    const auto most = float(2.5 * noise);
    for (size_t i = 0; i < fitted.size(); ++i) {
        if (!(range.distance[i] > 0)) continue;
        if (fitted[i] > 0) range.distance[i] += std::clamp(fitted[i] - range.distance[i], -most, most);
        else range.distance[i] = 0;
    }
    Smoothing done{noise, 0};
    // Small gaps first, so that larger ones are closed from firm ground.
    for (const int reach : {radius, radius, 2 * radius + 1, 2 * radius + 1}) {
        progress.check();
        done.filled += fillHoles(range, camera, reach, slope, noise);
    }
    return done;
}

}  // namespace relamp
