#include "brdf/layered_albedo.h"

#include "image/direction_grid.h"

namespace relamp {

float hemisphericalAlbedo(const Lobe& lobe) {
    constexpr int eyes = 16;
    const DirectionGrid grid{64};
    double sum = 0;
    for (int i = 0; i < eyes; ++i) {
        const float cosine = std::sqrt((float(i) + 0.5f) / eyes);  // even in cosine squared
        const Vec3 eye(std::sqrt(1 - cosine * cosine), 0, cosine);
        for (int c = 0; c < grid.cells(); ++c) {
            const Vec3 light = grid.direction(c);
            if (light.z > 0) sum += double(evaluateLobe(lobe, light, eye)) * light.z;
        }
    }
    return float(sum * grid.cellSolidAngle() / eyes);
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
