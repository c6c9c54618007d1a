#include "scene/openmesh_file.h"

#include <cstdint>
#include <cstring>
#include <vector>

#include "base/error.h"

namespace relamp {
namespace {

// Version 2.0 on writes half-edges; 2.2 on writes what type a custom property has (OpenMesh/Core/IO/OMFormat.hh).
constexpr unsigned withHalfEdges = 0x40, withTypeNames = 0x42, newest = 0x42;
constexpr size_t headerSize = 16;

enum Entity { vertex = 0, wholeMesh = 1, face = 2, edge = 4, halfEdge = 6, sentinel = 7 };
enum Kind { position = 0, normal = 1, textureCoordinate = 2, status = 3, colour = 4, custom = 6, topology = 7 };

class Cursor {
public:
    explicit Cursor(std::string_view bytes) : bytes_(bytes) {}
    bool atEnd() const { return at_ == bytes_.size(); }
    std::string_view take(uint64_t count) {
        if (count > bytes_.size() - at_) throw Error("ends early");
        const std::string_view taken = bytes_.substr(at_, size_t(count));
        at_ += size_t(count);
        return taken;
    }
    template <class Value>
    Value number() {
        Value value{};
        std::memcpy(&value, take(sizeof value).data(), sizeof value);
        return value;
    }

private:
    std::string_view bytes_;
    size_t at_ = 0;
};

struct Block {
    uint16_t word = 0;
    std::string_view data;
    unsigned entity() const { return word >> 2 & 7; }
    unsigned kind() const { return word >> 5 & 15; }
    size_t integerBytes() const { return size_t(1) << (word >> 14 & 3); }
};

struct File {
    std::string_view header;
    unsigned kind = 0, version = 0;
    uint64_t vertices = 0, faces = 0, halfEdges = 0;
    Block positions, vertexTopology, halfEdgeTopology, faceTopology;
};

/// Integers of 1, 2 or 4 bytes.
std::vector<int64_t> integers(const Block& block, bool hasSign) {
    const size_t size = block.integerBytes();
    std::vector<int64_t> values(block.data.size() / size);
    for (size_t i = 0; i < values.size(); ++i) {
        uint64_t value = 0;
        std::memcpy(&value, block.data.data() + i * size, size);
        const uint64_t top = uint64_t(1) << (8 * size - 1);
        values[i] = hasSign && value >= top ? int64_t(value) - int64_t(top) * 2 : int64_t(value);
    }
    return values;
}

/// Bytes of each of an entity's entries; 0 for what OpenMesh does not write.
size_t entrySize(const File& file, const Block& block) {
    switch (block.kind()) {
        case position: return block.entity() == vertex ? 12 : 0;
        case normal: return block.entity() == vertex || block.entity() == face ? 12 : 0;
        case textureCoordinate: return block.entity() == vertex || block.entity() == halfEdge ? 8 : 0;
        case status: return 4;
        case colour: return block.entity() == vertex || block.entity() == face ? 3 : 0;
        case topology: break;
        default: return 0;
    }
    if (block.integerBytes() > 4) return 0;
    const bool halfEdges = file.version >= withHalfEdges;
    switch (block.entity()) {
        case vertex: return halfEdges ? block.integerBytes() : 0;
        case halfEdge: return halfEdges ? 3 * block.integerBytes() : 0;
        case face: return halfEdges ? block.integerBytes() : (file.kind == 'Q' ? 4 : 3) * block.integerBytes();
        default: return 0;
    }
}

uint64_t entries(const File& file, unsigned entity) {
    switch (entity) {
        case vertex: return file.vertices;
        case face: return file.faces;
        case edge: return file.halfEdges / 2;
        case halfEdge: return file.halfEdges;
        case wholeMesh: return 1;
        default: throw Error("holds a block of an unknown kind");
    }
}

/// Where the file has polygons of any number of corners: the corners' count before each.
std::string_view polygonBytes(const File& file, const Block& block, Cursor rest) {
    Cursor walk = rest;
    uint64_t size = 0;
    if (block.integerBytes() > 4) throw Error("holds a block of an unknown kind");
    for (uint64_t f = 0; f < file.faces; ++f) {
        const uint64_t corners = walk.number<uint16_t>();
        walk.take(corners * block.integerBytes());
        size += 2 + corners * block.integerBytes();
    }
    return rest.take(size);
}

void keep(File& file, const Block& block) {
    Block* place = nullptr;
    if (block.entity() == vertex && block.kind() == position) {
        if ((block.word >> 10 & 0x3f) != 5) throw Error("has positions that are not three 32-bit floats");
        place = &file.positions;
    } else if (block.kind() == topology) {
        place = block.entity() == vertex ? &file.vertexTopology
                : block.entity() == face ? &file.faceTopology
                                         : &file.halfEdgeTopology;
    }
    if (!place) return;
    if (place->data.data()) throw Error("holds its positions or its topology twice");
    *place = block;
}

File walked(std::string_view bytes) {
    File file;
    Cursor cursor(bytes);
    file.header = cursor.take(headerSize);
    Cursor header(file.header);
    if (header.take(2) != "OM") throw Error("does not begin as OpenMesh's files do");
    file.kind = header.number<uint8_t>();
    file.version = header.number<uint8_t>();
    if (file.kind != 'T' && file.kind != 'Q' && file.kind != 'P')
        throw Error("is of a kind that is not known, expected T, Q or P");
    if (file.version > newest)
        throw Error("is of version {}.{}, expected at most 2.2", file.version >> 5, file.version & 31);
    file.vertices = header.number<uint32_t>();
    file.faces = header.number<uint32_t>();
    const uint64_t edges = header.number<uint32_t>();
    for (const uint64_t count : {file.vertices, file.faces, edges})
        if (count > bytes.size())
            throw Error("claims {} vertices, {} faces and {} edges, more than the file holds", file.vertices,
                        file.faces, edges);
    file.halfEdges = 2 * edges;
    while (!cursor.atEnd()) {
        Block block{cursor.number<uint16_t>(), {}};
        if (block.entity() == sentinel) break;
        const uint64_t count = entries(file, block.entity());
        const bool named = block.word >> 1 & 1;
        if (block.kind() == custom) {
            if (named) cursor.take(cursor.number<uint8_t>());
            if (named && file.version >= withTypeNames) cursor.take(cursor.number<uint8_t>());
            cursor.take(cursor.number<uint32_t>());
            continue;
        }
        if (named) throw Error("holds a block of an unknown kind");
        if (block.entity() == face && block.kind() == topology && file.version < withHalfEdges && file.kind == 'P') {
            block.data = polygonBytes(file, block, cursor);
            cursor.take(block.data.size());
        } else {
            const size_t size = entrySize(file, block);
            if (!size) throw Error("holds a block of an unknown kind");
            block.data = cursor.take(count * size);
        }
        keep(file, block);
    }
    if (!file.positions.data.data() || !file.faceTopology.data.data()) throw Error("has no positions or no faces");
    return file;
}

void checkCorners(const File& file) {
    const auto check = [&](int64_t corner) {
        if (uint64_t(corner) >= file.vertices) throw Error("a face names vertex {} of {}", corner, file.vertices);
    };
    if (file.kind != 'P') {
        for (const int64_t corner : integers(file.faceTopology, false)) check(corner);
        return;
    }
    Cursor cursor(file.faceTopology.data);
    for (uint64_t f = 0; f < file.faces; ++f) {
        const uint64_t corners = cursor.number<uint16_t>();
        if (corners < 3) throw Error("face {} has {} corners", f, corners);
        for (const int64_t corner :
             integers({file.faceTopology.word, cursor.take(corners * file.faceTopology.integerBytes())}, false))
            check(corner);
    }
}

/// Next half-edge, vertex it leads to, face on its left (-1: none).
void checkHalfEdges(const File& file) {
    if (file.faces && !file.halfEdgeTopology.data.data()) throw Error("has faces without edges");
    const int64_t halfEdges = int64_t(file.halfEdges), vertices = int64_t(file.vertices), faces = int64_t(file.faces);
    const std::vector<int64_t> links = integers(file.halfEdgeTopology, true), first = integers(file.faceTopology, true);
    for (size_t h = 0; h < links.size(); h += 3)
        if (links[h] < 0 || links[h] >= halfEdges || links[h + 1] < 0 || links[h + 1] >= vertices ||
            links[h + 2] < -1 || links[h + 2] >= faces)
            throw Error("half-edge {} names what is not there", h / 3);
    for (const int64_t h : integers(file.vertexTopology, true))
        if (h < -1 || h >= halfEdges) throw Error("a vertex names half-edge {} of {}", h, halfEdges);
    // Each half-edge is of one face only, so all walks together are no longer than their list.
    for (int64_t f = 0; f < faces; ++f) {
        const int64_t begin = first[size_t(f)];
        if (begin < 0 || begin >= halfEdges) throw Error("face {} names half-edge {} of {}", f, begin, halfEdges);
        int64_t at = begin, steps = 0;
        do {
            if (links[size_t(at) * 3 + 2] != f || ++steps > halfEdges)
                throw Error("the edges of face {} are not closed", f);
            at = links[size_t(at) * 3];
        } while (at != begin);
    }
}

}  // namespace

std::string openMeshEssentials(std::string_view bytes) {
    const File file = walked(bytes);
    if (file.version < withHalfEdges) checkCorners(file);
    else checkHalfEdges(file);
    std::string out(file.header);
    const auto put = [&](const Block& block) {
        if (!block.data.data()) return;
        out.append(reinterpret_cast<const char*>(&block.word), sizeof block.word);
        out.append(block.data);
    };
    for (const Block* block : {&file.positions, &file.halfEdgeTopology, &file.vertexTopology, &file.faceTopology})
        put(*block);
    put({sentinel << 2, ""});
    return out;
}

}  // namespace relamp
