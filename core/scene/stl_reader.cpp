// STL, binary and ascii. The format repeats every corner, so vertices at equal positions are made one.
#include <bit>
#include <cstring>
#include <unordered_map>

#include "base/error.h"
#include "base/random.h"
#include "base/text_scanner.h"
#include "scene/triangle_soup.h"

namespace relamp {
namespace {

/// Gives equal positions one index, in the order of their first appearance.
class Welder {
public:
    Welder(TriangleSoup& soup, const MeshLimits& limits) : soup_(soup), limits_(limits) {}

    uint32_t vertexAt(DVec3 position) {
        position += DVec3(0);  // -0 becomes 0
        uint64_t bits[3];
        std::memcpy(bits, &position, sizeof bits);
        uint64_t key = mixBits(mixBits(mixBits(bits[0]) ^ bits[1]) ^ bits[2]);
        for (;; ++key) {
            const auto [place, isNew] = at_.emplace(key, uint32_t(soup_.positions.size()));
            if (isNew) {
                if (soup_.positions.size() >= limits_.maxVertices)
                    throw Error("has more than {} vertices", limits_.maxVertices);
                soup_.positions.push_back(position);
                return place->second;
            }
            // By bits, so that a NaN is itself. NOLINTNEXTLINE(bugprone-suspicious-memory-comparison)
            if (std::memcmp(&soup_.positions[place->second], &position, sizeof position) == 0) return place->second;
        }
    }

private:
    TriangleSoup& soup_;
    const MeshLimits& limits_;
    std::unordered_map<uint64_t, uint32_t> at_;
};

constexpr size_t headerBytes = 84, facetBytes = 50;

TriangleSoup readBinary(std::string_view bytes, const MeshLimits& limits) {
    uint32_t count;
    std::memcpy(&count, bytes.data() + 80, sizeof count);
    static_assert(std::endian::native == std::endian::little, "binary STL is little-endian");
    if (count > (bytes.size() - headerBytes) / facetBytes)
        throw Error("claims {} triangles, the file holds {}", count, (bytes.size() - headerBytes) / facetBytes);
    if (count > limits.maxTriangles) throw Error("has {} triangles, expected at most {}", count, limits.maxTriangles);
    TriangleSoup soup;
    soup.triangles.reserve(count);
    Welder welder(soup, limits);
    for (size_t f = 0; f < count; ++f) {
        Vec3 corners[3];
        std::memcpy(corners, bytes.data() + headerBytes + f * facetBytes + 12, sizeof corners);
        Triangle triangle;
        for (size_t c = 0; c < 3; ++c) triangle[c] = welder.vertexAt(DVec3(corners[c]));
        soup.triangles.push_back(triangle);
    }
    return soup;
}

TriangleSoup readAscii(std::string_view bytes, const MeshLimits& limits) {
    TriangleSoup soup;
    Welder welder(soup, limits);
    TextScanner scanner(bytes);
    scanner.line();  // the name of the solid may hold any word
    std::vector<int64_t> face;
    bool closed = true;
    for (std::string_view word = scanner.word(); !word.empty(); word = scanner.word()) {
        if (word == "vertex") {
            DVec3 position;
            for (int c = 0; c < 3; ++c) {
                const std::string_view text = scanner.word();
                const auto value = TextScanner::number(text);
                if (!value) throw Error("a vertex holds \"{}\" where a number was expected", text.substr(0, 40));
                position[c] = *value;
            }
            face.push_back(welder.vertexAt(position));
        } else if (word == "facet") {
            face.clear();
            closed = false;
        } else if (word == "endfacet") {
            soup.addFace(face, soup.positions.size(), limits);
            face.clear();
            closed = true;
        }
    }
    if (!closed) throw Error("ends inside a facet");
    return soup;
}

}  // namespace

TriangleSoup readStl(std::string_view bytes, const MeshLimits& limits) {
    // Some binary files begin with "solid" as well, so the size decides first.
    if (bytes.size() >= headerBytes) {
        uint32_t count;
        std::memcpy(&count, bytes.data() + 80, sizeof count);
        if (bytes.size() == headerBytes + size_t(count) * facetBytes) return readBinary(bytes, limits);
    }
    if (bytes.substr(0, 5) == "solid") return readAscii(bytes, limits);
    if (bytes.size() < headerBytes) throw Error("has {} bytes, too few for an STL file", bytes.size());
    return readBinary(bytes, limits);
}

}  // namespace relamp
