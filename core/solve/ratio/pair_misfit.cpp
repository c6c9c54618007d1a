#include "solve/ratio/pair_misfit.h"

#include "base/parallel.h"

namespace relamp {

double pairMisfit(const MatteObservations& matte, const AlbedoPair& pair, const std::vector<Rgb>& lit,
                  const std::vector<Rgb>& again) {
    const auto [a, b, weight, edge, same] = pair;
    double sum = 0;
    for (int c = 0; c < 3; ++c) {
        const double ya = matte.radiance[a][c], yb = matte.radiance[b][c], la = lit[a][c], lb = lit[b][c];
        const double squared =
            RatioResidual::value(ya, yb, la, lb) * RatioResidual::value(ya, yb, again[a][c], again[b][c]);
        sum += squared /
               (RatioResidual::variance(ya, yb, la, lb, matte.sigma[a][c] * lb, matte.sigma[b][c] * la) + 4.5e-4);
    }
    return weight * std::log1p(std::max(0.0, sum) / 3 / 6.25);
}

double pairMisfit(const MatteObservations& matte, const std::vector<AlbedoPair>& pairs, const std::vector<Rgb>& lit,
                  const std::vector<Rgb>& again) {
    return parallelSum(pairs.size(), 4096, 0.0, [&](size_t begin, size_t end) {
        double sum = 0;
        for (size_t k = begin; k < end; ++k) sum += pairMisfit(matte, pairs[k], lit, again);
        return sum;
    });
}

}  // namespace relamp
