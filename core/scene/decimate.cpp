#include "scene/decimate.h"

#include <algorithm>
#include <array>
#include <functional>
#include <limits>
#include <numeric>
#include <queue>

#include "base/box.h"
#include "base/parallel.h"

namespace relamp {
namespace {

constexpr size_t minComponent = 64;
constexpr float turnCosine = 0.34f;

/// Sum of squared distances from planes, and a little from points, weighted by area.
struct Quadric {
    double xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0, x = 0, y = 0, z = 0, rest = 0;

    void addPlane(const DVec3& n, double d, double w) {
        xx += w * n.x * n.x, xy += w * n.x * n.y, xz += w * n.x * n.z, yy += w * n.y * n.y, yz += w * n.y * n.z,
            zz += w * n.z * n.z;
        x += w * n.x * d, y += w * n.y * d, z += w * n.z * d, rest += w * d * d;
    }
    void addPoint(const DVec3& p, double w) {
        for (int c = 0; c < 3; ++c) {
            DVec3 n(0);
            n[c] = 1;
            addPlane(n, -p[c], w);
        }
    }
    void add(const Quadric& o) {
        xx += o.xx, xy += o.xy, xz += o.xz, yy += o.yy, yz += o.yz, zz += o.zz, x += o.x, y += o.y, z += o.z,
            rest += o.rest;
    }
    double at(const DVec3& p) const {
        return p.x * (xx * p.x + 2 * (xy * p.y + xz * p.z + x)) + p.y * (yy * p.y + 2 * (yz * p.z + y)) +
               p.z * (zz * p.z + 2 * z) + rest;
    }
};

struct Collapse {
    double cost;
    uint32_t from, to, fromStamp, toStamp;
    bool operator>(const Collapse& o) const {
        return cost != o.cost ? cost > o.cost : from != o.from ? from > o.from : to > o.to;
    }
};

class Decimator {
public:
    Decimator(const Mesh& mesh, size_t wanted) : mesh_(mesh), wanted_(wanted) {
        weld();
        const size_t n = place_.size();
        facesOf_.resize(n);
        quadric_.resize(n);
        stamp_.assign(n, 0);
        into_.resize(n);
        std::iota(into_.begin(), into_.end(), 0u);
        double area = 0;
        for (size_t t = 0; t < mesh.triangles.size(); ++t) {
            const Triangle face{weld_[mesh.triangles[t][0]], weld_[mesh.triangles[t][1]], weld_[mesh.triangles[t][2]]};
            if (face[0] == face[1] || face[1] == face[2] || face[2] == face[0]) continue;
            const auto index = uint32_t(faces_.size());
            faces_.push_back(face);
            for (const uint32_t v : face) facesOf_[v].push_back(index);
            area += 0.5 * glm::length(crossOf(face));
        }
        left_ = faces_.size();
        alive_.assign(left_, 1);
        const double even = std::sqrt(area / double(std::max<size_t>(1, wanted)) * 4 / std::sqrt(3.0));
        longest2_ = 9 * even * even;
        countComponents();
        for (uint32_t f = 0; f < faces_.size(); ++f) addQuadrics(f);
    }

    void run(Progress& progress) {
        if (left_ <= wanted_) return;
        for (uint32_t v = 0; v < place_.size(); ++v) push(v, false);
        const size_t start = left_;
        progress.begin("Working mesh", start - wanted_);
        size_t told = start, steps = 0;
        while (left_ > wanted_ && !queue_.empty()) {
            const Collapse c = queue_.top();
            queue_.pop();
            if (++steps % 4096 == 0) {
                progress.check();
                progress.advance(told - left_);
                told = left_;
            }
            if (stamp_[c.from] != c.fromStamp || stamp_[c.to] != c.toStamp || into_[c.from] != c.from ||
                into_[c.to] != c.to)
                continue;
            if (allowed(c.from, c.to)) collapse(c.from, c.to);
        }
    }

    DecimatedMesh result() {
        DecimatedMesh out;
        // Which of the vertices at one place a corner takes: the one that faces as the triangle does.
        std::vector<std::vector<uint32_t>> at(place_.size());
        for (uint32_t v = 0; v < mesh_.vertexCount(); ++v)
            if (used_[v]) at[weld_[v]].push_back(v);
        std::vector<uint32_t> number(mesh_.vertexCount(), SurfacePlace::none);
        std::vector<Triangle> faces;
        for (size_t f = 0; f < faces_.size(); ++f) {
            if (!alive_[f]) continue;
            const Vec3 normal(glm::normalize(crossOf(faces_[f])));
            Triangle face{};
            for (size_t k = 0; k < 3; ++k) {
                const auto& choices = at[faces_[f][k]];
                face[k] = *std::max_element(choices.begin(), choices.end(), [&](uint32_t a, uint32_t b) {
                    return std::abs(glm::dot(mesh_.normals[a], normal)) < std::abs(glm::dot(mesh_.normals[b], normal));
                });
                number[face[k]] = 0;
            }
            faces.push_back(face);
        }
        for (uint32_t v = 0; v < number.size(); ++v)
            if (number[v] == 0) {
                number[v] = uint32_t(out.vertex.size());
                out.vertex.push_back(v);
                out.mesh.positions.push_back(mesh_.positions[v]);
            }
        for (const Triangle& f : faces) out.mesh.triangles.push_back({number[f[0]], number[f[1]], number[f[2]]});
        setNormals(at, number, out);
        findPlaces(out);
        return out;
    }

private:
    void weld() {
        const size_t n = mesh_.vertexCount();
        std::vector<uint32_t> order(n);
        std::iota(order.begin(), order.end(), 0u);
        const auto key = [&](uint32_t v) {
            return std::array<float, 3>{mesh_.positions[v].x, mesh_.positions[v].y, mesh_.positions[v].z};
        };
        std::sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) {
            const auto ka = key(a), kb = key(b);
            return ka != kb ? ka < kb : a < b;
        });
        used_.assign(n, 0);
        for (const Triangle& t : mesh_.triangles)
            for (const uint32_t v : t) used_[v] = 1;
        DBox box;
        for (uint32_t v = 0; v < n; ++v)
            if (used_[v]) box.grow(DVec3(mesh_.positions[v]));
        middle_ = box.centre();
        weld_.assign(n, 0);
        for (size_t i = 0; i < n; ++i) {
            if (i == 0 || key(order[i]) != key(order[i - 1]))
                place_.push_back(DVec3(mesh_.positions[order[i]]) - middle_);
            weld_[order[i]] = uint32_t(place_.size() - 1);
        }
    }
    DVec3 crossOf(const Triangle& f) const {
        return glm::cross(place_[f[1]] - place_[f[0]], place_[f[2]] - place_[f[0]]);
    }

    void countComponents() {
        componentOf_.resize(place_.size());
        std::iota(componentOf_.begin(), componentOf_.end(), 0u);
        const auto root = [&](uint32_t v) {
            while (componentOf_[v] != v) v = componentOf_[v] = componentOf_[componentOf_[v]];
            return v;
        };
        for (const Triangle& f : faces_)
            for (size_t k = 1; k < 3; ++k) {
                const uint32_t a = root(f[0]), b = root(f[k]);
                componentOf_[std::max(a, b)] = std::min(a, b);
            }
        for (uint32_t v = 0; v < componentOf_.size(); ++v) componentOf_[v] = root(v);
        componentFaces_.assign(place_.size(), 0);
        for (const Triangle& f : faces_) ++componentFaces_[componentOf_[f[0]]];
    }

    void addQuadrics(uint32_t index) {
        const Triangle& f = faces_[index];
        const DVec3 cross = crossOf(f);
        const double twice = glm::length(cross);
        if (!(twice > 0)) return;
        const DVec3 n = cross / twice;
        for (const uint32_t v : f) {
            quadric_[v].addPlane(n, -glm::dot(n, place_[v]), twice / 6);
            quadric_[v].addPoint(place_[v], 1e-3 * twice / 6);
        }
        for (size_t k = 0; k < 3; ++k) {
            const uint32_t a = f[k], b = f[(k + 1) % 3];
            if (sharedFaces(a, b) != 1) continue;
            // A rim holds its line: a plane through it, upright on the face.
            const DVec3 along = place_[b] - place_[a], upright = glm::normalize(glm::cross(along, n));
            const double w = 3 * glm::dot(along, along);
            quadric_[a].addPlane(upright, -glm::dot(upright, place_[a]), w);
            quadric_[b].addPlane(upright, -glm::dot(upright, place_[a]), w);
        }
    }
    size_t sharedFaces(uint32_t a, uint32_t b) const {
        size_t count = 0;
        for (const uint32_t f : facesOf_[a]) count += has(f, b);
        return count;
    }
    bool has(uint32_t f, uint32_t v) const { return faces_[f][0] == v || faces_[f][1] == v || faces_[f][2] == v; }

    /// Neighbours of v, and how many faces of v each shares.
    void around(uint32_t v, std::vector<std::pair<uint32_t, int>>& out) const {
        out.clear();
        for (const uint32_t f : facesOf_[v])
            for (const uint32_t w : faces_[f])
                if (w != v) {
                    const auto known =
                        std::find_if(out.begin(), out.end(), [&](const auto& p) { return p.first == w; });
                    if (known == out.end()) out.emplace_back(w, 1);
                    else ++known->second;
                }
    }

    void push(uint32_t v, bool bothWays) {
        around(v, near_);
        for (const auto& [w, faces] : near_) {
            Quadric sum = quadric_[v];
            sum.add(quadric_[w]);
            queue_.push({sum.at(place_[w]), v, w, stamp_[v], stamp_[w]});
            if (bothWays) queue_.push({sum.at(place_[v]), w, v, stamp_[w], stamp_[v]});
        }
    }

    bool allowed(uint32_t from, uint32_t to) {
        around(from, near_);
        around(to, other_);
        int shared = 0;
        bool rim = false;
        for (const auto& [w, faces] : near_) {
            if (faces > 2) return false;
            rim |= faces == 1;
            if (w == to) shared = faces;
        }
        if (shared == 0 || (rim && shared != 1)) return false;
        // The link condition: what both know is what their common faces show.
        int common = 0;
        for (const auto& [w, faces] : near_)
            if (w != to && std::any_of(other_.begin(), other_.end(), [w = w](const auto& p) { return p.first == w; }))
                ++common;
        if (common != shared) return false;
        if (componentFaces_[componentOf_[from]] <= minComponent) return false;
        const DVec3& target = place_[to];
        for (const auto& [w, faces] : near_) {
            const DVec3 edge = place_[w] - target;
            if (w != to && glm::dot(edge, edge) > longest2_) return false;
        }
        for (const uint32_t f : facesOf_[from]) {
            if (has(f, to)) continue;
            const DVec3 before = crossOf(faces_[f]);
            Triangle moved = faces_[f];
            for (uint32_t& v : moved)
                if (v == from) v = to;
            const DVec3 after = crossOf(moved);
            const double sizes = glm::length(before) * glm::length(after);
            if (!(glm::dot(before, after) > double(turnCosine) * sizes)) return false;
            // No slivers: twice the area against the longest edge.
            double longest = 0;
            for (size_t k = 0; k < 3; ++k) {
                const DVec3 e = place_[moved[k]] - place_[moved[(k + 1) % 3]];
                longest = std::max(longest, glm::dot(e, e));
            }
            if (glm::length(after) < 0.05 * longest && glm::length(after) < glm::length(before)) return false;
        }
        return true;
    }

    void collapse(uint32_t from, uint32_t to) {
        for (const uint32_t f : facesOf_[from]) {
            if (has(f, to)) {
                alive_[f] = 0;
                --left_;
                --componentFaces_[componentOf_[from]];
                for (const uint32_t v : faces_[f])
                    if (v != from) std::erase(facesOf_[v], f);
                continue;
            }
            for (uint32_t& v : faces_[f])
                if (v == from) v = to;
            facesOf_[to].push_back(f);
        }
        facesOf_[from] = {};
        into_[from] = to;
        quadric_[to].add(quadric_[from]);
        ++stamp_[to];
        push(to, true);
    }

    uint32_t finalOf(uint32_t place) {
        while (into_[place] != place) place = into_[place] = into_[into_[place]];
        return place;
    }

    void setNormals(const std::vector<std::vector<uint32_t>>& at, const std::vector<uint32_t>& number,
                    DecimatedMesh& out) {
        std::vector<float> area(mesh_.vertexCount(), 0);
        for (size_t t = 0; t < mesh_.triangles.size(); ++t)
            for (const uint32_t v : mesh_.triangles[t]) area[v] += mesh_.triangleArea(t);
        std::vector<Vec3> sum(out.vertex.size(), Vec3(0));
        for (uint32_t v = 0; v < mesh_.vertexCount(); ++v) {
            if (!used_[v]) continue;
            uint32_t best = SurfacePlace::none;
            float likest = 0.7f;
            for (const uint32_t w : at[finalOf(weld_[v])])
                if (const float like = glm::dot(mesh_.normals[v], mesh_.normals[w]);
                    number[w] != SurfacePlace::none && like > likest)
                    likest = like, best = number[w];
            if (best != SurfacePlace::none) sum[best] += area[v] * mesh_.normals[v];
        }
        for (size_t i = 0; i < sum.size(); ++i) {
            const float length = glm::length(sum[i]);
            out.mesh.normals.push_back(length > 0 ? sum[i] / length : mesh_.normals[out.vertex[i]]);
        }
    }

    void findPlaces(DecimatedMesh& out) {
        std::vector<std::vector<uint32_t>> triangles(place_.size());  // by place, of the decimated mesh
        for (uint32_t t = 0; t < out.mesh.triangles.size(); ++t)
            for (const uint32_t v : out.mesh.triangles[t]) triangles[weld_[out.vertex[v]]].push_back(t);
        std::vector<uint32_t> home(mesh_.vertexCount());
        for (uint32_t v = 0; v < home.size(); ++v) home[v] = used_[v] ? finalOf(weld_[v]) : 0;
        out.places.resize(mesh_.vertexCount());
        parallelFor(mesh_.vertexCount(), 256, [&](size_t v) {
            if (!used_[v]) return;
            double least = std::numeric_limits<double>::infinity();
            const auto tryFaces = [&](uint32_t place) {
                for (const uint32_t t : triangles[place]) {
                    SurfacePlace found{t, Vec3(0)};
                    const double distance = nearestOn(out.mesh, t, mesh_.positions[v], found.weight);
                    if (distance < least || (distance == least && t < out.places[v].triangle))
                        least = distance, out.places[v] = found;
                }
            };
            // Where the vertex went, and one ring further.
            tryFaces(home[v]);
            for (const uint32_t t : triangles[home[v]])
                for (const uint32_t w : out.mesh.triangles[t]) tryFaces(weld_[out.vertex[w]]);
        });
    }

    /// Squared distance of p from a triangle, and where on it the nearest point lies [Ericson05, 5.1.5].
    static double nearestOn(const Mesh& mesh, uint32_t t, const Vec3& p, Vec3& weight) {
        const Triangle& f = mesh.triangles[t];
        const DVec3 a(mesh.positions[f[0]]), ab = DVec3(mesh.positions[f[1]]) - a, ac = DVec3(mesh.positions[f[2]]) - a,
                                             ap = DVec3(p) - a;
        const double d1 = glm::dot(ab, ap), d2 = glm::dot(ac, ap), bb = glm::dot(ab, ab), bc = glm::dot(ab, ac),
                     cc = glm::dot(ac, ac), det = bb * cc - bc * bc;
        double v = det > 0 ? (cc * d1 - bc * d2) / det : 0, w = det > 0 ? (bb * d2 - bc * d1) / det : 0;
        if (v < 0 || w < 0 || v + w > 1) {
            // Outside: the nearest point of the three edges.
            double least = std::numeric_limits<double>::infinity();
            const auto tryEdge = [&](double v0, double w0, double v1, double w1) {
                const DVec3 from = v0 * ab + w0 * ac, along = v1 * ab + w1 * ac - from;
                const double length2 = glm::dot(along, along),
                             s = length2 > 0 ? std::clamp(glm::dot(ap - from, along) / length2, 0.0, 1.0) : 0;
                const DVec3 off = ap - from - s * along;
                if (glm::dot(off, off) < least) {
                    least = glm::dot(off, off);
                    v = v0 + s * (v1 - v0);
                    w = w0 + s * (w1 - w0);
                }
            };
            tryEdge(0, 0, 1, 0);
            tryEdge(1, 0, 0, 1);
            tryEdge(0, 1, 0, 0);
        }
        weight = Vec3(float(1 - v - w), float(v), float(w));
        const DVec3 off = ap - v * ab - w * ac;
        return glm::dot(off, off);
    }

    const Mesh& mesh_;
    size_t wanted_, left_ = 0;
    DVec3 middle_{0};
    std::vector<uint32_t> weld_;   // place of each vertex
    std::vector<uint8_t> used_;    // by a face
    std::vector<DVec3> place_;     // about the middle
    std::vector<Triangle> faces_;  // of places
    std::vector<uint8_t> alive_;
    std::vector<std::vector<uint32_t>> facesOf_;
    std::vector<Quadric> quadric_;
    std::vector<uint32_t> stamp_, into_, componentOf_, componentFaces_;
    double longest2_ = 0;
    std::priority_queue<Collapse, std::vector<Collapse>, std::greater<>> queue_;
    std::vector<std::pair<uint32_t, int>> near_, other_;
};

}  // namespace

DecimatedMesh decimate(const Mesh& mesh, size_t triangles, Progress& progress) {
    Decimator decimator(mesh, triangles);
    decimator.run(progress);
    return decimator.result();
}

}  // namespace relamp
