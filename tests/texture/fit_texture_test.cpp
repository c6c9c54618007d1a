#include "texture/fit_texture.h"

#include <gtest/gtest.h>

#include "base/parallel.h"
#include "base/random.h"
#include "support/estimates.h"
#include "support/stopping.h"
#include "texture/seams.h"

namespace relamp {
namespace {

/// A coarse sheet with a fine print, photographed from several sides under even light.
struct PrintedSheet {
    Capture capture;
    Scene scene;
    Estimate estimate;

    /// Stripes of 8 cm, wider than two pixels and much narrower than the 50 cm between vertices.
    static Rgb print(const Vec3& p) {
        const float wave = 0.5f + 0.5f * std::sin(2 * pi * p.x / 0.08f);
        return glm::mix(Rgb(0.15f, 0.2f, 0.3f), Rgb(0.75f, 0.7f, 0.5f), wave * wave);
    }

    explicit PrintedSheet(bool printed = true) {
        scene = test::sceneOf(test::sheet({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, 4, 4));
        capture.mesh = scene.mesh;
        const Rgb mean = printed ? Rgb(0.375f, 0.3875f, 0.375f) : Rgb(0.5f);
        estimate = test::matteEstimate(scene, mean, Rgb(1));
        estimate.surfaceLight.white = {std::vector<Rgb>(scene.mesh.vertexCount(), light)};
        estimate.surfaceLight.coating = {std::vector<Rgb>(scene.mesh.vertexCount(), Rgb(0))};
        for (int i = 0; i < 6; ++i) {
            const double turn = 1.1 * i;
            View view;
            view.name = std::to_string(i);
            view.camera = test::cameraAt({1.2 * std::cos(turn), 1.2 * std::sin(turn), 2.4}, {0, 0, 0}, 128, 96, 128);
            view.image = Image(128, 96);
            for (int y = 0; y < 96; ++y)
                for (int x = 0; x < 128; ++x) view.image.at(x, y) = pixel(view.camera, x, y, printed);
            capture.views.push_back(std::move(view));
        }
    }

    TextureFit fit(const TextureOptions& options = {}) const {
        Progress progress;
        return fitTexture(capture, scene, estimate, options, progress);
    }

    /// Root mean square error over middle of the sheet.
    static double errorOf(const std::function<Rgb(uint32_t, const Vec2&)>& albedo, const Mesh& mesh) {
        double sum = 0, count = 0;
        for (uint32_t t = 0; t < mesh.triangles.size(); ++t)
            for (int i = 0; i < 200; ++i) {
                const Vec2 r = r2Point(uint32_t(i), Vec2(0));
                const Vec2 b = r.x + r.y <= 1 ? r : Vec2(1 - r.x, 1 - r.y);
                const Triangle& c = mesh.triangles[t];
                const Vec3 p =
                    (1 - b.x - b.y) * mesh.positions[c[0]] + b.x * mesh.positions[c[1]] + b.y * mesh.positions[c[2]];
                if (std::abs(p.x) > 0.7f || std::abs(p.y) > 0.7f) continue;
                const Rgb d = albedo(t, b) - print(p);
                sum += double(glm::dot(d, d)) / 3;
                ++count;
            }
        return std::sqrt(sum / count);
    }

    static constexpr Rgb light{1.5f, 1.2f, 0.9f};

private:
    /// A pixel by many rays on the plane, by itself.
    static Rgb pixel(const Camera& camera, int x, int y, bool printed) {
        Rgb sum(0);
        for (int i = 0; i < 64; ++i) {
            const Vec3 d =
                camera.rayDirection(Vec2(float(x) + (float(i % 8) + 0.5f) / 8, float(y) + (float(i / 8) + 0.5f) / 8));
            const Vec3 p = Vec3(camera.position()) - d * (float(camera.position().z) / d.z);
            if (std::abs(p.x) <= 1 && std::abs(p.y) <= 1) sum += (printed ? print(p) : Rgb(0.5f)) * light / 64.0f;
        }
        return sum;
    }
};

TEST(FitTexture, FindsAPrintThatVerticesMiss) {
    const PrintedSheet sheet;
    const TextureFit fit = sheet.fit();
    ASSERT_TRUE(fit.texture) << fit.why;
    EXPECT_GT(fit.gain.percent(), 80);
    const Mesh& mesh = sheet.scene.mesh;
    const double vertices = PrintedSheet::errorOf([](uint32_t, const Vec2&) { return Rgb(0.375f); }, mesh),
                 texels = PrintedSheet::errorOf(
                     [&](uint32_t t, const Vec2&b) { return fit.texture->at(fit.texture->place(t, b)); }, mesh);
    EXPECT_GT(vertices, 0.15);
    ASSERT_TRUE(fit.without);
    EXPECT_NE(fit.without->texels, fit.texture->texels);
    EXPECT_LT(texels, 0.03);  // stripes of two and a half pixels through a pixel's own blur
}

TEST(FitTexture, LiesAsTheMeshsOwnTexcoordsSay) {
    PrintedSheet sheet;
    std::vector<TexturedFace> faces;
    for (const Triangle& t : sheet.scene.mesh.triangles) {
        TexturedFace face{t, {}};
        for (size_t k = 0; k < 3; ++k) {
            const Vec3& p = sheet.scene.mesh.positions[t[k]];
            face.texcoords[k] = Vec2(0.5f) + 0.45f * Vec2(p.y, p.x);
        }
        faces.push_back(face);
    }
    sheet.capture.texcoords = std::make_shared<const std::vector<TexturedFace>>(faces);
    const TextureFit fit = sheet.fit();
    ASSERT_TRUE(fit.texture) << fit.why;
    EXPECT_TRUE(fit.own) << fit.whyNotOwn;
    for (uint32_t t = 0; t < faces.size(); ++t)
        for (size_t k = 0; k < 3; ++k) {
            const Vec2 place = fit.texture->corners[t][k] / float(fit.texture->width);
            EXPECT_LT(glm::distance(Vec2(place.x, 1 - place.y), faces[t].texcoords[k]), 1e-6f);
        }
    const double texels = PrintedSheet::errorOf(
        [&](uint32_t t, const Vec2& b) { return fit.texture->at(fit.texture->place(t, b)); }, sheet.scene.mesh);
    EXPECT_LT(texels, 0.03);
    // Where they lie on one another, charts of our making do.
    for (TexturedFace& face : faces)
        for (Vec2& place : face.texcoords) place.x = std::abs(place.x - 0.5f);
    sheet.capture.texcoords = std::make_shared<const std::vector<TexturedFace>>(faces);
    const TextureFit other = sheet.fit();
    ASSERT_TRUE(other.texture);
    EXPECT_FALSE(other.own);
    EXPECT_EQ(other.whyNotOwn, "triangles lie on one another in the image");
}

TEST(FitTexture, OfAPlainSheetIsNotWorthIt) {
    const TextureFit fit = PrintedSheet(false).fit();
    EXPECT_FALSE(fit.texture);
    EXPECT_FALSE(fit.why.empty());
    TextureOptions always;
    always.always = true;
    const TextureFit asked = PrintedSheet(false).fit(always);
    ASSERT_TRUE(asked.texture);
    for (uint32_t t = 0; t < 8; ++t)
        EXPECT_LT(glm::length(asked.texture->at(asked.texture->place(t, {0.3f, 0.3f})) - Rgb(0.5f)), 0.005f);
}

TEST(FitTexture, WhatOneViewAloneShowsIsNoPrint) {
    PrintedSheet sheet;
    // Someone's hand in one photograph.
    for (int y = 40; y < 56; ++y)
        for (int x = 56; x < 72; ++x) sheet.capture.views[1].image.at(x, y) = Rgb(0.02f);
    const TextureFit fit = sheet.fit();
    ASSERT_TRUE(fit.texture);
    const double texels = PrintedSheet::errorOf(
        [&](uint32_t t, const Vec2& b) { return fit.texture->at(fit.texture->place(t, b)); }, sheet.scene.mesh);
    EXPECT_LT(texels, 0.04);
}

/// A ball lies in many charts: both sides of a seam say the same.
TEST(FitTexture, SeamsBetweenChartsAreNotSeen) {
    Capture capture;
    const Scene scene = test::sceneOf(test::ball({0, 0, 0}, 1, 16, 32));
    capture.mesh = scene.mesh;
    Estimate estimate = test::matteEstimate(scene, Rgb(0.5f), Rgb(1));
    estimate.surfaceLight.white = {std::vector<Rgb>(scene.mesh.vertexCount(), Rgb(1))};
    estimate.surfaceLight.coating = {std::vector<Rgb>(scene.mesh.vertexCount(), Rgb(0))};
    const auto paint = [](const Vec3& p) {
        return Rgb(0.5f) + 0.2f * Rgb(std::sin(5 * p.x), std::sin(4 * p.y), std::sin(4 * p.z));
    };
    for (int i = 0; i < 8; ++i) {
        const double turn = 0.8 * i, height = i % 2 ? 1.6 : -1.6;
        View view;
        view.name = std::to_string(i);
        view.camera = test::cameraAt({3 * std::cos(turn), 3 * std::sin(turn), height}, {0, 0, 0}, 160, 160, 200);
        view.image = Image(160, 160);
        for (int y = 0; y < 160; ++y)
            for (int x = 0; x < 160; ++x) {
                const Hit hit =
                    scene.tracer->closest({Vec3(view.camera.position()),
                                           view.camera.rayDirection({float(x) + 0.5f, float(y) + 0.5f}), 0, 1e30f});
                if (hit) view.image.at(x, y) = paint(scene.pointOf(hit));
            }
        capture.views.push_back(std::move(view));
    }
    Progress progress;
    const TextureFit fit = fitTexture(capture, scene, estimate, {}, progress);
    ASSERT_TRUE(fit.texture) << fit.why;
    EXPECT_GT(fit.charts, 4u);
    double difference = 0, most = 0;
    // Between the places that were levelled, too.
    const std::vector<SeamPoint> seams = seamPoints(scene.mesh, *fit.texture, 5);
    for (const SeamPoint& p : seams) {
        const double apart =
            double(glm::length(fit.texture->at(p.here) - fit.texture->at(p.there))) / (0.5 * sqrt(3.0));
        difference += apart / double(seams.size());
        most = std::max(most, apart);
    }
    EXPECT_GT(seams.size(), 100u);
    EXPECT_LT(difference, 0.002);
    EXPECT_LT(most, 0.01);
}

/// One corner of the sheet is masked in every photograph.
TEST(FitTexture, ConfidenceTellsWhatNoPhotographShows) {
    PrintedSheet sheet;
    sheet.estimate.reflectance.confidence.assign(sheet.scene.mesh.vertexCount(), 1);
    // Views do not show the pixels that look at this corner of the sheet.
    const auto hidden = [](const Vec3& p) { return p.x > 0.3f && p.y > 0.3f; };
    for (View& view : sheet.capture.views) {
        view.image.usable.assign(view.image.pixels.size(), 1);
        for (int y = 0; y < view.image.height; ++y)
            for (int x = 0; x < view.image.width; ++x) {
                const Vec3 d = view.camera.rayDirection(Vec2(float(x) + 0.5f, float(y) + 0.5f));
                const Vec3 p = Vec3(view.camera.position()) - d * (float(view.camera.position().z) / d.z);
                if (hidden(p)) view.image.usable[size_t(y * view.image.width + x)] = 0;
            }
    }
    for (size_t v = 0; v < sheet.scene.mesh.vertexCount(); ++v)
        if (hidden(sheet.scene.mesh.positions[v])) sheet.estimate.reflectance.confidence[v] = 0;
    const TextureFit fit = sheet.fit();
    ASSERT_TRUE(fit.texture) << fit.why;
    ASSERT_EQ(fit.texture->confidence.size(), fit.texture->texels.size());
    const Mesh& mesh = sheet.scene.mesh;
    int unseen = 0, seen = 0;
    for (uint32_t t = 0; t < mesh.triangles.size(); ++t)
        for (uint32_t i = 0; i < 100; ++i) {
            const Vec2 r = r2Point(i, Vec2(0)), b = r.x + r.y <= 1 ? r : Vec2(1 - r.x, 1 - r.y);
            const Triangle& c = mesh.triangles[t];
            const Vec3 p =
                (1 - b.x - b.y) * mesh.positions[c[0]] + b.x * mesh.positions[c[1]] + b.y * mesh.positions[c[2]];
            const float confidence = fit.texture->confidenceAt(fit.texture->place(t, b));
            if (p.x > 0.55f && p.y > 0.55f) {
                EXPECT_LT(confidence, 0.2f) << p.x << " " << p.y;
                ++unseen;
            }
            if (std::abs(p.x) < 0.9f && p.y < 0.1f && p.y > -0.9f) {
                EXPECT_GT(confidence, 0.7f) << p.x << " " << p.y;
                ++seen;
            }
        }
    EXPECT_GT(unseen, 20);
    EXPECT_GT(seen, 500);
}

TEST(FitTexture, SameBitsOnAnyNumberOfThreads) {
    const PrintedSheet sheet;
    std::vector<Rgb> one;
    {
        const ThreadLimit limit(1);
        one = sheet.fit().texture->texels;
    }
    const ThreadLimit limit(3);
    EXPECT_EQ(one, sheet.fit().texture->texels);
}

TEST(FitTexture, WithoutKnownLightThereIsNone) {
    PrintedSheet sheet;
    sheet.estimate.surfaceLight = {};
    EXPECT_FALSE(sheet.fit().texture);
    PrintedSheet metal;
    metal.estimate.reflectance.weight[0].assign(metal.scene.mesh.vertexCount(), Rgb(0));
    EXPECT_FALSE(metal.fit().texture);
}

TEST(FitTexture, StopsHalfWay) {
    const PrintedSheet sheet;
    test::expectStopsHalfWay(
        [&](Progress& progress) { fitTexture(sheet.capture, sheet.scene, sheet.estimate, {}, progress); });
}

}  // namespace
}  // namespace relamp
