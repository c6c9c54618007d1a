#include "image/image_io.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <mutex>
#include <optional>
#include <sstream>

#include "base/atomic_file.h"
#include "base/error.h"
#include "image/chromaticities.h"
#include "image/dpx_header.h"
#include "image/exr_header.h"

namespace relamp {
namespace fs = std::filesystem;
namespace {

const OIIO::TypeDesc floatType(OIIO::TypeDesc::FLOAT);

/// The library's own threads are off because callers already read several images at once.
void setUpLibrary() {
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

std::string lower(std::string text) {
    for (char& c : text) c = char(std::tolower(static_cast<unsigned char>(c)));
    return text;
}

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

std::unique_ptr<OIIO::ImageInput> openImage(const fs::path& file) {
    setUpLibrary();
    std::error_code ignored;
    if (!fs::exists(file, ignored)) throw Error("{}: does not exist", file.string());
    if (!fs::is_regular_file(file, ignored)) throw Error("{}: is not a file", file.string());
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
        throw Error("{}: is not a readable image ({})", file.string(), reason.empty() ? "unknown format" : reason);
    }
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

struct ChannelChoice {
    int r = 0, g = 0, b = 0, alpha = -1;
};

/// R, G, B by name; else the first three; one or two channels are grey.
ChannelChoice chooseChannels(const OIIO::ImageSpec& spec, const fs::path& file) {
    const auto find = [&](const char* name) {
        for (int c = 0; c < spec.nchannels; ++c)
            if (lower(spec.channel_name(c)) == name) return c;
        return -1;
    };
    ChannelChoice choice;
    choice.alpha = spec.alpha_channel >= 0 && spec.alpha_channel < spec.nchannels ? spec.alpha_channel : find("a");
    if (find("ry") >= 0 && find("by") >= 0)
        throw Error("{}: stores luminance and chroma, expected R, G, B", file.string());
    const int r = find("r"), g = find("g"), b = find("b");
    if (r >= 0 && g >= 0 && b >= 0) {
        choice.r = r, choice.g = g, choice.b = b;
        return choice;
    }
    if (const int y = find("y"); y >= 0) {
        choice.r = choice.g = choice.b = y;
        return choice;
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

enum class Curve { linear, srgb, gamma, cineonLog };
struct Transfer {
    Curve curve = Curve::linear;
    float gamma = 1;
};

/// What the file's header says about its transfer curve. The library's names for colour spaces changed between its
/// versions 2 and 3, so they are recognised by their parts.
Transfer transferOf(const OIIO::ImageSpec& spec, bool integer) {
    if (!integer) return {};
    const std::string space = lower(spec.get_string_attribute("oiio:ColorSpace"));
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
std::optional<Mat3> primariesMatrix(const OIIO::ImageSpec& spec) {
    const auto* attribute = spec.find_attribute("chromaticities");
    if (!attribute) return std::nullopt;
    const OIIO::TypeDesc type = attribute->type();
    if (type.basetype != OIIO::TypeDesc::FLOAT || type.numelements() * type.aggregate != 8) return std::nullopt;
    Chromaticities c;
    std::memcpy(c.data(), attribute->data(), sizeof c);
    if (isRec709(c)) return std::nullopt;
    return rec709From(c);
}

/// Reads channels [first, end) in bands from top to bottom, and gives each to part(row, count, samples); a band is a
/// whole number of the blocks that files are packed in.
template <class Sample, class Part>
void readBands(OIIO::ImageInput& input, const fs::path& file, int first, int end, OIIO::TypeDesc type,
               const std::function<void()>& between, Part&& part) {
    const OIIO::ImageSpec spec = input.spec();
    const bool tiled = spec.tile_width > 0 && spec.tile_height > 0;
    const int band = tiled ? spec.tile_height : 256;
    std::vector<Sample> samples(size_t(std::min(band, spec.height)) * size_t(spec.width) * size_t(end - first));
    for (int y = 0; y < spec.height; y += band) {
        if (between) between();
        const int count = std::min(band, spec.height - y), top = spec.y + y;
        const bool good = tiled
                              ? input.read_tiles(0, 0, spec.x, spec.x + spec.width, top, top + count, spec.z,
                                                 spec.z + 1, first, end, type, samples.data())
                              : input.read_scanlines(0, 0, top, top + count, spec.z, first, end, type, samples.data());
        if (!good) throw Error("{}: cannot be read to its end ({})", file.string(), input.geterror());
        part(y, count, samples);
    }
}

/// Counts and empties samples that are no radiance. Slightly negative ones come from lossy compression.
void setRight(Image& image, ImageReport& report) {
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
            spoil(i);
        }
    }
}

}  // namespace

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
    const OIIO::ImageSpec spec = input->spec();
    if (const size_t pixels = size_t(spec.width) * spec.height; pixels > maxPixels)
        throw Error("{}: has {} pixels, expected at most {}", file.string(), pixels, maxPixels);
    if (spec.format.basetype != OIIO::TypeDesc::UINT8 && spec.format.basetype != OIIO::TypeDesc::UINT16)
        throw Error("{}: is no 8 or 16 bit image, so it is radiance already", file.string());
    CodeImage image;
    image.width = spec.width, image.height = spec.height;
    image.linear = transferOf(spec, true).curve == Curve::linear;
    const ChannelChoice choice = chooseChannels(spec, file);
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
    auto input = openImage(file);
    const OIIO::ImageSpec spec = input->spec();
    const std::pair<int, int> whole = imageSize(spec);
    const int width = whole.first, height = whole.second;
    for (const size_t pixels : {size_t(width) * height, size_t(spec.width) * spec.height})
        if (pixels > maxPixels) throw Error("{}: has {} pixels, expected at most {}", file.string(), pixels, maxPixels);

    const ChannelChoice choice = chooseChannels(spec, file);
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
    const auto matrix = dataFile ? std::nullopt : primariesMatrix(spec);
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
    if (cropped) image.usable.assign(image.pixels.size(), 0);
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
                                 if (cropped) image.usable[i] = 1;
                                 if (hasAlpha && sample[choice.alpha - first] < 0.5f) {
                                     if (image.usable.empty()) image.usable.assign(image.pixels.size(), 1);
                                     image.usable[i] = 0;
                                     ++found.transparent;
                                 }
                             }
                         }
                     });
    setRight(image, found);
    if (report) *report = found;
    return image;
}

namespace {

/// Header entries. Sixteen numbers for worldToCamera and worldToNDC become matrices, as EXR readers expect.
void putHeader(OIIO::ImageSpec& spec, const std::map<std::string, std::string>& header) {
    for (const auto& [name, value] : header) {
        if (lower(name) == "worldtocamera" || lower(name) == "worldtondc") {
            std::istringstream in(value);
            std::array<float, 16> m{};
            size_t read = 0;
            while (read < 16 && in >> m[read]) ++read;
            if (read == 16) {
                const OIIO::TypeDesc matrix(OIIO::TypeDesc::FLOAT, OIIO::TypeDesc::MATRIX44);
                spec.attribute(lower(name) == "worldtocamera" ? "worldtocamera" : "worldtoNDC", matrix, m.data());
                continue;
            }
        }
        spec.attribute(name, value);
    }
}

void putExrDefaults(OIIO::ImageSpec& spec) {
    spec.attribute("compression", "zip");
    spec.attribute("DateTime", "");  // else the time of writing goes in, and equal images get unequal files
    spec.attribute("chromaticities", OIIO::TypeDesc(OIIO::TypeDesc::FLOAT, 8), rec709Chromaticities.data());
}

/// The file's bytes, encoded in memory, because a full disk is reported reliably only by our own writing. `file` gives
/// the format by its ending and is named in errors. `fillRows(y, rows, out)` gives interleaved samples.
template <class FillRows>
std::string encode(const fs::path& file, const OIIO::ImageSpec& spec, FillRows&& fillRows) {
    setUpLibrary();
    auto output = OIIO::ImageOutput::create(file.string());
    if (!output) throw Error("{}: cannot be written ({})", file.string(), OIIO::geterror());
    if (!output->supports("ioproxy")) throw Error("{}: this format cannot be written", file.string());
    OIIO::Filesystem::IOVecOutput memory;
    output->set_ioproxy(&memory);
    const auto check = [&](bool good) {
        if (!good) throw Error("{}: cannot be encoded ({})", file.string(), output->geterror());
    };
    check(output->open(file.string(), spec));
    constexpr int rowsAtOnce = 64;
    std::vector<float> rows(size_t(std::min(rowsAtOnce, spec.height)) * spec.width * spec.nchannels);
    for (int y = 0; y < spec.height; y += rowsAtOnce) {
        const int end = std::min(y + rowsAtOnce, spec.height);
        fillRows(y, end - y, rows.data());
        check(output->write_scanlines(y, end, 0, floatType, rows.data()));
    }
    check(output->close());
    const auto& bytes = memory.buffer();
    return std::string(bytes.begin(), bytes.end());
}

/// Three channels of an image, through the sRGB curve where the format is for display.
std::string encodeColours(const fs::path& file, const OIIO::ImageSpec& spec, const Image& image, bool display) {
    return encode(file, spec, [&](int y, int rows, float* out) {
        const Rgb* from = &image.pixels[size_t(y) * image.width];
        for (size_t i = 0; i < size_t(rows) * image.width; ++i)
            for (int c = 0; c < 3; ++c) out[i * 3 + size_t(c)] = display ? srgbEncode(from[i][c]) : from[i][c];
    });
}

void checkPixels(const fs::path& file, const Image& image) {
    if (image.width <= 0 || image.height <= 0 || image.pixels.size() != size_t(image.width) * image.height)
        throw Error("{}: there are no pixels to write", file.string());
}

constexpr float largestHalf = 65504.0f;

}  // namespace

void writeImage(const fs::path& file, const Image& image, const std::map<std::string, std::string>& header) {
    checkPixels(file, image);
    const std::string extension = lowerExtension(file);
    const bool exr = extension == ".exr", hdr = extension == ".hdr";
    const bool display = extension == ".png" || extension == ".jpg" || extension == ".jpeg";
    if (!exr && !hdr && !display)
        throw Error("{}: the ending \"{}\" is unknown, expected .exr, .hdr, .png, .jpg or .jpeg", file.string(),
                    extension);
    OIIO::TypeDesc type = floatType;
    if (display) type = OIIO::TypeDesc(OIIO::TypeDesc::UINT8);
    // Half floats end at 65504; a brighter sun keeps its energy in full floats.
    if (exr && std::none_of(image.pixels.begin(), image.pixels.end(),
                            [](const Rgb& c) { return maxChannel(c) > largestHalf; }))
        type = OIIO::TypeDesc(OIIO::TypeDesc::HALF);
    OIIO::ImageSpec spec(image.width, image.height, 3, type);
    if (exr) putExrDefaults(spec);
    if (display) spec.attribute("oiio:ColorSpace", "sRGB");
    if (extension == ".jpg" || extension == ".jpeg") spec.attribute("CompressionQuality", 95);
    putHeader(spec, header);
    writeBytesAtomically(file, encodeColours(file, spec, image, display));
}

std::string encodePng(const Image& image) {
    const fs::path name = "picture.png";
    checkPixels(name, image);
    OIIO::ImageSpec spec(image.width, image.height, 3, OIIO::TypeDesc(OIIO::TypeDesc::UINT8));
    spec.attribute("oiio:ColorSpace", "sRGB");
    return encodeColours(name, spec, image, true);
}

void writeChannels(const fs::path& file, int width, int height, const std::vector<Channel>& channels,
                   const std::map<std::string, std::string>& header) {
    if (width <= 0 || height <= 0 || channels.empty()) throw Error("{}: there are no pixels to write", file.string());
    if (lowerExtension(file) != ".exr") throw Error("{}: layers are written as .exr only", file.string());
    OIIO::ImageSpec spec(width, height, int(channels.size()), floatType);
    spec.channelnames.clear();
    for (size_t c = 0; c < channels.size(); ++c) {
        const Channel& channel = channels[c];
        if (channel.values.size() != size_t(width) * height)
            throw Error("{}: channel {}: has {} values, expected {}", file.string(), channel.name,
                        channel.values.size(), size_t(width) * height);
        const bool fitsHalf = std::none_of(channel.values.begin(), channel.values.end(),
                                           [](float v) { return std::isfinite(v) && std::abs(v) > largestHalf; });
        spec.channelnames.push_back(channel.name);
        spec.channelformats.emplace_back(channel.half && fitsHalf ? OIIO::TypeDesc::HALF : OIIO::TypeDesc::FLOAT);
        if (channel.name == "A") spec.alpha_channel = int(c);
    }
    putExrDefaults(spec);
    putHeader(spec, header);
    writeBytesAtomically(file, encode(file, spec, [&](int y, int rows, float* out) {
                             for (size_t c = 0; c < channels.size(); ++c) {
                                 const float* from = &channels[c].values[size_t(y) * width];
                                 for (size_t i = 0; i < size_t(rows) * width; ++i)
                                     out[i * channels.size() + c] = from[i];
                             }
                         }));
}

namespace {

/// A file that remembers why a write failed: the library says only that one did.
class DiskFile : public OIIO::Filesystem::IOProxy {
public:
    /// `shown` is what messages call it. With `nameless` the file has no name and is gone when closed.
    DiskFile(const fs::path& file, std::string shown, bool nameless = false)
        : IOProxy(file.string(), Write), shown_(std::move(shown)) {
        fd_ = nameless ? ::open(file.parent_path().empty() ? "." : file.parent_path().c_str(), O_TMPFILE | O_RDWR, 0600)
                       : ::open(file.c_str(), O_CREAT | O_TRUNC | O_WRONLY | O_CLOEXEC, 0666);
        if (fd_ < 0 && nameless) {  // not every file system has nameless files
            std::string name = (file.string() + ".XXXXXX");
            fd_ = ::mkstemp(name.data());
            if (fd_ >= 0) ::unlink(name.c_str());
        }
        if (fd_ < 0) failed_ = errno;
        check();
    }
    ~DiskFile() override { DiskFile::close(); }
    DiskFile(const DiskFile&) = delete;
    DiskFile& operator=(const DiskFile&) = delete;

    const char* proxytype() const override { return "disk"; }
    void close() override {
        if (fd_ >= 0 && ::close(fd_) != 0) failed_ = errno;
        fd_ = -1;
    }
    int64_t tell() override { return m_pos; }
    bool seek(int64_t offset) override {
        m_pos = offset;
        return true;
    }
    size_t write(const void* bytes, size_t size) override {
        const size_t done = pwrite(bytes, size, m_pos);
        m_pos += int64_t(done);
        return done;
    }
    size_t pwrite(const void* bytes, size_t size, int64_t offset) override {
        size_t done = 0;
        while (done < size) {
            const ssize_t n =
                ::pwrite(fd_, static_cast<const char*>(bytes) + done, size - done, offset + int64_t(done));
            if (n < 0 && errno == EINTR) continue;
            if (n <= 0) {
                failed_ = errno;
                break;
            }
            done += size_t(n);
        }
        end_ = std::max(end_, offset + int64_t(done));
        return done;
    }
    size_t pread(void* bytes, size_t size, int64_t offset) override {
        size_t done = 0;
        while (done < size) {
            const ssize_t n = ::pread(fd_, static_cast<char*>(bytes) + done, size - done, offset + int64_t(done));
            if (n < 0 && errno == EINTR) continue;
            if (n <= 0) {
                failed_ = n < 0 ? errno : EIO;
                break;
            }
            done += size_t(n);
        }
        return done;
    }
    size_t size() const override { return size_t(end_); }
    void flush() const override {}

    /// Throws OutOfResources or Error when something went wrong.
    void check() const {
        if (failed_) throwWriteFailure(shown_, failed_);
    }

private:
    std::string shown_;
    int fd_ = -1, failed_ = 0;
    int64_t end_ = 0;
};

/// An image being written to `temporary`, which will become `target`. Multi-part files are opened by name, because the
/// library cannot write them through a file of ours.
struct Encoder {
    fs::path target, opened;
    std::unique_ptr<DiskFile> disk;
    std::unique_ptr<OIIO::ImageOutput> output;

    Encoder(const fs::path& temporary, fs::path shown, bool byName = false)
        : target(std::move(shown)), opened(byName ? temporary : target) {
        setUpLibrary();
        output = OIIO::ImageOutput::create(target.string());
        if (!output) throw Error("{}: cannot be written ({})", target.string(), OIIO::geterror());
        if (byName) return;
        if (!output->supports("ioproxy")) throw Error("{}: this format cannot be written", target.string());
        disk = std::make_unique<DiskFile>(temporary, target.string());
        output->set_ioproxy(disk.get());
    }
    void check(bool good) const {
        if (good) return;
        const std::string reason = output->geterror();
        if (disk) disk->check();
        std::error_code failed;
        const fs::space_info space = fs::space(opened.parent_path().empty() ? "." : opened.parent_path(), failed);
        if (!failed && space.available < (1 << 20))
            throw OutOfResources("{}: cannot be written (no space left)", target.string());
        throw Error("{}: cannot be encoded ({})", target.string(), reason);
    }
    void close() {
        check(output->close());
        if (!disk) return;
        disk->close();
        disk->check();
    }
};

constexpr int rowsInZip = 16;  // lines that ZIP packs together

/// Rows of planar channels into the open part of a file.
void writePlanes(Encoder& encoder, const std::vector<const float*>& planes, int width, int first, int count,
                 const std::function<void()>& between) {
    std::vector<float> mixed(size_t(rowsInZip) * size_t(width) * planes.size());
    for (int y = 0; y < count; y += rowsInZip) {
        const int rows = std::min(rowsInZip, count - y);
        if (between) between();
        for (size_t c = 0; c < planes.size(); ++c) {
            const float* from = planes[c] + size_t(y) * size_t(width);
            for (size_t i = 0; i < size_t(rows) * size_t(width); ++i) mixed[i * planes.size() + c] = from[i];
        }
        encoder.check(encoder.output->write_scanlines(first + y, first + y + rows, 0, floatType, mixed.data()));
    }
}

/// The planes of one strip.
struct Strip {
    std::vector<std::vector<float>> planes;
    Strip(size_t channels, size_t pixels) : planes(channels, std::vector<float>(pixels)) {}
    std::vector<float*> places() {
        std::vector<float*> out;
        for (auto& plane : planes) out.push_back(plane.data());
        return out;
    }
};

void holdToHalf(std::vector<float>& plane, size_t count) {
    for (size_t i = 0; i < count; ++i) plane[i] = std::clamp(plane[i], -largestHalf, largestHalf);
}

}  // namespace

void writeChannelRows(const fs::path& file, int width, int height, int stripRows, const std::vector<ChannelPart>& parts,
                      const FillChannelRows& fill, const std::map<std::string, std::string>& header,
                      const std::function<void()>& between) {
    if (width <= 0 || height <= 0 || parts.empty()) throw Error("{}: there are no pixels to write", file.string());
    if (lowerExtension(file) != ".exr") throw Error("{}: layers are written as .exr only", file.string());
    stripRows = std::min((std::max(stripRows, 1) + rowsInZip - 1) / rowsInZip * rowsInZip, height);
    std::vector<OIIO::ImageSpec> specs;
    std::vector<ChannelFormat> all;
    for (const ChannelPart& part : parts) {
        OIIO::ImageSpec spec(width, height, int(part.channels.size()), floatType);
        spec.channelnames.clear();
        for (const ChannelFormat& channel : part.channels) {
            if (channel.name == "A") spec.alpha_channel = int(spec.channelnames.size());
            spec.channelnames.push_back(channel.name);
            spec.channelformats.emplace_back(channel.half ? OIIO::TypeDesc::HALF : OIIO::TypeDesc::FLOAT);
            all.push_back(channel);
        }
        if (parts.size() > 1) spec.attribute("oiio:subimagename", part.name);
        putExrDefaults(spec);
        putHeader(spec, header);
        specs.push_back(std::move(spec));
    }
    const size_t pixels = size_t(stripRows) * size_t(width);
    writeFileAtomically(file, [&](const fs::path& temporary) {
        Encoder encoder(temporary, file, parts.size() > 1);
        Strip strip(all.size(), pixels);
        const auto strips = [&](const auto& part) {
            for (int y = 0; y < height; y += stripRows) part(y, std::min(stripRows, height - y));
        };
        const auto filled = [&](int first, int count) {
            fill(first, count, strip.places());
            for (size_t c = 0; c < all.size(); ++c)
                if (all[c].half) holdToHalf(strip.planes[c], size_t(count) * size_t(width));
        };
        if (parts.size() == 1) {
            encoder.check(encoder.output->open(encoder.opened.string(), specs[0]));
            strips([&](int first, int count) {
                filled(first, count);
                std::vector<const float*> planes;
                for (const auto& plane : strip.planes) planes.push_back(plane.data());
                writePlanes(encoder, planes, width, first, count, between);
            });
        } else {
            DiskFile waiting(temporary, file.string(), true);
            const auto place = [&](size_t channel, int first) {
                return int64_t((channel * size_t(height) + size_t(first)) * size_t(width) * sizeof(float));
            };
            strips([&](int first, int count) {
                filled(first, count);
                for (size_t c = 0; c < all.size(); ++c)
                    waiting.pwrite(strip.planes[c].data(), size_t(count) * size_t(width) * sizeof(float),
                                   place(c, first));
                waiting.check();
            });
            encoder.check(encoder.output->open(encoder.opened.string(), int(specs.size()), specs.data()));
            size_t channel = 0;
            for (size_t p = 0; p < parts.size(); ++p) {
                if (p > 0)
                    encoder.check(
                        encoder.output->open(encoder.opened.string(), specs[p], OIIO::ImageOutput::AppendSubimage));
                strips([&](int first, int count) {
                    std::vector<const float*> planes;
                    for (size_t c = 0; c < parts[p].channels.size(); ++c) {
                        waiting.pread(strip.planes[c].data(), size_t(count) * size_t(width) * sizeof(float),
                                      place(channel + c, first));
                        planes.push_back(strip.planes[c].data());
                    }
                    waiting.check();
                    writePlanes(encoder, planes, width, first, count, between);
                });
                channel += parts[p].channels.size();
            }
        }
        encoder.close();
        if (parts.size() > 1) {
            // A disk that fills in the last moment is seen only by reading back what was written last.
            std::vector<float> last(size_t(width) * parts.back().channels.size());
            auto written = OIIO::ImageInput::open(temporary.string());
            const int part = int(parts.size()) - 1;
            encoder.check(written &&
                          written->read_scanlines(part, 0, height - 1, height, 0, 0, int(parts.back().channels.size()),
                                                  floatType, last.data()));
        }
    });
}

void writeColourRows(const fs::path& file, int width, int height, int stripRows, const FillColourRows& fill,
                     bool encoded) {
    const std::string extension = lowerExtension(file);
    const bool hdr = extension == ".hdr", jpeg = extension == ".jpg" || extension == ".jpeg";
    if (!hdr && !jpeg && extension != ".png")
        throw Error("{}: the ending \"{}\" is unknown, expected .exr, .hdr, .png, .jpg or .jpeg", file.string(),
                    extension);
    if (width <= 0 || height <= 0) throw Error("{}: there are no pixels to write", file.string());
    stripRows = std::clamp(stripRows, 1, height);
    OIIO::ImageSpec spec(width, height, 3, hdr ? floatType : OIIO::TypeDesc(OIIO::TypeDesc::UINT8));
    if (!hdr) spec.attribute("oiio:ColorSpace", "sRGB");
    if (jpeg) spec.attribute("CompressionQuality", 95);
    writeFileAtomically(file, [&](const fs::path& temporary) {
        Encoder encoder(temporary, file);
        encoder.check(encoder.output->open(encoder.opened.string(), spec));
        std::vector<Rgb> rows(size_t(stripRows) * size_t(width));
        for (int y = 0; y < height; y += stripRows) {
            const int count = std::min(stripRows, height - y);
            fill(y, count, rows.data());
            if (!hdr && !encoded)
                for (size_t i = 0; i < size_t(count) * size_t(width); ++i)
                    for (int c = 0; c < 3; ++c) rows[i][c] = srgbEncode(rows[i][c]);
            encoder.check(encoder.output->write_scanlines(y, y + count, 0, floatType, rows.data()));
        }
        encoder.close();
    });
}

}  // namespace relamp
