#include "scene/straight_rim.h"

#include <algorithm>
#include <unordered_map>

#include "base/random.h"
#include "base/statistics.h"
#include "scene/flat_surface.h"
#include "scene/rim.h"
#include "scene/vertex_rings.h"

namespace relamp {
namespace {

constexpr size_t mostRims = 12;
constexpr float rimTolerance = 0.012f;  ///< of the diagonal
constexpr double bent = 0.3;            ///< cosine between normals of triangles at a rim and of the plane
constexpr uint64_t lineTrials = 3000;
constexpr double lineTolerance = 1.5;  ///< of the spacing
constexpr double turned = 0.5;         ///< cosine between a piece of the rim and the line
constexpr double longEnough = 0.2;     ///< of the surface's extent
constexpr double leastSpacings = 15;
constexpr double leastCovered = 0.3;  ///< of the line by the rim
constexpr int bentRings = 5;          ///< of a rim that is bent, without going on
constexpr double creasedPart = 0.1;   ///< of the line: the surface goes on beyond it
constexpr double lostEnd = 0.35;      ///< of a line, that corners make up for
constexpr double hole = 8;            ///< spacings between pieces of a rim that are short

/// A piece of rim in its plane.
struct Piece {
    glm::dvec2 a{0}, b{0};
    glm::dvec2 out{0};
    bool ends = false;  ///< hardly anything goes on beyond it
    bool used = false;
    glm::dvec2 middle() const { return 0.5 * (a + b); }
};

struct Line {
    glm::dvec2 point{0}, along{0};
    double first = 0, last = 0;
    double covered = 0, creased = 0;  ///< length of the rim, and of the creases, along it
    glm::dvec2 out() const { return {along.y, -along.x}; }
    double off(const glm::dvec2& p) const { return glm::dot(p - point, out()); }
    double at(const glm::dvec2& p) const { return glm::dot(p - point, along); }
};

/// The face on the left of each directed edge.
using FaceOfEdge = std::unordered_map<uint64_t, uint32_t>;

uint64_t edgeKey(uint32_t a, uint32_t b) { return uint64_t(a) << 32 | b; }

FaceOfEdge facesOfEdges(const Mesh& mesh) {
    FaceOfEdge faces;
    faces.reserve(4 * mesh.triangles.size());
    for (uint32_t i = 0; i < mesh.triangles.size(); ++i)
        for (size_t k = 0; k < 3; ++k) faces[edgeKey(mesh.triangles[i][k], mesh.triangles[i][(k + 1) % 3])] = i;
    return faces;
}

/// Where a flat surface ends: at the mesh's rim, or at a face that falls away.
std::vector<Piece> endsOf(const Scene& scene, const FaceOfEdge& faces, const FlatSurface& plane, const DVec3& x,
                          const DVec3& y) {
    const Mesh& mesh = scene.mesh;
    const auto off = [&](uint32_t v) { return glm::dot(DVec3(mesh.positions[v]) - plane.point, plane.up); };
    std::vector<uint8_t> onIt(mesh.vertexCount());
    for (uint32_t v = 0; v < onIt.size(); ++v) onIt[v] = liesOn(scene, plane, v);
    const auto isFlat = [&](uint32_t t) {
        const Triangle& corners = mesh.triangles[t];
        return onIt[corners[0]] && onIt[corners[1]] && onIt[corners[2]];
    };
    std::vector<uint32_t> aboutRim;
    const std::vector<uint8_t> rim = rimVertices(mesh);
    for (uint32_t v = 0; v < rim.size(); ++v)
        if (rim[v]) aboutRim.push_back(v);
    const std::vector<int> rings = ringsAbout(scene.graph, bentRings, aboutRim);
    std::vector<Piece> pieces;
    for (uint32_t t = 0; t < mesh.triangles.size(); ++t)
        for (size_t k = 0; k < 3; ++k) {
            const uint32_t a = mesh.triangles[t][k], b = mesh.triangles[t][(k + 1) % 3];
            const auto other = faces.find(edgeKey(b, a));
            if (other == faces.end()) {
                if (!rim[a] || !rim[b]) continue;  // a seam
                if (std::max(std::abs(off(a)), std::abs(off(b))) > heightBesideRim(scene)) continue;
                if (glm::dot(DVec3(mesh.faceNormal(t)), plane.up) < bent) continue;
            } else {
                if (!isFlat(t) || isFlat(other->second)) continue;
                const Triangle& next = mesh.triangles[other->second];
                if (off(next[0]) + off(next[1]) + off(next[2]) >
                    2 * std::min(off(a), off(b)) + std::max(off(a), off(b)))
                    continue;
            }
            const auto inPlane = [&](uint32_t v) {
                const DVec3 p = DVec3(mesh.positions[v]) - plane.point;
                return glm::dvec2(glm::dot(p, x), glm::dot(p, y));
            };
            const glm::dvec2 pa = inPlane(a), pb = inPlane(b);
            const double length = glm::length(pb - pa);
            if (length > 0)
                pieces.push_back({pa, pb, glm::dvec2((pb - pa).y, -(pb - pa).x) / length, rings[a] >= 0, false});
        }
    return pieces;
}

/// Lines along the rim of one flat surface.
class RimLines {
public:
    RimLines(std::vector<Piece> pieces, double spacing, double least)
        : pieces_(std::move(pieces)), spacing_(spacing), least_(least) {}

    std::optional<Line> next() {
        std::vector<size_t> free;
        for (size_t i = 0; i < pieces_.size(); ++i)
            if (!pieces_[i].used) free.push_back(i);
        if (double(free.size()) < leastSpacings) return {};
        Line best;
        for (uint64_t trial = 0; trial < lineTrials; ++trial) {
            const auto draw = [&](uint64_t k) {
                return free[size_t(unitFloat(mixBits(mixBits(trial) ^ k)) * float(free.size()))];
            };
            const Piece &a = pieces_[draw(1)], &b = pieces_[draw(2)];
            const glm::dvec2 across = b.middle() - a.middle();
            const double length = glm::length(across);
            if (length < 4 * spacing_) continue;
            Line line{a.middle(), across / length, 0, 0, 0, 0};
            if (glm::dot(line.out(), a.out) < 0) line.along = -line.along;
            if (glm::dot(line.out(), a.out) < turned || glm::dot(line.out(), b.out) < turned) continue;
            for (const size_t i : free)
                if (on(line, pieces_[i])) line.covered += std::abs(glm::dot(pieces_[i].b - pieces_[i].a, line.along));
            if (line.covered > best.covered) best = line;
        }
        if (best.covered < least_) return {};
        for (int refinement = 0; refinement < 4; ++refinement) best = refined(best);
        spanOf(best);
        for (Piece& p : pieces_)
            p.used |= std::abs(best.off(p.middle())) < 3 * lineTolerance * spacing_ &&
                      best.at(p.middle()) > best.first - 2 * spacing_ && best.at(p.middle()) < best.last + 2 * spacing_;
        return best;
    }

private:
    bool on(const Line& line, const Piece& p) const {
        return !p.used && std::abs(line.off(p.middle())) < lineTolerance * spacing_ &&
               glm::dot(line.out(), p.out) > bent;
    }

    /// The least squares line of the pieces on it.
    Line refined(const Line& line) const {
        double weight = 0, at = 0, off = 0, atAt = 0, atOff = 0;
        for (const Piece& p : pieces_) {
            if (!on(line, p)) continue;
            const double w = glm::length(p.b - p.a), x = line.at(p.middle()), y = line.off(p.middle());
            weight += w;
            at += w * x;
            off += w * y;
            atAt += w * x * x;
            atOff += w * x * y;
        }
        const double spread = atAt - at * at / weight;
        if (!(weight > 0) || !(spread > 0)) return line;
        const double slope = (atOff - at * off / weight) / spread;
        Line better = line;
        better.point = line.point + at / weight * line.along + off / weight * line.out();
        better.along = glm::normalize(line.along + slope * line.out());
        return better;
    }

    /// Ends, without short pieces far from the rest.
    void spanOf(Line& line) const {
        std::vector<std::pair<double, double>> spans;
        for (const Piece& p : pieces_)
            if (on(line, p)) spans.push_back(std::minmax(line.at(p.a), line.at(p.b)));
        std::sort(spans.begin(), spans.end());
        std::vector<std::pair<double, double>> runs;
        for (const auto& span : spans)
            if (!runs.empty() && span.first < runs.back().second + hole * spacing_)
                runs.back().second = std::max(runs.back().second, span.second);
            else runs.push_back(span);
        const auto isShort = [&](const auto& run) { return run.second - run.first < hole * spacing_; };
        while (runs.size() > 1 && isShort(runs.back())) runs.pop_back();
        while (runs.size() > 1 && isShort(runs.front())) runs.erase(runs.begin());
        line.covered = 0;
        line.creased = 0;
        if (runs.empty()) return;
        line.first = runs.front().first;
        line.last = runs.back().second;
        for (const auto& run : runs) line.covered += run.second - run.first;
        for (const Piece& p : pieces_)
            if (on(line, p) && !p.ends) line.creased += glm::length(p.b - p.a);
    }

    std::vector<Piece> pieces_;
    double spacing_, least_;
};

/// Where two lines of one surface meet; none where they are nearly parallel.
std::optional<DVec3> cornerOf(const StraightRim& a, const StraightRim& b) {
    const double slant = glm::dot(a.along(), b.out());
    if (a.surface != b.surface || std::abs(slant) < 0.3) return {};
    return a.from - b.beyond(a.from) / slant * a.along();
}

}  // namespace

double heightBesideRim(const Scene& scene) { return double(rimTolerance * scene.diagonal); }

std::vector<StraightRim> straightRims(const Scene& scene, const std::vector<uint8_t>& leftOut) {
    const FaceOfEdge faces = facesOfEdges(scene.mesh);
    std::vector<StraightRim> result;
    const std::vector<FlatSurface> surfaces = flatSurfaces(scene, leftOut);
    for (uint32_t s = 0; s < surfaces.size(); ++s) {
        const FlatSurface& plane = surfaces[s];
        const DVec3 x = glm::normalize(
                        glm::cross(plane.up, std::abs(plane.up.x) < 0.7 ? DVec3(1, 0, 0) : DVec3(0, 1, 0))),
                    y = glm::cross(plane.up, x);
        std::vector<Piece> pieces = endsOf(scene, faces, plane, x, y);
        std::vector<double> lengths;
        for (const Piece& p : pieces) lengths.push_back(glm::length(p.b - p.a));
        if (pieces.empty()) continue;
        const double spacing = medianOf(std::move(lengths));
        RimLines lines(std::move(pieces), spacing,
                       std::max(leastSpacings * spacing, longEnough * leastCovered * std::sqrt(plane.area)));
        for (size_t k = 0; k < mostRims; ++k) {
            const std::optional<Line> line = lines.next();
            if (!line) break;
            const double length = line->last - line->first;
            if (length < longEnough * std::sqrt(plane.area) || line->covered < leastCovered * length) continue;
            const auto world = [&](double at) {
                const glm::dvec2 p = line->point + at * line->along;
                return plane.point + p.x * x + p.y * y;
            };
            result.push_back({world(line->first), world(line->last), plane.up, spacing, s,
                              line->creased > creasedPart * length, false, false});
        }
    }
    return result;
}

void joinCorners(std::vector<StraightRim>& rims, double reach) {
    const std::vector<StraightRim> was = rims;
    for (size_t i = 0; i < was.size(); ++i)
        for (size_t k = 0; k < was.size(); ++k) {
            if (i == k) continue;
            const std::optional<DVec3> corner = cornerOf(was[i], was[k]);
            if (!corner) continue;
            // One of them has lost its end, in the dark or where the mesh goes on.
            const double first = glm::length(*corner - was[i].to), second = glm::length(*corner - was[k].from);
            if (std::min(first, second) > reach || first > std::max(reach, lostEnd * was[i].length()) ||
                second > std::max(reach, lostEnd * was[k].length()))
                continue;
            rims[i].to = rims[k].from = *corner;
            rims[i].cornerTo = rims[k].cornerFrom = true;
        }
}

}  // namespace relamp
