#include "brdf/measured_gloss.h"

#include <limits>

#include "brdf/models.h"

namespace relamp {
namespace {

struct SampledPair {
    Vec3 light, eye;
    float solidAngle;  // of the light
};

/// Light directions on a polar grid about the normal and, finer, about the mirror direction; grazing ones are left out,
/// where nothing was measured well.
std::vector<SampledPair> somePairs() {
    std::vector<SampledPair> pairs;
    constexpr int rings = 24, azimuths = 12;
    for (const float angle : {0.1f, 0.5f, 0.9f}) {
        const Vec3 eye(std::sin(angle), 0, std::cos(angle));
        for (int i = 0; i < rings; ++i)
            for (int k = 0; k < azimuths; ++k) {
                // Half vectors, dense about the normal.
                const float fraction = (float(i) + 0.5f) / rings, theta = fraction * fraction * 0.5f * pi,
                            phi = (float(k) + 0.5f) / azimuths * pi;
                const Vec3 h(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta));
                const float cosine = glm::dot(eye, h);
                const Vec3 light = 2 * cosine * h - eye;
                if (cosine <= 0 || light.z < 0.2f) continue;
                pairs.push_back({light, eye, 8 * cosine * std::sin(theta) * fraction * pi / rings * pi / azimuths});
            }
    }
    return pairs;
}

float quantile(std::vector<std::pair<float, float>> weighted, float q) {
    std::sort(weighted.begin(), weighted.end());
    float total = 0, run = 0;
    for (const auto& [value, weight] : weighted) total += weight;
    for (const auto& [value, weight] : weighted)
        if ((run += weight) >= q * total) return value;
    return weighted.empty() ? 0 : weighted.back().first;
}

}  // namespace

float MeasuredGloss::evaluate(const Vec3& towardLight, const Vec3& towardEye) const {
    if (!(towardLight.z > 0 && towardEye.z > 0)) return 0;
    double sum = 0, weights = 0;
    for (const MerlCorner& corner : merlCorners(towardLight, towardEye)) {
        const float value = cells[corner.cell];
        if (!(corner.weight > 0) || value < 0) continue;
        sum += corner.weight * double(value);
        weights += corner.weight;
    }
    return weights > 0 ? float(sum / weights) : 0.0f;
}

MeasuredGloss glossOf(const MeasuredBrdf& brdf, std::filesystem::path file) {
    MeasuredGloss gloss;
    gloss.file = std::move(file);
    const std::vector<SampledPair> pairs = somePairs();
    std::vector<Rgb> values;
    values.reserve(pairs.size());
    for (const SampledPair& p : pairs) values.push_back(brdf.evaluate(p.light, p.eye));
    for (int c = 0; c < 3; ++c) {
        std::vector<std::pair<float, float>> weighted;
        for (size_t i = 0; i < pairs.size(); ++i)
            weighted.emplace_back(values[i][c], pairs[i].solidAngle * pairs[i].light.z);
        gloss.matte[c] = std::min(1.0f, pi * quantile(std::move(weighted), 0.05f));
    }
    const Rgb floor = gloss.matte / pi;
    gloss.cells.resize(brdf.cells.size());
    for (size_t i = 0; i < brdf.cells.size(); ++i) {
        const Rgb& v = brdf.cells[i];
        const Rgb left = glm::max(v - floor, Rgb(0));
        gloss.cells[i] = v.x < 0 || v.y < 0 || v.z < 0 ? -1.0f : (left.x + left.y + left.z) / 3;
    }
    // The colour: least squares of each channel's gloss against the table, under the light's solid angle and cosine.
    glm::dvec3 cross(0);
    double square = 0;
    std::vector<double> shape;
    for (size_t i = 0; i < pairs.size(); ++i) {
        const double g = double(gloss.evaluate(pairs[i].light, pairs[i].eye)),
                     w = double(pairs[i].solidAngle * pairs[i].light.z * pairs[i].light.z);
        cross += w * g * glm::dvec3(glm::max(values[i] - floor, Rgb(0)));
        square += w * g * g;
        shape.push_back(g);
    }
    if (square > 0) gloss.colour = Rgb(cross / square);
    // The width of the bare GGX lobe that is nearest after scaling, by cube roots: they see the tails, where most
    // directions are.
    double least = std::numeric_limits<double>::infinity();
    for (float roughness = 0.08f; roughness < 0.85f; roughness *= 1.15f) {
        const float alpha = roughness * roughness;
        double gg = 0, gs = 0, ss = 0;
        for (size_t i = 0; i < pairs.size(); ++i) {
            const double g = std::cbrt(double(ggx(pairs[i].light, pairs[i].eye, alpha))), s = std::cbrt(shape[i]),
                         w = double(pairs[i].solidAngle);
            gg += w * g * g;
            gs += w * g * s;
            ss += w * s * s;
        }
        const double error = gg > 0 ? ss - gs * gs / gg : ss;
        if (error < least) {
            least = error;
            gloss.alpha = alpha;
        }
    }
    return gloss;
}

}  // namespace relamp
