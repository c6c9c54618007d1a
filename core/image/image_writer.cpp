// Image files are written, whole or not at all. OpenImageIO is named here and in image_reader.cpp only.
#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <sstream>

#include "base/atomic_file.h"
#include "base/error.h"
#include "image/chromaticities.h"
#include "image/image_files.h"
#include "image/image_io.h"

namespace relamp {
namespace fs = std::filesystem;
namespace {

const OIIO::TypeDesc floats(OIIO::TypeDesc::FLOAT);

/// Header entries. Sixteen numbers for worldToCamera and worldToNDC become matrices, as EXR readers expect.
void putHeader(OIIO::ImageSpec& spec, const std::map<std::string, std::string>& header) {
    for (const auto& [name, value] : header) {
        if (lowerCase(name) == "worldtocamera" || lowerCase(name) == "worldtondc") {
            std::istringstream in(value);
            std::array<float, 16> m{};
            size_t read = 0;
            while (read < 16 && in >> m[read]) ++read;
            if (read == 16) {
                const OIIO::TypeDesc matrix(OIIO::TypeDesc::FLOAT, OIIO::TypeDesc::MATRIX44);
                spec.attribute(lowerCase(name) == "worldtocamera" ? "worldtocamera" : "worldtoNDC", matrix, m.data());
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
    setUpImageLibrary();
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
        check(output->write_scanlines(y, end, 0, floats, rows.data()));
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
    OIIO::TypeDesc type = floats;
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
    OIIO::ImageSpec spec(width, height, int(channels.size()), floats);
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
        setUpImageLibrary();
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
        encoder.check(encoder.output->write_scanlines(first + y, first + y + rows, 0, floats, mixed.data()));
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
                      const std::function<void()>& between, const FileWindow& window) {
    if (width <= 0 || height <= 0 || parts.empty()) throw Error("{}: there are no pixels to write", file.string());
    if (lowerExtension(file) != ".exr") throw Error("{}: layers are written as .exr only", file.string());
    stripRows = std::min((std::max(stripRows, 1) + rowsInZip - 1) / rowsInZip * rowsInZip, height);
    std::vector<OIIO::ImageSpec> specs;
    std::vector<ChannelFormat> all;
    for (const ChannelPart& part : parts) {
        OIIO::ImageSpec spec(width, height, int(part.channels.size()), floats);
        spec.channelnames.clear();
        for (const ChannelFormat& channel : part.channels) {
            if (channel.name == "A") spec.alpha_channel = int(spec.channelnames.size());
            spec.channelnames.push_back(channel.name);
            spec.channelformats.emplace_back(channel.half ? OIIO::TypeDesc::HALF : OIIO::TypeDesc::FLOAT);
            all.push_back(channel);
        }
        if (parts.size() > 1) spec.attribute("oiio:subimagename", part.name);
        spec.x = window.left, spec.y = window.top;
        if (window.wholeWidth > 0) spec.full_width = window.wholeWidth, spec.full_height = window.wholeHeight;
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
                writePlanes(encoder, planes, width, window.top + first, count, between);
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
                    writePlanes(encoder, planes, width, window.top + first, count, between);
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
                          written->read_scanlines(part, 0, window.top + height - 1, window.top + height, 0, 0,
                                                  int(parts.back().channels.size()), floats, last.data()));
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
    OIIO::ImageSpec spec(width, height, 3, hdr ? floats : OIIO::TypeDesc(OIIO::TypeDesc::UINT8));
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
            encoder.check(encoder.output->write_scanlines(y, y + count, 0, floats, rows.data()));
        }
        encoder.close();
    });
}

}  // namespace relamp
