// OBJ, OFF and ascii text in general: vertices and polygons, and of materials the image; groups are passed over.
#include "base/error.h"
#include "base/text_scanner.h"
#include "scene/mesh_materials.h"
#include "scene/triangle_soup.h"

namespace relamp {
namespace {

/// One logical line: a backslash at the end joins the next one.
std::string_view logicalLine(TextScanner& scanner, std::string& joined) {
    std::string_view line = scanner.line();
    if (line.empty() || line.back() != '\\') return line;
    joined.clear();
    while (!line.empty() && line.back() == '\\') {
        joined.append(line.substr(0, line.size() - 1)).push_back(' ');
        line = scanner.line();
    }
    joined.append(line);
    return joined;
}

DVec3 threeNumbers(TextScanner& words, const char* what, size_t lineNumber) {
    DVec3 v;
    for (int c = 0; c < 3; ++c) {
        const std::string_view word = words.word();
        const auto value = TextScanner::number(word);
        if (!value)
            throw Error("line {}: {} holds \"{}\" where a number was expected", lineNumber, what, word.substr(0, 40));
        v[c] = *value;
    }
    return v;
}

/// What follows "v x y z" where it is a colour, as scanners write it.
void addColour(TextScanner& words, TriangleSoup& soup) {
    Vec3 colour(0);
    for (int c = 0; c < 3; ++c) {
        const auto value = TextScanner::number(words.word('#'));
        if (!value || !std::isfinite(*value)) return;
        colour[c] = float(*value);
    }
    soup.paint.colours.resize(soup.positions.size() - 1, Vec3(0));
    soup.paint.colours.push_back(colour);
}

/// Names may hold spaces.
std::string restOf(TextScanner& words) {
    std::string_view rest = words.line();
    while (!rest.empty() && TextScanner::isSpace(rest.front())) rest.remove_prefix(1);
    while (!rest.empty() && TextScanner::isSpace(rest.back())) rest.remove_suffix(1);
    return std::string(rest);
}

/// "vt": v may be missing.
Vec2 twoNumbers(TextScanner& words, size_t lineNumber) {
    const std::string_view first = words.word(), second = words.word('#');
    const auto u = TextScanner::number(first);
    if (!u) throw Error("line {}: vt holds \"{}\" where a number was expected", lineNumber, first.substr(0, 40));
    return {float(*u), float(TextScanner::number(second).value_or(0))};
}

/// Index of a corner from 0; negative indices count from the last vertex so far, 0 and nonsense give -1.
int64_t fromOne(std::optional<int64_t> index, size_t soFar) {
    if (!index || *index == 0) return -1;
    if (*index > 0) return *index - 1;
    return *index < -int64_t(soFar) ? -1 : int64_t(soFar) + *index;
}

}  // namespace

TriangleSoup readObj(std::string_view bytes, const std::filesystem::path& file, const MeshLimits& limits) {
    TriangleSoup soup;
    ObjMaterials materials(file.parent_path());
    std::vector<Vec3> normals;
    struct Corner {
        uint32_t vertex, normal;
    };
    std::vector<Corner> corners;  // which normal a face gives a vertex; both may be declared later in the file
    struct Face {
        std::vector<int64_t> vertices, texcoords;
        int image = -1;
    };
    std::vector<Face> late;
    std::vector<Vec2> texcoords, places;
    Face face;
    const auto addFace = [&](const Face& f) {
        places.clear();
        for (const int64_t t : f.texcoords)
            if (t >= 0 && t < int64_t(texcoords.size())) places.push_back(texcoords[size_t(t)]);
        soup.image = f.image;
        soup.addFace(f.vertices, soup.positions.size(), limits, &places);
    };
    std::string joined;
    TextScanner scanner(bytes);
    for (size_t lineNumber = 1; !scanner.atEnd(); ++lineNumber) {
        TextScanner words(logicalLine(scanner, joined));
        const std::string_view key = words.word('#');
        if (key == "v") {
            if (soup.positions.size() >= limits.maxVertices)
                throw Error("has more than {} vertices", limits.maxVertices);
            soup.positions.push_back(threeNumbers(words, "v", lineNumber));
            addColour(words, soup);
        } else if (key == "vn") {
            normals.emplace_back(threeNumbers(words, "vn", lineNumber));
        } else if (key == "vt") {
            texcoords.push_back(twoNumbers(words, lineNumber));
        } else if (key == "mtllib") {
            materials.read(restOf(words));
        } else if (key == "usemtl") {
            face.image = materials.imageOf(restOf(words));
        } else if (key == "f") {
            face.vertices.clear();
            face.texcoords.clear();
            for (std::string_view word = words.word('#'); !word.empty(); word = words.word('#')) {
                const int64_t vertex = fromOne(TextScanner::integer(word), soup.positions.size());
                face.vertices.push_back(vertex);
                const size_t first = word.find('/');
                if (first != word.npos)
                    if (const int64_t t = fromOne(TextScanner::integer(word.substr(first + 1)), texcoords.size());
                        t >= 0)
                        face.texcoords.push_back(t);
                const size_t second = first == word.npos ? first : word.find('/', first + 1);
                if (second == word.npos || vertex < 0 || vertex >= TriangleSoup::noVertex) continue;
                const int64_t normal = fromOne(TextScanner::integer(word.substr(second + 1)), normals.size());
                if (normal >= 0 && normal < TriangleSoup::noVertex)
                    corners.push_back({uint32_t(vertex), uint32_t(normal)});
            }
            // Some writers put faces before their vertices, so indices are checked at the end where they are ahead.
            bool ahead = false;
            for (const int64_t corner : face.vertices) ahead = ahead || corner >= int64_t(soup.positions.size());
            for (const int64_t place : face.texcoords) ahead = ahead || place >= int64_t(texcoords.size());
            if (ahead) late.push_back(face);
            else addFace(face);
        }
    }
    for (const Face& lateFace : late) addFace(lateFace);
    if (!soup.paint.colours.empty()) soup.paint.colours.resize(soup.positions.size(), Vec3(0));
    soup.paint.images = materials.images();
    if (!corners.empty()) {
        soup.normals.assign(soup.positions.size(), Vec3(0));
        for (const Corner& c : corners)
            if (c.vertex < soup.positions.size() && c.normal < normals.size() && isFinite(normals[c.normal])) {
                const float length = glm::length(normals[c.normal]);
                if (length > 0) soup.normals[c.vertex] += normals[c.normal] / length;
            }
    }
    return soup;
}

TriangleSoup readOff(std::string_view bytes, const MeshLimits& limits) {
    TextScanner scanner(bytes);
    std::string_view magic = scanner.word('#');
    if (magic.size() < 3 || magic.substr(magic.size() - 3) != "OFF") throw Error("is no OFF file");
    const std::string_view kinds = magic.substr(0, magic.size() - 3);
    if (kinds.find_first_of("4n") != kinds.npos)
        throw Error("is an OFF file of four or more dimensions, expected three");
    const bool hasNormals = kinds.find('N') != kinds.npos;
    int64_t counts[3];
    for (int c = 0; c < 3; ++c) {
        const std::string_view word = scanner.word('#');
        const auto value = TextScanner::integer(word);
        if (!value || *value < 0)
            throw Error("has \"{}\" for its number of {}, expected 0 or more", word.substr(0, 40),
                        c == 0   ? "vertices"
                        : c == 1 ? "faces"
                                 : "edges");
        counts[c] = *value;
    }
    // A vertex takes at least three digits and three spaces, a face at least a digit and a space.
    const size_t vertices = size_t(counts[0]), faces = size_t(counts[1]), rest = scanner.remaining() + 1;
    if (vertices > rest / 6 || faces > rest / 2)
        throw Error("claims {} vertices and {} faces, more than the file holds", vertices, faces);
    if (vertices > limits.maxVertices)
        throw Error("has {} vertices, expected at most {}", vertices, limits.maxVertices);
    if (faces > limits.maxTriangles) throw Error("has {} faces, expected at most {}", faces, limits.maxTriangles);
    const auto nextLine = [&]() -> std::string_view {
        while (!scanner.atEnd()) {
            std::string_view line = scanner.line();
            line = line.substr(0, line.find('#'));
            if (line.find_first_not_of(" \t\v\f") != line.npos) return line;
        }
        throw Error("ends before its last face");
    };
    TriangleSoup soup;
    soup.positions.resize(vertices);
    if (hasNormals) soup.normals.resize(vertices);
    for (size_t v = 0; v < vertices; ++v) {
        TextScanner words(nextLine());
        soup.positions[v] = threeNumbers(words, "vertex", v);
        if (hasNormals) soup.normals[v] = Vec3(threeNumbers(words, "normal", v));
    }
    std::vector<int64_t> face;
    for (size_t f = 0; f < faces; ++f) {
        TextScanner words(nextLine());
        const auto corners = TextScanner::integer(words.word());
        if (!corners || *corners < 0 || size_t(*corners) > words.remaining())
            throw Error("face {} has no proper number of corners", f);
        face.clear();
        for (int64_t c = 0; c < *corners; ++c) face.push_back(TextScanner::integer(words.word()).value_or(-1));
        soup.addFace(face, vertices, limits);
    }
    return soup;
}

}  // namespace relamp
