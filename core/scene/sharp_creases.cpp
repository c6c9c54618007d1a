#include "scene/sharp_creases.h"

#include <optional>

#include "base/parallel.h"

namespace relamp {
namespace {

constexpr float reach = 6;             ///< edges: how far sides are looked at
constexpr size_t leastFaces = 20;      ///< within reach
constexpr size_t seedEvery = 3;        ///< of them, one is tried as a side
constexpr float turning = 0.99f;       ///< cosine between neighbours' normals: beside a crease there are more so
constexpr float sameSide = 0.985f;     ///< cosine: 10 degrees
constexpr float sameDrum = 0.6f;       ///< cosine: 53 degrees
constexpr float sameSlope = 0.17f;     ///< of cosines with the other side's normal: 10 degrees
constexpr float otherSide = 0.82f;     ///< cosine: 35 degrees
constexpr float blade = -0.9f;         ///< cosine: sides that lie back to back have no crease to slide to
constexpr float sameSheet = -0.2f;     ///< cosine: what faces away is another sheet
constexpr float leastPart = 0.18f;     ///< of the surface within reach: each side
constexpr float leastBoth = 0.7f;      ///< the same: both
constexpr float flatWithin = 0.035f;   ///< of the reach: deviation of a side from its plane (root mean square)
constexpr float slidesAtMost = 2.2f;   ///< edges
constexpr float besideCrease = 0.06f;  ///< edges

/// A face within reach.
struct Near {
    Vec3 position, normal;
    float area;
};

/// One of the sides about a vertex.
struct Side {
    Vec3 normal{0};
    float area = 0;
    float height = 0;  ///< metres: of the vertex above it
    bool flat = false;
};

/// Whether a face is of the side with this normal. What stands on a side may bend around its normal, as drums do.
bool isOf(const Near& n, const Vec3& axis, const Vec3* apartFrom) {
    const float cosine = glm::dot(n.normal, axis);
    if (!apartFrom) return cosine > sameSide;
    const float slope = glm::dot(n.normal, *apartFrom);
    if (slope > otherSide) return false;
    return cosine > sameSide || (cosine > sameDrum && std::abs(slope - glm::dot(axis, *apartFrom)) < sameSlope);
}

/// Mean normal within a side, and its area.
std::pair<Vec3, float> coneMean(const std::vector<Near>& all, const Vec3& axis, const Vec3* apartFrom) {
    Vec3 sum(0);
    float area = 0;
    for (const Near& n : all) {
        if (!isOf(n, axis, apartFrom)) continue;
        sum += n.area * n.normal;
        area += n.area;
    }
    return {sum, area};
}

/// The side that holds most of the surface, or most of what faces elsewhere than `apartFrom`.
std::optional<Side> largestSide(const std::vector<Near>& all, const Vec3& place, float reached, const Vec3* apartFrom) {
    float most = 0;
    Vec3 axis(0);
    for (size_t i = 0; i < all.size(); i += seedEvery) {
        const Near& n = all[i];
        if (apartFrom && glm::dot(n.normal, *apartFrom) > otherSide) continue;
        const auto [sum, area] = coneMean(all, n.normal, apartFrom);
        if (!(area > most)) continue;
        most = area;
        axis = sum;
    }
    if (!(glm::length(axis) > 0)) return std::nullopt;
    Side side;
    side.normal = glm::normalize(axis);
    Vec3 centre(0);
    float middle = 0;  // area of what faces as the side does, without its bend
    for (const Near& n : all) {
        if (!isOf(n, side.normal, apartFrom)) continue;
        side.area += n.area;
        // Half way between the normals: exact on spheres and cylinders.
        side.height += n.area * glm::dot(place - n.position, 0.5f * (n.normal + side.normal));
        if (glm::dot(n.normal, side.normal) < sameSide) continue;
        middle += n.area;
        centre += n.area * n.position;
    }
    if (!(middle > 0)) return std::nullopt;
    centre /= middle;
    side.height /= side.area;
    float squares = 0;
    for (const Near& n : all) {
        if (!isOf(n, side.normal, apartFrom) || glm::dot(n.normal, side.normal) < sameSide) continue;
        const float off = glm::dot(n.position - centre, side.normal);
        squares += n.area * off * off;
    }
    side.flat = squares <= middle * flatWithin * flatWithin * reached * reached;
    return side;
}

class CreaseSearch {
public:
    CreaseSearch(const Scene& scene, const std::vector<Vec3>& places, const std::vector<Vec3>& sides,
                 const std::vector<uint8_t>& leftOut)
        : scene_(scene),
          sides_(sides),
          leftOut_(leftOut),
          mesh_{places, {}, scene.mesh.triangles},
          normals_(vertexNormalsFromFaces(mesh_)),
          facesFrom_(places.size() + 1, 0) {
        for (const Triangle& t : mesh_.triangles)
            for (const uint32_t v : t) ++facesFrom_[v + 1];
        for (size_t v = 0; v < places.size(); ++v) facesFrom_[v + 1] += facesFrom_[v];
        faces_.resize(facesFrom_.back());
        std::vector<uint32_t> next(facesFrom_.begin(), facesFrom_.end() - 1);
        for (uint32_t t = 0; t < mesh_.triangles.size(); ++t)
            for (const uint32_t v : mesh_.triangles[t]) faces_[next[v]++] = t;
    }

    std::vector<CreaseVertex> found() const {
        const std::vector<uint32_t> beside = turningVertices();
        std::vector<std::optional<Place>> places(beside.size());
        parallelBlocks(beside.size(), 256, [&](size_t begin, size_t end) {
            std::vector<uint32_t> stamp(mesh_.vertexCount(), 0);
            for (size_t i = begin; i < end; ++i) places[i] = placeOf(beside[i], uint32_t(i - begin + 1), stamp);
        });
        std::vector<uint32_t> indexOf(mesh_.vertexCount(), Hit::none);
        for (size_t i = 0; i < places.size(); ++i)
            if (places[i]) indexOf[beside[i]] = uint32_t(i);
        std::vector<CreaseVertex> all;
        std::vector<Vec3> onSide;
        for (size_t i = 0; i < places.size(); ++i) {
            if (!places[i]) continue;
            const uint32_t v = beside[i];
            bool crosses = false;
            for (uint32_t e = scene_.graph.start[v]; e < scene_.graph.start[v + 1]; ++e) {
                const uint32_t k = indexOf[scene_.graph.to[e]];
                crosses |= k != Hit::none && glm::dot(places[k]->normal, places[i]->normal) < otherSide;
            }
            const bool atCrease = crosses && places[i]->slides;
            onSide.push_back(places[i]->onSide);
            all.push_back({v, atCrease ? places[i]->atCrease : places[i]->onSide, places[i]->normal,
                           atCrease ? places[i]->middle : places[i]->normal});
        }
        return withoutFolds(std::move(all), onSide);
    }

private:
    struct Place {
        Vec3 normal{0}, middle{0}, onSide{0}, atCrease{0};
        bool slides = false;  ///< the crease is near enough
    };

    /// Vertices whose normals differ from a neighbour's.
    std::vector<uint32_t> turningVertices() const {
        std::vector<uint32_t> found;
        for (uint32_t v = 0; v < normals_.size(); ++v) {
            if (!scene_.referenced[v] || leftOut_[v]) continue;
            bool turns = false;
            for (uint32_t e = scene_.graph.start[v]; e < scene_.graph.start[v + 1]; ++e)
                turns |= glm::dot(normals_[v], normals_[scene_.graph.to[e]]) < turning;
            if (turns) found.push_back(v);
        }
        return found;
    }

    /// Edges about a vertex, mean over its neighbours: one vertex's own may be slivers'.
    float spacingAbout(uint32_t v) const {
        float sum = scene_.vertexSpacing[v];
        const uint32_t begin = scene_.graph.start[v], end = scene_.graph.start[v + 1];
        for (uint32_t e = begin; e < end; ++e) sum += scene_.vertexSpacing[scene_.graph.to[e]];
        return sum / float(end - begin + 1);
    }

    std::vector<Near> nearOf(uint32_t v, float reached, uint32_t mark, std::vector<uint32_t>& stamp) const {
        const Vec3 place = mesh_.positions[v];
        std::vector<uint32_t> queue{v};
        std::vector<Near> all;
        stamp[v] = mark;
        for (size_t i = 0; i < queue.size(); ++i) {
            const uint32_t u = queue[i];
            for (uint32_t k = facesFrom_[u]; k < facesFrom_[u + 1]; ++k) addFace(faces_[k], u, v, reached, all);
            for (uint32_t e = scene_.graph.start[u]; e < scene_.graph.start[u + 1]; ++e) {
                const uint32_t w = scene_.graph.to[e];
                if (stamp[w] == mark) continue;
                stamp[w] = mark;
                if (glm::distance(mesh_.positions[w], place) < reached) queue.push_back(w);
            }
        }
        return all;
    }

    /// Each face once: by its first corner within reach.
    void addFace(uint32_t t, uint32_t by, uint32_t v, float reached, std::vector<Near>& all) const {
        const Triangle& corners = mesh_.triangles[t];
        Vec3 middle(0);
        for (const uint32_t c : corners) {
            if (leftOut_[c]) return;
            middle += mesh_.positions[c] / 3.0f;
        }
        const uint32_t first = *std::find_if(corners.begin(), corners.end(), [&](uint32_t c) {
            return c == v || glm::distance(mesh_.positions[c], mesh_.positions[v]) < reached;
        });
        const Vec3 normal = mesh_.faceNormal(t);
        if (first != by || glm::dot(normal, normals_[v]) < sameSheet) return;
        all.push_back({middle, normal, mesh_.triangleArea(t)});
    }

    std::optional<Place> placeOf(uint32_t v, uint32_t mark, std::vector<uint32_t>& stamp) const {
        const float spacing = spacingAbout(v), reached = reach * spacing;
        const Vec3 place = mesh_.positions[v];
        const std::vector<Near> all = nearOf(v, reached, mark, stamp);
        if (all.size() < leastFaces) return std::nullopt;
        float whole = 0;
        for (const Near& n : all) whole += n.area;
        const std::optional<Side> a = largestSide(all, place, reached, nullptr);
        if (!a || !a->flat || a->area < leastPart * whole) return std::nullopt;
        const std::optional<Side> b = largestSide(all, place, reached, &a->normal);
        if (!b || !b->flat || b->area < leastPart * whole || a->area + b->area < leastBoth * whole) return std::nullopt;
        const Vec3 known = sides_.empty() ? Vec3(0) : sides_[v];
        const bool first = known == Vec3(0) ? std::abs(a->height) < std::abs(b->height)
                                            : glm::dot(a->normal, known) > glm::dot(b->normal, known);
        const Side &own = first ? *a : *b, &other = first ? *b : *a;
        const float cosine = glm::dot(own.normal, other.normal);
        if (cosine < blade) return std::nullopt;
        Place result;
        result.normal = own.normal;
        result.middle = glm::normalize(own.normal + other.normal);
        result.onSide = place - own.height * own.normal;
        // Along the own side, towards or away from the other one.
        const Vec3 along = other.normal - cosine * own.normal;
        const float sine = glm::length(along), slide = -(other.height - own.height * cosine) / sine;
        result.slides = std::abs(slide) < slidesAtMost * spacing;
        result.atCrease = result.onSide + (slide - std::copysign(besideCrease * spacing, slide)) / sine * along;
        return result;
    }

    /// Vertices that would turn a triangle over do not slide (`onSide`: where they are then), or stay where they are.
    std::vector<CreaseVertex> withoutFolds(std::vector<CreaseVertex> all, const std::vector<Vec3>& onSide) const {
        std::vector<uint8_t> folds(mesh_.vertexCount());
        for (int round = 0;; ++round) {
            Mesh moved = mesh_;
            for (const CreaseVertex& c : all) moved.positions[c.vertex] = c.position;
            std::fill(folds.begin(), folds.end(), uint8_t(0));
            bool any = false;
            for (size_t t = 0; t < moved.triangles.size(); ++t) {
                const Triangle& corners = moved.triangles[t];
                const bool touched = std::any_of(corners.begin(), corners.end(),
                                                 [&](uint32_t v) { return moved.positions[v] != mesh_.positions[v]; });
                const bool sliver = moved.triangleArea(t) < 0.1f * mesh_.triangleArea(t);  // along a crease
                if (!touched || sliver || glm::dot(moved.faceNormal(t), mesh_.faceNormal(t)) > 0) continue;
                for (const uint32_t v : corners) folds[v] = any = true;
            }
            if (!any) return all;
            for (size_t i = 0; i < all.size(); ++i)
                if (folds[all[i].vertex]) all[i].position = round == 0 ? onSide[i] : mesh_.positions[all[i].vertex];
        }
    }

    const Scene& scene_;
    const std::vector<Vec3>& sides_;
    const std::vector<uint8_t>& leftOut_;
    const Mesh mesh_;
    const std::vector<Vec3> normals_;
    std::vector<uint32_t> facesFrom_, faces_;  ///< of each vertex, in compressed rows
};

}  // namespace

std::vector<CreaseVertex> sharpCreases(const Scene& scene, const std::vector<Vec3>& places,
                                       const std::vector<Vec3>& sides, const std::vector<uint8_t>& leftOut) {
    return CreaseSearch(scene, places, sides, leftOut).found();
}

}  // namespace relamp
