#include "brdf/models.h"

namespace relamp {
namespace {

/// Smallest alpha, Ward width or Beckmann slope: a narrower lobe overflows single precision towards grazing.
constexpr float minimumWidth = 1e-3f;
/// Cosines below this count as this. The models grow without bound where both directions graze; so they stay finite.
constexpr float minimumCosine = 1e-6f;

bool belowHorizon(const Vec3& towardLight, const Vec3& towardEye) { return !(towardLight.z > 0 && towardEye.z > 0); }
Vec3 offHorizon(const Vec3& direction) { return {direction.x, direction.y, std::max(direction.z, minimumCosine)}; }
float squared(float x) { return x * x; }

/// The pair of directions as the microfacet models see it. Every member is symmetric under exchange of the two up to
/// the names, so each model is reciprocal to the last bit.
struct Pair {
    float lightCosine, eyeCosine;
    float halfXy2, halfZ2, half2;  ///< squared parts of light + eye, not normalised

    Pair(const Vec3& towardLight, const Vec3& towardEye) {
        const Vec3 l = offHorizon(towardLight), e = offHorizon(towardEye), h = l + e;
        lightCosine = l.z;
        eyeCosine = e.z;
        halfXy2 = h.x * h.x + h.y * h.y;
        halfZ2 = h.z * h.z;
        half2 = halfXy2 + halfZ2;
    }
    /// Between either direction and the half vector: |l + e| / 2 for unit l and e.
    float halfAngleCosine() const { return std::min(1.0f, 0.5f * std::sqrt(half2)); }
    float halfTangent2() const { return halfXy2 / halfZ2; }
};

/// [Walter07] eq. 33 with cos^2 (tan^2 + a^2) written as sin^2 + a^2 cos^2, which keeps its digits near the normal.
float ggxDistribution(const Pair& pair, float alpha) {
    const float a2 = alpha * alpha;
    return a2 / (pi * squared((pair.halfXy2 + a2 * pair.halfZ2) / pair.half2));
}

/// cosine * sqrt(1 + a^2 tan^2): the root in Smith's Lambda for GGX, times the cosine.
float smithRoot(float cosine, float alpha) {
    const float a2 = alpha * alpha;
    return std::sqrt(a2 + (1 - a2) * cosine * cosine);
}

/// G2 / (4 cos cos) with the height-correlated G2 = 1 / (1 + Lambda_l + Lambda_e), [Heitz14] eq. 99.
float ggxValue(const Pair& pair, float alpha) {
    const float masking = 0.5f / (pair.lightCosine * smithRoot(pair.eyeCosine, alpha) +
                                  pair.eyeCosine * smithRoot(pair.lightCosine, alpha));
    return ggxDistribution(pair, alpha) * masking;
}

}  // namespace

float lambert(const Vec3& towardLight, const Vec3& towardEye) {
    return belowHorizon(towardLight, towardEye) ? 0.0f : 1 / pi;
}

float ggx(const Vec3& towardLight, const Vec3& towardEye, float alpha) {
    if (belowHorizon(towardLight, towardEye)) return 0;
    return ggxValue(Pair(towardLight, towardEye), std::max(alpha, minimumWidth));
}

float ggxDielectric(const Vec3& towardLight, const Vec3& towardEye, float alpha, float ior) {
    if (belowHorizon(towardLight, towardEye)) return 0;
    const Pair pair(towardLight, towardEye);
    return ggxValue(pair, std::max(alpha, minimumWidth)) * dielectricFresnel(pair.halfAngleCosine(), ior);
}

float ggxGrazing(const Vec3& towardLight, const Vec3& towardEye, float alpha) {
    if (belowHorizon(towardLight, towardEye)) return 0;
    const Pair pair(towardLight, towardEye);
    const float rest = 1 - pair.halfAngleCosine(), rest2 = rest * rest;
    return ggxValue(pair, std::max(alpha, minimumWidth)) * rest2 * rest2 * rest;
}

float ward(const Vec3& towardLight, const Vec3& towardEye, float alpha) {
    if (belowHorizon(towardLight, towardEye)) return 0;
    const Pair pair(towardLight, towardEye);
    const float a2 = squared(std::max(alpha, minimumWidth));
    return std::exp(-pair.halfTangent2() / a2) / (pi * a2) * (pair.half2 / squared(pair.halfZ2));
}

float lafortune(const Vec3& towardLight, const Vec3& towardEye, float cxy, float cz, float exponent) {
    if (belowHorizon(towardLight, towardEye)) return 0;
    const float base =
        cz * (towardLight.z * towardEye.z) - cxy * (towardLight.x * towardEye.x + towardLight.y * towardEye.y);
    return base > 0 ? std::pow(base, exponent) : 0.0f;
}

float cookTorrance(const Vec3& towardLight, const Vec3& towardEye, float m) {
    if (belowHorizon(towardLight, towardEye)) return 0;
    const Pair pair(towardLight, towardEye);
    const float m2 = squared(std::max(m, minimumWidth));
    const float beckmann = std::exp(-pair.halfTangent2() / m2) * squared(pair.half2 / pair.halfZ2) / (pi * m2);
    // V-groove: min(1, 2 (n.h) (n.l) / (l.h), the same with e); in the unnormalised half vector (n.h) / (l.h) = 2 h_z /
    // |h|^2.
    const float groove = 4 * std::sqrt(pair.halfZ2) / pair.half2 * std::min(pair.lightCosine, pair.eyeCosine);
    return beckmann * std::min(1.0f, groove) / (4 * pair.lightCosine * pair.eyeCosine);
}

float dielectricFresnel(float cosine, float ior) {
    const float c = std::clamp(cosine, 0.0f, 1.0f);
    const float sineInside2 = (1 - c * c) / (ior * ior);
    if (sineInside2 >= 1) return 1;  // total reflection, only for ior <= 1
    const float inside = std::sqrt(1 - sineInside2);
    const float s = (c - ior * inside) / (c + ior * inside), p = (ior * c - inside) / (ior * c + inside);
    return 0.5f * (s * s + p * p);
}

Vec3 sampleGgx(const Vec3& towardEye, float alpha, const Vec2& u) {
    // [Heitz18] listing 1: stretch the eye, sample the projected half disc, unstretch.
    const float a = std::max(alpha, minimumWidth);
    const Vec3 eye = offHorizon(towardEye);
    const Vec3 stretched = glm::normalize(Vec3(a * eye.x, a * eye.y, eye.z));
    const float across2 = stretched.x * stretched.x + stretched.y * stretched.y;
    const Vec3 first = across2 > 0 ? Vec3(-stretched.y, stretched.x, 0) / std::sqrt(across2) : Vec3(1, 0, 0);
    const Vec3 second = glm::cross(stretched, first);
    const float r = std::sqrt(u.x), phi = 2 * pi * u.y, fraction = 0.5f * (1 + stretched.z);
    const float x = r * std::cos(phi);
    const float y = (1 - fraction) * std::sqrt(std::max(0.0f, 1 - x * x)) + fraction * r * std::sin(phi);
    const Vec3 n = x * first + y * second + std::sqrt(std::max(0.0f, 1 - x * x - y * y)) * stretched;
    const Vec3 halfVector = glm::normalize(Vec3(a * n.x, a * n.y, std::max(n.z, minimumCosine)));
    return glm::normalize(2 * glm::dot(eye, halfVector) * halfVector - eye);
}

float ggxSampleDensity(const Vec3& towardLight, const Vec3& towardEye, float alpha) {
    if (belowHorizon(towardLight, towardEye)) return 0;
    // [Heitz18] eq. 17: D(h) G1(e) / (4 cos e), with G1 = 2 cos / (cos + root).
    const Pair pair(towardLight, towardEye);
    const float a = std::max(alpha, minimumWidth);
    return ggxDistribution(pair, a) * 0.5f / (pair.eyeCosine + smithRoot(pair.eyeCosine, a));
}

}  // namespace relamp
