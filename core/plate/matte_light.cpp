#include "plate/matte_light.h"

#include "base/parallel.h"
#include "relight/point_shader.h"

namespace relamp {
namespace {

constexpr float held = 0.5f;

std::array<Vec3, 6> axes() {
    return {Vec3(1, 0, 0), Vec3(-1, 0, 0), Vec3(0, 1, 0), Vec3(0, -1, 0), Vec3(0, 0, 1), Vec3(0, 0, -1)};
}

}  // namespace

IrradianceCube irradianceCube(const RelitScene& relit, const Vec3& point, int samples, uint64_t seed) {
    FrameOptions options;
    options.samplesPerPixel = samples;
    options.seed = seed;
    const SceneLights lights(relit);
    IrradianceCube cube{};
    const std::array<Vec3, 6> directions = axes();
    parallelFor(directions.size(), 1, [&](size_t a) {
        PointShader shader(lights, options);
        ShadedPoint white;
        PointShader::whiteAt(point, directions[a], white);
        Gather gloss, matte;
        gloss.clear(relit.emitters.size());
        matte.clear(relit.emitters.size());
        for (int i = 0; i < samples; ++i) shader.gather(white, uint32_t(i), mixBits(seed * 0x51ed + a), gloss, matte);
        Rgb sum = matte.world;
        for (const Rgb& group : matte.byEmitter) sum += group;
        cube[a] = glm::max(sum / float(samples), Rgb(0));
    });
    return cube;
}

Rgb irradianceFor(const IrradianceCube& cube, const Vec3& normal) {
    Rgb sum(0);
    for (int axis = 0; axis < 3; ++axis)
        sum += normal[axis] * normal[axis] * cube[size_t(2 * axis + (normal[axis] < 0 ? 1 : 0))];
    return sum;
}

std::optional<MattePlace> mattePlaceOf(const RelitScene& captured, const Camera& camera,
                                       const std::vector<float>& matte) {
    const int w = camera.width, h = camera.height;
    const auto at = [&](int x, int y) { return matte[size_t(y) * size_t(w) + size_t(x)] >= held; };
    int top = h, bottom = -1;
    double sumX = 0, sumY = 0, count = 0;
    for (int y = 0; y < h; ++y)
        for (int x = 0; x < w; ++x)
            if (at(x, y)) {
                top = std::min(top, y);
                bottom = y;
                sumX += x + 0.5;
                sumY += y + 0.5;
                ++count;
            }
    if (bottom < 0) return std::nullopt;
    // The lowest fiftieth of its height: the feet.
    double footX = 0, feet = 0;
    for (int y = bottom - (bottom - top) / 50; y <= bottom; ++y)
        for (int x = 0; x < w; ++x)
            if (at(x, y)) footX += x + 0.5, ++feet;
    const Vec3 eye(camera.position());
    const Vec2 pixel(float(footX / feet), std::min(float(bottom) + 1.5f, float(h) - 0.5f));
    const Hit hit = captured.scene.cameraTracer->closest({eye, camera.rayDirection(pixel), 0, 1e30f});
    if (!hit) return std::nullopt;
    MattePlace place;
    place.foot = captured.scene.pointOf(hit);
    // The upright plane through the foot that faces the camera.
    Vec3 across = eye - place.foot;
    across.z = 0;
    const Vec3 towards = camera.rayDirection(Vec2(float(sumX / count), float(sumY / count)));
    const float slope = glm::dot(towards, across);
    if (!(glm::length(across) > 1e-4f) || std::abs(slope) < 1e-6f) return std::nullopt;
    const float distance = glm::dot(place.foot - eye, across) / slope;
    if (!(distance > 0) || !std::isfinite(distance)) return std::nullopt;
    place.middle = eye + distance * towards;
    return place;
}

std::vector<Rgb> matteFactors(const MatteLight& light, const Camera& camera, const std::vector<float>& matte) {
    constexpr float most = 64;
    const int w = camera.width;
    std::vector<Rgb> factor(matte.size(), Rgb(1));
    Vec3 facing = Vec3(camera.position()) - light.place.middle;
    facing.z = 0;
    facing = glm::length(facing) > 1e-6f ? glm::normalize(facing) : Vec3(1, 0, 0);
    // To the right as the camera sees it.
    const Vec3 right = glm::cross(Vec3(0, 0, 1), facing);
    parallelFor(matte.size() / size_t(w), 8, [&](size_t y) {
        const float* row = &matte[y * size_t(w)];
        for (int x = 0; x < w;) {
            if (!(row[x] > 0)) {
                ++x;
                continue;
            }
            int end = x;
            while (end < w && row[end] > 0) ++end;
            const float centre = 0.5f * float(x + end), half = 0.5f * float(end - x);
            for (; x < end; ++x) {
                const float u = (float(x) + 0.5f - centre) / half;
                const Vec3 normal = u * right + std::sqrt(std::max(0.0f, 1 - u * u)) * facing;
                const Rgb before = irradianceFor(light.before, normal), after = irradianceFor(light.after, normal);
                Rgb& f = factor[y * size_t(w) + size_t(x)];
                for (int c = 0; c < 3; ++c)
                    f[c] = before[c] > 0 ? std::clamp(after[c] / before[c], 1 / most, most) : 1.0f;
            }
        }
    });
    return factor;
}

}  // namespace relamp
