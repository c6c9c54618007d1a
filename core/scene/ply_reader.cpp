#include "scene/ply_reader.h"

#include <bit>
#include <cstring>
#include <limits>

#include "base/error.h"
#include "base/text_scanner.h"
#include "scene/mesh_materials.h"
#include "scene/triangle_soup.h"

namespace relamp {
namespace {

PlyType typeNamed(std::string_view name) {
    const struct {
        const char *shortName, *longName;
        PlyType type;
    } known[] = {{"char", "int8", PlyType::int8},        {"uchar", "uint8", PlyType::uint8},
                 {"short", "int16", PlyType::int16},     {"ushort", "uint16", PlyType::uint16},
                 {"int", "int32", PlyType::int32},       {"uint", "uint32", PlyType::uint32},
                 {"float", "float32", PlyType::float32}, {"double", "float64", PlyType::float64}};
    for (const auto& k : known)
        if (name == k.shortName || name == k.longName) return k.type;
    throw Error("header: property type \"{}\" is unknown", name.substr(0, 40));
}

/// Fewest bytes one instance of the element can take.
size_t leastBytes(const PlyElement& element, PlyEncoding encoding) {
    size_t bytes = 0;
    for (const PlyProperty& p : element.properties)
        bytes += encoding == PlyEncoding::ascii ? 2 : plySize(p.isList ? p.countType : p.type);
    return bytes;
}

/// Names may hold spaces.
std::string restOfLine(TextScanner& words) {
    std::string_view rest = words.line();
    while (!rest.empty() && TextScanner::isSpace(rest.front())) rest.remove_prefix(1);
    while (!rest.empty() && TextScanner::isSpace(rest.back())) rest.remove_suffix(1);
    return std::string(rest);
}

template <class T>
T load(const char* from, bool swap) {
    char raw[sizeof(T)];
    std::memcpy(raw, from, sizeof raw);
    if (swap)
        for (size_t i = 0; i < sizeof(T) / 2; ++i) std::swap(raw[i], raw[sizeof(T) - 1 - i]);
    T value;
    std::memcpy(&value, raw, sizeof value);
    return value;
}

}  // namespace

size_t plySize(PlyType type) {
    switch (type) {
        case PlyType::int8:
        case PlyType::uint8: return 1;
        case PlyType::int16:
        case PlyType::uint16: return 2;
        case PlyType::int32:
        case PlyType::uint32:
        case PlyType::float32: return 4;
        case PlyType::float64: return 8;
    }
    return 0;
}

int PlyElement::find(std::string_view property) const {
    for (size_t i = 0; i < properties.size(); ++i)
        if (properties[i].name == property) return int(i);
    return -1;
}

PlyHeader readPlyHeader(std::string_view bytes) {
    // A header is short; one that does not end soon is no header.
    constexpr size_t longestHeader = 1 << 20;
    TextScanner scanner(bytes.substr(0, longestHeader));
    const size_t whole = scanner.remaining();
    if (scanner.line() != "ply") throw Error("is no PLY file");
    PlyHeader header;
    bool hasFormat = false;
    for (;;) {
        if (scanner.atEnd()) throw Error("header: ends without end_header");
        const std::string_view line = scanner.line();
        TextScanner words(line);
        const std::string_view key = words.word();
        if (key == "end_header") break;
        if (key == "format") {
            const std::string_view name = words.word();
            if (name == "ascii") header.encoding = PlyEncoding::ascii;
            else if (name == "binary_little_endian") header.encoding = PlyEncoding::littleEndian;
            else if (name == "binary_big_endian") header.encoding = PlyEncoding::bigEndian;
            else throw Error("header: format \"{}\" is unknown", name.substr(0, 40));
            hasFormat = true;
        } else if (key == "element") {
            PlyElement element;
            element.name = words.word();
            const std::string_view count = words.word();
            const auto value = TextScanner::integer(count);
            if (!value || *value < 0)
                throw Error("header: element {} has count \"{}\", expected 0 or more", element.name.substr(0, 40),
                            count.substr(0, 40));
            element.count = size_t(*value);
            header.elements.push_back(std::move(element));
        } else if (key == "property") {
            if (header.elements.empty()) throw Error("header: a property stands before any element");
            PlyProperty property;
            std::string_view type = words.word();
            if (type == "list") {
                property.isList = true;
                property.countType = typeNamed(words.word());
                type = words.word();
            }
            property.type = typeNamed(type);
            property.name = words.word();
            header.elements.back().properties.push_back(std::move(property));
        } else if (key == "comment" && words.word() == "TextureFile") {
            header.textureFiles.push_back(restOfLine(words));
        }
        // other comments, obj_info and unknown lines say nothing about the data
    }
    if (!hasFormat) throw Error("header: format is missing");
    header.bodyAt = whole - scanner.remaining();
    const size_t part = bytes.size() - header.bodyAt;
    for (const PlyElement& element : header.elements) {
        const size_t least = leastBytes(element, header.encoding);
        // The last value of an ascii file needs no space after it.
        if (least && element.count > (part + 1) / least)
            throw Error("element {} claims {} entries, the file has {} bytes for them", element.name.substr(0, 40),
                        element.count, part);
    }
    return header;
}

double PlyCursor::binaryScalar(PlyType type) {
    const size_t size = plySize(type);
    if (bytes_.size() - at_ < size) throw Error("ends before its last element");
    const char* from = bytes_.data() + at_;
    at_ += size;
    const bool swap = (encoding_ == PlyEncoding::bigEndian) != (std::endian::native == std::endian::big);
    switch (type) {
        case PlyType::int8: return load<int8_t>(from, false);
        case PlyType::uint8: return load<uint8_t>(from, false);
        case PlyType::int16: return load<int16_t>(from, swap);
        case PlyType::uint16: return load<uint16_t>(from, swap);
        case PlyType::int32: return load<int32_t>(from, swap);
        case PlyType::uint32: return load<uint32_t>(from, swap);
        case PlyType::float32: return double(load<float>(from, swap));
        case PlyType::float64: return load<double>(from, swap);
    }
    return 0;
}

double PlyCursor::scalar(PlyType type) {
    if (encoding_ != PlyEncoding::ascii) return binaryScalar(type);
    TextScanner scanner(bytes_.substr(at_));
    const std::string_view word = scanner.word();
    if (word.empty()) throw Error("ends before its last element");
    at_ = bytes_.size() - scanner.remaining();
    const auto value = TextScanner::number(word);
    if (!value) throw Error("holds \"{}\" where a number was expected", word.substr(0, 40));
    return *value;
}

void PlyCursor::list(const PlyProperty& property, std::vector<double>& values) {
    const double length = scalar(property.countType);
    const size_t each = encoding_ == PlyEncoding::ascii ? 2 : plySize(property.type);
    if (!(length >= 0) || length != std::floor(length))
        throw Error("list {} has length {}, expected 0 or more", property.name, length);
    if (length > double((bytes_.size() - at_) / each + 1))
        throw Error("list {} claims {} values, more than the file holds", property.name, length);
    values.resize(size_t(length));
    for (double& value : values) value = scalar(property.type);
}

void PlyCursor::skip(const PlyElement& element) {
    if (element.properties.empty()) return;
    std::vector<double> ignored;
    for (size_t i = 0; i < element.count; ++i)
        for (const PlyProperty& property : element.properties) {
            if (property.isList) list(property, ignored);
            else scalar(property.type);
        }
}

namespace {

/// Where texture coordinates stand among the properties of a vertex: [0] is -1 where it has none.
std::array<int, 2> texcoordsAt(const PlyElement& element) {
    constexpr const char* names[][2] = {{"s", "t"}, {"u", "v"}, {"texture_u", "texture_v"}};
    for (const auto& [first, second] : names) {
        const int u = element.find(first), v = element.find(second);
        if (u >= 0 && v >= 0 && !element.properties[size_t(u)].isList && !element.properties[size_t(v)].isList)
            return {u, v};
    }
    return {-1, -1};
}

/// What a colour of this type has where it is full.
double fullOf(PlyType type) { return type == PlyType::uint8 ? 255 : type == PlyType::uint16 ? 65535 : 1; }

/// Where the colour of a vertex stands; [0] is -1 where it has none.
std::array<int, 3> coloursAt(const PlyElement& element) {
    constexpr const char* names[][3] = {{"red", "green", "blue"}, {"diffuse_red", "diffuse_green", "diffuse_blue"}};
    for (const auto& [r, g, b] : names) {
        const std::array<int, 3> at{element.find(r), element.find(g), element.find(b)};
        if (std::all_of(at.begin(), at.end(), [&](int p) { return p >= 0 && !element.properties[size_t(p)].isList; }))
            return at;
    }
    return {-1, -1, -1};
}

void readVertices(PlyCursor& cursor, const PlyElement& element, TriangleSoup& soup, std::vector<Vec2>& texcoords) {
    const int x = element.find("x"), y = element.find("y"), z = element.find("z");
    if (x < 0 || y < 0 || z < 0) throw Error("element vertex has no x, y and z");
    const int nx = element.find("nx"), ny = element.find("ny"), nz = element.find("nz");
    const bool hasNormals = nx >= 0 && ny >= 0 && nz >= 0;
    soup.positions.resize(element.count);
    if (hasNormals) soup.normals.resize(element.count);
    const auto [u, t] = texcoordsAt(element);
    if (u >= 0) texcoords.resize(element.count);
    const std::array<int, 3> colour = coloursAt(element);
    if (colour[0] >= 0) soup.paint.colours.resize(element.count);
    std::vector<double> ignored;
    std::vector<double> row(element.properties.size());
    for (size_t v = 0; v < element.count; ++v) {
        for (size_t p = 0; p < row.size(); ++p) {
            if (element.properties[p].isList) cursor.list(element.properties[p], ignored);
            else row[p] = cursor.scalar(element.properties[p].type);
        }
        soup.positions[v] = {row[size_t(x)], row[size_t(y)], row[size_t(z)]};
        if (hasNormals) soup.normals[v] = Vec3(DVec3(row[size_t(nx)], row[size_t(ny)], row[size_t(nz)]));
        if (u >= 0) texcoords[v] = Vec2(float(row[size_t(u)]), float(row[size_t(t)]));
        for (size_t c = 0; colour[0] >= 0 && c < 3; ++c) {
            const size_t at = size_t(colour[c]);
            soup.paint.colours[v][int(c)] = float(row[at] / fullOf(element.properties[at].type));
        }
    }
}

int64_t indexOf(double value) { return value >= -1e15 && value <= 1e15 ? int64_t(value) : -1; }

/// Faces, or the triangle strips of the Stanford scans (-1 starts a new strip).
void readFaces(PlyCursor& cursor, const PlyElement& element, size_t vertices, bool strips, TriangleSoup& soup,
               const MeshLimits& limits) {
    int wanted = element.find("vertex_indices");
    if (wanted < 0) wanted = element.find("vertex_index");
    if (wanted < 0 || !element.properties[size_t(wanted)].isList) return cursor.skip(element);
    int texcoord = element.find("texcoord");
    if (texcoord >= 0 && !element.properties[size_t(texcoord)].isList) texcoord = -1;
    const int number = element.find("texnumber");
    const int images = int(soup.paint.images.size());
    soup.image = images == 0 ? -1 : 0;
    if (!strips) soup.triangles.reserve(std::min(element.count, limits.maxTriangles));
    std::vector<double> values, texcoords, ignored;
    std::vector<int64_t> corners;
    std::vector<Vec2> places;
    for (size_t f = 0; f < element.count; ++f) {
        for (size_t p = 0; p < element.properties.size(); ++p) {
            const PlyProperty& property = element.properties[p];
            if (!property.isList) {
                const double value = cursor.scalar(property.type);
                if (int(p) == number) soup.image = value >= 0 && value < images ? int(value) : -1;
            } else cursor.list(property, int(p) == wanted ? values : int(p) == texcoord ? texcoords : ignored);
        }
        if (!strips) {
            corners.resize(values.size());
            for (size_t c = 0; c < values.size(); ++c) corners[c] = indexOf(values[c]);
            places.clear();
            for (size_t i = 0; i + 1 < texcoords.size(); i += 2)
                places.emplace_back(float(texcoords[i]), float(texcoords[i + 1]));
            soup.addFace(corners, vertices, limits, &places);
            continue;
        }
        size_t start = 0;
        for (size_t c = 0; c < values.size(); ++c) {
            if (values[c] < 0) start = c + 1;
            else if (c >= start + 2) {
                const bool odd = (c - start) % 2 == 1;
                corners = {indexOf(values[c - 2]), indexOf(values[odd ? c : c - 1]), indexOf(values[odd ? c - 1 : c])};
                soup.addFace(corners, vertices, limits);
            }
        }
    }
}

}  // namespace

TriangleSoup readPly(std::string_view bytes, const std::filesystem::path& file, const MeshLimits& limits) {
    const PlyHeader header = readPlyHeader(bytes);
    size_t vertices = 0;
    bool hasVertices = false;
    for (const PlyElement& element : header.elements) {
        if (element.name == "vertex") vertices = element.count, hasVertices = true;
        const size_t most = element.name == "vertex" ? limits.maxVertices : limits.maxTriangles;
        if ((element.name == "vertex" || element.name == "face") && element.count > most)
            throw Error("element {} has {} entries, expected at most {}", element.name, element.count, most);
    }
    if (!hasVertices) throw Error("has no element vertex");
    TriangleSoup soup;
    for (const std::string& name : header.textureFiles)
        soup.paint.images.push_back({fileNamedIn(file.parent_path(), name)});
    PlyCursor cursor(bytes, header);
    std::vector<Vec2> texcoords;
    bool done = false;
    for (const PlyElement& element : header.elements) {
        if (element.name == "vertex" && !done) {
            readVertices(cursor, element, soup, texcoords);
            vertices = element.count;
            done = true;
        } else if (element.name == "face" || element.name == "tristrips") {
            readFaces(cursor, element, vertices, element.name == "tristrips", soup, limits);
        } else {
            cursor.skip(element);
        }
    }
    if (!texcoords.empty() && soup.texcoords.empty())
        for (const Triangle& t : soup.triangles) {
            FaceTexcoords places{};
            for (size_t k = 0; k < 3; ++k)
                if (t[k] < texcoords.size()) places[k] = texcoords[t[k]];
            soup.texcoords.push_back(places);
            soup.images.push_back(soup.paint.images.empty() ? -1 : 0);
        }
    return soup;
}

}  // namespace relamp
