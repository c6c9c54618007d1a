// glTF 2.0 (.glb, .gltf): triangles of the scene's nodes where these put them, and the image or the colours of their
// vertices. What else materials hold, and motion, is passed over. Y stays up here; what is up is the capture's to say.
#include <glm/gtc/quaternion.hpp>
#include <map>
#include <nlohmann/json.hpp>

#include "scene/equal_vertices.h"
#include "scene/gltf_document.h"
#include "scene/triangle_soup.h"

namespace relamp {
namespace fs = std::filesystem;
namespace {

constexpr size_t nothing = ~size_t(0);

/// The triangles of a mesh with one material, by the accessors that hold them; `nothing` where there is none.
struct Primitive {
    size_t positions = nothing, normals = nothing, texcoords = nothing, indices = nothing, colours = nothing;
    size_t material = nothing;
    int mode = 4;
    std::string where;
};

size_t indexIn(const JsonFields& fields, const char* key) {
    return fields.has(key) ? size_t(fields.get<uint64_t>(key)) : nothing;
}

std::vector<Primitive> primitivesOf(const JsonFields& mesh) {
    constexpr const char* compressed[] = {"KHR_draco_mesh_compression"};
    std::vector<Primitive> primitives;
    for (const JsonFields& fields : mesh.list("primitives")) {
        Primitive p;
        p.mode = fields.get("mode", 4);
        if (p.mode > 6) throw Error("{}: is {}, expected 0 to 6", fields.name("mode"), p.mode);
        const JsonFields attributes = fields.object("attributes"), extensions = fields.object("extensions");
        for (const char* name : compressed)
            if (extensions.has(name)) throw Error("{}: is not read; export the mesh without it", extensions.name(name));
        p.positions = indexIn(attributes, "POSITION");
        if (p.mode < 4 || p.positions == nothing) continue;  // points and lines
        p.normals = indexIn(attributes, "NORMAL");
        p.texcoords = indexIn(attributes, "TEXCOORD_0");
        p.colours = indexIn(attributes, "COLOR_0");
        p.indices = indexIn(fields, "indices");
        p.material = indexIn(fields, "material");
        p.where = fields.name("attributes");
        primitives.push_back(std::move(p));
    }
    return primitives;
}

/// The numbers of a list of a fixed length.
template <size_t count>
std::array<double, count> numbersIn(const JsonFields& fields, const char* key,
                                    const std::array<double, count>& fallback) {
    const Json* list = fields.find(key);
    if (!list) return fallback;
    if (!list->is_array() || list->size() != count) throw Error("{}: expected {} numbers", fields.name(key), count);
    std::array<double, count> numbers;
    for (size_t i = 0; i < count; ++i) numbers[i] = numberOf((*list)[i], fmt::format("{}[{}]", fields.name(key), i));
    return numbers;
}

DMat4 matrixOf(const JsonFields& node) {
    if (node.has("matrix")) {
        const auto m = numbersIn<16>(node, "matrix", {});
        DMat4 matrix;
        for (int i = 0; i < 16; ++i) matrix[i / 4][i % 4] = m[size_t(i)];
        for (int c = 0; c < 4; ++c)
            if (matrix[c][3] != (c == 3 ? 1 : 0)) throw Error("{}: its last row is not 0 0 0 1", node.name("matrix"));
        return matrix;
    }
    const auto t = numbersIn<3>(node, "translation", {0, 0, 0}), s = numbersIn<3>(node, "scale", {1, 1, 1});
    const auto q = numbersIn<4>(node, "rotation", {0, 0, 0, 1});
    const glm::dquat turn(q[3], q[0], q[1], q[2]);
    if (!(glm::length(turn) > 1e-6))
        throw Error("{}: has no length, expected a unit quaternion", node.name("rotation"));
    DMat4 matrix(glm::mat3_cast(glm::normalize(turn)));
    for (int c = 0; c < 3; ++c) matrix[c] *= s[size_t(c)];
    matrix[3] = glm::dvec4(t[0], t[1], t[2], 1);
    return matrix;
}

std::vector<size_t> indicesIn(const JsonFields& fields, const char* key) {
    std::vector<size_t> indices;
    const Json* list = fields.find(key);
    if (list && !list->is_array()) throw Error("{}: expected a list", fields.name(key));
    if (list)
        for (const Json& value : *list) {
            if (!value.is_number_unsigned())
                throw Error("{}[{}]: expected a whole number", fields.name(key), indices.size());
            indices.push_back(value.get<size_t>());
        }
    return indices;
}

/// Nodes where a scene begins: of the file's scene, else of its first, else those that are no node's child.
std::vector<size_t> rootNodes(const GltfDocument& document, std::string& where) {
    const JsonFields root = document.root();
    const std::vector<JsonFields> scenes = root.list("scenes");
    if (!scenes.empty()) {
        const auto scene = root.get<uint64_t>("scene", 0);
        if (scene >= scenes.size()) throw Error("scene: is {}, the file has {} scenes", scene, scenes.size());
        where = scenes[scene].name("nodes");
        return indicesIn(scenes[scene], "nodes");
    }
    std::vector<uint8_t> isChild(document.nodes(), 0);
    for (size_t n = 0; n < isChild.size(); ++n)
        for (const size_t child : indicesIn(document.node(n, ""), "children"))
            if (child < isChild.size()) isChild[child] = 1;
    std::vector<size_t> roots;
    for (size_t n = 0; n < isChild.size(); ++n)
        if (!isChild[n]) roots.push_back(n);
    return roots;
}

class SoupBuilder {
public:
    SoupBuilder(const GltfDocument& document, const MeshLimits& limits)
        : document_(document), limits_(limits), primitives_(document.meshes()), known_(document.meshes(), 0) {}

    TriangleSoup build() {
        struct Visit {
            size_t node;
            DMat4 worldFromParent;
            std::string from;
        };
        std::string where;
        const std::vector<size_t> roots = rootNodes(document_, where);
        std::vector<Visit> open;
        for (auto root = roots.rbegin(); root != roots.rend(); ++root) open.push_back({*root, DMat4(1), where});
        std::vector<uint8_t> visited(document_.nodes(), 0);
        while (!open.empty()) {
            const Visit visit = std::move(open.back());
            open.pop_back();
            const JsonFields& node = document_.node(visit.node, visit.from);
            // A circle, too, comes back to where it has been.
            if (visited[visit.node]++)
                throw Error("{}: node {} is reached twice, expected a tree", visit.from, visit.node);
            const DMat4 world = visit.worldFromParent * matrixOf(node);
            if (const size_t mesh = indexIn(node, "mesh"); mesh != nothing) {
                if (node.has("skin")) throw Error("{}: skinned meshes are not read", node.name("skin"));
                addMesh(mesh, world, node.name("mesh"));
            }
            const std::vector<size_t> children = indicesIn(node, "children");
            const std::string from = node.name("children");
            for (auto child = children.rbegin(); child != children.rend(); ++child)
                open.push_back({*child, world, from});
        }
        if (!soup_.paint.colours.empty()) soup_.paint.colours.resize(soup_.positions.size(), Vec3(0));
        soup_.paint.linear = true;
        return std::move(soup_);
    }

private:
    const GltfDocument& document_;
    const MeshLimits& limits_;
    TriangleSoup soup_;
    std::vector<std::vector<Primitive>> primitives_;  // of each mesh, once it is known
    std::vector<uint8_t> known_;
    std::map<size_t, int> imageOf_;  // material, in soup_.paint.images; -1: none
    size_t numbers_ = 0;             // that were read

    /// One mesh may be placed by many nodes, and one accessor named by many primitives: a small file would stand for
    /// any number of triangles. Asked when the bytes of its buffers are known.
    void checkSize(size_t vertices, size_t corners, const std::string& where) const {
        constexpr size_t perByte = 8, numbersPerByte = 64;
        if (vertices > limits_.maxVertices) throw Error("{}: has more than {} vertices", where, limits_.maxVertices);
        if (std::max(vertices, corners / 3) > perByte * document_.bytes() ||
            numbers_ > numbersPerByte * document_.bytes())
            throw Error("{}: its meshes are placed so often that they have more than {} vertices or triangles", where,
                        perByte * document_.bytes());
    }

    GltfValues read(size_t accessor, size_t width, bool whole, const std::string& where) {
        GltfValues values = document_.read(accessor, width, whole, where);
        numbers_ += values.values.size();
        return values;
    }

    void addMesh(size_t index, const DMat4& world, const std::string& from) {
        const JsonFields& mesh = document_.mesh(index, from);
        if (!known_[index]) primitives_[index] = primitivesOf(mesh);
        known_[index] = 1;
        std::map<std::pair<size_t, size_t>, size_t> placed;  // where the vertices of two accessors begin
        for (const Primitive& p : primitives_[index]) {
            const auto [at, isNew] = placed.emplace(std::pair(p.positions, p.normals), soup_.positions.size());
            if (isNew) {
                addVertices(p, world);
                addColours(p, at->second);
            }
            soup_.image = imageOf(p.material);
            addFaces(p, at->second, glm::determinant(glm::dmat3(world)) < 0);
        }
    }

    void addVertices(const Primitive& p, const DMat4& world) {
        const size_t count = document_.count(p.positions, limits_.maxVertices, p.where + ".POSITION"),
                     before = soup_.positions.size();
        const GltfValues positions = read(p.positions, 3, false, p.where + ".POSITION");
        checkSize(before + count, 0, p.where + ".POSITION");
        for (size_t v = 0; v < count; ++v) soup_.positions.emplace_back(world * glm::dvec4(positions.vector(v), 1));
        // Normals turn by the inverse transpose; up to its sign and length that is the matrix of cofactors.
        const glm::dmat3 m(world);
        const double sign = glm::determinant(m) < 0 ? -1 : 1;
        const glm::dmat3 turn(sign * glm::cross(m[1], m[2]), sign * glm::cross(m[2], m[0]),
                              sign * glm::cross(m[0], m[1]));
        soup_.normals.resize(soup_.positions.size(), Vec3(0));
        if (p.normals == nothing) return;
        const GltfValues normals = read(p.normals, 3, false, p.where + ".NORMAL");
        for (size_t v = 0; v < std::min(count, normals.count); ++v) {
            const DVec3 n = turn * normals.vector(v);
            const double length = glm::length(n);
            if (length > 0 && std::isfinite(length)) soup_.normals[before + v] = Vec3(n / length);
        }
    }

    /// Colours are a look and no geometry: what is wrong with them leaves them out.
    void addColours(const Primitive& p, size_t first) {
        if (p.colours == nothing) return;
        const std::string where = p.where + ".COLOR_0";
        try {
            const size_t width = document_.shapeOf(p.colours, where) == "VEC4" ? 4 : 3;
            document_.count(p.colours, limits_.maxVertices, where);
            const GltfValues colours = read(p.colours, width, false, where);
            soup_.paint.colours.resize(first, Vec3(0));
            for (size_t v = 0; first + v < soup_.positions.size(); ++v)
                soup_.paint.colours.push_back(v < colours.count
                                                  ? Vec3(DVec3(colours.values[width * v], colours.values[width * v + 1],
                                                               colours.values[width * v + 2]))
                                                  : Vec3(0));
        } catch (const Error&) { return; }
    }

    int imageOf(size_t material) {
        if (material == nothing) return -1;
        const auto [at, isNew] = imageOf_.emplace(material, -1);
        if (!isNew) return at->second;
        try {
            if (const std::optional<MeshImage> image = document_.colourImage(material)) {
                std::vector<MeshImage>& images = soup_.paint.images;
                const auto known = std::find(images.begin(), images.end(), *image);
                at->second = int(known - images.begin());
                if (known == images.end()) images.push_back(*image);
            }
        } catch (const Error&) { at->second = -1; }
        return at->second;
    }

    void addFaces(const Primitive& p, size_t first, bool mirrored) {
        const size_t vertices = document_.count(p.positions, limits_.maxVertices, p.where + ".POSITION");
        GltfValues indices;
        if (p.indices != nothing) indices = read(p.indices, 1, true, p.where + " with its indices");
        const size_t corners = p.indices == nothing ? vertices : indices.count;
        checkSize(soup_.positions.size(), 3 * soup_.triangles.size() + corners * (p.mode == 4 ? 1 : 3), p.where);
        GltfValues texcoords;
        if (p.texcoords != nothing) texcoords = read(p.texcoords, 2, false, p.where + ".TEXCOORD_0");
        const auto cornerAt = [&](size_t i) { return p.indices == nothing ? i : size_t(indices.values[i]); };
        std::vector<int64_t> face(3);
        std::vector<Vec2> places(3);
        const size_t faces = p.mode == 4 ? corners / 3 : corners < 3 ? 0 : corners - 2;
        for (size_t f = 0; f < faces; ++f) {
            std::array<size_t, 3> c;
            if (p.mode == 4) c = {cornerAt(3 * f), cornerAt(3 * f + 1), cornerAt(3 * f + 2)};
            else if (p.mode == 5) c = {cornerAt(f), cornerAt(f + 1 + f % 2), cornerAt(f + 2 - f % 2)};
            else c = {cornerAt(f + 1), cornerAt(f + 2), cornerAt(0)};
            if (mirrored) std::swap(c[1], c[2]);
            bool textured = texcoords.count > 0;
            for (size_t k = 0; k < 3; ++k) {
                face[k] = c[k] < vertices ? int64_t(first + c[k]) : -1;
                textured = textured && c[k] < texcoords.count;
            }
            if (textured)
                for (size_t k = 0; k < 3; ++k)
                    places[k] = Vec2(texcoords.values[2 * c[k]], 1 - texcoords.values[2 * c[k] + 1]);
            soup_.addFace(face, soup_.positions.size(), limits_, textured ? &places : nullptr);
        }
    }
};

/// Of vertices that a writer split the first stays, so they keep the file's order.
void joinSplitVertices(TriangleSoup& soup) {
    std::vector<uint32_t> place = firstEqualVertex(soup.positions, soup.normals);
    const auto count = uint32_t(place.size());
    uint32_t kept = 0;
    for (uint32_t v = 0; v < count; ++v) {
        if (place[v] != v) {
            place[v] = place[place[v]];
            continue;
        }
        soup.positions[kept] = soup.positions[v];
        soup.normals[kept] = soup.normals[v];
        if (v < soup.paint.colours.size()) soup.paint.colours[kept] = soup.paint.colours[v];
        place[v] = kept++;
    }
    soup.positions.resize(kept);
    soup.normals.resize(kept);
    if (!soup.paint.colours.empty()) soup.paint.colours.resize(kept);
    for (Triangle& t : soup.triangles)
        for (uint32_t& v : t) v = place[v];
}

}  // namespace

TriangleSoup readGltf(std::string_view bytes, const fs::path& file, const MeshLimits& limits) {
    const GltfDocument document(bytes, file);
    TriangleSoup soup = SoupBuilder(document, limits).build();
    joinSplitVertices(soup);
    soup.yUp = true;
    return soup;
}

}  // namespace relamp
