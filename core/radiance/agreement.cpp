#include "radiance/agreement.h"

#include <algorithm>

#include "base/parallel.h"
#include "base/statistics.h"

namespace relamp {
namespace {

/// Median absolute deviation about `centre` as a standard deviation.
float spreadAbout(std::vector<float> values, float centre) {
    for (float& v : values) v = std::abs(v - centre);
    return 1.4826f * medianOf(std::move(values));
}

ViewAgreement agreementOf(const RadianceSamples& samples, uint32_t view, size_t vertices) {
    std::vector<float> own, others, ratio;
    for (uint32_t v = 0; v < vertices; ++v)
        for (uint32_t s = samples.start[v]; s < samples.start[v + 1]; ++s) {
            const RadianceSample& r = samples.samples[s];
            if (r.view != view || r.clipped || !(luminance(r.radiance) > 2 * samples.noiseFloor)) continue;
            const std::optional<Rgb> rest = medianObservation(samples, v, view);
            if (!rest || !(luminance(*rest) > 2 * samples.noiseFloor)) continue;
            own.push_back(std::log(luminance(r.radiance)));
            others.push_back(std::log(luminance(*rest)));
            ratio.push_back(own.back() - others.back());
        }
    ViewAgreement a;
    a.vertices = own.size();
    if (own.size() < 20) return a;
    double mx = 0, my = 0, xx = 0, yy = 0, xy = 0;
    for (size_t i = 0; i < own.size(); ++i) mx += own[i], my += others[i];
    mx /= double(own.size()), my /= double(own.size());
    for (size_t i = 0; i < own.size(); ++i) {
        const double x = own[i] - mx, y = others[i] - my;
        xx += x * x, yy += y * y, xy += x * y;
    }
    a.correlation = xx > 0 && yy > 0 ? float(xy / std::sqrt(xx * yy)) : 1.0f;
    a.gain = medianOf(ratio);
    a.spread = spreadAbout(std::move(ratio), a.gain);
    return a;
}

/// Vertices with several views, spread over the mesh: logs of radiance, and the normal in each camera's axes.
struct SeenVertex {
    std::vector<float> log;
    std::vector<Vec3> normal;
};

MovingLight movingLightOf(const Capture& capture, const Scene& scene, const RadianceSamples& samples) {
    constexpr size_t wanted = 2000;
    std::vector<uint32_t> several;
    for (uint32_t v = 0; v < scene.mesh.vertexCount(); ++v)
        if (samples.countOf(v) >= 3) several.push_back(v);
    std::sort(several.begin(), several.end(), [&](uint32_t a, uint32_t b) { return scene.rank[a] < scene.rank[b]; });
    if (several.size() > wanted) several.resize(wanted);
    std::vector<SeenVertex> seen;
    for (uint32_t v : several) {
        SeenVertex vertex;
        for (uint32_t s = samples.start[v]; s < samples.start[v + 1]; ++s) {
            const RadianceSample& r = samples.samples[s];
            if (r.clipped || r.weight < 0.3f || !(luminance(r.radiance) > 2 * samples.noiseFloor)) continue;
            vertex.log.push_back(std::log(luminance(r.radiance)));
            vertex.normal.push_back(glm::transpose(Mat3(glm::dmat3(capture.views[r.view].camera.worldFromCamera))) *
                                    scene.mesh.normals[v]);
        }
        if (vertex.log.size() >= 3) seen.push_back(std::move(vertex));
    }
    MovingLight result;
    if (seen.size() < 50) return result;
    const auto spreadUnder = [&](const Vec3& light, float ambient) {
        std::vector<float> spreads;
        for (const SeenVertex& vertex : seen) {
            const float count = float(vertex.log.size());
            float sum = 0, squares = 0;
            for (size_t i = 0; i < vertex.log.size(); ++i) {
                const float x = vertex.log[i] - std::log(ambient + std::max(0.0f, glm::dot(light, vertex.normal[i])));
                sum += x;
                squares += x * x;
            }
            spreads.push_back(std::sqrt(std::max(0.0f, squares - sum * sum / count) / (count - 1)));
        }
        return medianOf(std::move(spreads));
    };
    result.spreadStatic = result.spreadMoving = spreadUnder(Vec3(0), 1);
    // Directions by a spiral over the half sphere in front of the camera and a little more, then by one about the best
    // of them.
    const auto tryAll = [&](int count, auto&& direction) {
        std::vector<std::pair<float, Vec3>> tried(static_cast<size_t>(count));
        parallelFor(tried.size(), 1, [&](size_t k) {
            const float along = (float(k) + 0.5f) / float(count), phi = 2.399963f * float(k);
            const Vec3 light = direction(along, phi);
            float best = 1e30f;
            for (float ambient : {0.1f, 0.3f, 1.0f}) best = std::min(best, spreadUnder(light, ambient));
            tried[k] = {best, light};
        });
        for (const auto& [spread, light] : tried)
            if (spread < result.spreadMoving) result.spreadMoving = spread, result.direction = light;
    };
    tryAll(64, [](float along, float phi) {
        const float z = 1 - 1.2f * along, r = std::sqrt(std::max(0.0f, 1 - z * z));
        return Vec3(r * std::cos(phi), r * std::sin(phi), z);
    });
    if (result.direction == Vec3(0)) return result;
    const Mat3 frame = frameAround(result.direction);
    tryAll(32, [&](float along, float phi) {
        return frame * glm::normalize(
                           Vec3(0.35f * std::sqrt(along) * std::cos(phi), 0.35f * std::sqrt(along) * std::sin(phi), 1));
    });
    return result;
}

}  // namespace

std::optional<Rgb> medianObservation(const RadianceSamples& samples, uint32_t vertex, uint32_t without) {
    float values[3][256];
    size_t count = 0;
    for (uint32_t s = samples.start[vertex]; s < samples.start[vertex + 1] && count < 256; ++s) {
        const RadianceSample& r = samples.samples[s];
        if (r.view == without || r.clipped) continue;
        for (int c = 0; c < 3; ++c) values[c][count] = r.radiance[c];
        ++count;
    }
    if (!count) return {};
    Rgb median(0);
    for (int c = 0; c < 3; ++c) {
        std::nth_element(values[c], values[c] + count / 2, values[c] + count);
        median[c] = values[c][count / 2];
        if (count % 2 == 0) median[c] = 0.5f * (median[c] + *std::max_element(values[c], values[c] + count / 2));
    }
    return median;
}

PhotographAgreement photographAgreement(const Capture& capture, const Scene& scene, const RadianceSamples& samples,
                                        Progress& progress) {
    PhotographAgreement result;
    result.views.resize(capture.views.size());
    progress.begin("Do the photographs agree?", capture.views.size());
    parallelFor(
        capture.views.size(), 1,
        [&](size_t i) { result.views[i] = agreementOf(samples, uint32_t(i), scene.mesh.vertexCount()); }, &progress);
    result.movingLight = movingLightOf(capture, scene, samples);
    return result;
}

}  // namespace relamp
