#include "solve/gloss/lobe_choice.h"

#include <gtest/gtest.h>

#include "base/parallel.h"
#include "base/random.h"
#include "solve/gloss/arriving_light.h"
#include "support/shapes.h"

namespace relamp {
namespace {

constexpr size_t vertices = 150, observationsEach = 6;

float random(uint64_t a, uint64_t b) { return unitFloat(mixBits(mixBits(a) ^ b)); }

struct Problem {
    std::vector<Lobe> lobes = wideBasis().lobes;
    std::vector<std::vector<Rgb>> responses;
    std::vector<GlossyObservation> observations;

    Problem() {
        for (uint32_t v = 0; v < vertices; ++v)
            for (uint32_t i = 0; i < observationsEach; ++i)
                observations.push_back({v, i, Rgb(0), 0.01f, Vec3(0, 0, 1)});
        // Each lobe answers to a few lights in its own way, neighbours alike: evaluated for made-up directions.
        responses.assign(lobes.size(), std::vector<Rgb>(observations.size(), Rgb(0)));
        for (size_t k = 1; k < lobes.size(); ++k)
            for (size_t i = 0; i < observations.size(); ++i)
                for (uint64_t l = 0; l < 12; ++l) {
                    const auto direction = [&](uint64_t salt) {
                        const float z = 0.25f + 0.75f * random(salt, 1), phi = 2 * pi * random(salt, 2),
                                    r = std::sqrt(1 - z * z);
                        return Vec3(r * std::cos(phi), r * std::sin(phi), z);
                    };
                    const Vec3 eye = direction(i * 977 + 5), light = direction(i / observationsEach * 31337 + l);
                    responses[k][i] += 0.4f * evaluateLobe(lobes[k], light, eye) * light.z * Rgb(1, 0.8f, 0.9f);
                }
    }
    size_t named(const std::string& name) const {
        for (size_t k = 0; k < lobes.size(); ++k)
            if (lobes[k].name == name) return k;
        return 0;
    }
    void photograph(const std::vector<std::pair<std::string, float>>& mixture, bool matte, float outliers = 0) {
        for (size_t i = 0; i < observations.size(); ++i) {
            Rgb y = matte ? Rgb(0.3f + random(observations[i].vertex, 3)) : Rgb(0);
            for (const auto& [name, weight] : mixture) y += weight * responses[named(name)][i];
            for (int c = 0; c < 3; ++c) y[c] += 0.02f * (random(i, uint64_t(c) + 10) - 0.5f);
            if (random(i, 20) < outliers) y *= 3;
            observations[i].radiance = y;
        }
    }
};

TEST(ChooseLobes, FindsTheLobeThatWasThere) {
    for (const char* name : {"ggx roughness 0.38", "ward roughness 0.25", "lafortune back 4"}) {
        Problem p;
        ASSERT_GT(p.named(name), 0u) << name;
        p.photograph({{name, 0.8f}}, true);
        const std::vector<LobeChoice> choices = chooseLobes(p.lobes, p.responses, p.observations, true, 3);
        ASSERT_FALSE(choices.empty());
        EXPECT_EQ(choices[0].lobe.name, name);
    }
}

TEST(ChooseLobes, FindsAMixtureWithItsFractions) {
    Problem p;
    p.photograph({{"ggx roughness 0.17", 0.5f}, {"lafortune back 2", 0.25f}}, true, 0.03f);
    const std::vector<LobeChoice> choices = chooseLobes(p.lobes, p.responses, p.observations, true, 2);
    ASSERT_EQ(choices.size(), 2u);
    const Lobe& mixture = choices[1].lobe;
    ASSERT_EQ(mixture.parts.size(), 2u);
    EXPECT_LT(choices[1].residual, 0.3 * choices[0].residual);
    EXPECT_TRUE(std::any_of(mixture.parts.begin(), mixture.parts.end(),
                            [](const Lobe& s) { return s.name == "ggx roughness 0.17" && s.fraction == 1; }));
    EXPECT_TRUE(std::any_of(mixture.parts.begin(), mixture.parts.end(), [](const Lobe& s) {
        return s.name == "lafortune back 2" && std::abs(s.fraction - 0.5f) < 0.1f;
    }));
}

TEST(ChooseLobes, AMetalNeedsNoMattePart) {
    Problem p;
    p.photograph({{"ggx roughness 0.38", 0.8f}}, false);
    const std::vector<LobeChoice> metal = chooseLobes(p.lobes, p.responses, p.observations, false, 1);
    ASSERT_FALSE(metal.empty());
    EXPECT_EQ(metal[0].lobe.name, "ggx roughness 0.38");
}

TEST(ChooseLobes, SaysNothingOfObservationsThatAreBlack) {
    Problem p;
    EXPECT_TRUE(chooseLobes(p.lobes, p.responses, p.observations, false, 3).empty());
}

/// A ball on which every direction is seen, under environment that change smoothly.
struct Ball {
    Scene scene;
    Lighting lighting;
    std::vector<GlossyObservation> observations;

    Ball() {
        Mesh mesh;
        for (int i = 0; i < 300; ++i) {
            const Vec2 u = r2Point(uint32_t(i), Vec2(0));
            const float z = 2 * u.x - 1, phi = 2 * pi * u.y, r = std::sqrt(1 - z * z);
            const Vec3 n(r * std::cos(phi), r * std::sin(phi), z),
                side = glm::normalize(glm::cross(n, std::abs(n.z) < 0.9f ? Vec3(0, 0, 1) : Vec3(1, 0, 0)));
            // Small triangles, apart from each other.
            const uint32_t first = uint32_t(mesh.positions.size());
            for (const Vec3& p : {n, n + 1e-3f * side, n + 1e-3f * glm::cross(n, side)}) {
                mesh.positions.push_back(p);
                mesh.normals.push_back(n);
            }
            mesh.triangles.push_back({first, first + 1, first + 2});
        }
        scene = test::sceneOf(mesh);
        lighting.leaves = LightLeaves::uniform(4);
        for (size_t i = 0; i < lighting.leaves.size(); ++i) {
            const Vec3 d = lighting.leaves.direction(i, Vec2(0.5f));
            lighting.leafRadiance.push_back(Rgb(1.5f + d.x + 0.3f * d.z, 1, 1 - 0.5f * d.y));
        }
        for (uint32_t v = 0; v < 300; ++v) {
            GlossyObservation observation;
            observation.vertex = 3 * v;
            observation.sigma = 0.01f;
            observation.towardEye = glm::normalize(
                scene.mesh.normals[3 * v] + 0.7f * Vec3(random(v, 1) - 0.5f, random(v, 2) - 0.5f, random(v, 3) - 0.5f));
            observations.push_back(observation);
        }
    }
};

TEST(LobeResponses, AreWhatTheRowsOfEachLobeSay) {
    const Ball ball;
    Progress progress;
    LobeRowOptions options;
    options.lobeSamples = 512;
    options.cosineSamples = 256;
    const std::vector<Lobe> lobes = wideBasis().lobes;
    const auto responses =
        lobeResponses(ball.scene, {}, {}, ball.lighting, lobes, ball.observations, options, progress);
    for (const char* name :
         {"ggx roughness 0.17", "ggx dielectric roughness 0.38", "ward roughness 0.25", "lafortune back 2"}) {
        const auto k = size_t(std::find_if(lobes.begin(), lobes.end(), [&](const Lobe& l) { return l.name == name; }) -
                              lobes.begin());
        ASSERT_LT(k, lobes.size()) << name;
        const InfluenceMatrix rows =
            glossyRows(ball.scene, {}, {}, ball.lighting.leaves, lobes[k], ball.observations, options, progress);
        double difference = 0, size = 0;
        for (size_t i = 0; i < ball.observations.size(); ++i) {
            Rgb y(0);
            for (size_t j = 0; j < ball.lighting.leaves.size(); ++j)
                y += rows.row(i)[j] * ball.lighting.leafRadiance[j];
            difference += double(glm::dot(y - responses[k][i], y - responses[k][i]));
            size += double(glm::dot(y, y));
        }
        EXPECT_LT(std::sqrt(difference / size), 0.04) << name;
    }
}

TEST(LobeResponses, SameBitsOnOneAndManyThreads) {
    const Ball ball;
    const std::vector<Lobe> lobes = wideBasis().lobes;
    const auto all = [&](int threads) {
        const ThreadLimit limit(threads);
        Progress progress;
        return lobeResponses(ball.scene, {}, {}, ball.lighting, lobes, ball.observations, {}, progress);
    };
    EXPECT_EQ(all(1), all(4));
}

}  // namespace
}  // namespace relamp
