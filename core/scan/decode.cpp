#include "scan/decode.h"

#include <limits>

#include "base/parallel.h"
#include "base/statistics.h"
#include "scan/code_fit.h"

namespace relamp {
namespace {

/// Bits, counted from the finest, that separate direct from global light: fine enough to light all but evenly what
/// global light comes from, coarse enough to be sharp.
constexpr int finestSeparating = 1, coarsestSeparating = 3, coarsestForNoise = 4;
constexpr size_t noiseBins = 12;

/// What a photograph is read as in pairs: pattern and inverse, where one alone is completed by white and black.
struct PatternPair {
    std::vector<float> pattern, inverse;
    bool whole = true;
};

/// Pixels of all photographs that must be known at once.
struct LightParts {
    GreyImage white, black;
    std::vector<float> direct, global;  ///< without black
    std::array<float, noiseBins> noise{};
    float brightest = 0;
    size_t pixels() const { return white.values.size(); }
    size_t binOf(size_t i) const {
        const float root = std::sqrt(std::max(0.0f, white.values[i] / brightest));
        return std::min(noiseBins - 1, size_t(root * float(noiseBins)));
    }
    float noiseAt(size_t i) const { return noise[binOf(i)]; }
};

GreyImage readPlace(const PatternStack& stack, size_t place, const GreyImage* like) {
    GreyImage image = stack.read(place);
    if (like && (image.width != like->width || image.height != like->height))
        throw Error("{}: is {} x {} pixels, the white photograph {} x {}", nameOfPlace(stack.bits, place), image.width,
                    image.height, like->width, like->height);
    return image;
}

PatternPair readPair(const PatternStack& stack, size_t place, const LightParts& light) {
    PatternPair pair;
    if (stack.there[place]) pair.pattern = readPlace(stack, place, &light.white).values;
    if (stack.there[place + 1]) pair.inverse = readPlace(stack, place + 1, &light.white).values;
    pair.whole = stack.there[place] && stack.there[place + 1];
    std::vector<float>& absent = stack.there[place] ? pair.inverse : pair.pattern;
    const std::vector<float>& present = stack.there[place] ? pair.pattern : pair.inverse;
    if (!pair.whole) {
        absent.resize(light.pixels());
        for (size_t i = 0; i < absent.size(); ++i)
            absent[i] = light.white.values[i] + light.black.values[i] - present[i];
    }
    return pair;
}

/// Calls each(bit, pair) for the given places in order; pairs are read several at once, which 512 MiB bound.
template <class Each>
void forEachPair(const PatternStack& stack, const std::vector<size_t>& places, const LightParts& light,
                 Progress& progress, Each&& each) {
    const size_t most = std::clamp<size_t>((size_t(512) << 20) / std::max<size_t>(1, light.pixels() * 28), 1, 8);
    for (size_t first = 0; first < places.size(); first += most) {
        const size_t count = std::min(most, places.size() - first);
        std::vector<PatternPair> pairs(count);
        parallelFor(
            count, 1, [&](size_t i) { pairs[i] = readPair(stack, places[first + i], light); }, &progress);
        for (size_t i = 0; i < count; ++i) each(first + i, pairs[i]);
    }
}

/// White and black; throws where they cannot be that.
LightParts readWhiteAndBlack(const PatternStack& stack) {
    LightParts light;
    light.white = readPlace(stack, 0, nullptr);
    light.black = readPlace(stack, 1, &light.white);
    double sum = 0;
    for (size_t i = 0; i < light.pixels(); ++i) {
        sum += double(light.white.values[i]) - double(light.black.values[i]);
        light.brightest = std::max(light.brightest, light.white.values[i]);
    }
    if (!(sum > 0))
        throw Error(
            "the first photograph is not brighter than the second, expected white, then black: are the "
            "photographs in order?");
    return light;
}

/// Standard deviation of a photograph by brightness: pattern + inverse is the same light for every bit, so the sums of
/// two bits differ by the noise of four photographs.
class NoiseMeter {
public:
    explicit NoiseMeter(const LightParts& light)
        : light_(light), stride_(std::max<size_t>(1, light.pixels() / 200'000)) {}

    void add(const PatternPair& pair) {
        std::vector<float> sums;
        for (size_t i = 0; i < light_.pixels(); i += stride_) {
            // Beside edges a camera's curve that is no sRGB changes the sum.
            const float whole = light_.white.values[i] - light_.black.values[i];
            const bool plain = std::abs(pair.pattern[i] - pair.inverse[i]) > 0.8f * whole;
            sums.push_back(plain ? pair.pattern[i] + pair.inverse[i] : NAN);
        }
        for (size_t k = 0; k < before_.size(); ++k)
            if (std::isfinite(sums[k] - before_[k]))
                residuals_[light_.binOf(k * stride_)].push_back(std::abs(sums[k] - before_[k]));
        before_ = std::move(sums);
    }
    /// Bins with few pixels take the noise of the next darker one.
    std::array<float, noiseBins> noise() {
        const float floor = 2e-4f * light_.brightest;
        std::array<float, noiseBins> noise{};
        float darker = floor;
        for (size_t b = 0; b < noiseBins; ++b) {
            if (residuals_[b].size() >= 100)
                darker = std::max(floor, 0.5f * 1.4826f * medianOf(std::move(residuals_[b])));
            noise[b] = darker;
        }
        return noise;
    }

private:
    const LightParts& light_;
    size_t stride_;
    std::vector<float> before_;
    std::array<std::vector<float>, noiseBins> residuals_;
};

void separate(const PatternStack& stack, LightParts& light, Progress& progress) {
    struct Pair {
        size_t place;
        int fine;
    };
    std::vector<Pair> pairs;
    std::vector<size_t> places;
    for (int axis : {0, 1})
        for (int fine = finestSeparating; fine <= coarsestForNoise; ++fine) {
            const int bit = stack.bits[size_t(axis)] - 1 - fine;
            if (bit < 0) continue;
            const size_t place = patternPlace(stack.bits, axis, bit);
            if (!stack.there[place] || !stack.there[place + 1]) continue;
            pairs.push_back({place, fine});
            places.push_back(place);
        }
    std::vector<float> most(light.pixels(), -1e30f), least(light.pixels(), 1e30f);
    NoiseMeter meter(light);
    progress.begin("Separating direct light", places.size());
    forEachPair(stack, places, light, progress, [&](size_t which, const PatternPair& pair) {
        if (pairs[which].fine >= coarsestSeparating) meter.add(pair);
        if (pairs[which].fine > coarsestSeparating) return;
        for (size_t i = 0; i < light.pixels(); ++i) {
            most[i] = std::max({most[i], pair.pattern[i], pair.inverse[i]});
            least[i] = std::min({least[i], pair.pattern[i], pair.inverse[i]});
        }
    });
    light.noise = meter.noise();
    light.direct.resize(light.pixels());
    light.global.resize(light.pixels());
    for (size_t i = 0; i < light.pixels(); ++i) {
        const float black = light.black.values[i], whole = light.white.values[i] - black;
        light.direct[i] = most[i] < least[i] ? whole : most[i] - least[i];
        light.global[i] = most[i] < least[i] ? 0 : std::max(0.0f, 2 * (least[i] - black));
    }
}

/// Whether a bit is 0, 1 or not known (2).
int classified(float pattern, float inverse, float direct, float global, float noise, const DecodeOptions& options,
               bool whole, int fine) {
    const float difference = std::abs(pattern - inverse), sigma = noise * (whole ? 1.4142f : 2.4495f);
    // A wrong finest bit is wrong by one pixel of the projector, the next by up to three.
    const float noises = options.noises * float(std::min(fine + 1, 3)) / 3;
    if (!(difference > std::max(noises * sigma, options.leastContrast * direct))) return 2;
    const int bit = pattern > inverse;
    if (direct > global) return bit;
    const float off = bit ? inverse : pattern, on = bit ? pattern : inverse, slack = 2 * noise;
    return off <= direct + slack && on >= global - slack ? bit : 2;
}

/// Gray bits of one axis and which of them are not known; bit 0 is the finest.
struct GrayBits {
    std::vector<uint16_t> gray, unsure;
    CodeMap map;
};

GrayBits readBits(const PatternStack& stack, int axis, const LightParts& light, const DecodeOptions& options,
                  LostBits& lost, Progress& progress) {
    const int bits = stack.bits[size_t(axis)];
    GrayBits out;
    out.gray.assign(light.pixels(), 0);
    out.unsure.assign(light.pixels(), 0);
    out.map.width = light.white.width;
    out.map.height = light.white.height;
    out.map.contrast.assign(light.pixels(), {});
    std::vector<size_t> places;
    std::vector<int> fine;
    for (int bit = 0; bit < bits; ++bit) {
        const size_t place = patternPlace(stack.bits, axis, bit);
        if (stack.there[place] || stack.there[place + 1]) {
            places.push_back(place);
            fine.push_back(bits - 1 - bit);
            continue;
        }
        lost.bits[size_t(axis)].push_back(bit);
        for (uint16_t& unsure : out.unsure) unsure = uint16_t(unsure | 1u << (bits - 1 - bit));
    }
    progress.begin(axis == 0 ? "Reading codes along the first axis" : "Reading codes along the second axis",
                   places.size());
    forEachPair(stack, places, light, progress, [&](size_t which, const PatternPair& pair) {
        const int bit = fine[which];
        parallelFor(light.pixels(), 16384, [&](size_t i) {
            const float black = light.black.values[i], p = pair.pattern[i] - black, q = pair.inverse[i] - black;
            const int value =
                classified(p, q, light.direct[i], light.global[i], light.noiseAt(i), options, pair.whole, bit);
            if (value == 2) out.unsure[i] = uint16_t(out.unsure[i] | 1u << bit);
            // What is not sure keeps its likelier value.
            if (p > q) out.gray[i] = uint16_t(out.gray[i] | 1u << bit);
            if (bit < crossingBits) {
                const float whole = light.white.values[i] - black;
                out.map.contrast[i][size_t(bit)] =
                    whole > 0 ? int8_t(std::lround(std::clamp((p - q) / whole, -1.0f, 1.0f) * 127)) : int8_t(0);
            }
        });
    });
    return out;
}

/// A pair that is missing leaves codes of two pixels or of a block, by the bits below it.
int exactnessOf(const std::vector<int>& absent, int bits) {
    if (absent.empty()) return 1;
    return 1 << (bits - absent.front());
}

void takeCodes(GrayBits& bits, const LightParts& light, const std::vector<uint8_t>& lit, int size, int widest) {
    bits.map.codes.resize(light.pixels());
    parallelFor(light.pixels(), 16384, [&](size_t i) {
        CodeInterval code = lit[i] ? intervalOf(bits.gray[i], bits.unsure[i], widest) : CodeInterval{};
        if (size > 0 && int(code.low) >= size) code = {};
        bits.map.codes[i] = code;
    });
}

}  // namespace

DecodedView decodePatterns(const PatternStack& stack, const DecodeOptions& options, Progress& progress) {
    progress.begin("Reading white and black", 1);
    LightParts light = readWhiteAndBlack(stack);
    progress.advance();
    separate(stack, light, progress);
    DecodedView view;
    view.width = light.white.width;
    view.height = light.white.height;
    for (size_t place = 0; place < stack.there.size(); ++place)
        if (!stack.there[place]) view.lost.absent.push_back(place);

    std::vector<uint8_t> lit(light.pixels());
    std::vector<float> whites, globals, noises;
    for (size_t i = 0; i < light.pixels(); ++i) {
        const float whole = light.white.values[i] - light.black.values[i], noise = light.noiseAt(i);
        lit[i] = whole > 2 * options.noises * noise && whole > 0.01f * light.brightest;
        if (!lit[i]) continue;
        ++view.lit;
        if (i % 7 != 0) continue;
        whites.push_back(light.white.values[i]);
        globals.push_back(std::min(1.0f, light.global[i] / whole));
        noises.push_back(noise);
    }
    if (view.lit == 0) throw Error("white and black do not differ anywhere: the projector lights nothing");
    view.noise = medianOf(std::move(noises)) / std::max(1e-30f, medianOf(std::move(whites)));
    view.global = medianOf(std::move(globals));

    std::array<std::vector<float>, 2> places;
    std::array<std::vector<uint8_t>, 2> exact;
    for (int axis : {0, 1}) {
        GrayBits bits = readBits(stack, axis, light, options, view.lost, progress);
        const int coarsest = exactnessOf(view.lost.bits[size_t(axis)], stack.bits[size_t(axis)]);
        view.lost.exactness[size_t(axis)] = coarsest;
        takeCodes(bits, light, lit, options.projectorSize[size_t(axis)],
                  coarsest > 1 ? std::max(options.widestInterval, 2 * coarsest) : options.widestInterval);
        bits.gray = bits.unsure = {};
        const float slope = slopeOf(bits.map);
        view.slope = std::max(view.slope, slope);
        places[size_t(axis)] = fitPlaces(bits.map, slope, progress);
        exact[size_t(axis)].resize(light.pixels());
        for (size_t i = 0; i < light.pixels(); ++i) exact[size_t(axis)][i] = bits.map.codes[i].width() == 1;
    }
    view.places.resize(light.pixels(), Vec2(std::numeric_limits<float>::quiet_NaN()));
    for (size_t i = 0; i < light.pixels(); ++i) {
        if (!(std::isfinite(places[0][i]) && std::isfinite(places[1][i]))) continue;
        view.places[i] = Vec2(places[0][i], places[1][i]);
        ++view.decoded;
        view.coarse += !(exact[0][i] && exact[1][i]);
    }
    return view;
}

}  // namespace relamp
