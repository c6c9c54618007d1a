#include "brdf/basis.h"

#include <fmt/format.h>

#include "base/error.h"

namespace relamp {
namespace {

/// Roughnesses in equal steps of the logarithm: neighbouring lobes then overlap equally at the sharp and at the wide
/// end.
void addLadder(BrdfBasis& basis, Lobe::Kind kind, const char* name, float sharpest, float widest, int steps) {
    for (int i = 0; i < steps; ++i) {
        const float roughness = sharpest * std::pow(widest / sharpest, float(i) / float(steps - 1));
        basis.lobes.push_back({kind, roughness * roughness, fmt::format("{} roughness {:.2f}", name, roughness)});
    }
}

float exponentOf(float alpha) { return std::max(0.1f, 2 / (alpha * alpha) - 2); }

}  // namespace

BrdfBasis builtInBasis() {
    BrdfBasis basis;
    basis.lobes.push_back({Lobe::Kind::lambert, 1, "lambert"});
    addLadder(basis, Lobe::Kind::ggx, "ggx", 0.1f, 0.7f, 6);
    addLadder(basis, Lobe::Kind::ggxDielectric, "ggx dielectric", 0.1f, 0.7f, 6);
    return basis;
}

BrdfBasis wideBasis() {
    BrdfBasis basis;
    basis.lobes.push_back({Lobe::Kind::lambert, 1, "lambert"});
    addLadder(basis, Lobe::Kind::ggx, "ggx", 0.06f, 0.85f, 11);
    addLadder(basis, Lobe::Kind::ggxDielectric, "ggx dielectric", 0.06f, 0.85f, 11);
    addLadder(basis, Lobe::Kind::ggxGrazing, "ggx grazing", 0.06f, 0.85f, 11);
    addLadder(basis, Lobe::Kind::cookTorrance, "cook-torrance", 0.08f, 0.85f, 9);
    addLadder(basis, Lobe::Kind::ward, "ward", 0.08f, 0.8f, 5);
    // Backscatter of cloth and paint, and forward scatter towards grazing.
    for (const auto& [kind, name, most] : {std::tuple{Lobe::Kind::lafortuneBack, "lafortune back", 8},
                                           std::tuple{Lobe::Kind::lafortuneForward, "lafortune forward", 4}})
        for (int n = 1; n <= most; n *= 2)
            basis.lobes.push_back({kind, std::sqrt(2 / float(n + 2)), fmt::format("{} {}", name, n)});
    return basis;
}

BrdfBasis basisNamed(const std::string& name) {
    if (name == "built-in") return builtInBasis();
    if (name == "wide") return wideBasis();
    if (name == "lambert") return {{Lobe{Lobe::Kind::lambert, 1, "lambert"}}};
    throw Error("basis {}: unknown, expected built-in, wide or lambert", name);
}

Lobe measuredLobe(std::shared_ptr<const MeasuredGloss> gloss) {
    Lobe lobe{Lobe::Kind::measured, gloss->alpha, gloss->file.stem().string()};
    lobe.measured = std::move(gloss);
    return lobe;
}

std::vector<Lobe> readMeasuredLobes(const std::filesystem::path& folder) {
    std::error_code failed;
    std::vector<std::filesystem::path> files;
    for (std::filesystem::directory_iterator entry(folder, failed), end; !failed && entry != end;
         entry.increment(failed))
        if (entry->path().extension() == ".binary") files.push_back(entry->path());
    if (failed) throw Error("{}: cannot be read ({})", folder.string(), failed.message());
    if (files.empty())
        throw Error("{}: holds no measured reflectance, expected MERL files that end in .binary", folder.string());
    std::sort(files.begin(), files.end());
    std::vector<Lobe> lobes;
    lobes.reserve(files.size());
    for (const auto& file : files)
        lobes.push_back(measuredLobe(std::make_shared<const MeasuredGloss>(glossOf(readMerl(file), file))));
    return lobes;
}

float evaluateLobe(const Lobe& lobe, const Vec3& towardLight, const Vec3& towardEye) {
    switch (lobe.kind) {
        case Lobe::Kind::lambert: return lambert(towardLight, towardEye);
        case Lobe::Kind::ggx: return ggx(towardLight, towardEye, lobe.alpha);
        case Lobe::Kind::ggxDielectric: return ggxDielectric(towardLight, towardEye, lobe.alpha);
        case Lobe::Kind::ggxGrazing: return ggxGrazing(towardLight, towardEye, lobe.alpha);
        case Lobe::Kind::cookTorrance: return cookTorrance(towardLight, towardEye, lobe.alpha);
        case Lobe::Kind::ward: return ward(towardLight, towardEye, lobe.alpha);
        case Lobe::Kind::lafortuneBack: return lafortune(towardLight, towardEye, -1, 1, exponentOf(lobe.alpha));
        case Lobe::Kind::lafortuneForward: return lafortune(towardLight, towardEye, 1, 0, exponentOf(lobe.alpha));
        case Lobe::Kind::measured: return lobe.measured ? lobe.measured->evaluate(towardLight, towardEye) : 0.0f;
        case Lobe::Kind::mixture: {
            float sum = 0;
            for (const Lobe& part : lobe.parts) sum += part.fraction * evaluateLobe(part, towardLight, towardEye);
            return sum;
        }
    }
    return 0;
}

float lobeAlbedo(const Lobe& lobe) {
    if (lobe.kind == Lobe::Kind::lambert || lobe.kind == Lobe::Kind::ggx) return 1;
    if (lobe.kind == Lobe::Kind::ggxDielectric) return 0.04f;
    // Towards the normal, over rings of half angles that are dense about it.
    constexpr int rings = 64;
    float sum = 0;
    for (int i = 0; i < rings; ++i) {
        const float fraction = (float(i) + 0.5f) / rings, half = fraction * fraction * 0.25f * pi, theta = 2 * half;
        sum += evaluateLobe(lobe, {std::sin(theta), 0, std::cos(theta)}, {0, 0, 1}) * std::cos(theta) *
               std::sin(theta) * 2 * pi * (pi * fraction / rings);
    }
    return sum;
}

const char* kindName(Lobe::Kind kind) {
    switch (kind) {
        case Lobe::Kind::lambert: return "lambert";
        case Lobe::Kind::ggx: return "ggx";
        case Lobe::Kind::ggxDielectric: return "ggx_dielectric";
        case Lobe::Kind::ggxGrazing: return "ggx_grazing";
        case Lobe::Kind::cookTorrance: return "cook_torrance";
        case Lobe::Kind::ward: return "ward";
        case Lobe::Kind::lafortuneBack: return "lafortune_back";
        case Lobe::Kind::lafortuneForward: return "lafortune_forward";
        case Lobe::Kind::measured: return "measured";
        case Lobe::Kind::mixture: return "mixture";
    }
    return "";
}

}  // namespace relamp
