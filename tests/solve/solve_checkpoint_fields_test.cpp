// Every field of a checkpoint comes back. A field that is added to one of these structs does not compile here until it
// is told of.
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <tuple>

#include "solve/solve_checkpoint.h"
#include "support/temporary_folder.h"

namespace relamp {
namespace {

// What is not named in a tie is made again when a solve goes on.
auto fieldsOf(EmitterEvidence& e) {
    auto& [a, b, c, d, g, h, i, j, k, l] = e;
    return std::tie(a, b, c, d, g, h, i, j, k, l);
}
auto fieldsOf(EmissionLobe& lobe) {
    auto& [axis, power] = lobe;
    return std::tie(axis, power);
}
auto fieldsOf(EmitterCluster& e) {
    auto& [id, vertices, triangles, radiance, sigma, twoSided, fitted, unobserved, position, centroid, normal, area,
           evidence, emission, pattern, lobe, inState] = e;
    return std::tie(id, vertices, triangles, radiance, sigma, twoSided, fitted, unobserved, position, centroid, normal,
                    area, evidence, emission, lobe, inState);
}
auto fieldsOf(RejectedPatch& r) {
    auto& [centroid, radiance, evidence, reason, besideBall] = r;
    return std::tie(centroid, radiance, evidence, reason);
}
auto fieldsOf(EmitterClusters& c) {
    auto& [emitters, candidates, rejected, ofVertex, ofTriangle] = c;
    return std::tie(emitters, rejected);
}
auto fieldsOf(Leaf& leaf) {
    auto& [level, x, y, environment] = leaf;
    return std::tie(level, x, y, environment);
}
auto fieldsOf(Lobe& lobe) {
    auto& [kind, alpha, name, measured, parts, fraction] = lobe;
    return std::tie(kind, alpha, name, parts, fraction);
}
auto fieldsOf(GlossyObservation& observation) {
    auto& [vertex, view, radiance, sigma, towardEye, state] = observation;
    return std::tie(vertex, view, radiance, sigma, towardEye, state);
}
auto fieldsOf(ComponentGloss& g) {
    auto& [component, lobe, weight, matte, residual, residualMatte, observations] = g;
    return std::tie(component, lobe, weight, matte, residual, residualMatte, observations);
}
auto fieldsOf(PriorStrength::Trial& t) {
    auto& [factor, misfit, error] = t;
    return std::tie(factor, misfit, error);
}
auto fieldsOf(PriorStrength& p) {
    auto& [factor, chosenBy, trials] = p;
    return std::tie(factor, chosenBy, trials);
}
auto fieldsOf(PaletteColour& p) {
    auto& [albedo, fraction] = p;
    return std::tie(albedo, fraction);
}
auto fieldsOf(TimelineEntry& t) {
    auto& [seconds, stage, iteration, objective, rmse] = t;
    return std::tie(seconds, stage, iteration, objective, rmse);
}
auto fieldsOf(PlanChoices& p) {
    auto& [a, b, c, d, e, g, h, i, j, k, l, m] = p;
    return std::tie(a, b, c, d, e, g, h, i, j, k, l, m);
}
auto fieldsOf(PlannedStage& s) {
    auto& [stage, predictedSeconds, measuredSeconds, predictedMib, measuredMib] = s;
    return std::tie(stage, predictedSeconds, measuredSeconds, predictedMib, measuredMib);
}
auto fieldsOf(PlannedOmission& o) {
    auto& [what, reason, savedSeconds, savedMib] = o;
    return std::tie(what, reason, savedSeconds, savedMib);
}
auto fieldsOf(SuspectedLight& s) {
    auto& [position, gain, certainty, fraction] = s;
    return std::tie(position, gain, certainty, fraction);
}
auto fieldsOf(SolvePlan& p) {
    auto& [choices, stages, leftOut, planningSeconds, suspectedLight, observed, light] = p;
    return std::tie(choices, stages, leftOut, planningSeconds, suspectedLight);
}
auto fieldsOf(SolveCheckpoint& c) {
    auto& [step, between, seconds, clusters, suspect, leaves, leafRadiance, emitterRadiance, environmentBlack, refined,
           bounceKept, noMetals, backgroundRefuted, visibilityStep, refinedMisfit, bouncedFraction, noBounceBecause,
           vertexBounce, outgoing, matteRadiance, matteSigma, lightSmoothness, albedoSmoothness, gloss, firstGloss,
           metalsHeard, metalsJoined, glossSettled, lightUnfinished, information, informationOfObservations,
           informationSeen, albedo, confidence, palette, timeline, kktResidual, plan, patchUsed] = c;
    return std::tie(step, between, seconds, clusters, suspect, leaves, leafRadiance, emitterRadiance, environmentBlack,
                    refined, bounceKept, noMetals, backgroundRefuted, visibilityStep, refinedMisfit, bouncedFraction,
                    noBounceBecause, vertexBounce, outgoing, matteRadiance, matteSigma, lightSmoothness,
                    albedoSmoothness, gloss, firstGloss, metalsHeard, metalsJoined, glossSettled, lightUnfinished,
                    information, informationOfObservations, informationSeen, albedo, confidence, palette, timeline,
                    kktResidual, plan, patchUsed);
}

/// Makes every field another than it is by default: lists get one entry.
struct Fill {
    int n = 0;
    void operator()(bool& value) { value = !value; }
    void operator()(uint8_t& value) { value = uint8_t(value + 1); }
    void operator()(uint16_t& value) { value = uint16_t(++n); }
    void operator()(uint32_t& value) { value = uint32_t(++n); }
    void operator()(int& value) { value = ++n; }
    void operator()(size_t& value) { value = size_t(++n); }
    void operator()(float& value) { value += float(++n); }
    void operator()(double& value) { value += ++n; }
    void operator()(Vec3& value) { value += Vec3(float(++n)); }
    void operator()(DVec3& value) { value += DVec3(++n); }
    void operator()(std::string& value) { value += std::to_string(++n); }
    void operator()(Stage& value) { value = Stage::light; }
    void operator()(Omission& value) { value = Omission::triangles; }
    void operator()(Lobe::Kind& value) { value = Lobe::Kind::mixture; }
    template <class T>
    void operator()(std::vector<T>& values) {
        (*this)(values.emplace_back());
    }
    void operator()(std::vector<Lobe>& parts) {
        Lobe& part = parts.emplace_back();
        part.kind = Lobe::Kind::ward;
        (*this)(part.alpha);
        (*this)(part.name);
        (*this)(part.fraction);
    }
    template <class T>
    void operator()(std::optional<T>& value) {
        (*this)(value.emplace());
    }
    template <class T, size_t N>
    void operator()(T (&values)[N]) {
        for (T& value : values) (*this)(value);
    }
    template <class T>
    requires requires(T& value) { fieldsOf(value); }
    void operator()(T& value) {
        std::apply([&](auto&... field) { ((*this)(field), ...); }, fieldsOf(value));
    }
};

/// How many of the numbers and texts in two structs are equal, and where they are not.
struct Compare {
    size_t equal = 0;
    std::vector<std::string> differ;
    template <class T>
    void operator()(T& a, T& b, const std::string& where) {
        if constexpr (std::is_same_v<T, Vec3> || std::is_same_v<T, DVec3> || std::is_same_v<T, std::string> ||
                      std::is_arithmetic_v<T> || std::is_enum_v<T>) {
            if (a == b) ++equal;
            else differ.push_back(where);
        } else if constexpr (std::is_array_v<T>) {
            for (size_t i = 0; i < std::extent_v<T>; ++i) (*this)(a[i], b[i], fmt::format("{}[{}]", where, i));
        } else if constexpr (requires { a.has_value(); }) {
            if (a && b) (*this)(*a, *b, where);
            else differ.push_back(where);
        } else if constexpr (requires { a.push_back(a[0]); }) {
            if (a.size() != b.size()) differ.push_back(where + ".size");
            for (size_t i = 0; i < std::min(a.size(), b.size()); ++i)
                (*this)(a[i], b[i], fmt::format("{}[{}]", where, i));
        } else {
            auto x = fieldsOf(a), y = fieldsOf(b);
            [&]<size_t... I>(std::index_sequence<I...>) {
                ((*this)(std::get<I>(x), std::get<I>(y), fmt::format("{}.{}", where, I)), ...);
            }
            (std::make_index_sequence<std::tuple_size_v<decltype(x)>>());
        }
    }
};

SolveCheckpoint filledCheckpoint() {
    SolveCheckpoint checkpoint;
    Fill{}(checkpoint);
    checkpoint.information = {1, 2, 3, 4, 5, 6};  // of one unknown in three channels
    return checkpoint;
}

}  // namespace

TEST(SolveCheckpoint, EveryFieldComesBack) {
    SolveCheckpoint written = filledCheckpoint(), read = checkpointFromBytes(checkpointBytes(written)), none;
    Compare untouched;
    untouched(written, none, "checkpoint");
    EXPECT_EQ(untouched.equal, 0u) << "a field was not filled";
    Compare compare;
    compare(written, read, "checkpoint");
    EXPECT_EQ(compare.differ, std::vector<std::string>{});
    EXPECT_GT(compare.equal, 120u);
}

/// RELAMP_WRITE_SEEDS=1 writes it anew, after a field was added.
TEST(SolveCheckpoint, TheFuzzSeedHoldsEveryField) {
    const std::string file = std::string(RELAMP_SOURCE_DIR) + "/tests/fuzz/corpus/checkpoint/every-field";
    const std::string bytes = checkpointBytes(filledCheckpoint());
    if (std::getenv("RELAMP_WRITE_SEEDS")) std::ofstream(file, std::ios::binary) << bytes;
    EXPECT_TRUE(test::TemporaryFolder::read(file) == bytes) << file << " is of another layout";
}

}  // namespace relamp
