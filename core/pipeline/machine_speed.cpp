#include "pipeline/machine_speed.h"

#include "base/parallel.h"
#include "base/random.h"
#include "solve/work_samples.h"

namespace relamp {

MachineSpeed measureMachine(Progress& progress) {
    MachineSpeed speed;
    const auto timed = [&](auto&& work) {
        const double start = progress.seconds();
        work();
        return std::max(progress.seconds() - start, 1e-7);
    };
    // Two widths tell the products from the sums.
    constexpr double rows = 2048, narrow = 96, wide = 320;
    const double few = timed([&] { sampleGram(size_t(rows), size_t(narrow), progress); }),
                 many = timed([&] { sampleGram(size_t(rows), size_t(wide), progress); });
    speed.gramPerSquare = std::max(0.0, many / wide - few / narrow) / (rows * (wide - narrow));
    speed.gramPerColumn = std::max(0.0, few / narrow - speed.gramPerSquare * rows * narrow) / rows;
    speed.factorPerCube = timed([&] { sampleProgram(256, progress); }) / (256.0 * 256 * 256);
    std::vector<float> large(size_t(1) << 22, 1.0f);
    double total = 0;
    const double read = timed([&] {
        total = parallelSum(large.size(), size_t(1) << 16, 0.0, [&](size_t begin, size_t end) {
            float sum = 0;
            for (size_t i = begin; i < end; ++i) sum += large[i];
            return double(sum);
        });
    });
    speed.bytes = total > 0 ? read / (double(large.size()) * sizeof(float)) : 0;
    constexpr int side = 56;
    speed.sparse =
        timed([&] { sampleAlbedo(side, progress); }) / (double(side) * side * std::log2(double(side) * side));
    return speed;
}

}  // namespace relamp
