#include "solve/ratio/pairs.h"

#include <functional>
#include <unordered_map>

#include "base/parallel.h"
#include "base/random.h"
#include "image/direction_grid.h"
#include "solve/ratio/joined_materials.h"

namespace relamp {
namespace {

constexpr uint32_t noPlace = ~0u;

/// Partners across a corner, through a grid of buckets as wide as a few edges of the mesh.
class CornerPartners {
public:
    /// `place[v]`: the observation of a vertex that may have partners, else noPlace.
    CornerPartners(const Scene& scene, const MatteObservations& matte, const std::vector<uint32_t>& place,
                   const PairOptions& options)
        : scene_(scene),
          matte_(matte),
          cornerCosine_(options.cornerCosine),
          flatCosine_(options.flatCosine),
          corner_(std::acos(options.cornerCosine) - 1e-3f),
          joined_(joinedMaterials(scene)) {
        double spacing = 0;
        for (uint32_t v : matte.vertices) spacing += scene.vertexSpacing[v];
        reach_ = matte.vertices.empty() ? 0 : float(8 * spacing / double(matte.vertices.size()));
        if (!(reach_ > 0)) return;
        for (uint32_t i = 0; i < matte.vertices.size(); ++i) {
            if (place[matte.vertices[i]] == noPlace || !flat(matte.vertices[i])) continue;
            Bucket& bucket = buckets_[keyOf(scene.mesh.positions[matte.vertices[i]], 0, 0, 0)];
            bucket.observations.push_back(i);
            bucket.axis += scene.mesh.normals[matte.vertices[i]];
        }
        for (auto& [key, bucket] : buckets_) {
            const float length = glm::length(bucket.axis);
            bucket.axis = length > 0 ? bucket.axis / length : Vec3(0, 0, 1);
            for (const uint32_t i : bucket.observations)
                bucket.spread = std::max(bucket.spread, angle(bucket.axis, scene.mesh.normals[matte.vertices[i]]));
        }
    }

    bool any() const { return reach_ > 0; }

    /// The two nearest. Regular meshes hold many that are equally near, and rounding must not choose among them.
    void nearest(uint32_t i, float weight, std::vector<AlbedoPair>& out) const {
        if (!flat(matte_.vertices[i])) return;
        thread_local std::vector<std::pair<float, uint32_t>> near;  // squared distance and observation
        near.clear();
        collect(matte_.vertices[i], near);
        constexpr size_t few = 16;
        const auto sorted = near.begin() + ptrdiff_t(std::min(few, near.size()));
        std::partial_sort(near.begin(), sorted, near.end());
        if (sorted != near.end() && !(near[few - 1].first > near[1].first * (1 + 1e-4f)))
            std::sort(near.begin(), near.end());
        for (size_t kept = 0; kept < 2 && kept < near.size(); ++kept) {
            size_t last = kept + 1;
            while (last < near.size() && near[last].first <= near[kept].first * (1 + 1e-4f)) ++last;
            const auto chosen = std::min_element(
                near.begin() + ptrdiff_t(kept), near.begin() + ptrdiff_t(last), [&](const auto& a, const auto& b) {
                    return scene_.rank[matte_.vertices[a.second]] < scene_.rank[matte_.vertices[b.second]];
                });
            std::iter_swap(near.begin() + ptrdiff_t(kept), chosen);
            out.push_back({i, near[kept].second, weight});
        }
    }

private:
    /// Most buckets are smooth: those whose normals all lie near the asking one hold no corner.
    struct Bucket {
        std::vector<uint32_t> observations;
        Vec3 axis{0};
        float spread = 0;  ///< largest angle to the axis
    };

    /// Whether the surface around a vertex faces one way. Reconstruction rounds creases: in the round its normals are
    /// none of the photographed surface's.
    bool flat(uint32_t v) const {
        for (uint32_t e = scene_.graph.start[v]; e < scene_.graph.start[v + 1]; ++e)
            if (glm::dot(scene_.mesh.normals[scene_.graph.to[e]], scene_.mesh.normals[v]) < flatCosine_) return false;
        return true;
    }
    static float angle(const Vec3& a, const Vec3& b) { return std::acos(std::clamp(glm::dot(a, b), -1.0f, 1.0f)); }
    uint64_t keyOf(const Vec3& p, int dx, int dy, int dz) const {
        const auto cell = [&](float x) { return int64_t(std::floor(x / reach_)); };
        return mixBits(mixBits(mixBits(uint64_t(cell(p.x) + dx)) ^ uint64_t(cell(p.y) + dy)) ^
                       uint64_t(cell(p.z) + dz));
    }
    void collect(uint32_t v, std::vector<std::pair<float, uint32_t>>& near) const {
        const Vec3 p = scene_.mesh.positions[v], normal = scene_.mesh.normals[v];
        for (int k = 0; k < 27; ++k) {
            const auto at = buckets_.find(keyOf(p, k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1));
            if (at == buckets_.end() || angle(normal, at->second.axis) + at->second.spread < corner_) continue;
            for (uint32_t j : at->second.observations) {
                const uint32_t u = matte_.vertices[j];
                if (joined_[scene_.material[u]] != joined_[scene_.material[v]] ||
                    glm::dot(scene_.mesh.normals[u], normal) > cornerCosine_)
                    continue;
                const Vec3 d = scene_.mesh.positions[u] - p;
                if (const float d2 = glm::dot(d, d); d2 < reach_ * reach_) near.emplace_back(d2, j);
            }
        }
    }

    const Scene& scene_;
    const MatteObservations& matte_;
    float cornerCosine_, flatCosine_, corner_, reach_ = 0;
    std::vector<uint32_t> joined_;  ///< per material
    std::unordered_map<uint64_t, Bucket> buckets_;
};

}  // namespace

std::vector<AlbedoPair> albedoPairs(const Scene& scene, const MatteObservations& matte, const PairOptions& options) {
    std::vector<uint32_t> place(scene.mesh.vertexCount(), noPlace);
    for (uint32_t i = 0; i < matte.vertices.size(); ++i)
        if (matte.componentGlossy[scene.material[matte.vertices[i]]] < 2) place[matte.vertices[i]] = i;
    const VertexGraph& graph = scene.graph;
    std::vector<AlbedoPair> pairs;
    // What belongs to a block of observations, one block behind the other.
    using PairsOf = std::function<void(uint32_t, std::vector<AlbedoPair>&)>;
    const auto append = [&](const PairsOf& of) {
        constexpr size_t block = 512;
        std::vector<std::vector<AlbedoPair>> parts((matte.vertices.size() + block - 1) / block);
        parallelBlocks(matte.vertices.size(), block, [&](size_t begin, size_t end) {
            for (size_t i = begin; i < end; ++i)
                if (place[matte.vertices[i]] != noPlace) of(uint32_t(i), parts[begin / block]);
        });
        for (const std::vector<AlbedoPair>& part : parts) pairs.insert(pairs.end(), part.begin(), part.end());
    };
    // Walks choose among neighbours in an order that does not know the file's.
    std::vector<uint32_t> ways = graph.to;
    parallelFor(scene.mesh.vertexCount(), 1024, [&](size_t v) {
        std::sort(ways.begin() + graph.start[v], ways.begin() + graph.start[v + 1],
                  [&](uint32_t a, uint32_t b) { return scene.rank[a] < scene.rank[b]; });
    });
    append([&](uint32_t i, std::vector<AlbedoPair>& out) {
        const uint32_t v = matte.vertices[i];
        for (uint32_t e = graph.start[v]; e < graph.start[v + 1]; ++e) {
            const uint32_t j = place[graph.to[e]];
            if (j != noPlace && i < j) out.push_back({i, j, options.edgeWeight, true});
        }
        uint64_t bits = mixBits(options.seed * 0x1000003 + scene.rank[v]);
        uint32_t at = v;
        int step = 0;
        for (const int length : {4, 12, 36}) {
            for (; step < length; ++step) {
                const uint32_t degree = graph.start[at + 1] - graph.start[at];
                if (!degree) break;
                bits = mixBits(bits);
                at = ways[graph.start[at] + bits % degree];
            }
            if (at != v && place[at] != noPlace) out.push_back({i, place[at], length == 36 ? 0.5f : 0.7f});
        }
    });
    // Long pairs: anywhere on the component, where the surface faces alike.
    std::vector<std::vector<uint32_t>> ofComponent(scene.materials);
    for (uint32_t i = 0; i < matte.vertices.size(); ++i)
        if (place[matte.vertices[i]] != noPlace) ofComponent[scene.material[matte.vertices[i]]].push_back(i);
    for (std::vector<uint32_t>& list : ofComponent)
        std::sort(list.begin(), list.end(), [&](uint32_t a, uint32_t b) {
            return scene.rank[matte.vertices[a]] < scene.rank[matte.vertices[b]];
        });
    append([&](uint32_t i, std::vector<AlbedoPair>& out) {
        constexpr int tries = 12;
        const uint32_t v = matte.vertices[i];
        const std::vector<uint32_t>& list = ofComponent[scene.material[v]];
        uint64_t bits = mixBits(options.seed * 0x2000003 + scene.rank[v]);
        for (int k = 0, kept = 0; k < tries && kept < options.longPairs; ++k) {
            bits = mixBits(bits);
            const uint32_t j = list[bits % list.size()];
            if (j == i || glm::dot(scene.mesh.normals[matte.vertices[j]], scene.mesh.normals[v]) < options.longCosine)
                continue;
            out.push_back({i, j, options.longWeight});
            ++kept;
        }
    });
    // Walks leave a material where a scan joins two.
    std::erase_if(pairs, [&](const AlbedoPair& p) {
        return scene.material[matte.vertices[p.a]] != scene.material[matte.vertices[p.b]];
    });
    const CornerPartners corners(scene, matte, place, options);
    if (corners.any())
        append([&](uint32_t i, std::vector<AlbedoPair>& out) { corners.nearest(i, options.cornerWeight, out); });
    return pairs;
}

namespace {

/// One vertex in two lighting states has one albedo.
void addPairsOfStates(const MatteObservations& matte, const PairOptions& options, size_t vertices,
                      const std::vector<uint32_t>& component, std::vector<AlbedoPair>& pairs) {
    std::vector<std::vector<uint32_t>> observed(matte.states(), std::vector<uint32_t>(vertices, noPlace));
    for (size_t s = 0; s < matte.states(); ++s)
        for (size_t i = matte.beginOf(s); i < matte.endOf(s); ++i) observed[s][matte.vertices[i]] = uint32_t(i);
    std::vector<uint32_t> here;
    for (uint32_t v = 0; v < vertices; ++v) {
        here.clear();
        for (const std::vector<uint32_t>& state : observed)
            if (state[v] != noPlace && matte.componentGlossy[component[v]] < 2) here.push_back(state[v]);
        for (size_t a = 0; a < here.size(); ++a)
            for (size_t b = a + 1; b < here.size(); ++b)
                pairs.push_back({here[a], here[b], 2 * options.sameWeight / float(here.size()), false, true});
    }
}

/// Pairs of each lighting state, and those between them.
std::vector<AlbedoPair> pairsOfStates(const Scene& scene, const MatteObservations& matte, const PairOptions& options) {
    if (matte.states() == 1) return albedoPairs(scene, matte, options);
    std::vector<AlbedoPair> pairs;
    for (size_t s = 0; s < matte.states(); ++s)
        for (AlbedoPair& p : albedoPairs(scene, matte.inState(s), options)) {
            p.a += uint32_t(matte.beginOf(s));
            p.b += uint32_t(matte.beginOf(s));
            pairs.push_back(p);
        }
    addPairsOfStates(matte, options, scene.mesh.vertexCount(), scene.material, pairs);
    return pairs;
}

}  // namespace

void weighOrientations(const Scene& scene, const MatteObservations& matte, std::vector<AlbedoPair>& pairs) {
    // Counted by cells, each with the mean of its normals and with soft cones: it does not matter which of two cells
    // gets a normal between them.
    constexpr float rim = 0.88f;  // cosine at which a cone ends, 28 degrees; half at 20
    const DirectionGrid grid{16, scene.axes};
    std::vector<Vec3> mean(size_t(grid.cells()), Vec3(0));
    std::vector<float> count(mean.size(), 0);
    for (const uint32_t v : matte.vertices) {
        const auto cell = size_t(grid.cellOf(scene.mesh.normals[v]));
        mean[cell] += scene.mesh.normals[v];
        count[cell] += 1;
    }
    for (Vec3& m : mean) m = glm::dot(m, m) > 0 ? glm::normalize(m) : Vec3(0);
    std::vector<double> facing(matte.vertices.size(), 0);
    parallelFor(facing.size(), 1024, [&](size_t i) {
        const Vec3& normal = scene.mesh.normals[matte.vertices[i]];
        for (size_t c = 0; c < mean.size(); ++c)
            facing[i] += double(count[c] * std::max(0.0f, (glm::dot(normal, mean[c]) - rim) / (1 - rim)));
        facing[i] = std::max(facing[i], 1.0);
    });
    double before = 0, after = 0;
    const auto factor = [&](const AlbedoPair& p) { return std::pow(facing[p.a] * facing[p.b], -0.25); };
    for (const AlbedoPair& p : pairs) {
        if (p.same) continue;
        before += double(p.weight);
        after += double(p.weight) * factor(p);
    }
    if (!(after > 0)) return;
    for (AlbedoPair& p : pairs)
        if (!p.same) p.weight *= float(before / after * factor(p));
}

RatioObservations ratioObservations(const Scene& scene, const RadianceSamples& samples, std::vector<uint8_t> skip,
                                    uint64_t seed, bool noMetals) {
    RatioObservations result;
    result.matte = matteObservations(scene, samples, skip);
    if (noMetals && std::count(result.matte.componentGlossy.begin(), result.matte.componentGlossy.end(), 2)) {
        std::vector<uint8_t> glossy = result.matte.componentGlossy, matte = glossy;
        std::replace(matte.begin(), matte.end(), uint8_t(2), uint8_t(0));
        std::replace(glossy.begin(), glossy.end(), uint8_t(2), uint8_t(1));
        result.matte = matteObservations(scene, samples, skip, &matte);
        result.matte.componentGlossy = std::move(glossy);
    }
    result.noMetals = noMetals;
    PairOptions options;
    options.seed = seed;
    // Distant light alone changes with the way a surface faces, not with its place.
    if (std::none_of(skip.begin(), skip.end(), [](uint8_t s) { return s != 0; })) options.longPairs = 0;
    result.pairs = pairsOfStates(scene, result.matte, options);
    weighOrientations(scene, result.matte, result.pairs);
    result.skip = std::move(skip);
    result.seed = seed;
    return result;
}

}  // namespace relamp
