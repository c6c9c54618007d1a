// A surface of two colours under a red lamp and a blue sky: leans of its normals come out of its hue.
#include "solve/registration/hue_normals.h"

#include <gtest/gtest.h>

#include "base/random.h"
#include "support/estimates.h"

namespace relamp {
namespace {

constexpr int leanCuts = 60;

/// A square metre, and something ten metres away: relief is small beside the scene.
Scene leanSheet() {
    Mesh mesh = test::sheet({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, leanCuts, leanCuts);
    test::append(mesh, test::sheet({7, 7, 0}, {0.1f, 0, 0}, {0, 0.1f, 0}));
    return test::sceneOf(mesh);
}

struct LeantSheet {
    Scene scene = leanSheet();
    std::vector<HueSample> samples;
    std::vector<float> truth;

    /// `relief`: radians. The right half has `other` times the albedo.
    explicit LeantSheet(float relief, const Rgb& other = Rgb(1)) {
        for (uint32_t v = 0; v < scene.mesh.vertexCount(); ++v) {
            const Vec3 p = scene.mesh.positions[v];
            if (p.x > 2) continue;
            HueSample s;
            s.vertex = v;
            s.sigma = 0.005f;
            s.tangents[0] = {1, 0, 0};
            s.tangents[1] = {0, 1, 0};
            s.change[0] = {1.0f, 0.2f, 0.1f};  // the lamp stands at +x
            s.change[1] = Rgb(0.1f);
            truth.push_back(relief * std::sin(2 * pi * 7 * p.x) * std::cos(2 * pi * 5 * p.y));
            const Rgb own = Rgb(0.6f, 0.5f, 0.4f) * (p.x > 0.5f ? other : Rgb(1));
            const Vec2 noise = randomShift(5, v, 0);
            for (int c = 0; c < 3; ++c)
                s.albedo[c] = own[c] * std::exp(s.change[0][c] * truth.back() + 0.01f * (noise[c % 2] - 0.5f));
            samples.push_back(s);
        }
    }

    /// Root mean square of what leans towards x are off by.
    double error() const {
        const std::vector<Vec2> leans = hueLeans(scene, samples);
        double squares = 0;
        for (size_t i = 0; i < leans.size(); ++i) squares += std::pow(double(leans[i].x - truth[i]), 2);
        return std::sqrt(squares / double(leans.size()));
    }
};

TEST(HueLeans, AreThoseOfTheRelief) {
    constexpr double relief = 0.05, rms = relief / 2;
    EXPECT_LT(LeantSheet(float(relief)).error(), 0.5 * rms);
    for (const Rgb& other : {Rgb(0.3f, 0.8f, 1.5f), Rgb(0.6f, 0.9f, 1)})
        EXPECT_LT(LeantSheet(float(relief), other).error(), 0.6 * rms) << "a border of materials is none";
}

TEST(HueLeans, AreNoneOnAFlatSheet) {
    EXPECT_LT(LeantSheet(0).error(), 0.006);
    for (const Rgb& other : {Rgb(0.3f, 0.8f, 1.5f), Rgb(0.6f, 0.9f, 1)}) EXPECT_LT(LeantSheet(0, other).error(), 0.008);
}

TEST(HueLeans, AreNoneWhereLightHasOneHue) {
    LeantSheet sheet(0.05f);
    for (HueSample& s : sheet.samples) s.change[0] = s.change[1] = Rgb(0.5f);
    for (const Vec2& lean : hueLeans(sheet.scene, sheet.samples)) EXPECT_EQ(lean, Vec2(0));
    EXPECT_TRUE(hueLeans(sheet.scene, {}).empty());
}

}  // namespace
}  // namespace relamp
