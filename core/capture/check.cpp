#include "capture/check.h"

#include <array>
#include <limits>

#include "base/parallel.h"
#include "base/statistics.h"
#include "capture/check_warnings.h"
#include "capture/colour_agreement.h"
#include "capture/orientation.h"
#include "capture/placement_trials.h"
#include "capture/view_sight.h"

namespace relamp {
namespace {

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

/// A place as large, or cameras as far away, as people seldom take: lengths may be centimetres or millimetres. Where a
/// model does not know metres it is asked otherwise.
void askForUnit(const Capture& capture, CaptureCheck& check) {
    constexpr double large = 80, far = 40, small = 20;  // metres
    const double size = double(glm::length(check.meshMax - check.meshMin));
    const bool told = check.advice || check.reconstruction || capture.metresPerUnit != 1;
    if (told || !(size > large || check.cameraDistance > far)) return;
    const bool millimetres = size / 100 > small || check.cameraDistance / 100 > small;
    const double scale = capture.metresPerUnit * (millimetres ? 0.001 : 0.01);
    const char* unit = millimetres ? "millimetre" : "centimetre";
    check.unitQuestion = UnitQuestion{
        fmt::format("Is the scene really {:.3g} m across, and are the cameras {:.3g} m away? If its unit is the {}, "
                    "--scale {:g} sets lengths right; light and colours do not rest on it.",
                    size, check.cameraDistance, unit, scale),
        fmt::format("Lengths are {}s", unit), scale};
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

void compareColours(const Capture& capture, const std::vector<ViewSight>& sights, CaptureCheck& check,
                    Progress& progress) {
    MeshColours colours = meshColours(capture, progress);
    for (const std::string& fault : colours.faults) check.notes.push_back("the mesh's texture: " + fault);
    if (colours.empty()) return;
    const ColourAgreement found = colourAgreement(capture, colours, sights, progress);
    check.meshColours = std::make_shared<const MeshColours>(std::move(colours));
    if (found.views.empty()) return;
    std::vector<double> cells;
    for (const ColourView& view : found.views) cells.push_back(view.cell);
    const ColourView& worst = found.worst();
    check.colours =
        ColourCheck{check.meshColours->images,        found.views.size(),         found.correlation, found.shift,
                    double(glm::length(worst.shift)), medianOf(std::move(cells)), worst.name};
}

}  // namespace

CaptureFix advised(CaptureFix fix, const PlacementAdvice& advice) {
    fix.scale = advice.scale;
    fix.meshScale = advice.readAs.meshScale;
    fix.meshUp = advice.readAs.meshUp;
    fix.flipCameras = advice.readAs.flipCameras;
    fix.mirror = advice.readAs.mirror;
    fix.meshMirror = advice.readAs.meshMirror;
    return fix;
}

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
    check.format = capture.format;
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
            sights[i] = lookAt(view, view.camera, mesh, referenced, stride, figures, progress);
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
    compareColours(capture, sights, check, progress);
    compareExposures(sights, check);
    guessAxes(capture, check);
    double covered = 0;
    for (const ViewCheck& v : check.views) covered += v.meshFraction / double(check.views.size());
    const PlacementScore score{disagreement(sights), check.seenTwiceFraction, covered};
    check.advice = betterPlacement(capture, referenced, stride, score, progress);
    // Cameras that look away from the mesh are told of by what they look at.
    if (check.advice && check.lookBackwards && check.advice->option == "--flip-cameras") check.advice.reset();
    if (check.advice) {
        // What is said of axes holds once the files are read right.
        check.lookBackwards = false;
        check.upGuess = check.up;
    }
    askForUnit(capture, check);
    warn(capture, check);
    return check;
}

}  // namespace relamp
