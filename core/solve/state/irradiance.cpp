#include "solve/state/irradiance.h"

#include "base/parallel.h"

namespace relamp {

Irradiance Irradiance::inState(const MatteObservations& matte, size_t state) const {
    const ptrdiff_t begin = ptrdiff_t(matte.beginOf(state)), end = ptrdiff_t(matte.endOf(state));
    return {{value.begin() + begin, value.begin() + end}, {sigma.begin() + begin, sigma.begin() + end}};
}

Irradiance irradianceOf(const InfluenceMatrix& rows, const Lighting& lighting, const std::vector<Rgb>& bounce,
                        const std::vector<AlbedoPair>& pairs) {
    Irradiance result;
    std::vector<Rgb>&lit = result.value, &sigma = result.sigma;
    lit.assign(rows.rows, Rgb(0));
    parallelFor(rows.rows, 64, [&](size_t i) {
        const Rgb sum = lightOfRow(rows.row(i), lighting);
        lit[i] = bounce.empty() ? sum : sum + bounce[i];
    });
    sigma.assign(rows.rows, Rgb(0));
    for (const AlbedoPair& p : pairs) {
        if (!p.edge) continue;
        const Rgb step = glm::abs(lit[p.a] - lit[p.b]);
        sigma[p.a] = glm::max(sigma[p.a], 0.25f * step);
        sigma[p.b] = glm::max(sigma[p.b], 0.25f * step);
    }
    for (size_t i = 0; i < rows.rows; ++i) sigma[i] = glm::sqrt(sigma[i] * sigma[i] + 1e-4f * lit[i] * lit[i]);
    return result;
}

double pairMismatch(const MatteObservations& matte, const std::vector<AlbedoPair>& pairs,
                    const Irradiance& irradiance) {
    double sum = 0, counted = 0;
    for (const AlbedoPair& p : pairs)
        for (int c = 0; c < 3; ++c) {
            sum += robustStep(RatioResidual::value(matte.radiance[p.a][c], matte.radiance[p.b][c],
                                                   irradiance.value[p.a][c], irradiance.value[p.b][c]));
            ++counted;
        }
    return std::sqrt(sum / std::max(1.0, counted));
}

float bouncedFractionOf(const std::vector<Rgb>& bounce, const Irradiance& irradiance) {
    double bounced = 0, all = 0;
    for (size_t i = 0; i < bounce.size(); ++i) {
        bounced += luminance(bounce[i]);
        all += luminance(irradiance.value[i]);
    }
    return all > 0 ? float(bounced / all) : 0.0f;
}

}  // namespace relamp
