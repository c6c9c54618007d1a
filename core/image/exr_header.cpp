#include "image/exr_header.h"

#include <cstdint>
#include <fstream>
#include <map>
#include <string>

#include "base/error.h"

namespace relamp {
namespace {

class Reader {
public:
    explicit Reader(const std::filesystem::path& file) : in_(file, std::ios::binary) {
        in_.seekg(0, std::ios::end);
        size_ = in_ ? int64_t(in_.tellg()) : 0;
        in_.seekg(0);
    }
    /// Little-endian; 0 behind the end.
    uint32_t number() {
        unsigned char b[4] = {};
        in_.read(reinterpret_cast<char*>(b), 4);
        return uint32_t(b[0]) | uint32_t(b[1]) << 8 | uint32_t(b[2]) << 16 | uint32_t(b[3]) << 24;
    }
    int byte() { return in_.get(); }
    /// Up to its zero; false when there is none within 256 bytes.
    bool word(std::string& text) {
        text.clear();
        for (int c = in_.get(); c != 0; c = in_.get()) {
            if (c < 0 || text.size() > 255) return false;
            text += char(c);
        }
        return true;
    }
    int64_t left() { return in_ ? size_ - int64_t(in_.tellg()) : 0; }
    void skip(int64_t count) { in_.seekg(count, std::ios::cur); }

private:
    std::ifstream in_;
    int64_t size_ = 0;
};

/// Types of one size; OpenEXR reads that many bytes whatever the header says.
const std::map<std::string, int64_t> fixedSizes{{"box2i", 16},
                                                {"box2f", 16},
                                                {"chromaticities", 32},
                                                {"compression", 1},
                                                {"deepImageState", 1},
                                                {"double", 8},
                                                {"envmap", 1},
                                                {"float", 4},
                                                {"int", 4},
                                                {"keycode", 28},
                                                {"lineOrder", 1},
                                                {"m33f", 36},
                                                {"m33d", 72},
                                                {"m44f", 64},
                                                {"m44d", 128},
                                                {"rational", 8},
                                                {"tiledesc", 9},
                                                {"timecode", 8},
                                                {"v2i", 8},
                                                {"v2f", 8},
                                                {"v2d", 16},
                                                {"v3i", 12},
                                                {"v3f", 12},
                                                {"v3d", 24}};

/// What a part's decoder will ask memory for.
struct PartShape {
    int64_t width = 0, height = 0, tileWidth = 0, tileHeight = 0, channels = 0, linesTogether = 1;

    void take(Reader& in, const std::string& name, const std::string& type) {
        if (name == "dataWindow" && type == "box2i") {
            int32_t corner[4];
            for (int32_t& c : corner) c = int32_t(in.number());
            width = int64_t(corner[2]) - corner[0] + 1;
            height = int64_t(corner[3]) - corner[1] + 1;
        } else if (name == "tiles" && type == "tiledesc") {
            tileWidth = in.number();
            tileHeight = in.number();
        } else if (name == "compression" && type == "compression") {
            constexpr int lines[] = {1,  1,  1,  16, 32,
                                     16, 32, 32, 32, 256};  // none, RLE, ZIPS, ZIP, PIZ, PXR24, B44, B44A, DWAA, DWAB
            const int kind = in.byte();
            linesTogether = kind >= 0 && kind < 10 ? lines[kind] : 256;
        }
    }
    /// OpenEXR asks for whole tiles, however small the image, and for as many lines as are packed together.
    void check(const std::filesystem::path& file) const {
        constexpr int64_t mostSide = 1 << 20, mostSamples = 1 << 27;
        const int64_t across = tileWidth > 0 ? tileWidth : width, down = tileWidth > 0 ? tileHeight : linesTogether;
        if (width > mostSide || height > mostSide)
            throw Error("{}: is {} x {} pixels, expected at most {} a side", file.string(), width, height, mostSide);
        if (across > mostSamples || down > mostSamples || across * down > mostSamples ||
            across * down * channels > mostSamples)
            throw Error("{}: packs {} x {} pixels of {} channels together, expected at most {} numbers", file.string(),
                        across, down, channels, mostSamples);
    }
};

/// How many bytes a value takes by what stands in it; `size` where only the header says so.
int64_t sizeByContent(Reader& in, const std::string& type, int64_t size, PartShape& shape) {
    if (const auto fixed = fixedSizes.find(type); fixed != fixedSizes.end()) return fixed->second;
    const int64_t before = in.left();
    if (type == "preview") {
        const int64_t width = in.number(), height = in.number();
        return width <= size && (width == 0 || height <= size / width) ? 8 + 4 * width * height : -1;
    }
    if (type != "chlist") return size;
    std::string channel;
    for (; in.word(channel) && !channel.empty(); ++shape.channels) in.skip(16);
    return channel.empty() ? before - in.left() : -1;
}

}  // namespace

void checkExrHeader(const std::filesystem::path& file) {
    Reader in(file);
    if (in.number() != 20000630) return;
    const bool severalParts = in.number() & 0x1000;
    std::string name, type;
    do {
        size_t attributes = 0;
        PartShape shape;
        for (;; ++attributes) {
            if (!in.word(name)) throw Error("{}: the header breaks off", file.string());
            if (name.empty()) break;
            if (!in.word(type)) throw Error("{}: the header breaks off at {}", file.string(), name);
            const auto size = int64_t(int32_t(in.number()));
            if (size < 0 || size > in.left())
                throw Error("{}: the header's {} says it is {} bytes large, {} are left", file.string(), name, size,
                            in.left());
            const int64_t begin = in.left();
            if (sizeByContent(in, type, size, shape) != size)
                throw Error("{}: the header's {} ({}) has another size than it says", file.string(), name, type);
            shape.take(in, name, type);
            in.skip(size - (begin - in.left()));
        }
        shape.check(file);
        if (attributes == 0) return;  // the empty header that ends the list of parts
    } while (severalParts);
}

}  // namespace relamp
