#include "relight/standing_emitters.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <set>

namespace relamp {
namespace {

using Edge = std::pair<uint32_t, uint32_t>;

/// A closed border, in the order of the emitter's triangles, and how many of its edges others share.
struct Border {
    std::vector<uint32_t> vertices;
    size_t shared = 0;
    float length = 0;  ///< metres
};

/// The connected pieces of an emitter: per vertex the least vertex of its piece.
std::map<uint32_t, uint32_t> piecesOf(const Mesh& mesh, const EmitterCluster& emitter) {
    std::map<uint32_t, uint32_t> parent;
    const auto root = [&](uint32_t v) {
        while (parent[v] != v) v = parent[v] = parent[parent[v]];
        return v;
    };
    for (const uint32_t t : emitter.triangles) {
        for (const uint32_t v : mesh.triangles[t]) parent.emplace(v, v);
        const uint32_t a = root(mesh.triangles[t][0]), b = root(mesh.triangles[t][1]), c = root(mesh.triangles[t][2]),
                       least = std::min({a, b, c});
        parent[a] = parent[b] = parent[c] = least;
    }
    for (auto& [v, up] : parent) up = root(v);
    return parent;
}

struct Borders {
    std::vector<Border> outer;         ///< of each piece the longest; the others are specks that did not shine
    std::vector<uint32_t> neighbours;  ///< triangles of the surface outside that touch a border
};

Borders bordersOf(const Mesh& mesh, const EmitterCluster& emitter) {
    std::set<Edge> inside;
    for (const uint32_t t : emitter.triangles)
        for (size_t k = 0; k < 3; ++k) inside.emplace(mesh.triangles[t][k], mesh.triangles[t][(k + 1) % 3]);
    std::map<uint32_t, uint32_t> next;
    for (const Edge& e : inside)
        if (!inside.count({e.second, e.first})) next[e.first] = e.second;
    std::vector<uint8_t> onBorder(mesh.vertexCount(), 0);
    for (const auto& [from, to] : next) onBorder[from] = onBorder[to] = 1;
    std::set<Edge> others;
    Borders borders;
    for (uint32_t i = 0; i < mesh.triangles.size(); ++i) {
        const Triangle& t = mesh.triangles[i];
        if (!onBorder[t[0]] && !onBorder[t[1]] && !onBorder[t[2]]) continue;
        if (std::binary_search(emitter.triangles.begin(), emitter.triangles.end(), i)) continue;
        borders.neighbours.push_back(i);
        for (size_t k = 0; k < 3; ++k) others.emplace(t[k], t[(k + 1) % 3]);
    }
    const std::map<uint32_t, uint32_t> piece = piecesOf(mesh, emitter);
    std::map<uint32_t, Border> longest;
    while (!next.empty()) {
        Border loop;
        const uint32_t first = next.begin()->first;
        uint32_t at = first;
        bool closed = false;
        for (auto step = next.find(at); step != next.end(); step = next.find(at)) {
            const uint32_t to = step->second;
            next.erase(step);
            loop.vertices.push_back(at);
            loop.shared += others.count({to, at});
            loop.length += glm::distance(mesh.positions[at], mesh.positions[to]);
            at = to;
            closed = at == first;
            if (closed) break;
        }
        Border& known = longest[piece.at(first)];
        if (closed && loop.vertices.size() > 2 && loop.length > known.length) known = std::move(loop);
    }
    for (auto& [of, loop] : longest)
        if (!loop.vertices.empty()) borders.outer.push_back(std::move(loop));
    return borders;
}

Vec3 centreOf(const Mesh& mesh, const Border& loop) {
    Vec3 sum(0);
    for (const uint32_t v : loop.vertices) sum += mesh.positions[v];
    return sum / float(loop.vertices.size());
}

/// Twice the fan's area along its mean normal, seen from the side that the emitter's triangles face away from.
Vec3 fanNormal(const Mesh& mesh, const Border& loop, const Vec3& centre) {
    Vec3 sum(0);
    for (size_t i = 0; i < loop.vertices.size(); ++i)
        sum += glm::cross(mesh.positions[loop.vertices[(i + 1) % loop.vertices.size()]] - centre,
                          mesh.positions[loop.vertices[i]] - centre);
    return sum;
}

/// A vertex of the surface outside, up to three edges away from a border's.
uint32_t outsideOf(const Scene& scene, uint32_t vertex, const std::vector<uint32_t>& emitting) {
    std::vector<uint32_t> ring{vertex};
    std::set<uint32_t> known{vertex};
    for (int step = 0; step < 3; ++step) {
        std::vector<uint32_t> wider;
        for (const uint32_t v : ring)
            for (uint32_t e = scene.graph.start[v]; e < scene.graph.start[v + 1]; ++e) {
                const uint32_t to = scene.graph.to[e];
                if (known.insert(to).second && !std::binary_search(emitting.begin(), emitting.end(), to))
                    wider.push_back(to);
            }
        if (wider.empty()) break;
        ring = std::move(wider);
    }
    return ring[ring.size() / 2];
}

class Closing {
public:
    Closing(const Scene& scene, ClosedMesh& out) : scene_(scene), out_(out) {}

    /// The place that the emitter leaves. Triangles around it no longer have its vertices, which are black.
    void ground(const Border& loop, const std::vector<uint32_t>& neighbours, const std::vector<uint32_t>& emitting,
                const Vec3& centre, const Vec3& below) {
        std::vector<uint32_t> rim;
        std::map<uint32_t, uint32_t> rimOf;
        for (const uint32_t v : loop.vertices) {
            rim.push_back(addVertex(scene_.mesh.positions[v], -below, outsideOf(scene_, v, emitting)));
            rimOf[v] = rim.back();
        }
        for (const uint32_t t : neighbours)
            for (uint32_t& v : out_.mesh.triangles[t])
                if (const auto at = rimOf.find(v); at != rimOf.end()) {
                    v = at->second;
                    out_.untextured.push_back(t);
                }
        const uint32_t middle = addVertex(centre, -below, out_.vertexOrigin[rim.front()]);
        for (size_t i = 0; i < rim.size(); ++i) addTriangle({rim[i], rim[(i + 1) % rim.size()], middle}, -1);
    }
    /// The emitter's underside. Its vertices are the emitter's own.
    void underside(const Border& loop, size_t emitter, const Vec3& centre, const Vec3& below) {
        const std::vector<uint32_t>& rim = loop.vertices;
        const uint32_t middle = addVertex(centre, below, rim.front());
        for (size_t i = 0; i < rim.size(); ++i) {
            out_.emitters[emitter].triangles.push_back(uint32_t(out_.mesh.triangles.size()));
            addTriangle({rim[(i + 1) % rim.size()], rim[i], middle}, int(emitter));
        }
        out_.emitters[emitter].vertices.push_back(middle);
    }

private:
    uint32_t addVertex(const Vec3& position, const Vec3& normal, uint32_t origin) {
        out_.mesh.positions.push_back(position);
        out_.mesh.normals.push_back(normal);
        out_.vertexOrigin.push_back(origin);
        return uint32_t(out_.mesh.positions.size() - 1);
    }
    void addTriangle(const Triangle& triangle, int emitter) {
        out_.mesh.triangles.push_back(triangle);
        out_.emitterOfNewTriangle.push_back(emitter);
    }

    const Scene& scene_;
    ClosedMesh& out_;
};

}  // namespace

ClosedMesh closeStandingEmitters(const Scene& scene, const std::vector<EmitterCluster>& emitters,
                                 const std::vector<uint8_t>& leaves) {
    constexpr float mostlyShared = 0.8f, standsOut = 2;
    ClosedMesh out{scene.mesh, {}, emitters, {}, {}, leaves};
    out.vertexOrigin.resize(scene.mesh.vertexCount());
    std::iota(out.vertexOrigin.begin(), out.vertexOrigin.end(), 0u);
    Closing closing(scene, out);
    for (size_t e = 0; e < emitters.size(); ++e) {
        if (!leaves[e] || emitters[e].triangles.empty()) continue;
        const Borders borders = bordersOf(scene.mesh, emitters[e]);
        float open = 0;
        for (const Border& loop : borders.outer)
            open += 0.5f * glm::length(fanNormal(scene.mesh, loop, centreOf(scene.mesh, loop)));
        for (const Border& loop : borders.outer) {
            const Vec3 centre = centreOf(scene.mesh, loop), below = fanNormal(scene.mesh, loop, centre);
            if (!(glm::length(below) > 0) || float(loop.shared) < mostlyShared * float(loop.vertices.size())) continue;
            closing.ground(loop, borders.neighbours, emitters[e].vertices, centre, glm::normalize(below));
            if (emitters[e].area > standsOut * open) closing.underside(loop, e, centre, glm::normalize(below));
        }
    }
    return out;
}

}  // namespace relamp
