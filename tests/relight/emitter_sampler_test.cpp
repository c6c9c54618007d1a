#include "relight/emitter_sampler.h"

#include <gtest/gtest.h>

#include "base/random.h"

namespace relamp {
namespace {

class Surface {
public:
    EmitterSurface surface;

    void triangle(Vec3 a, Vec3 b, Vec3 c) {
        EmitterSurface& s = surface;
        const Vec3 centre = (a + b + c) / 3.0f, n = glm::cross(b - a, c - a);
        float radius = 0;
        for (const Vec3& p : {a, b, c}) radius = std::max(radius, glm::length(p - centre));
        s.corners.push_back({a, b, c});
        s.centres.push_back(centre);
        s.normals.push_back(glm::normalize(n));
        s.areas.push_back(glm::length(n) / 2);
        s.radii.push_back(radius);
        s.cumulativeArea.push_back(s.area() + s.areas.back());
        s.radius = std::max(s.radius, glm::length(centre) + radius);
    }
    /// `pieces` x `pieces` squares, each of two triangles; faces cross(u, v).
    void rectangle(Vec3 corner, Vec3 u, Vec3 v, int pieces) {
        u /= float(pieces);
        v /= float(pieces);
        for (int i = 0; i < pieces; ++i)
            for (int k = 0; k < pieces; ++k) {
                const Vec3 o = corner + float(i) * u + float(k) * v;
                triangle(o, o + u, o + u + v);
                triangle(o, o + u + v, o + v);
            }
    }
    /// A box about the origin.
    void box(Vec3 size, int pieces) {
        const Vec3 x(size.x, 0, 0), y(0, size.y, 0), z(0, 0, size.z), o = -0.5f * size;
        rectangle(o, y, x, pieces);
        rectangle(o + z, x, y, pieces);
        rectangle(o, x, z, pieces);
        rectangle(o + y, z, x, pieces);
        rectangle(o, z, y, pieces);
        rectangle(o + x, y, z, pieces);
    }
};

struct FormFactor {
    double mean = 0, deviation = 0;  // of one sample, relative
    double exact = 0;
};

/// The form factor of a convex surface from samples, and in closed form.
FormFactor formFactor(const EmitterSurface& s, const Vec3& point, const Vec3& normal, int n = 20000) {
    const EmitterSampler sampler(s);
    EmitterSampler::Cuts cuts;
    FormFactor e;
    for (const auto& c : s.corners) e.exact += double(triangleFormFactor(point, normal, c, s.twoSided));
    const EmitterSampler::Proposal* proposal = sampler.prepare(point, normal, cuts);
    if (!proposal) return e;
    double squares = 0;
    int disagree = 0;  // on the border of two parts
    for (int i = 0; i < n; ++i) {
        float density = 0;
        size_t t = 0;
        const Vec3 to = sampler.sample(*proposal, {(float(i) + 0.5f) / float(n), r2Point(uint32_t(i), {0.3f, 0.7f}).y},
                                       density, t) -
                        point;
        disagree += std::abs(density - sampler.areaDensity(*proposal, t, point + to)) > 1e-3f * density;
        const float d2 = glm::dot(to, to), d = std::sqrt(d2);
        const float facing = -glm::dot(to, s.normals[t]) / d, height = glm::dot(to, normal) / d;
        const double f = facing > 0 && height > 0 ? double(facing * height / (d2 * pi * density)) : 0;
        e.mean += f / n;
        squares += f * f / n;
    }
    EXPECT_LE(disagree, n / 1000);
    e.deviation = std::sqrt(std::max(0.0, squares - e.mean * e.mean)) / std::max(e.exact, 1e-30);
    return e;
}

TEST(EmitterSampler, GivesTheFormFactorWithLittleNoiseNearAndFar) {
    // A panel a centimetre and a half off a wall, fine and coarse: the wall beside it sees its back at a grazing angle.
    for (const int pieces : {1, 24}) {
        Surface panel;
        panel.box({1.2f, 0.7f, 0.03f}, pieces);
        for (const float beside : {0.003f, 0.01f, 0.03f, 0.1f, 0.3f}) {
            const FormFactor e = formFactor(panel.surface, {0.6f + beside, 0.1f, -0.03f}, {0, 0, 1});
            EXPECT_NEAR(e.mean, e.exact, 0.02 * e.exact) << pieces << " " << beside;
            EXPECT_LT(e.deviation, 1.0) << pieces << " " << beside;
        }
        for (const float above : {0.02f, 0.3f, 5.0f}) {
            const FormFactor e = formFactor(panel.surface, {0.1f, 0.2f, 0.015f + above}, {0, 0, -1});
            EXPECT_NEAR(e.mean, e.exact, 0.01 * e.exact) << pieces << " " << above;
            EXPECT_LT(e.deviation, 0.7) << pieces << " " << above;
        }
    }
}

TEST(EmitterSampler, GivesNothingBehindTheHorizon) {
    Surface one;
    one.triangle({0, 0, -5}, {1, 0, -5}, {0, 1, -5});
    const EmitterSampler sampler(one.surface);
    EmitterSampler::Cuts cuts;
    EXPECT_FALSE(sampler.prepare({0, 0, 0}, {0, 0, 1}, cuts));
}

TEST(EmitterSampler, ACutIsThatOfItsPointWhateverCameBefore) {
    Surface panel;
    panel.box({1.2f, 0.7f, 0.03f}, 4);
    const EmitterSampler sampler(panel.surface);
    EmitterSampler::Cuts kept(2);
    int shared = 0;
    for (int i = 0; i < 200; ++i) {
        const Vec2 u = r2Point(uint32_t(i), {0.1f, 0.6f});
        const Vec3 point(2 * u.x - 1, u.y, 1 + 0.001f * float(i)), normal = glm::normalize(Vec3(u.x - 0.5f, 0.1f, -1));
        EmitterSampler::Cuts fresh;
        const EmitterSampler::Proposal *a = sampler.prepare(point, normal, kept),
                                       *b = sampler.prepare(point, normal, fresh);
        ASSERT_TRUE(a && b);
        ASSERT_EQ(a->leaves, b->leaves);
        float densities[2] = {0, 0};
        size_t triangle = 0;
        EXPECT_EQ(sampler.sample(*a, u, densities[0], triangle), sampler.sample(*b, u, densities[1], triangle));
        EXPECT_EQ(densities[0], densities[1]);
        EXPECT_GE(glm::dot(a->normal, normal), 0.9998f);
        shared += sampler.prepare(point + Vec3(0.002f, 0, 0), normal, fresh)->point == b->point;
    }
    EXPECT_GT(shared, 150) << "neighbours have one cut";
}

}  // namespace
}  // namespace relamp
