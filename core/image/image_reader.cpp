// Image files are read. OpenImageIO is named here and in image_writer.cpp only.
#include <OpenImageIO/imageio.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <mutex>
#include <optional>

#include "base/error.h"
#include "base/is_there.h"
#include "image/chromaticities.h"
#include "image/dpx_header.h"
#include "image/exr_header.h"
#include "image/image_files.h"
#include "image/image_io.h"
#include "image/jpeg_end.h"

namespace relamp {
namespace fs = std::filesystem;
namespace {

const OIIO::TypeDesc floatType(OIIO::TypeDesc::FLOAT);

/// The library's name for the format by the file's first bytes, for those that are often named wrongly; "" for others.
/// Camera raw begins as TIFF does, so TIFF is told only under the ending of another format.
std::string formatByContent(const fs::path& file) {
    std::array<char, 8> begin{};
    std::ifstream(file, std::ios::binary).read(begin.data(), begin.size());
    const std::string_view bytes(begin.data(), begin.size());
    const auto begins = [&](std::string_view magic) { return bytes.substr(0, magic.size()) == magic; };
    if (begins("\x89PNG\r\n")) return "png";
    if (begins("\xff\xd8\xff")) return "jpeg";
    if (begins("v/1\x01")) return "openexr";
    if (begins("#?")) return "hdr";
    const std::string extension = lowerExtension(file);
    const bool otherwise = extension == ".png" || extension == ".jpg" || extension == ".jpeg" || extension == ".exr" ||
                           extension == ".hdr";
    if (otherwise && (begins(std::string_view("II*\0", 4)) || begins(std::string_view("MM\0*", 4)))) return "tiff";
    return "";
}

struct ChannelChoice {
    int r = 0, g = 0, b = 0, alpha = -1;
};

/// R, G, B by name, of the image or of its first layer that has them; Y alone is grey. In files that name their
/// channels freely (EXR) nothing else is a colour: depth read as light would be silently wrong. Elsewhere the first
/// three; one or two channels are grey.
std::optional<ChannelChoice> choiceOf(const OIIO::ImageSpec& spec, std::string_view format) {
    const auto find = [&](const std::string& name) {
        for (int c = 0; c < spec.nchannels; ++c)
            if (lowerCase(spec.channel_name(c)) == name) return c;
        return -1;
    };
    ChannelChoice choice;
    choice.alpha = spec.alpha_channel >= 0 && spec.alpha_channel < spec.nchannels ? spec.alpha_channel : find("a");
    const auto takeLayer = [&](const std::string& layer) {
        const int r = find(layer + "r"), g = find(layer + "g"), b = find(layer + "b");
        if (r < 0 || g < 0 || b < 0) return false;
        choice.r = r, choice.g = g, choice.b = b;
        return true;
    };
    if (takeLayer("")) return choice;
    // Beside X and Z it is a position or a tristimulus value.
    if (const int y = find("y"); y >= 0 && (find("x") < 0 || find("z") < 0)) {
        choice.r = choice.g = choice.b = y;
        return choice;
    }
    if (format == "openexr") {
        for (int c = 0; c < spec.nchannels; ++c)
            if (const std::string name = lowerCase(spec.channel_name(c)); name.ends_with(".r"))
                if (takeLayer(name.substr(0, name.size() - 1))) return choice;
        return std::nullopt;
    }
    std::vector<int> colours;
    for (int c = 0; c < spec.nchannels; ++c)
        if (c != choice.alpha) colours.push_back(c);
    if (colours.empty()) colours.push_back(0);
    choice.r = colours[0];
    choice.g = colours.size() >= 3 ? colours[1] : colours[0];
    choice.b = colours.size() >= 3 ? colours[2] : colours[0];
    return choice;
}

/// The same; throws Error where there are none.
ChannelChoice chooseChannels(const OIIO::ImageInput& input, const fs::path& file) {
    const OIIO::ImageSpec& spec = input.spec();
    const auto has = [&](const char* name) {
        return std::any_of(spec.channelnames.begin(), spec.channelnames.end(),
                           [&](const std::string& channel) { return lowerCase(channel) == name; });
    };
    if (has("ry") && has("by")) throw Error("{}: stores luminance and chroma, expected R, G, B", file.string());
    if (const auto choice = choiceOf(spec, input.format_name())) return *choice;
    std::string names;
    for (size_t c = 0; c < spec.channelnames.size() && c < 8; ++c)
        names += (c ? ", " : "") + spec.channelnames[c].substr(0, 80);
    throw Error("{}: has the channels {}{}, expected R, G and B, or Y", file.string(), names,
                spec.nchannels > 8 ? ", ..." : "");
}

/// The library's reason, which may have lines, as part of a sentence.
std::string inOneLine(std::string reason) {
    while (!reason.empty() && reason.back() == '\n') reason.pop_back();
    for (size_t at = 0; (at = reason.find('\n', at)) != std::string::npos; at += 2) reason.replace(at, 1, "; ");
    return reason;
}

/// The library turns a lack of memory into a text.
void refuseMemory(const fs::path& file, const std::string& reason) {
    if (reason.find("bad_alloc") != std::string::npos) throw OutOfResources("{}: out of memory", file.string());
}

/// Moves to the first flat part that has colours; where none has, the first part stays open.
void seekColours(OIIO::ImageInput& input) {
    for (int part = 0; input.seek_subimage(part, 0); ++part)
        if (!input.spec().deep && choiceOf(input.spec(), input.format_name())) return;
    input.geterror();  // that there is no further part
    input.seek_subimage(0, 0);
}

std::unique_ptr<OIIO::ImageInput> openImage(const fs::path& file) {
    setUpImageLibrary();
    if (!isFile(file)) throw Error("{}: {}", file.string(), whyNoFile(file));
    errno = 0;
    if (!std::ifstream(file, std::ios::binary))
        throw Error("{}: cannot be read ({})", file.string(), std::strerror(errno));
    checkExrHeader(file);
    checkDpxHeader(file);
    OIIO::ImageSpec wanted;
    wanted.attribute("oiio:UnassociatedAlpha", 1);  // alpha is a mask here, colours must not be scaled by it
    wanted.attribute("raw:ColorSpace", "sRGB-linear");
    std::unique_ptr<OIIO::ImageInput> input;
    std::string reason;
    if (const std::string format = formatByContent(file); format.empty()) {
        input = OIIO::ImageInput::open(file.string(), &wanted);
    } else if (input = OIIO::ImageInput::create(format); input) {
        OIIO::ImageSpec spec;
        if (!input->open(file.string(), spec, wanted)) {
            reason = input->geterror();
            input.reset();
        }
    }
    if (!input) {
        if (reason.empty()) reason = OIIO::geterror();
        refuseMemory(file, reason);
        if (reason.empty() || reason.find("could not find a format reader") != std::string::npos)
            reason = "unknown format";
        throw Error("{}: is not a readable image ({})", file.string(), inOneLine(reason));
    }
    seekColours(*input);
    const OIIO::ImageSpec& spec = input->spec();
    if (spec.width <= 0 || spec.height <= 0 || spec.nchannels <= 0) throw Error("{}: has no pixels", file.string());
    if (spec.depth > 1) throw Error("{}: is a volume, expected a flat image", file.string());
    for (const int corner : {spec.x, spec.y, spec.full_x, spec.full_y})
        if (std::abs(double(corner)) > 1 << 29)
            throw Error("{}: a corner of its window lies at {}, too far out", file.string(), corner);
    if (spec.deep) throw Error("{}: is a deep image, expected a flat one", file.string());
    return input;
}

/// The display window; a crop (data window) is put into it.
std::pair<int, int> imageSize(const OIIO::ImageSpec& spec) {
    if (spec.full_width > 0 && spec.full_height > 0) return {spec.full_width, spec.full_height};
    return {spec.width, spec.height};
}

enum class Curve { linear, srgb, gamma, cineonLog };
struct Transfer {
    Curve curve = Curve::linear;
    float gamma = 1;
};

/// What the file's header says about its transfer curve. The library's names for colour spaces changed between its
/// versions 2 and 3, so they are recognised by their parts.
Transfer transferOf(const OIIO::ImageSpec& spec, bool integer) {
    if (!integer) return {};
    const std::string space = lowerCase(spec.get_string_attribute("oiio:ColorSpace"));
    if (space == "linear" || space == "scene_linear" || space.rfind("lin_", 0) == 0 || space == "srgb-linear")
        return {};
    if (space == "kodaklog") return {Curve::cineonLog};
    const float gamma = spec.get_float_attribute("oiio:Gamma", 0.0f);
    if (space.rfind("gamma", 0) == 0 && gamma > 0.1f && gamma < 10) {
        if (std::abs(gamma - 1) < 1e-3f) return {};
        return {Curve::gamma, gamma};
    }
    return {Curve::srgb};
}

float decode(const Transfer& transfer, float value) {
    switch (transfer.curve) {
        case Curve::linear: return value;
        case Curve::srgb: return srgbDecode(value);
        case Curve::gamma: return value <= 0 ? value : std::pow(value, transfer.gamma);
        case Curve::cineonLog: {
            // Kodak's film log: code 95 is black, code 685 is 90 % white.
            constexpr float black = 0.010797752f;  // 10^((95 - 685) / 300)
            return std::max(0.0f, (std::pow(10.0f, (1023 * value - 685) / 300) - black) / (1 - black));
        }
    }
    return value;
}

/// Matrix to Rec.709 from the header's primaries; nothing when they are Rec.709 or not given.
std::optional<Mat3> primariesMatrix(const OIIO::ImageSpec& spec, const fs::path& file) {
    const auto* attribute = spec.find_attribute("chromaticities");
    if (!attribute) return std::nullopt;
    const OIIO::TypeDesc type = attribute->type();
    if (type.basetype != OIIO::TypeDesc::FLOAT || type.numelements() * type.aggregate != 8) return std::nullopt;
    Chromaticities c;
    std::memcpy(c.data(), attribute->data(), sizeof c);
    if (isRec709(c)) return std::nullopt;
    const std::optional<Mat3> matrix = rec709From(c);
    if (!matrix) throw Error("{}: the header's chromaticities are no colour space", file.string());
    return matrix;
}

/// Reads channels [first, end) in bands from top to bottom, and gives each to take(row, count, samples); a band is a
/// whole number of the blocks that files are packed in.
template <class Sample, class Take>
void readBands(OIIO::ImageInput& input, const fs::path& file, int first, int end, OIIO::TypeDesc type,
               const std::function<void()>& between, Take&& take) {
    const OIIO::ImageSpec spec = input.spec();
    const int part = input.current_subimage();
    const bool tiled = spec.tile_width > 0 && spec.tile_height > 0;
    const int band = tiled ? spec.tile_height : 256;
    std::vector<Sample> samples(size_t(std::min(band, spec.height)) * size_t(spec.width) * size_t(end - first));
    for (int y = 0; y < spec.height; y += band) {
        if (between) between();
        const int count = std::min(band, spec.height - y), top = spec.y + y;
        const bool good =
            tiled ? input.read_tiles(part, 0, spec.x, spec.x + spec.width, top, top + count, spec.z, spec.z + 1, first,
                                     end, type, samples.data())
                  : input.read_scanlines(part, 0, top, top + count, spec.z, first, end, type, samples.data());
        // Truncated TIFF strips are filled and called good, but leave an error behind.
        if (!good || input.has_error()) {
            const std::string reason = input.geterror();
            refuseMemory(file, reason);
            throw Error("{}: cannot be read to its end ({})", file.string(), inOneLine(reason));
        }
        take(y, count, samples);
    }
}

/// Counts and empties samples that are no radiance; negative ones are counted, and stay where `keepNegative` says so.
/// Slightly negative ones come from lossy compression.
void setRight(Image& image, ImageReport& report, bool keepNegative) {
    const auto spoil = [&](size_t i) {
        image.pixels[i] = Rgb(0);
        if (image.usable.empty()) image.usable.assign(image.pixels.size(), 1);
        image.usable[i] = 0;
    };
    for (size_t i = 0; i < image.pixels.size(); ++i) {
        const Rgb& c = image.pixels[i];
        if (std::isnan(c.x) || std::isnan(c.y) || std::isnan(c.z)) {
            ++report.nan;
            spoil(i);
        } else if (!isFinite(c)) {
            ++report.infinite;
            spoil(i);
        } else if (c.x < 0 || c.y < 0 || c.z < 0) {
            ++report.negative;
            if (!keepNegative) spoil(i);
        }
    }
}

Image readPixels(const fs::path& file, ImageReport* report, bool dataFile, size_t maxPixels,
                 const std::function<void()>& between, bool asTheyStand) {
    auto input = openImage(file);
    checkJpegEnd(file);
    const OIIO::ImageSpec spec = input->spec();
    const std::pair<int, int> whole = imageSize(spec);
    const int width = whole.first, height = whole.second;
    for (const size_t pixels : {size_t(width) * height, size_t(spec.width) * spec.height})
        if (pixels > maxPixels) throw Error("{}: has {} pixels, expected at most {}", file.string(), pixels, maxPixels);

    const ChannelChoice choice = chooseChannels(*input, file);
    int first = std::min({choice.r, choice.g, choice.b}), last = std::max({choice.r, choice.g, choice.b});
    if (choice.alpha >= 0) first = std::min(first, choice.alpha), last = std::max(last, choice.alpha);
    if (last - first >= 8)
        first = std::min({choice.r, choice.g, choice.b}), last = std::max({choice.r, choice.g, choice.b});
    const bool hasAlpha = choice.alpha >= first && choice.alpha <= last;
    const size_t channels = size_t(last - first) + 1;

    ImageReport found;
    found.integer = spec.format.basetype != OIIO::TypeDesc::FLOAT && spec.format.basetype != OIIO::TypeDesc::HALF &&
                    spec.format.basetype != OIIO::TypeDesc::DOUBLE;
    const Transfer transfer = dataFile ? Transfer{} : transferOf(spec, found.integer);
    found.clipLevel = found.integer ? decode(transfer, 1.0f) : 0.0f;
    const auto matrix = dataFile ? std::nullopt : primariesMatrix(spec, file);
    // 8-bit curves are looked up because most photographs are 8-bit.
    std::vector<float> table;
    if (transfer.curve != Curve::linear && spec.format.basetype == OIIO::TypeDesc::UINT8)
        for (int i = 0; i < 256; ++i) table.push_back(decode(transfer, float(i) / 255));
    const auto linear = [&](float value) {
        if (!table.empty()) return table[size_t(std::clamp(std::lround(value * 255), 0l, 255l))];
        return decode(transfer, value);
    };

    Image image(width, height);
    const int left = spec.x - spec.full_x, top = spec.y - spec.full_y;
    const bool cropped = left > 0 || top > 0 || left + spec.width < width || top + spec.height < height;
    if (cropped && !asTheyStand) image.usable.assign(image.pixels.size(), 0);
    readBands<float>(*input, file, first, last + 1, floatType, between,
                     [&](int row, int count, const std::vector<float>& samples) {
                         for (int y = row; y < row + count; ++y) {
                             const int toY = y + top;
                             if (toY < 0 || toY >= height) continue;
                             for (int x = 0; x < spec.width; ++x) {
                                 const int toX = x + left;
                                 if (toX < 0 || toX >= width) continue;
                                 const float* sample = &samples[(size_t(y - row) * spec.width + x) * channels];
                                 const size_t i = size_t(toY) * width + toX;
                                 Rgb colour(linear(sample[choice.r - first]), linear(sample[choice.g - first]),
                                            linear(sample[choice.b - first]));
                                 image.pixels[i] = matrix ? *matrix * colour : colour;
                                 if (!image.usable.empty() && cropped) image.usable[i] = 1;
                                 if (!asTheyStand && hasAlpha && sample[choice.alpha - first] < 0.5f) {
                                     if (image.usable.empty()) image.usable.assign(image.pixels.size(), 1);
                                     image.usable[i] = 0;
                                     ++found.transparent;
                                 }
                             }
                         }
                     });
    setRight(image, found, asTheyStand);
    if (report) *report = found;
    return image;
}

}  // namespace

void setUpImageLibrary() {
    static std::once_flag once;
    std::call_once(once, [] {
        OIIO::attribute("threads", 1);
        OIIO::attribute("exr_threads", -1);
        // What is no image by its ending and beginning is not shown to the decoders of forty other formats.
        OIIO::attribute("try_all_readers", 0);
    });
}

std::string lowerExtension(const fs::path& file) {
    std::string extension = file.extension().string();
    for (char& c : extension) c = char(std::tolower(static_cast<unsigned char>(c)));
    return extension;
}

std::string lowerCase(std::string text) {
    for (char& c : text) c = char(std::tolower(static_cast<unsigned char>(c)));
    return text;
}

float srgbEncode(float linear) {
    const float c = std::clamp(linear, 0.0f, 1.0f);
    return c <= 0.0031308f ? 12.92f * c : 1.055f * std::pow(c, 1 / 2.4f) - 0.055f;
}

float srgbDecode(float encoded) {
    const float c = std::clamp(encoded, 0.0f, 1.0f);
    return c <= 0.04045f ? c / 12.92f : std::pow((c + 0.055f) / 1.055f, 2.4f);
}

std::pair<int, int> readImageSize(const fs::path& file) { return imageSize(openImage(file)->spec()); }

CodeImage readCodes(const fs::path& file, size_t maxPixels, const std::function<void()>& between) {
    auto input = openImage(file);
    checkJpegEnd(file);
    const OIIO::ImageSpec spec = input->spec();
    if (const size_t pixels = size_t(spec.width) * spec.height; pixels > maxPixels)
        throw Error("{}: has {} pixels, expected at most {}", file.string(), pixels, maxPixels);
    if (spec.format.basetype != OIIO::TypeDesc::UINT8 && spec.format.basetype != OIIO::TypeDesc::UINT16)
        throw Error("{}: is no 8 or 16 bit image, so it is radiance already", file.string());
    CodeImage image;
    image.width = spec.width, image.height = spec.height;
    image.linear = transferOf(spec, true).curve == Curve::linear;
    const ChannelChoice choice = chooseChannels(*input, file);
    const int chosen[] = {choice.r, choice.g, choice.b};
    const OIIO::TypeDesc word(OIIO::TypeDesc::UINT16);
    image.codes.resize(size_t(spec.width) * spec.height * 3);
    const int first = *std::min_element(chosen, chosen + 3), end = *std::max_element(chosen, chosen + 3) + 1;
    const size_t channels = size_t(end - first);
    readBands<uint16_t>(*input, file, first, end, word, between,
                        [&](int y, int count, const std::vector<uint16_t>& codes) {
                            uint16_t* to = &image.codes[size_t(y) * size_t(spec.width) * 3];
                            for (size_t i = 0; i < size_t(count) * size_t(spec.width); ++i)
                                for (size_t c = 0; c < 3; ++c)
                                    to[i * 3 + c] = codes[i * channels + size_t(chosen[c] - first)];
                        });
    return image;
}

ExposureTags readExposureTags(const fs::path& file) {
    const auto input = openImage(file);
    const OIIO::ImageSpec& spec = input->spec();
    const auto number = [&](const char* name) {
        double value = double(spec.get_float_attribute(name, 0.0f));
        if (value == 0) value = spec.get_int_attribute(name, 0);
        return std::isfinite(value) && value > 0 ? value : 0.0;
    };
    ExposureTags tags{number("ExposureTime"), number("FNumber"), number("Exif:PhotographicSensitivity")};
    if (!(tags.iso > 0)) tags.iso = number("Exif:ISOSpeedRatings");
    return tags;
}

Image readImage(const fs::path& file, ImageReport* report, bool dataFile, size_t maxPixels,
                const std::function<void()>& between) {
    return readPixels(file, report, dataFile, maxPixels, between, false);
}

Image readImagePart(const fs::path& file, size_t begin, size_t size, size_t maxPixels,
                    const std::function<void()>& between) {
    if (size == 0) return readImage(file, nullptr, false, maxPixels, between);
    // A nameless file in memory, so that it is held to the same checks as any other.
    constexpr size_t most = size_t(1) << 30;
    if (size > most) throw Error("{}: holds an image of {} bytes, expected at most {}", file.string(), size, most);
    std::string bytes(size, '\0');
    std::ifstream stream(file, std::ios::binary);
    stream.seekg(std::streamoff(begin));
    if (!stream.read(bytes.data(), std::streamsize(size))) throw Error("{}: ends before its image", file.string());
    const int part = memfd_create("image", MFD_CLOEXEC);
    if (part < 0) throw OutOfResources("{}: no room for its image ({})", file.string(), std::strerror(errno));
    const std::unique_ptr<const int, void (*)(const int*)> closes(&part, [](const int* open) { close(*open); });
    for (size_t at = 0; at < size;) {
        const ssize_t written = write(part, bytes.data() + at, size - at);
        if (written <= 0) throw OutOfResources("{}: no room for its image", file.string());
        at += size_t(written);
    }
    const std::string name = "/proc/self/fd/" + std::to_string(part);
    try {
        return readImage(name, nullptr, false, maxPixels, between);
    } catch (const OutOfResources&) { throw; } catch (const Error& error) {
        const std::string words = error.what();
        throw Error("{}: its image{}", file.string(), words.substr(words.rfind(name, 0) == 0 ? name.size() : 0));
    }
}

Image readValues(const fs::path& file, ImageReport* report, bool dataFile, size_t maxPixels,
                 const std::function<void()>& between) {
    return readPixels(file, report, dataFile, maxPixels, between, true);
}

}  // namespace relamp
