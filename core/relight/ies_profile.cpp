#include "relight/ies_profile.h"

#include <algorithm>
#include <cmath>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/text_scanner.h"

namespace relamp {
namespace {

constexpr size_t longestFile = size_t(8) << 20;
constexpr double mostAngles = 4096;

/// The numbers after the TILT line: any white space or commas part them, lines mean nothing.
class Numbers {
public:
    explicit Numbers(std::string_view text) : text_(text) {
        std::replace(text_.begin(), text_.end(), ',', ' ');
        scanner_ = TextScanner(text_);
    }
    double next(const char* what) {
        const std::string_view word = scanner_.word();
        if (word.empty()) throw Error("{}: is missing, the file ends before it", what);
        const auto value = TextScanner::number(word);
        if (!value || !std::isfinite(*value) || std::abs(*value) > 1e30)
            throw Error("{}: is {}, expected a number", what, std::string(word.substr(0, 40)));
        return *value;
    }
    size_t count(const char* what) {
        const double value = next(what);
        if (!(value >= 1) || value > mostAngles || value != std::floor(value))
            throw Error("{}: is {}, expected 1 to {}", what, value, mostAngles);
        return size_t(value);
    }
    std::vector<float> ascending(size_t count, const char* what) {
        std::vector<float> out;
        out.reserve(count);
        for (size_t i = 0; i < count; ++i) {
            out.push_back(float(next(what)));
            if (i && !(out[i] > out[i - 1])) throw Error("{}: {} follows {}, expected more", what, out[i], out[i - 1]);
        }
        return out;
    }

private:
    std::string text_;
    TextScanner scanner_{std::string_view()};
};

/// Place of `x` among ascending values: index of the one below and the fraction to the next.
std::pair<size_t, float> placeOf(const std::vector<float>& values, float x) {
    if (values.size() == 1 || x <= values.front()) return {0, 0.0f};
    if (x >= values.back()) return {values.size() - 2, 1.0f};
    const size_t next = size_t(std::upper_bound(values.begin(), values.end(), x) - values.begin());
    return {next - 1, (x - values[next - 1]) / (values[next] - values[next - 1])};
}

/// The horizontal angle in the range that was measured, by the symmetry that the range stands for.
float folded(float degrees, float last) {
    if (last <= 0) return 0;
    if (last <= 180 && degrees > 180) degrees = 360 - degrees;
    if (last <= 90 && degrees > 90) degrees = 180 - degrees;
    return degrees;
}

bool isRange(float value, std::initializer_list<float> allowed) {
    return std::any_of(allowed.begin(), allowed.end(), [&](float a) { return std::abs(value - a) < 0.01f; });
}

}  // namespace

float IesProfile::at(const Vec3& d) const {
    const float down = std::acos(std::clamp(-d.z, -1.0f, 1.0f)) * (180 / pi);
    if (down < vertical.front() - 1e-3f || down > vertical.back() + 1e-3f) return 0;
    float around = std::atan2(d.y, d.x) * (180 / pi);
    if (around < 0) around += 360;
    const auto [h, across] = placeOf(horizontal, folded(around, horizontal.back()));
    const auto [v, along] = placeOf(vertical, down);
    const size_t columns = vertical.size(), nextRow = horizontal.size() > 1 ? columns : 0, next = columns > 1 ? 1 : 0;
    const float* row = &candela[h * columns + v];
    const float first = row[0] + along * (row[next] - row[0]),
                second = row[nextRow] + along * (row[nextRow + next] - row[nextRow]);
    return (first + across * (second - first)) / most;
}

IesProfile iesFromText(const std::string& text) {
    if (text.size() > longestFile) throw Error("is larger than {} MiB", longestFile >> 20);
    IesProfile out;
    std::string tilt;
    TextScanner lines(text);
    while (!lines.atEnd()) {
        const std::string_view line = lines.line();
        if (!line.starts_with("TILT=")) continue;
        tilt = line.substr(5, 200);
        break;
    }
    if (tilt.empty()) throw Error("TILT: is missing, expected a photometric file (IES LM-63)");
    Numbers numbers(std::string_view(text).substr(text.size() - lines.remaining()));
    if (tilt.starts_with("INCLUDE")) {
        // How its output changes as the luminaire is tilted: it is used upright.
        numbers.next("lamp to luminaire geometry");
        const size_t pairs = numbers.count("number of tilt angles");
        for (size_t i = 0; i < 2 * pairs; ++i) numbers.next("tilt angles and factors");
    }
    numbers.next("number of lamps");
    numbers.next("lumens per lamp");
    const double multiplier = numbers.next("candela multiplier");
    const size_t verticals = numbers.count("number of vertical angles"),
                 horizontals = numbers.count("number of horizontal angles");
    const double type = numbers.next("photometric type");
    if (type == 2 || type == 3) throw Error("photometric type: is {}, expected C", type == 2 ? "B" : "A");
    if (type != 1) throw Error("photometric type: is {}, expected 1 (type C)", type);
    for (const char* what : {"units", "width", "length", "height"}) numbers.next(what);
    const double ballast = numbers.next("ballast factor");
    numbers.next("future use");
    numbers.next("input watts");
    out.vertical = numbers.ascending(verticals, "vertical angles");
    out.horizontal = numbers.ascending(horizontals, "horizontal angles");
    if (out.vertical.front() < 0 || out.vertical.back() > 180.01f)
        throw Error("vertical angles: run from {} to {}, expected 0 to 180", out.vertical.front(), out.vertical.back());
    if (!isRange(out.horizontal.front(), {0}) || !isRange(out.horizontal.back(), {0, 90, 180, 360}))
        throw Error("horizontal angles: run from {} to {}, expected 0 to 0, 90, 180 or 360", out.horizontal.front(),
                    out.horizontal.back());
    const double factor = multiplier * (ballast > 0 ? ballast : 1.0);
    out.candela.reserve(verticals * horizontals);
    for (size_t i = 0; i < verticals * horizontals; ++i) {
        const double value = numbers.next("candela values") * factor;
        if (value < 0 || value > 1e30) throw Error("candela values: one is {}, expected 0 or more", value);
        out.candela.push_back(float(value));
        out.most = std::max(out.most, float(value));
    }
    if (!(out.most > 0)) throw Error("candela values: are all 0, expected light in some direction");
    return out;
}

IesProfile readIes(const std::filesystem::path& file) {
    const std::string text = readBytes(file, longestFile);
    return withContext(file.string(), [&] { return iesFromText(text); });
}

}  // namespace relamp
