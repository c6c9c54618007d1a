#include "plate/plate_sequence.h"

#include "base/is_there.h"
#include "image/image_io.h"
#include "shot/frame_numbers.h"

namespace relamp {
namespace fs = std::filesystem;
namespace {

/// The number that a name has in place of the pattern's; none when it is no name of the pattern.
std::optional<int> numberBy(const std::string& pattern, const NumberPlace& place, const std::string& name) {
    const size_t behind = pattern.size() - place.end;
    if (name.size() < place.begin + behind + 1 || name.compare(0, place.begin, pattern, 0, place.begin) != 0 ||
        name.compare(name.size() - behind, behind, pattern, place.end, behind) != 0)
        return std::nullopt;
    const std::string digits = name.substr(place.begin, name.size() - behind - place.begin);
    if (digits.size() > 9 || digits.find_first_not_of("0123456789") != std::string::npos) return std::nullopt;
    if (digits.size() < place.width || (digits.size() > place.width && digits[0] == '0')) return std::nullopt;
    return std::stoi(digits);
}

}  // namespace

PlateCurve plateCurve(const std::string& name) {
    static const std::map<std::string, PlateCurve> curves{
        {"auto", PlateCurve::automatic}, {"linear", PlateCurve::linear},   {"srgb", PlateCurve::srgb},
        {"rec709", PlateCurve::rec709},  {"gamma22", PlateCurve::gamma22}, {"gamma24", PlateCurve::gamma24}};
    const auto found = curves.find(name);
    if (found == curves.end())
        throw BadOption("--plate-curve {}: unknown, expected auto, linear, srgb, rec709, gamma22 or gamma24", name);
    return found->second;
}

float decoded(PlateCurve curve, float value) {
    if (!(value > 0)) return value;
    switch (curve) {
        case PlateCurve::automatic:
        case PlateCurve::linear: return value;
        case PlateCurve::srgb: return value <= 0.04045f ? value / 12.92f : std::pow((value + 0.055f) / 1.055f, 2.4f);
        case PlateCurve::rec709: return value < 0.081f ? value / 4.5f : std::pow((value + 0.099f) / 1.099f, 1 / 0.45f);
        case PlateCurve::gamma22: return std::pow(value, 2.2f);
        case PlateCurve::gamma24: return std::pow(value, 2.4f);
    }
    return value;
}

PlateFiles plateFiles(const fs::path& pattern, const char* what) {
    const std::string name = pattern.filename().string();
    const std::optional<NumberPlace> place = numberPlace(name);
    if (!place) {
        if (!isFile(pattern)) throw Error("{} {}: {}", what, pattern.string(), whyNoFile(pattern));
        return {{numberInName(pattern).value_or(1), pattern}};
    }
    if (numberPlace(name, place->end))
        throw BadOption("{} {}: has two places for the frame's number, expected one", what, pattern.string());
    PlateFiles files;
    const fs::path folder = pattern.has_parent_path() ? pattern.parent_path() : fs::path(".");
    std::error_code failed;
    for (fs::directory_iterator at(folder, failed); !failed && at != fs::directory_iterator(); at.increment(failed))
        if (const auto number = numberBy(name, *place, at->path().filename().string()))
            files.emplace(*number, pattern.parent_path() / at->path().filename());
    if (files.empty()) throw Error("{} {}: {} holds no such frame", what, pattern.string(), folder.string());
    return files;
}

fs::path platePattern(const fs::path& frame) {
    std::string name = frame.filename().string();
    const size_t dot = name.rfind('.');
    const size_t last = name.find_last_of("0123456789", dot == std::string::npos || dot == 0 ? dot : dot - 1);
    if (last == std::string::npos || numberPlace(name)) return frame;
    const size_t before = name.find_last_not_of("0123456789", last),
                 first = before == std::string::npos ? 0 : before + 1;
    name.replace(first, last + 1 - first, std::string(last + 1 - first, '#'));
    return frame.parent_path() / name;
}

Image readPlate(const fs::path& file, PlateCurve curve, float& saturation, const std::function<void()>& between) {
    ImageReport report;
    const bool told = curve != PlateCurve::automatic;
    Image image = readValues(file, &report, told, size_t(1) << 28, between);
    saturation = report.integer ? 0.995f : 0.0f;
    if (told)
        for (Rgb& pixel : image.pixels)
            for (int c = 0; c < 3; ++c) pixel[c] = decoded(curve, pixel[c]);
    return image;
}

std::vector<float> readMatte(const fs::path& file, int width, int height, const std::function<void()>& between) {
    const Image image = readValues(file, nullptr, true, size_t(1) << 28, between);
    if (image.width != width || image.height != height)
        throw Error("{}: is {} x {} pixels, the plate {} x {}", file.string(), image.width, image.height, width,
                    height);
    std::vector<float> matte(image.pixels.size());
    for (size_t p = 0; p < matte.size(); ++p) matte[p] = std::clamp(image.pixels[p].x, 0.0f, 1.0f);
    return matte;
}

}  // namespace relamp
