// A printed sheet whose cameras and shape can be put off by known amounts.
#pragma once
#include <array>

#include "base/random.h"
#include "capture/capture.h"
#include "capture/registration_fix.h"
#include "support/estimates.h"

namespace relamp::test {

/// A sheet of 2 m with a print, photographed from eight sides.
struct ShakenSheet {
    static constexpr int width = 160, height = 120, views = 8;
    Capture capture;
    Scene scene;

    /// `cuts`: into so many strips each way; more of them follow a bend better.
    explicit ShakenSheet(int cuts = 60) {
        scene = sceneOf(sheet({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, cuts, cuts));
        capture.mesh = scene.mesh;
        static const std::vector<View> photographs = photographed();
        capture.views = photographs;
    }

    /// Blotches of 10 to 40 cm.
    static float print(float x, float y) {
        struct Wave {
            float frequency, cosine, sine, phase;
        };
        static const std::array<Wave, 12> waves = [] {
            std::array<Wave, 12> all{};
            for (size_t k = 0; k < all.size(); ++k) {
                const Vec2 r = randomShift(3, k, 0), s = randomShift(3, k, 1);
                const float angle = 2 * pi * r.y;
                all[k] = {15 + 45 * r.x, std::cos(angle), std::sin(angle), 2 * pi * s.x};
            }
            return all;
        }();
        float sum = 0;
        for (const Wave& w : waves) sum += std::sin(w.frequency * (x * w.cosine + y * w.sine) + w.phase);
        return 0.4f * std::exp(0.25f * sum);
    }

    /// The sheet off by `height` at a place.
    static double wave(const Vec3& p) { return 0.006 * std::sin(9 * double(p.x) + 1) * std::cos(8 * double(p.y)); }

    void bend() {
        for (Vec3& p : capture.mesh.positions) p.z += float(wave(p));
        scene = sceneOf(capture.mesh);
        capture.mesh = scene.mesh;
    }
    /// What a visual hull does with a hollow: off by some pixels over a third of the sheet.
    void fillHollow() {
        for (Vec3& p : capture.mesh.positions) p.z += 0.06f * std::exp(-12 * (p.x * p.x + p.y * p.y));
        scene = sceneOf(capture.mesh);
        capture.mesh = scene.mesh;
    }
    /// Cameras off by about `pixels`, each otherwise.
    void shake(double pixels = 1) {
        for (int i = 0; i < views; ++i) {
            const Vec2 a = randomShift(5, uint64_t(i), 0), b = randomShift(5, uint64_t(i), 1);
            const PoseFix off{"", DVec3(a.x - 0.5f, a.y - 0.5f, b.x - 0.5f) * 0.012 * pixels,
                              DVec3(b.y - 0.5f, b.x - 0.5f, a.x - 0.5f) * 0.02 * pixels};
            capture.views[size_t(i)].camera = corrected(capture.views[size_t(i)].camera, off);
        }
    }
    /// Root mean square of where cameras show the flat sheet against where `truth` does, pixels.
    double pixelsFrom(const Capture& truth) const {
        double sum = 0, count = 0;
        for (size_t i = 0; i < capture.views.size(); ++i)
            for (int k = 0; k < 400; ++k) {
                const DVec3 p(-0.7 + 1.4 * (k % 20) / 19, -0.7 + 1.4 * (k / 20) / 19, 0);
                const auto a = capture.views[i].camera.project(p), b = truth.views[i].camera.project(p);
                if (!a || !b) continue;
                sum += double(glm::dot(*a - *b, *a - *b));
                count += 1;
            }
        return std::sqrt(sum / count);
    }
    /// Root mean square over the views of where each shows a place of the flat sheet from where they do on average,
    /// metres: a sheet tells no motion that is common to all.
    double apartFrom(const Capture& truth) const {
        double sum = 0, count = 0;
        for (int k = 0; k < 400; ++k) {
            const DVec3 p(-0.7 + 1.4 * (k % 20) / 19, -0.7 + 1.4 * (k / 20) / 19, 0);
            std::vector<DVec3> shown;
            DVec3 mean(0);
            for (size_t i = 0; i < capture.views.size(); ++i) {
                const Camera& camera = capture.views[i].camera;
                const auto at = truth.views[i].camera.project(p);
                if (!at) continue;
                const DVec3 d(camera.rayDirection(*at)), eye = camera.position();
                shown.push_back(eye - d * (eye.z / d.z));
                mean += shown.back();
            }
            for (const DVec3& s : shown)
                sum += glm::dot(s - mean / double(shown.size()), s - mean / double(shown.size()));
            count += double(shown.size());
        }
        return std::sqrt(sum / count);
    }
    /// Root mean square height over the middle of the sheet, metres.
    double bentBy() const {
        double sum = 0, count = 0;
        for (const Vec3& p : capture.mesh.positions) {
            if (std::abs(p.x) > 0.7f || std::abs(p.y) > 0.7f) continue;
            sum += double(p.z) * double(p.z);
            count += 1;
        }
        return std::sqrt(sum / count);
    }

private:
    static std::vector<View> photographed() {
        std::vector<View> all;
        for (int i = 0; i < views; ++i) {
            const double turn = 2 * double(pi) * i / views;
            View view;
            view.name = std::to_string(i);
            view.camera = cameraAt({1.6 * std::cos(turn), 1.6 * std::sin(turn), 1.6 + 0.3 * (i % 3)}, {0, 0, 0}, width,
                                   height, 170);
            view.image = Image(width, height);
            for (int y = 0; y < height; ++y)
                for (int x = 0; x < width; ++x) view.image.at(x, y) = pixel(view.camera, x, y);
            all.push_back(std::move(view));
        }
        return all;
    }
    static Rgb pixel(const Camera& camera, int x, int y) {
        float sum = 0;
        for (int i = 0; i < 9; ++i) {
            const Vec3 d =
                camera.rayDirection(Vec2(float(x) + (float(i % 3) + 0.5f) / 3, float(y) + (float(i / 3) + 0.5f) / 3));
            const Vec3 p = Vec3(camera.position()) - d * (float(camera.position().z) / d.z);
            if (std::abs(p.x) <= 1 && std::abs(p.y) <= 1) sum += print(p.x, p.y) / 9;
        }
        return Rgb(sum);
    }
};

}  // namespace relamp::test
