// From the triangles of a file to a mesh that can be lit: faces that are no surface go, everything is counted.
#include <numeric>

#include "base/box.h"
#include "base/error.h"
#include "scene/equal_vertices.h"
#include "scene/triangle_soup.h"

namespace relamp {
namespace {

/// Coordinates beyond this are treated as not finite, because their squares leave the range of floats.
constexpr double largestCoordinate = 1e15;

bool isUsable(const DVec3& p) {
    return std::abs(p.x) < largestCoordinate && std::abs(p.y) < largestCoordinate &&
           std::abs(p.z) < largestCoordinate;  // false for what is no number
}

/// No area to the precision of a float: repeated corner, or three corners on a line.
bool isDegenerate(const std::vector<Vec3>& positions, const Triangle& t) {
    if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0]) return true;
    const Vec3 a = positions[t[1]] - positions[t[0]], b = positions[t[2]] - positions[t[0]];
    if (!(glm::length(glm::cross(a, b)) > 0)) return true;
    const DVec3 da(a), db(b);
    const double longest = std::max({glm::dot(da, da), glm::dot(db, db), glm::dot(da - db, da - db)});
    return !(glm::length(glm::cross(da, db)) > 1e-9 * longest);
}

/// For each vertex the first one at the same position, so that seams of normals or texture are no holes.
std::vector<uint32_t> weldedVertices(const std::vector<Vec3>& positions) {
    return firstOfEqual(positions.size(), [&](uint32_t v) {
        return std::array<float, 3>{positions[v].x, positions[v].y, positions[v].z};
    });
}

/// Triangles with the same corners, or at the same place and turned the same way: one stays. A hundred thousand of them
/// in one place would cost each ray a hundred thousand tests. Two sheets that lie back to back both stay.
size_t dropDuplicates(std::vector<Triangle>& triangles, const std::vector<uint32_t>& welded) {
    struct Key {
        Triangle place, corners;
        bool odd = false;  ///< turned against the order of the places
    };
    std::vector<Key> keys(triangles.size());
    for (size_t i = 0; i < keys.size(); ++i) {
        Key& key = keys[i];
        key.corners = triangles[i];
        std::sort(key.corners.begin(), key.corners.end());
        for (size_t k = 0; k < 3; ++k) key.place[k] = welded[triangles[i][k]];
        const auto order = [&](size_t a, size_t b) {
            if (key.place[a] <= key.place[b]) return;
            std::swap(key.place[a], key.place[b]);
            key.odd = !key.odd;
        };
        order(0, 1), order(1, 2), order(0, 1);
    }
    std::vector<uint32_t> order(triangles.size());
    std::iota(order.begin(), order.end(), 0u);
    std::sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) {
        return keys[a].place != keys[b].place ? keys[a].place < keys[b].place : a < b;
    });
    std::vector<uint8_t> drop(triangles.size(), 0);
    for (size_t i = 0; i < order.size();) {
        const Key& first = keys[order[i]];
        bool back = false;
        for (++i; i < order.size() && keys[order[i]].place == first.place; ++i) {
            const Key& key = keys[order[i]];
            const bool keep = !back && key.odd != first.odd && key.corners != first.corners;
            back |= keep;
            drop[order[i]] = !keep;
        }
    }
    size_t kept = 0;
    for (size_t i = 0; i < triangles.size(); ++i)
        if (!drop[i]) triangles[kept++] = triangles[i];
    const size_t dropped = triangles.size() - kept;
    triangles.resize(kept);
    return dropped;
}

void countEdges(const Mesh& mesh, const std::vector<uint32_t>& welded, MeshReport& report) {
    std::vector<uint64_t> edges;
    edges.reserve(mesh.triangles.size() * 3);
    for (const Triangle& t : mesh.triangles)
        for (size_t k = 0; k < 3; ++k) {
            const uint64_t a = welded[t[k]], b = welded[t[(k + 1) % 3]];
            if (a != b) edges.push_back(std::min(a, b) << 32 | std::max(a, b));
        }
    std::sort(edges.begin(), edges.end());
    for (size_t i = 0; i < edges.size();) {
        size_t end = i;
        while (end < edges.size() && edges[end] == edges[i]) ++end;
        report.boundaryEdges += end - i == 1;
        report.nonManifoldEdges += end - i >= 3;
        i = end;
    }
}

/// The file's normals where they are good, those of the faces elsewhere.
void setNormals(Mesh& mesh, std::vector<Vec3>&& fromFile, const std::vector<uint8_t>& referenced, MeshReport& report) {
    mesh.normals = vertexNormalsFromFaces(mesh);
    if (fromFile.size() != mesh.vertexCount()) return;
    size_t good = 0, wanted = 0;
    for (size_t v = 0; v < fromFile.size(); ++v) {
        if (!referenced[v]) continue;
        ++wanted;
        const float length = isFinite(fromFile[v]) ? glm::length(fromFile[v]) : 0.0f;
        if (!(length > 1e-6f) || !std::isfinite(length)) continue;
        mesh.normals[v] = fromFile[v] / length;
        ++good;
    }
    report.normalsFromFile = 2 * good > wanted;
    if (!report.normalsFromFile) return;
    // Faces turned against the normals of all their corners: emitters shine to the front only.
    for (Triangle& t : mesh.triangles) {
        const Vec3 face =
            glm::cross(mesh.positions[t[1]] - mesh.positions[t[0]], mesh.positions[t[2]] - mesh.positions[t[0]]);
        if (std::all_of(t.begin(), t.end(), [&](uint32_t v) { return glm::dot(face, mesh.normals[v]) < 0; }))
            std::swap(t[1], t[2]);
    }
}

}  // namespace

DVec3 originFor(const DVec3& low, const DVec3& high) {
    const double size = glm::length(high - low);
    const DVec3 middle = 0.5 * (low + high);
    if (!(size > 0) || !std::isfinite(size) || !(glm::length(middle) > 2 * size)) return DVec3(0);
    const double step = std::exp2(std::floor(std::log2(size)));
    return glm::round(middle / step) * step;
}

void TriangleSoup::addFace(const std::vector<int64_t>& corners, size_t vertices, const MeshLimits& limits,
                           const std::vector<Vec2>* places) {
    const bool inside =
        std::all_of(corners.begin(), corners.end(), [&](int64_t c) { return c >= 0 && size_t(c) < vertices; });
    if (corners.size() < 3 || !inside) {
        ++badIndexFaces;
        return;
    }
    polygons += corners.size() > 3;
    if (triangles.size() + corners.size() - 2 > limits.maxTriangles)
        throw Error("has more than {} triangles", limits.maxTriangles);
    if (places && places->size() == corners.size()) {
        texcoords.resize(triangles.size());
        images.resize(triangles.size(), -1);
        for (size_t c = 2; c < corners.size(); ++c) {
            texcoords.push_back({(*places)[0], (*places)[c - 1], (*places)[c]});
            images.push_back(image);
        }
    }
    for (size_t c = 2; c < corners.size(); ++c)
        triangles.push_back({uint32_t(corners[0]), uint32_t(corners[c - 1]), uint32_t(corners[c])});
}

Mesh repairSoup(TriangleSoup&& soup, bool recentre, MeshReport& report) {
    report = {};
    report.polygons = soup.polygons;
    report.badIndexFaces = soup.badIndexFaces;
    report.yUp = soup.yUp;
    const size_t facesInFile = soup.triangles.size() + soup.badIndexFaces;
    Mesh mesh;
    std::vector<uint8_t> usable(soup.positions.size(), 1);
    DBox all, surface;
    for (size_t v = 0; v < usable.size(); ++v) {
        usable[v] = isUsable(soup.positions[v]);
        if (usable[v]) all.grow(soup.positions[v]);
        else ++report.nanVertices;
    }
    for (const Triangle& t : soup.triangles)
        for (const uint32_t v : t)
            if (v < usable.size() && usable[v]) surface.grow(soup.positions[v]);
    if (recentre) report.origin = originFor(surface.min, surface.max);
    mesh.positions.reserve(usable.size());
    for (size_t v = 0; v < usable.size(); ++v)
        mesh.positions.emplace_back((usable[v] ? soup.positions[v] : all.centre()) - report.origin);
    soup.positions = {};
    size_t notFinite = 0;
    for (const Triangle& t : soup.triangles) {
        if (t[0] >= usable.size() || t[1] >= usable.size() || t[2] >= usable.size()) ++report.badIndexFaces;
        else if (!usable[t[0]] || !usable[t[1]] || !usable[t[2]]) ++notFinite;
        else if (isDegenerate(mesh.positions, t)) ++report.degenerateFaces;
        else mesh.triangles.push_back(t);
    }
    const std::vector<uint32_t> welded = weldedVertices(mesh.positions);
    report.duplicateFaces = dropDuplicates(mesh.triangles, welded);
    if (mesh.triangles.empty()) {
        if (facesInFile == 0)
            throw Error("holds {} vertices and no faces, expected a surface of triangles", mesh.vertexCount());
        throw Error(
            "holds no usable triangle: of {} faces {} touch a vertex that is not finite, {} name a vertex that does "
            "not exist, {} have no area",
            facesInFile, notFinite, report.badIndexFaces, report.degenerateFaces);
    }
    std::vector<uint8_t> referenced(mesh.vertexCount(), 0);
    for (const Triangle& t : mesh.triangles)
        for (const uint32_t v : t) referenced[v] = 1;
    for (const uint8_t r : referenced) report.unreferencedVertices += !r;
    setNormals(mesh, std::move(soup.normals), referenced, report);
    countEdges(mesh, welded, report);
    report.vertices = mesh.vertexCount();
    report.triangles = mesh.triangles.size();
    return mesh;
}

}  // namespace relamp
