#include "relight/live/gloss_taps.h"

#include <bit>
#include <cstring>
#include <numeric>

#include "image/mirrored_cell.h"

// Vectors are handed about inside this file alone.
#pragma GCC diagnostic ignored "-Wpsabi"

namespace relamp {
namespace {

constexpr size_t lanes = EnvironmentPyramid::lanes;
constexpr float narrowest = 1e-3f;
/// Cells this many times brighter than the mean are suns.
constexpr float sunContrast = 12;

/// One quantity in sixteen directions; the compiler splits it where the machine has narrower registers.
typedef float Lanes __attribute__((vector_size(4 * lanes)));
typedef int32_t IntLanes __attribute__((vector_size(4 * lanes)));
typedef float Colour __attribute__((vector_size(16)));

struct Directions {
    Lanes x, y, z;
};

template <class To, class From>
inline To bitsOf(const From& from) {
    static_assert(sizeof(To) == sizeof(From));
    To to;
    std::memcpy(&to, &from, sizeof to);
    return to;
}
inline Lanes all(float x) { return x - Lanes{}; }
inline Lanes larger(const Lanes& a, const Lanes& b) { return a > b ? a : b; }
inline Lanes smaller(const Lanes& a, const Lanes& b) { return a < b ? a : b; }
inline Lanes magnitude(const Lanes& a) { return bitsOf<Lanes>(bitsOf<IntLanes>(a) & 0x7fffffff); }
inline Lanes withSign(const Lanes& a, const Lanes& of) {
    return bitsOf<Lanes>((bitsOf<IntLanes>(a) & 0x7fffffff) | (bitsOf<IntLanes>(of) & int32_t(0x80000000)));
}
/// 1 / sqrt(a) to the last bits, by Newton's steps from a guess: std::sqrt would go lane by lane because of errno. 0
/// gives something finite.
inline Lanes inverseRoot(const Lanes& a) {
    Lanes r = bitsOf<Lanes>(0x5f3759df - (bitsOf<IntLanes>(a) >> 1));
    const Lanes half = 0.5f * a;
    for (int step = 0; step < 3; ++step) r = r * (1.5f - half * r * r);
    return r;
}
inline Lanes root(const Lanes& a) { return a * inverseRoot(a); }

/// atan(t) / (pi / 2) for t in [0, 1], to 4e-8.
inline Lanes arcFraction(const Lanes& t) {
    const Lanes s = t * t;
    return t * (0.63661970f +
                s * (-0.21219691f +
                     s * (0.12711363f +
                          s * (-0.08914771f +
                               s * (0.06282715f + s * (-0.03745218f + s * (0.01513915f + s * (-0.00290285f))))))));
}

/// sphereToSquare of each direction.
inline void squareOf(const Directions& d, Lanes& u, Lanes& v) {
    const Lanes ax = magnitude(d.x), ay = magnitude(d.y), r = root(larger(1 - magnitude(d.z), Lanes{}));
    const Lanes most = larger(ax, ay);
    const Lanes fraction = arcFraction(smaller(ax, ay) / larger(most, all(1e-30f)));
    const Lanes phi = ay > ax ? 1 - fraction : fraction;
    const Lanes b = phi * r, a = r - b;
    const Lanes x = withSign(d.z < 0 ? 1 - b : a, d.x), y = withSign(d.z < 0 ? 1 - a : b, d.y);
    u = smaller(larger(0.5f + 0.5f * x, Lanes{}), all(1));
    v = smaller(larger(0.5f + 0.5f * y, Lanes{}), all(1));
}

/// BRDF x cosine, per channel, and the density with which sampleGgx draws a direction.
struct Shine {
    Lanes red{}, green{}, blue{}, density{};
};

/// Lobes of the rarer kinds, a direction at a time.
Lanes oneByOne(const Lobe& lobe, const Directions& light, const Vec3& eye) {
    Lanes value{};
    for (size_t k = 0; k < lanes; ++k)
        if (light.z[k] > 0) value[k] = evaluateLobe(lobe, {light.x[k], light.y[k], light.z[k]}, eye);
    return value;
}

/// Adds a lobe (models.cpp, written for lanes).
inline void addLobe(const Lobe& lobe, const Rgb& weight, const Directions& light, const Vec3& eye, Shine& out) {
    const float a = std::max(lobe.alpha, narrowest), a2 = a * a, ez = std::max(eye.z, 1e-6f);
    const float eyeRoot = std::sqrt(a2 + (1 - a2) * ez * ez), eyeFraction = 0.5f / (ez + eyeRoot);
    const Lanes lz = larger(light.z, all(1e-6f)), hx = light.x + eye.x, hy = light.y + eye.y, hz = lz + ez;
    const Lanes flat2 = hx * hx + hy * hy, up2 = hz * hz, half2 = flat2 + up2, spread = (flat2 + a2 * up2) / half2;
    const Lanes distribution = (a2 / pi) / (spread * spread);
    Lanes value = all(1 / pi);
    if (lobe.kind > Lobe::Kind::ggxDielectric) value = oneByOne(lobe, light, eye);
    else if (lobe.kind != Lobe::Kind::lambert)
        value = distribution * (0.5f / (lz * eyeRoot + ez * root(a2 + (1 - a2) * lz * lz)));
    if (lobe.kind == Lobe::Kind::ggxDielectric) {
        constexpr float ior = 1.5f;
        const Lanes c = smaller(0.5f * root(half2), all(1)), inside = root(1 - (1 - c * c) * (1 / (ior * ior)));
        const Lanes s = (c - ior * inside) / (c + ior * inside), p = (ior * c - inside) / (ior * c + inside);
        value *= 0.5f * (s * s + p * p);
    }
    const Lanes shone = light.z > 0 ? value * lz : Lanes{};
    out.red += weight.x * shone;
    out.green += weight.y * shone;
    out.blue += weight.z * shone;
    out.density += light.z > 0 ? distribution * eyeFraction : Lanes{};
}

/// sampleGgx for one eye and width.
class LobeSampler {
public:
    LobeSampler(float alpha, const Vec3& towardEye)
        : a_(std::max(alpha, narrowest)), eye_(towardEye.x, towardEye.y, std::max(towardEye.z, 1e-6f)) {
        stretched_ = glm::normalize(Vec3(a_ * eye_.x, a_ * eye_.y, eye_.z));
        const float across2 = stretched_.x * stretched_.x + stretched_.y * stretched_.y;
        first_ = across2 > 0 ? Vec3(-stretched_.y, stretched_.x, 0) / std::sqrt(across2) : Vec3(1, 0, 0);
        second_ = glm::cross(stretched_, first_);
    }
    void sample(const TapPattern& pattern, size_t begin, Directions& out) const {
        Lanes x, rest, along;
        std::memcpy(&x, &pattern.across[begin], sizeof x);
        std::memcpy(&rest, &pattern.rest[begin], sizeof rest);
        std::memcpy(&along, &pattern.along[begin], sizeof along);
        const float fraction = 0.5f * (1 + stretched_.z);
        const Lanes y = (1 - fraction) * rest + fraction * along, z = root(larger(1 - x * x - y * y, Lanes{}));
        Lanes hx = a_ * (x * first_.x + y * second_.x + z * stretched_.x),
              hy = a_ * (x * first_.y + y * second_.y + z * stretched_.y);
        Lanes hz = larger(x * first_.z + y * second_.z + z * stretched_.z, all(1e-6f));
        const Lanes shorten = inverseRoot(hx * hx + hy * hy + hz * hz);
        hx *= shorten;
        hy *= shorten;
        hz *= shorten;
        const Lanes twice = 2 * (eye_.x * hx + eye_.y * hy + eye_.z * hz);
        out.x = twice * hx - eye_.x;
        out.y = twice * hy - eye_.y;
        out.z = twice * hz - eye_.z;
    }

private:
    float a_;
    Vec3 eye_, stretched_, first_, second_;
};

inline Directions turned(const Mat3& m, const Directions& d) {
    return {m[0].x * d.x + m[1].x * d.y + m[2].x * d.z, m[0].y * d.x + m[1].y * d.y + m[2].y * d.z,
            m[0].z * d.x + m[1].z * d.y + m[2].z * d.z};
}

}  // namespace

EnvironmentPyramid::EnvironmentPyramid(const DistantLight& distant) : black_(distant.black()) {
    side_ = distant.grid().side;
    int side = side_;
    std::vector<Rgb> cells = distant.cells();
    // Suns: the brightest cells above a multiple of the mean; the limit rises until they are few.
    std::vector<float> bright(cells.size());
    for (size_t c = 0; c < cells.size(); ++c) bright[c] = luminance(cells[c]);
    float limit = sunContrast * float(std::accumulate(bright.begin(), bright.end(), 0.0) / double(bright.size()));
    std::vector<uint32_t> chosen;
    for (uint32_t c = 0; c < bright.size(); ++c)
        if (bright[c] > limit) chosen.push_back(c);
    if (chosen.size() > mostSuns) {
        std::nth_element(chosen.begin(), chosen.begin() + mostSuns, chosen.end(), [&](uint32_t a, uint32_t b) {
            return bright[a] != bright[b] ? bright[a] > bright[b] : a < b;
        });
        limit = bright[chosen[mostSuns]];
        chosen.resize(mostSuns);
        std::sort(chosen.begin(), chosen.end());
    }
    suns_.count = chosen.size();
    for (const uint32_t c : chosen) {
        const Vec3 d = distant.grid().direction(int(c));
        const float excess = 1 - limit / bright[c];
        suns_.x.push_back(d.x);
        suns_.y.push_back(d.y);
        suns_.z.push_back(d.z);
        suns_.power.push_back(cells[c] * (excess * distant.grid().cellSolidAngle()));
        suns_.square.push_back((Vec2(float(int(c) % side), float(int(c) / side)) + Vec2(0.5f)) / float(side));
        cells[c] *= 1 - excess;
    }
    while (suns_.power.size() % lanes) {
        suns_.x.push_back(0);
        suns_.y.push_back(0);
        suns_.z.push_back(1);
        suns_.power.push_back(Rgb(0));
        suns_.square.push_back(Vec2(0));
    }
    for (;; side /= 2) {
        const int wide = side + 2;
        start_.push_back(cells_.size());
        cells_.resize(cells_.size() + size_t(wide) * size_t(wide));
        for (int y = -1; y <= side; ++y)
            for (int x = -1; x <= side; ++x)
                cells_[start_.back() + size_t(y + 1) * size_t(wide) + size_t(x + 1)] =
                    Vec4(cells[size_t(mirroredCell(x, y, side))], 0);
        if (side == 1) break;
        const int half = side / 2;
        std::vector<Rgb> coarse(size_t(half) * size_t(half));
        for (int y = 0; y < half; ++y)
            for (int x = 0; x < half; ++x) {
                const size_t at = size_t(2 * y) * size_t(side) + size_t(2 * x);
                coarse[size_t(y * half + x)] =
                    0.25f * ((cells[at] + cells[at + 1]) + (cells[at + size_t(side)] + cells[at + size_t(side) + 1]));
            }
        cells = std::move(coarse);
    }
}

TapPattern::TapPattern(int count_) : count(count_) {
    // Hammersley points.
    for (uint32_t i = 0; i < uint32_t(count); ++i) {
        uint32_t reversed = i;
        reversed = (reversed << 16) | (reversed >> 16);
        reversed = ((reversed & 0x00ff00ffu) << 8) | ((reversed & 0xff00ff00u) >> 8);
        reversed = ((reversed & 0x0f0f0f0fu) << 4) | ((reversed & 0xf0f0f0f0u) >> 4);
        reversed = ((reversed & 0x33333333u) << 2) | ((reversed & 0xccccccccu) >> 2);
        reversed = ((reversed & 0x55555555u) << 1) | ((reversed & 0xaaaaaaaau) >> 1);
        const float r = std::sqrt((float(i) + 0.5f) / float(count)), phi = 2 * pi * (float(reversed) * 0x1p-32f);
        across.push_back(r * std::cos(phi));
        along.push_back(r * std::sin(phi));
        rest.push_back(std::sqrt(std::max(0.0f, 1 - across.back() * across.back())));
    }
}

Rgb tapEnvironment(const EnvironmentPyramid& environment, const BrdfBasis& basis, std::span<const LobeWeight> lobes,
                   const TapPattern& pattern, const Mat3& toWorld, const Vec3& eye, const LiveGrid& grid,
                   const uint8_t* masks) {
    if (environment.black()) return Rgb(0);
    Directions light;
    const int quarterSide = 2 * grid.grid().side, halfSide = grid.grid().side;
    const auto seen = [&](int qx, int qy) {
        const int cell = (qy >> 1) * halfSide + (qx >> 1), quarter = (qy & 1) * 2 + (qx & 1);
        return nibbleOf(masks, size_t(cell)) >> quarter & 1;
    };
    const float count = float(pattern.count), finest = float(environment.side());
    const int sideBits = std::bit_width(unsigned(environment.side())) - 1;
    Colour sum{};
    for (const LobeWeight& own : lobes) {
        const LobeSampler sampler(basis.lobes[own.lobe].alpha, eye);
        for (size_t first = 0; first < size_t(pattern.count); first += lanes) {
            sampler.sample(pattern, first, light);
            Shine shine;
            for (const LobeWeight& l : lobes) addLobe(basis.lobes[l.lobe], l.weight, light, eye, shine);
            Lanes u, v;
            squareOf(turned(toWorld, light), u, v);
            const Lanes taps = count * larger(shine.density, all(1e-20f)), each = 1 / taps;
            const Lanes red = shine.red * each, green = shine.green * each, blue = shine.blue * each;
            // The coarsest level that still has as many cells as there would be taps this dense on the whole sphere.
            const Lanes ratio = smaller((finest * finest / (4 * pi)) * each, all(1e18f));
            IntLanes level = (bitsOf<IntLanes>(ratio) >> 23) - 127;
            level = level > 0 ? level >> 1 : IntLanes{};
            level = level > sideBits ? sideBits - IntLanes{} : level;
            const Lanes side = bitsOf<Lanes>((127 + sideBits - level) << 23);
            // Cell x has its middle at x + 1/2, and a rim before it: between middles where taps are wide, in the cell
            // itself where they are narrow.
            const Lanes shift = ratio < 1 ? all(1) : all(0.5f), px = smaller(u * side + shift, side + 0.5f),
                        py = smaller(v * side + shift, side + 0.5f);
            const IntLanes ix = __builtin_convertvector(px, IntLanes), iy = __builtin_convertvector(py, IntLanes);
            const Lanes fx = ratio < 1 ? Lanes{} : px - __builtin_convertvector(ix, Lanes),
                        fy = ratio < 1 ? Lanes{} : py - __builtin_convertvector(iy, Lanes);
            const IntLanes qx =
                __builtin_convertvector(smaller(u * float(quarterSide), all(float(quarterSide) - 0.5f)), IntLanes);
            const IntLanes qy =
                __builtin_convertvector(smaller(v * float(quarterSide), all(float(quarterSide) - 0.5f)), IntLanes);
            for (size_t k = 0; k < lanes; ++k) {
                if (!(shine.density[k] > 0) || !seen(qx[k], qy[k])) continue;
                const int wide = (environment.side() >> level[k]) + 2;
                const Vec4* at = environment.level(level[k]) + size_t(iy[k] * wide + ix[k]);
                Colour corner[4];
                std::memcpy(&corner[0], at, 2 * sizeof(Colour));
                std::memcpy(&corner[2], at + wide, 2 * sizeof(Colour));
                const Colour above = corner[0] + fx[k] * (corner[1] - corner[0]),
                             below = corner[2] + fx[k] * (corner[3] - corner[2]);
                sum += Colour{red[k], green[k], blue[k], 0} * (above + fy[k] * (below - above));
            }
        }
    }
    const EnvironmentPyramid::Suns& suns = environment.suns();
    const Mat3 toLocal = glm::transpose(toWorld);
    for (size_t first = 0; first < suns.count; first += lanes) {
        const size_t end = std::min(first + lanes, suns.count);
        uint32_t on = 0;
        for (size_t k = first; k < end; ++k) {
            const int qx = std::min(int(suns.square[k].x * float(quarterSide)), quarterSide - 1),
                      qy = std::min(int(suns.square[k].y * float(quarterSide)), quarterSide - 1);
            on |= uint32_t(seen(qx, qy)) << (k - first);
        }
        if (!on) continue;
        std::memcpy(&light.x, &suns.x[first], sizeof light.x);
        std::memcpy(&light.y, &suns.y[first], sizeof light.y);
        std::memcpy(&light.z, &suns.z[first], sizeof light.z);
        light = turned(toLocal, light);
        Shine shine;
        for (const LobeWeight& l : lobes) addLobe(basis.lobes[l.lobe], l.weight, light, eye, shine);
        for (size_t k = 0; k < lanes; ++k) {
            const Rgb& power = suns.power[first + k];
            if (on >> k & 1)
                sum += Colour{shine.red[k], shine.green[k], shine.blue[k], 0} * Colour{power.x, power.y, power.z, 0};
        }
    }
    return {sum[0], sum[1], sum[2]};
}

}  // namespace relamp
