// Binary OFF. The format is big-endian with a colour count after each face; OpenMesh writes the machine's own byte
// order and no such count. Nothing in the file says which, so the reading that uses up the file exactly is taken.
#include <bit>
#include <cstring>
#include <optional>

#include "base/error.h"
#include "base/text_scanner.h"
#include "scene/triangle_soup.h"

namespace relamp {
namespace {

struct OffLayout {
    bool swapped = false;      ///< byte order other than this machine's
    bool faceColours = false;  ///< a count of colour components after each face, and that many floats
};

class Words {
public:
    Words(std::string_view bytes, bool swapped) : bytes_(bytes), swapped_(swapped) {}
    size_t left() const { return bytes_.size() / 4; }
    bool atEnd() const { return bytes_.empty(); }
    /// Not behind the end: left() is asked first.
    uint32_t next() {
        uint32_t word = 0;
        std::memcpy(&word, bytes_.data(), 4);
        bytes_.remove_prefix(4);
        return swapped_ ? __builtin_bswap32(word) : word;
    }
    float nextFloat() { return std::bit_cast<float>(next()); }
    void skip(size_t words) { bytes_.remove_prefix(4 * words); }

private:
    std::string_view bytes_;
    bool swapped_;
};

/// None when the bytes do not read like this to their very end.
std::optional<TriangleSoup> readAs(const OffLayout& layout, std::string_view bytes, size_t wordsAfterPosition,
                                   bool hasNormals, const MeshLimits& limits) {
    Words words(bytes, layout.swapped);
    if (words.left() < 3) return {};
    const size_t vertices = words.next(), faces = words.next();
    words.skip(1);
    const size_t perVertex = 3 + (hasNormals ? 3 : 0) + wordsAfterPosition, perFace = layout.faceColours ? 2 : 1;
    if (vertices > words.left() / perVertex || faces > (words.left() - vertices * perVertex) / perFace) return {};
    if (vertices > limits.maxVertices)
        throw Error("has {} vertices, expected at most {}", vertices, limits.maxVertices);
    if (faces > limits.maxTriangles) throw Error("has {} faces, expected at most {}", faces, limits.maxTriangles);
    TriangleSoup soup;
    const auto three = [&] {
        Vec3 v;
        for (int c = 0; c < 3; ++c) v[c] = words.nextFloat();
        return v;
    };
    for (size_t v = 0; v < vertices; ++v) {
        soup.positions.emplace_back(three());
        if (hasNormals) soup.normals.push_back(three());
        words.skip(wordsAfterPosition);
    }
    std::vector<int64_t> face;
    for (size_t f = 0; f < faces; ++f) {
        if (words.left() < perFace) return {};
        const size_t corners = words.next();
        if (corners > words.left()) return {};
        face.clear();
        for (size_t c = 0; c < corners; ++c) face.push_back(words.next());
        soup.addFace(face, vertices, limits);
        if (!layout.faceColours) continue;
        if (words.left() < 1) return {};
        const size_t colours = words.next();
        if (colours > 4 || colours > words.left()) return {};
        words.skip(colours);
    }
    if (!words.atEnd()) return {};
    return soup;
}

}  // namespace

TriangleSoup readBinaryOff(std::string_view bytes, const MeshLimits& limits) {
    TextScanner scanner(bytes);
    const std::string_view magic = TextScanner(scanner.line()).word();
    const std::string_view kinds = magic.substr(0, magic.size() - 3),
                           rest = bytes.substr(bytes.size() - scanner.remaining());
    if (kinds.find_first_of("4n") != kinds.npos)
        throw Error("is an OFF file of four or more dimensions, expected three");
    const bool hasNormals = kinds.find('N') != kinds.npos;
    const size_t colours = kinds.find('C') != kinds.npos ? 4 : 0, texture = kinds.find("ST") != kinds.npos ? 2 : 0;
    for (const bool swapped : {true, false})
        for (const bool faceColours : {true, false})
            if (auto soup = readAs({swapped, faceColours}, rest, colours + texture, hasNormals, limits))
                return std::move(*soup);
    throw Error("claims more than the file holds, or less: it does not read as a binary OFF file to its end");
}

}  // namespace relamp
