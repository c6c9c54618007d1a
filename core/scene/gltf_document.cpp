// glTF 2.0, https://registry.khronos.org/glTF/specs/2.0/glTF-2.0.html: 3.6 buffers and accessors, 4 the binary file.
#include "scene/gltf_document.h"

#include <cstring>
#include <nlohmann/json.hpp>

#include "base/atomic_file.h"
#include "base/printable.h"
#include "base/text_scanner.h"

namespace relamp {
namespace fs = std::filesystem;
namespace {

constexpr size_t mostBufferBytes = size_t(1) << 36;
constexpr std::string_view glbMagic = "glTF";

uint32_t wordAt(std::string_view bytes, size_t at) {
    const auto byte = [&](size_t i) { return uint32_t(static_cast<unsigned char>(bytes[at + i])); };
    return byte(0) | byte(1) << 8 | byte(2) << 16 | byte(3) << 24;
}

/// The chunks of a .glb.
struct GlbChunks {
    std::string_view json, binary;
    bool hasBinary = false;
};

GlbChunks chunksOf(std::string_view bytes) {
    constexpr uint32_t jsonChunk = 0x4e4f534a, binaryChunk = 0x004e4942;
    if (bytes.size() < 20) throw Error("ends inside its header");
    if (const uint32_t version = wordAt(bytes, 4); version != 2)
        throw Error("is a binary glTF file of version {}, expected 2", version);
    const size_t length = wordAt(bytes, 8);
    if (length > bytes.size()) throw Error("claims {} bytes, the file holds {}", length, bytes.size());
    GlbChunks chunks;
    for (size_t at = 12, index = 0; length >= at + 8; ++index) {
        const size_t size = wordAt(bytes, at);
        const uint32_t type = wordAt(bytes, at + 4);
        at += 8;
        if (size > length - at) throw Error("chunk {} claims {} bytes, the file holds {}", index, size, length - at);
        if (index == 0 && type != jsonChunk) throw Error("chunk 0 is not its JSON");
        if (index == 0) chunks.json = bytes.substr(at, size);
        if (type == binaryChunk && !chunks.hasBinary) {
            chunks.binary = bytes.substr(at, size);
            chunks.hasBinary = true;
        }
        at += size;
    }
    if (chunks.json.empty()) throw Error("holds no JSON");
    return chunks;
}

std::string fromBase64(std::string_view text, const std::string& where) {
    const auto digit = [](char c) {
        if (c >= 'A' && c <= 'Z') return c - 'A';
        if (c >= 'a' && c <= 'z') return c - 'a' + 26;
        if (c >= '0' && c <= '9') return c - '0' + 52;
        return c == '+' || c == '-' ? 62 : c == '/' || c == '_' ? 63 : -1;
    };
    while (!text.empty() && text.back() == '=') text.remove_suffix(1);
    std::string bytes;
    bytes.reserve(text.size() / 4 * 3 + 3);
    uint32_t bits = 0;
    int held = 0;
    for (size_t i = 0; i < text.size(); ++i) {
        const int value = digit(text[i]);
        if (value < 0) throw Error("{}: holds no base64 at character {}", where, i);
        bits = (bits << 6 | uint32_t(value)) & 0xffff;
        if ((held += 6) < 8) continue;
        held -= 8;
        bytes.push_back(char(bits >> held & 0xff));
    }
    return bytes;
}

/// "%20" and the like.
std::string withoutPercent(const std::string& uri) {
    std::string name;
    const auto digit = [](char c) {
        return c >= '0' && c <= '9'   ? c - '0'
               : c >= 'a' && c <= 'f' ? c - 'a' + 10
               : c >= 'A' && c <= 'F' ? c - 'A' + 10
                                      : -1;
    };
    for (size_t i = 0; i < uri.size(); ++i) {
        if (uri[i] == '%' && i + 2 < uri.size() && digit(uri[i + 1]) >= 0 && digit(uri[i + 2]) >= 0) {
            name.push_back(char(16 * digit(uri[i + 1]) + digit(uri[i + 2])));
            i += 2;
        } else name.push_back(uri[i]);
    }
    return name;
}

bool isData(const std::string& uri) { return uri.rfind("data:", 0) == 0; }

/// Extensions that say nothing about geometry, and those of it that are read.
bool isReadable(const std::string& extension) {
    for (const char* known : {"KHR_mesh_quantization", "KHR_materials_", "KHR_texture_", "EXT_texture_", "KHR_lights_"})
        if (extension.rfind(known, 0) == 0) return true;
    return false;
}

size_t componentSize(int type, const std::string& where) {
    switch (type) {
        case 5120:
        case 5121: return 1;
        case 5122:
        case 5123: return 2;
        case 5125:
        case 5126: return 4;
        default: throw Error("{}: is {}, expected 5120, 5121, 5122, 5123, 5125 or 5126", where, type);
    }
}

template <class T>
double loaded(const char* from) {
    T value;
    std::memcpy(&value, from, sizeof value);
    return double(value);
}

double componentAt(const char* from, int type, bool normalized) {
    switch (type) {
        case 5120: return normalized ? std::max(loaded<int8_t>(from) / 127, -1.0) : loaded<int8_t>(from);
        case 5121: return loaded<uint8_t>(from) / (normalized ? 255 : 1);
        case 5122: return normalized ? std::max(loaded<int16_t>(from) / 32767, -1.0) : loaded<int16_t>(from);
        case 5123: return loaded<uint16_t>(from) / (normalized ? 65535 : 1);
        case 5125: return loaded<uint32_t>(from);
        default: return loaded<float>(from);
    }
}

}  // namespace

bool isGltf(std::string_view bytes) {
    if (bytes.substr(0, 4) == glbMagic) return true;
    size_t at = bytes.substr(0, 3) == "\xef\xbb\xbf" ? 3 : 0;
    while (at < bytes.size() && TextScanner::isSpace(bytes[at])) ++at;
    return at < bytes.size() && bytes[at] == '{';
}

GltfDocument::GltfDocument(std::string_view bytes, const fs::path& file) : file_(file), folder_(file.parent_path()) {
    bytes_ = bytes.size();
    std::string_view text = bytes;
    if (bytes.substr(0, 4) == glbMagic) {
        const GlbChunks chunks = chunksOf(bytes);
        text = chunks.json;
        chunk_ = chunks.binary;
        chunkBegin_ = size_t(chunk_.data() - bytes.data());
        hasChunk_ = chunks.hasBinary;
    }
    root_ = std::make_unique<const Json>(parseJson(std::string(text)));
    if (!root_->is_object()) throw Error("holds {}, expected an object", kindOf(*root_));
    const JsonFields top(*root_);
    const auto version = top.object("asset").get<std::string>("version");
    if (version.rfind("2.", 0) != 0)
        throw Error("asset.version: is \"{}\", expected 2.0", printable(version.substr(0, 40)));
    if (const Json* required = top.find("extensionsRequired")) {
        if (!required->is_array()) throw Error("extensionsRequired: expected a list");
        for (const Json& name : *required)
            if (const std::string extension = textOf(name, "extensionsRequired"); !isReadable(extension))
                throw Error("extensionsRequired: names {}, which relamp does not read; export the mesh without it",
                            printable(extension.substr(0, 80)));
    }
    nodes_ = top.list("nodes");
    meshes_ = top.list("meshes");
    accessors_ = top.list("accessors");
    views_ = top.list("bufferViews");
    buffers_ = top.list("buffers");
    materials_ = top.list("materials");
    textures_ = top.list("textures");
    images_ = top.list("images");
    contents_.resize(buffers_.size());
}

GltfDocument::~GltfDocument() = default;

JsonFields GltfDocument::root() const { return JsonFields(*root_); }

const JsonFields& GltfDocument::at(const List& list, const char* name, size_t index, const std::string& from) {
    if (index >= list.size()) throw Error("{}: is {}, the file has {} {}", from, index, list.size(), name);
    return list[index];
}

fs::path GltfDocument::fileOf(const std::string& uri, const std::string& where) const {
    const std::string name = withoutPercent(uri);
    // "C:", "http:": a colon before the first slash.
    const size_t colon = name.find(':');
    if (name.empty() || name.find('\0') != name.npos || (colon != name.npos && colon < name.find('/')))
        throw Error("{}: is \"{}\", expected data or the name of a file beside it", where,
                    printable(name.substr(0, 80)));
    return folder_ / name;
}

std::vector<fs::path> GltfDocument::filesBeside(const List& list) const {
    std::vector<fs::path> files;
    for (const JsonFields& entry : list)
        if (const auto uri = entry.get<std::string>("uri", ""); !uri.empty() && !isData(uri))
            files.push_back(fileOf(uri, entry.name("uri")));
    return files;
}

std::vector<fs::path> GltfDocument::bufferFiles() const { return filesBeside(buffers_); }

std::vector<fs::path> GltfDocument::imageFiles() const { return filesBeside(images_); }

std::optional<MeshImage> GltfDocument::colourImage(size_t material) const {
    const JsonFields texture =
        at(materials_, "materials", material, "material").object("pbrMetallicRoughness").object("baseColorTexture");
    if (!texture.has("index") || texture.get("texCoord", 0) != 0 ||
        texture.object("extensions").has("KHR_texture_transform"))
        return std::nullopt;
    const JsonFields& entry = at(textures_, "textures", texture.get<uint64_t>("index"), texture.name("index"));
    if (!entry.has("source")) return std::nullopt;
    const JsonFields& image = at(images_, "images", entry.get<uint64_t>("source"), entry.name("source"));
    if (const auto uri = image.get<std::string>("uri", ""); isData(uri)) return std::nullopt;
    else if (!uri.empty()) return MeshImage{fileOf(uri, image.name("uri"))};
    const JsonFields& part = at(views_, "bufferViews", image.get<uint64_t>("bufferView"), image.name("bufferView"));
    const JsonFields& held = at(buffers_, "buffers", part.get<uint64_t>("buffer"), part.name("buffer"));
    const auto uri = held.get<std::string>("uri", "");
    if (isData(uri)) return std::nullopt;
    const auto begin = part.get<uint64_t>("byteOffset", 0), size = part.get<uint64_t>("byteLength");
    if (begin > mostBufferBytes || size == 0 || size > mostBufferBytes) return std::nullopt;
    if (!uri.empty()) return MeshImage{fileOf(uri, held.name("uri")), begin, size};
    if (begin > chunk_.size() || size > chunk_.size() - begin) return std::nullopt;
    return MeshImage{file_, chunkBegin_ + begin, size};
}

std::string GltfDocument::shapeOf(size_t accessor, const std::string& from) const {
    return at(accessors_, "accessors", accessor, from).get<std::string>("type");
}

std::string_view GltfDocument::buffer(size_t index, const std::string& from) const {
    const JsonFields& fields = at(buffers_, "buffers", index, from);
    if (contents_[index]) return *contents_[index];
    const auto uri = fields.get<std::string>("uri", "");
    const std::string where = fields.name("uri");
    std::string_view held;
    if (uri.empty()) {
        if (index > 0 || !hasChunk_) throw Error("{}: is missing", where);
        held = chunk_;
    } else if (isData(uri)) {
        constexpr std::string_view mark = ";base64,";
        const size_t begin = uri.find(mark);
        if (begin == uri.npos) throw Error("{}: is data of an unknown kind, expected base64", where);
        held = owned_.emplace_back(fromBase64(std::string_view(uri).substr(begin + mark.size()), where));
    } else {
        const fs::path file = fileOf(uri, where);
        held = withContext(where, [&]() -> std::string_view {
            return owned_.emplace_back(readBytes(file, mostBufferBytes - std::min(bytes_, mostBufferBytes)));
        });
        bytes_ += held.size();
    }
    const auto length = fields.get<uint64_t>("byteLength");
    if (length > held.size())
        throw Error("{}: is {}, there are {} bytes", fields.name("byteLength"), length, held.size());
    contents_[index] = held.substr(0, length);
    return *contents_[index];
}

std::string_view GltfDocument::view(size_t index, const std::string& from, size_t& stride) const {
    const JsonFields& fields = at(views_, "bufferViews", index, from);
    const std::string_view whole = buffer(fields.get<uint64_t>("buffer"), fields.name("buffer"));
    const auto offset = fields.get<uint64_t>("byteOffset", 0), length = fields.get<uint64_t>("byteLength");
    if (offset > whole.size() || length > whole.size() - offset)
        throw Error("{}: is {} after byteOffset {}, the buffer holds {} bytes", fields.name("byteLength"), length,
                    offset, whole.size());
    stride = fields.get<uint64_t>("byteStride", 0);
    if (fields.has("byteStride") && (stride < 4 || stride > 252))
        throw Error("{}: is {}, expected 4 to 252", fields.name("byteStride"), stride);
    return whole.substr(offset, length);
}

size_t GltfDocument::count(size_t accessor, size_t most, const std::string& from) const {
    const JsonFields& fields = at(accessors_, "accessors", accessor, from);
    const auto count = fields.get<uint64_t>("count");
    if (count > most) throw Error("{}: is {}, expected at most {}", fields.name("count"), count, most);
    return count;
}

GltfValues GltfDocument::read(size_t accessor, size_t width, bool whole, const std::string& from) const {
    constexpr const char* types[] = {"", "SCALAR", "VEC2", "VEC3", "VEC4"};
    const JsonFields& fields = at(accessors_, "accessors", accessor, from);
    if (fields.has("sparse")) throw Error("{}: sparse accessors are not read", fields.name("sparse"));
    if (const auto type = fields.get<std::string>("type"); type != types[width])
        throw Error("{}: is \"{}\", expected {}", fields.name("type"), printable(type.substr(0, 40)), types[width]);
    const int component = fields.get<int>("componentType");
    const size_t size = componentSize(component, fields.name("componentType"));
    if (whole && component != 5121 && component != 5123 && component != 5125)
        throw Error("{}: is {}, expected 5121, 5123 or 5125 for indices", fields.name("componentType"), component);
    const bool normalized = fields.get("normalized", false);
    size_t stride = 0;
    const std::string_view bytes = view(fields.get<uint64_t>("bufferView"), fields.name("bufferView"), stride);
    const size_t each = size * width, step = stride == 0 ? each : stride;
    if (step < each)
        throw Error("{}: reads {} bytes an element, more than the byteStride {} of its bufferView", fields.name("type"),
                    each, step);
    const auto offset = fields.get<uint64_t>("byteOffset", 0), count = fields.get<uint64_t>("count");
    const size_t room = offset > bytes.size() ? 0 : bytes.size() - offset;
    if (offset > bytes.size() || (count > 0 && (room < each || count - 1 > (room - each) / step)))
        throw Error("{}: is {} after byteOffset {}, the bufferView holds {} bytes", fields.name("count"), count, offset,
                    bytes.size());
    GltfValues result{count, width, {}};
    result.values.resize(count * width);
    for (size_t i = 0; i < count; ++i)
        for (size_t c = 0; c < width; ++c)
            result.values[i * width + c] =
                componentAt(bytes.data() + offset + i * step + c * size, component, normalized);
    return result;
}

}  // namespace relamp
