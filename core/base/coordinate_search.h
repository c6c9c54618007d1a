// The minimum of a function of a few variables, by steps along one of them at a time.
#pragma once
#include <array>
#include <cstddef>

namespace relamp {

/// Moves `x`, which costs `least`, by `step` along one coordinate as long as that lowers `loss`, then by half of it,
/// down to `finest`. Where `loss` is none (infinity) it does not go. Returns the least loss. For functions without
/// derivatives that are cheap: some 20 evaluations a coordinate and halving.
template <size_t N, typename Loss>
double coordinateSearch(std::array<double, N>& x, double least, double step, double finest, const Loss& loss) {
    constexpr double worthIt = 1e-9;
    for (; step > finest; step /= 2)
        for (bool better = true; better;) {
            better = false;
            for (size_t k = 0; k < N; ++k)
                for (const double sign : {-1.0, 1.0}) {
                    std::array<double, N> tried = x;
                    tried[k] += sign * step;
                    const double there = loss(tried);
                    if (!(there < least - worthIt)) continue;
                    least = there;
                    x = tried;
                    better = true;
                }
        }
    return least;
}

}  // namespace relamp
