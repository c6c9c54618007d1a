#include "capture/check.h"

#include <array>
#include <limits>

#include "base/parallel.h"
#include "base/statistics.h"
#include "capture/check_warnings.h"
#include "capture/orientation.h"

namespace relamp {
namespace {

/// Distance along the view axis of the nearest surface, on a small image.
struct DepthImage {
    int width = 0, height = 0;
    float pixelsPerCell = 1;  ///< pixels of the photograph along one edge of a cell
    std::vector<float> depth;

    float at(const Vec2& pixel) const {
        const int x = int(pixel.x / pixelsPerCell), y = int(pixel.y / pixelsPerCell);
        if (x < 0 || y < 0 || x >= width || y >= height) return std::numeric_limits<float>::infinity();
        return depth[size_t(y) * width + x];
    }
};

struct Projected {
    Vec2 pixel{0};
    float depth = -1;  ///< metres; negative where the vertex does not project
};

std::vector<Projected> projectVertices(const Camera& camera, const Mesh& mesh, const Progress& progress) {
    std::vector<Projected> result(mesh.vertexCount());
    for (size_t v = 0; v < result.size(); ++v) {
        if (v % 4096 == 0) progress.check();
        if (const auto pixel = camera.project(DVec3(mesh.positions[v])))
            result[v] = {*pixel, float(camera.depthOf(DVec3(mesh.positions[v])))};
    }
    return result;
}

DepthImage rasterise(const Camera& camera, const Mesh& mesh, const std::vector<Projected>& vertices,
                     const Progress& progress) {
    constexpr int longestSide = 320;
    DepthImage image;
    image.pixelsPerCell = std::max(1.0f, float(std::max(camera.width, camera.height)) / longestSide);
    image.width = std::max(1, int(std::ceil(float(camera.width) / image.pixelsPerCell)));
    image.height = std::max(1, int(std::ceil(float(camera.height) / image.pixelsPerCell)));
    image.depth.assign(size_t(image.width) * image.height, std::numeric_limits<float>::infinity());
    for (size_t t = 0; t < mesh.triangles.size(); ++t) {
        if (t % 4096 == 0) progress.check();
        const Projected corner[3] = {vertices[mesh.triangles[t][0]], vertices[mesh.triangles[t][1]],
                                     vertices[mesh.triangles[t][2]]};
        if (corner[0].depth <= 0 || corner[1].depth <= 0 || corner[2].depth <= 0) continue;
        const Vec2 a = corner[0].pixel / image.pixelsPerCell, b = corner[1].pixel / image.pixelsPerCell,
                   c = corner[2].pixel / image.pixelsPerCell;
        const Vec2 low = glm::min(a, glm::min(b, c)), high = glm::max(a, glm::max(b, c));
        if (!(high.x >= 0 && high.y >= 0 && low.x < float(image.width) && low.y < float(image.height))) continue;
        const int x0 = int(std::max(low.x, 0.0f)), x1 = int(std::min(high.x, float(image.width - 1)));
        const int y0 = int(std::max(low.y, 0.0f)), y1 = int(std::min(high.y, float(image.height - 1)));
        const float area = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
        const auto put = [&](int x, int y, float depth) {
            float& stored = image.depth[size_t(y) * image.width + x];
            stored = std::min(stored, depth);
        };
        // Triangles smaller than a cell would slip between the centres.
        if (x1 - x0 <= 1 && y1 - y0 <= 1) {
            const Vec2 middle = (a + b + c) / 3.0f;
            if (middle.x >= 0 && middle.y >= 0 && middle.x < float(image.width) && middle.y < float(image.height))
                put(int(middle.x), int(middle.y), (corner[0].depth + corner[1].depth + corner[2].depth) / 3);
        }
        if (area == 0) continue;
        for (int y = y0; y <= y1; ++y)
            for (int x = x0; x <= x1; ++x) {
                const Vec2 p(float(x) + 0.5f, float(y) + 0.5f);
                const float wb = ((p.x - a.x) * (c.y - a.y) - (p.y - a.y) * (c.x - a.x)) / area;
                const float wc = ((b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x)) / area;
                if (wb < 0 || wc < 0 || wb + wc > 1) continue;
                put(x, y, 1 / ((1 - wb - wc) / corner[0].depth + wb / corner[1].depth + wc / corner[2].depth));
            }
    }
    return image;
}

bool isInside(const Camera& camera, const Vec2& pixel) {
    return pixel.x >= 0 && pixel.y >= 0 && pixel.x < float(camera.width) && pixel.y < float(camera.height);
}

void imageFigures(const View& view, ViewCheck& check) {
    check.nan = view.imageReport.nan;
    check.infinite = view.imageReport.infinite;
    check.negative = view.imageReport.negative;
    size_t usable = 0, clipped = 0;
    double sum = 0;
    for (size_t i = 0; i < view.image.pixels.size(); ++i) {
        if (!view.image.usable.empty() && !view.image.usable[i]) continue;
        ++usable;
        sum += luminance(view.image.pixels[i]);
        clipped += view.saturation > 0 && maxChannel(view.image.pixels[i]) >= view.saturation;
    }
    const double all = double(std::max<size_t>(1, view.image.pixels.size()));
    check.maskedFraction = view.image.pixels.empty() ? 0 : 1 - double(usable) / all;
    check.clippedFraction = double(clipped) / all;
    check.meanRadiance = usable ? sum / double(usable) : 0;
}

/// What the pixels beside the mesh show: light, or a mask or black cloth. At one pixel a cell.
void judgeBackground(const View& view, const DepthImage& depth, ViewCheck& check) {
    if (view.image.pixels.empty()) return;
    constexpr float black = 0.05f;  // of the brightness of the brighter surfaces
    std::vector<float> surface;
    size_t open = 0, light = 0;
    const auto each = [&](auto&& use) {
        for (int y = 0; y < depth.height; ++y)
            for (int x = 0; x < depth.width; ++x) {
                const int px = std::min(int((float(x) + 0.5f) * depth.pixelsPerCell), view.image.width - 1),
                          py = std::min(int((float(y) + 0.5f) * depth.pixelsPerCell), view.image.height - 1);
                use(std::isfinite(depth.depth[size_t(y) * size_t(depth.width) + size_t(x)]),
                    view.image.usableAt(px, py), luminance(view.image.at(px, py)));
            }
    };
    each([&](bool mesh, bool usable, float y) {
        if (mesh && usable) surface.push_back(y);
    });
    const float least = black * nearestQuantileOf(surface, 0.9);
    each([&](bool mesh, bool usable, float y) {
        if (mesh) return;
        ++open;
        light += usable && y > least;
    });
    check.openFraction = double(open) / double(std::max<size_t>(1, depth.depth.size()));
    check.lightFraction = open ? double(light) / double(open) : 0;
}

/// What one view says of the mesh: which vertices it sees, and how bright some of them are.
struct ViewSight {
    std::vector<uint8_t> sees;      ///< per vertex
    std::vector<float> brightness;  ///< log2 luminance per sampled vertex; NaN where it is not seen
    uint32_t state = 0;             ///< lighting state of the view
};

ViewSight lookAt(const View& view, const Mesh& mesh, const std::vector<uint8_t>& referenced, size_t stride,
                 ViewCheck& check, const Progress& progress) {
    const std::vector<Projected> vertices = projectVertices(view.camera, mesh, progress);
    const DepthImage depth = rasterise(view.camera, mesh, vertices, progress);
    size_t covered = 0, inside = 0;
    for (const float d : depth.depth) covered += std::isfinite(d);
    check.meshFraction = double(covered) / double(depth.depth.size());
    judgeBackground(view, depth, check);
    ViewSight sight;
    sight.state = view.state;
    sight.sees.assign(mesh.vertexCount(), 0);
    sight.brightness.assign((mesh.vertexCount() + stride - 1) / stride, std::numeric_limits<float>::quiet_NaN());
    const DVec3 eye = view.camera.position();
    for (size_t v = 0; v < mesh.vertexCount(); ++v) {
        const Projected& p = vertices[v];
        if (p.depth <= 0 || !isInside(view.camera, p.pixel)) continue;
        ++inside;
        if (!referenced[v]) continue;
        const Vec3 towardEye = Vec3(glm::normalize(eye - DVec3(mesh.positions[v])));
        // Grazing vertices are judged by their neighbours' depth, so they are left out.
        if (glm::dot(mesh.normals[v], towardEye) < 0.2f || p.depth > depth.at(p.pixel) * 1.02f) continue;
        sight.sees[v] = 1;
        if (v % stride || view.image.pixels.empty()) continue;
        const int x = std::min(int(p.pixel.x), view.image.width - 1),
                  y = std::min(int(p.pixel.y), view.image.height - 1);
        const Rgb& colour = view.image.at(x, y);
        const bool clipped = view.saturation > 0 && maxChannel(colour) >= view.saturation;
        if (view.image.usableAt(x, y) && !clipped && luminance(colour) > 0)
            sight.brightness[v / stride] = std::log2(luminance(colour));
    }
    check.verticesInside = double(inside) / double(std::max<size_t>(1, mesh.vertexCount()));
    return sight;
}

/// Median of the sorted values without the one at `leftOut`.
float medianWithout(const std::vector<float>& sorted, size_t leftOut) {
    const size_t count = sorted.size() - 1;
    const auto value = [&](size_t i) { return sorted[i < leftOut ? i : i + 1]; };
    return 0.5f * (value((count - 1) / 2) + value(count / 2));
}

/// Each view's brightness against the other views that see the same vertices: the median difference to the median of
/// the others, refined a few times with the differences found so far taken out. Views of other lighting states show
/// other light.
void compareExposures(const std::vector<ViewSight>& sights, CaptureCheck& check) {
    if (sights.empty()) return;
    uint32_t states = 1;
    for (const ViewSight& sight : sights) states = std::max(states, sight.state + 1);
    std::vector<float> stops(sights.size(), 0.0f);
    std::vector<std::vector<float>> differences(sights.size());
    std::vector<std::pair<float, size_t>> seen;
    std::vector<float> sorted;
    for (int round = 0; round < 6; ++round) {
        for (auto& d : differences) d.clear();
        for (size_t k = 0; k < sights[0].brightness.size() * states; ++k) {
            const size_t s = k / states;
            seen.clear();
            sorted.clear();
            for (size_t i = 0; i < sights.size(); ++i)
                if (sights[i].state == k % states && !std::isnan(sights[i].brightness[s]))
                    seen.emplace_back(sights[i].brightness[s] - stops[i], i);
            if (seen.size() < 2) continue;
            std::sort(seen.begin(), seen.end());
            for (const auto& [value, view] : seen) sorted.push_back(value);
            for (size_t j = 0; j < seen.size(); ++j)
                differences[seen[j].second].push_back(sorted[j] - medianWithout(sorted, j));
        }
        // Half steps, because two views that correct each other fully would swing.
        for (size_t i = 0; i < sights.size(); ++i) {
            check.views[i].comparedVertices = differences[i].size();
            stops[i] += 0.5f * medianOf(differences[i]);
        }
        for (uint32_t state = 0; state < states; ++state) {
            std::vector<float> ofState;
            for (size_t i = 0; i < sights.size(); ++i)
                if (sights[i].state == state) ofState.push_back(stops[i]);
            const float middle = medianOf(std::move(ofState));
            for (size_t i = 0; i < sights.size(); ++i)
                if (sights[i].state == state) stops[i] -= middle;
        }
    }
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (size_t i = 0; i < sights.size(); ++i) {
        check.views[i].exposureStops = double(stops[i]);
        check.views[i].exposureScatterStops =
            double(nearestQuantileOf(differences[i], 0.75) - nearestQuantileOf(differences[i], 0.25));
        if (check.views[i].comparedVertices < enoughVertices) continue;
        low = std::min(low, check.views[i].exposureStops);
        high = std::max(high, check.views[i].exposureStops);
    }
    check.exposureSpreadStops = high > low ? high - low : 0;
}

/// Median over the surface of how much views disagree on its brightness, stops; infinite where too few see one place.
float disagreement(const std::vector<ViewSight>& sights) {
    std::vector<float> scatter;
    for (size_t s = 0; !sights.empty() && s < sights[0].brightness.size(); ++s) {
        float sum = 0, squares = 0, count = 0;
        for (const ViewSight& sight : sights)
            if (const float b = sight.brightness[s]; std::isfinite(b)) sum += b, squares += b * b, ++count;
        if (count >= 2) scatter.push_back(std::sqrt(std::max(0.0f, squares / count - sum * sum / (count * count))));
    }
    if (scatter.size() < enoughVertices) return std::numeric_limits<float>::infinity();
    return medianOf(std::move(scatter));
}

/// The --mesh-up with which views would agree on the surface, where they do not: files have Y or Z up, and not all of
/// a capture the same. Empty where nothing speaks for it.
std::string meshUpGuess(const Capture& capture, const std::vector<uint8_t>& referenced, size_t stride, float now,
                        Progress& progress) {
    constexpr float usual = 0.25f, clearly = 0.6f;  // stops; of what they disagree by now
    if (now < usual || capture.views.empty() || capture.views[0].image.pixels.empty()) return "";
    std::string best;
    float least = clearly * now;
    const Mat3 turn = rotationToZUp({0, 1, 0});
    for (const auto& [name, quarter] : {std::pair{"y", turn}, std::pair{"z", glm::transpose(turn)}}) {
        Mesh turned = capture.mesh;
        const Vec3 origin(capture.origin);
        for (Vec3& p : turned.positions) p = quarter * (p + origin) - origin;
        for (Vec3& n : turned.normals) n = quarter * n;
        std::vector<ViewSight> sights(capture.views.size());
        parallelFor(sights.size(), 1, [&](size_t i) {
            ViewCheck ignored;
            sights[i] = lookAt(capture.views[i], turned, referenced, stride, ignored, progress);
        });
        if (const float scatter = disagreement(sights); scatter < least) least = scatter, best = name;
    }
    return best;
}

std::string axisName(const Vec3& v) {
    int axis = 0;
    for (int c = 1; c < 3; ++c)
        if (std::abs(v[c]) > std::abs(v[axis])) axis = c;
    return std::string(v[axis] < 0 ? "-" : "") + "xyz"[axis];
}

void guessAxes(const Capture& capture, CaptureCheck& check) {
    check.up = nameFromAxis(capture.up);
    DVec3 cameraUp(0);
    size_t ahead = 0, behind = 0;
    const DVec3 middle = DVec3(0.5f * (check.meshMin + check.meshMax));
    for (const View& view : capture.views) {
        cameraUp += DVec3(view.camera.worldFromCamera[1]);
        (view.camera.depthOf(middle) > 0 ? ahead : behind)++;
    }
    check.lookBackwards = behind > ahead;
    if (check.lookBackwards) cameraUp = -cameraUp;  // OpenCV's axes have y down as well
    const double length = glm::length(cameraUp);
    if (!(length > 1e-9)) return;
    check.upAgreement = glm::dot(cameraUp / length, DVec3(0, 0, 1));
    // Within 45 degrees nothing is said against a direction that is no axis: photographs often look down.
    const bool isAxis = check.up.find(',') == std::string::npos;
    check.upGuess = !isAxis && check.upAgreement > 0.7
                        ? check.up
                        : axisName(glm::transpose(capture.worldFromFile) * Vec3(cameraUp / length));
}

/// Fraction of the points within about two hundredths of the mesh's size from its surface, and the sizes' ratio: a mesh
/// from another run, or in another unit, shows here.
void comparePoints(const Capture& capture, CaptureCheck& check) {
    const Mesh& mesh = capture.mesh;
    if (capture.points.size() < 20 || mesh.triangles.empty()) return;
    constexpr int side = 64;
    const Vec3 low = check.meshMin;
    const float cell = std::max(maxChannel(check.meshMax - check.meshMin) / float(side), 1e-20f);
    const auto indexOf = [&](const Vec3& p, int spread, auto&& use) {
        const Vec3 at = (p - low) / cell;
        for (int c = 0; c < 3; ++c)
            if (!(at[c] >= -1 && at[c] <= side + 1)) return;
        for (int z = int(at.z) - spread; z <= int(at.z) + spread; ++z)
            for (int y = int(at.y) - spread; y <= int(at.y) + spread; ++y)
                for (int x = int(at.x) - spread; x <= int(at.x) + spread; ++x)
                    if (x >= 0 && y >= 0 && z >= 0 && x <= side && y <= side && z <= side)
                        use((size_t(z) * (side + 1) + size_t(y)) * (side + 1) + size_t(x));
    };
    std::vector<uint8_t> surface(size_t(side + 1) * (side + 1) * (side + 1), 0);
    for (const Triangle& t : mesh.triangles) {
        const Vec3 a = mesh.positions[t[0]], b = mesh.positions[t[1]], c = mesh.positions[t[2]];
        const float longest = std::max({glm::distance(a, b), glm::distance(b, c), glm::distance(c, a)});
        const int steps = std::clamp(int(std::ceil(longest / (0.7f * cell))), 1, 2 * side);
        for (int i = 0; i <= steps; ++i)
            for (int j = 0; i + j <= steps; ++j)
                indexOf(a + (b - a) * (float(i) / float(steps)) + (c - a) * (float(j) / float(steps)), 0,
                        [&](size_t k) { surface[k] = 1; });
    }
    size_t on = 0;
    std::array<std::vector<float>, 3> along;
    for (const DVec3& wide : capture.points) {
        const Vec3 p(wide);
        bool found = false;
        indexOf(p, 1, [&](size_t k) { found |= surface[k] != 0; });
        on += found;
        for (int c = 0; c < 3; ++c) along[size_t(c)].push_back(p[c]);
    }
    check.pointsOnMesh = double(on) / double(capture.points.size());
    Vec3 cloud;
    for (int c = 0; c < 3; ++c)
        cloud[c] = nearestQuantileOf(along[size_t(c)], 0.95) - nearestQuantileOf(along[size_t(c)], 0.05);
    if (const float size = glm::length(cloud); size > 0)
        check.meshToPoints = double(glm::length(check.meshMax - check.meshMin) / size);
}

}  // namespace

std::vector<std::pair<std::string, size_t>> viewsOfStates(const Capture& capture) {
    std::vector<std::pair<std::string, size_t>> states;
    for (const std::string& name : capture.states) states.emplace_back(name, 0);
    for (const View& view : capture.views)
        if (view.state < states.size()) ++states[view.state].second;
    return states;
}

std::string environmentInWords(const Capture& capture, size_t state) {
    const std::vector<int>& environments = capture.environmentOfState;
    if (environments[state] < 0) return "none";
    const size_t first =
        size_t(std::find(environments.begin(), environments.end(), environments[state]) - environments.begin());
    return first == state ? "own" : capture.states[first];
}

CaptureCheck checkCapture(const Capture& capture, Progress& progress) {
    CaptureCheck check;
    const Mesh& mesh = capture.mesh;
    check.mesh = capture.meshReport;
    check.notes = capture.notes;
    check.origin = capture.origin;
    std::vector<uint8_t> referenced(mesh.vertexCount(), 0);
    Vec3 low(std::numeric_limits<float>::infinity()), high(-low);
    for (const Triangle& t : mesh.triangles)
        for (const uint32_t v : t) {
            referenced[v] = 1;
            low = glm::min(low, mesh.positions[v]);
            high = glm::max(high, mesh.positions[v]);
        }
    if (!mesh.triangles.empty()) check.meshMin = low, check.meshMax = high;

    constexpr size_t mostSamples = 20000;
    const size_t stride = std::max<size_t>(1, mesh.vertexCount() / mostSamples);
    check.views.resize(capture.views.size());
    std::vector<ViewSight> sights(capture.views.size());
    std::vector<uint32_t> viewsOf(mesh.vertexCount(), 0);
    progress.begin("Checking views", capture.views.size());
    parallelFor(
        capture.views.size(), 1,
        [&](size_t i) {
            const View& view = capture.views[i];
            ViewCheck& figures = check.views[i];
            figures.name = view.name;
            figures.width = view.camera.width;
            figures.height = view.camera.height;
            imageFigures(view, figures);
            sights[i] = lookAt(view, mesh, referenced, stride, figures, progress);
        },
        &progress);
    for (const ViewSight& sight : sights)
        for (size_t v = 0; v < viewsOf.size(); ++v) viewsOf[v] += sight.sees[v];
    size_t surface = 0, once = 0, twice = 0, sum = 0;
    for (size_t v = 0; v < viewsOf.size(); ++v) {
        if (!referenced[v]) continue;
        ++surface;
        once += viewsOf[v] >= 1;
        twice += viewsOf[v] >= 2;
        sum += viewsOf[v];
    }
    const double count = double(std::max<size_t>(1, surface));
    check.seenFraction = double(once) / count;
    check.seenTwiceFraction = double(twice) / count;
    check.meanViewsPerVertex = double(sum) / count;
    check.reconstruction = capture.reconstruction;
    std::vector<float> distances;
    for (const View& view : capture.views)
        distances.push_back(
            float(glm::distance(view.camera.position(), DVec3(0.5f * (check.meshMin + check.meshMax)))));
    check.cameraDistance = double(medianOf(std::move(distances)));
    double open = 0, light = 0;
    for (const ViewCheck& v : check.views) open += v.openFraction, light += v.openFraction * v.lightFraction;
    check.backdrop = open > 0.1 * double(check.views.size()) && light < 0.05 * open;
    check.states = viewsOfStates(capture);
    for (size_t s = 0; s < capture.environmentOfState.size(); ++s)
        check.environments.push_back(environmentInWords(capture, s));
    comparePoints(capture, check);
    compareExposures(sights, check);
    guessAxes(capture, check);
    warn(capture, check);
    if (const auto up = meshUpGuess(capture, referenced, stride, disagreement(sights), progress); !up.empty())
        check.warnings.push_back(
            fmt::format("The photographs agree much better on the mesh turned by a quarter: try --mesh-up {}.", up));
    return check;
}

}  // namespace relamp
