#include "brdf/basis.h"

#include <fmt/format.h>

namespace relamp {
namespace {
// Equal steps in log roughness: neighbouring lobes then overlap equally at the sharp and at the wide end.
constexpr float sharpest = 0.1f, widest = 0.7f;
constexpr int ladderSteps = 6;
}  // namespace

BrdfBasis builtInBasis() {
    BrdfBasis basis;
    basis.lobes.push_back({Lobe::Kind::lambert, 1, "lambert"});
    const auto addLadder = [&](Lobe::Kind kind, const char* kindName) {
        for (int i = 0; i < ladderSteps; ++i) {
            const float roughness = sharpest * std::pow(widest / sharpest, float(i) / float(ladderSteps - 1));
            basis.lobes.push_back({kind, roughness * roughness, fmt::format("{} roughness {:.2f}", kindName, roughness)});
        }
    };
    addLadder(Lobe::Kind::ggx, "ggx");
    addLadder(Lobe::Kind::ggxDielectric, "ggx dielectric");
    return basis;
}

float evaluateLobe(const Lobe& lobe, const Vec3& towardLight, const Vec3& towardEye) {
    switch (lobe.kind) {
        case Lobe::Kind::lambert: return lambert(towardLight, towardEye);
        case Lobe::Kind::ggx: return ggx(towardLight, towardEye, lobe.alpha);
        case Lobe::Kind::ggxDielectric: return ggxDielectric(towardLight, towardEye, lobe.alpha);
    }
    return 0;
}

}  // namespace relamp
