#include "brdf/layered_albedo.h"

#include "base/random.h"

namespace relamp {

float hemisphericalAlbedo(const Lobe& lobe) {
    constexpr int eyes = 16, each = 256;
    double sum = 0;
    for (int i = 0; i < eyes; ++i) {
        const float cosine = std::sqrt((float(i) + 0.5f) / eyes);  // even in cosine squared
        const Vec3 eye(std::sqrt(1 - cosine * cosine), 0, cosine);
        const auto add = [&](const Vec3& light) {
            if (!(light.z > 0)) return;
            const double density = double(ggxSampleDensity(light, eye, lobe.alpha)) + double(light.z / pi);
            sum += double(evaluateLobe(lobe, light, eye)) * double(light.z) / density;
        };
        for (int k = 0; k < each; ++k) {
            const Vec2 u = r2Point(uint32_t(k), Vec2(0.5f, (float(i) + 0.5f) / eyes));
            add(sampleGgx(eye, lobe.alpha, u));
            add(cosineHemisphere(u));
        }
    }
    return float(sum / (eyes * each));
}

std::vector<float> hemisphericalAlbedos(const BrdfBasis& basis) {
    std::vector<float> albedos;
    for (const Lobe& lobe : basis.lobes)
        albedos.push_back(lobe.kind == Lobe::Kind::lambert ? 1 : hemisphericalAlbedo(lobe));
    return albedos;
}

std::vector<Rgb> albedoUnderCoating(const BrdfBasis& basis, const std::vector<std::vector<Rgb>>& weight) {
    std::vector<Rgb> through(weight[0].size(), Rgb(1));
    for (size_t k = 1; k < weight.size(); ++k) {
        const float back = hemisphericalAlbedo(basis.lobes[k]);
        for (size_t v = 0; v < through.size(); ++v) through[v] -= back * weight[k][v];
    }
    std::vector<Rgb> albedo = weight[0];
    for (size_t v = 0; v < albedo.size(); ++v)
        if (through[v] != Rgb(1)) albedo[v] = glm::min(albedo[v] / glm::max(through[v], Rgb(0.3f)), Rgb(1));
    return albedo;
}

}  // namespace relamp
