#include "transport/near_field.h"

#include "base/parallel.h"
#include "base/random.h"
#include "clusters/emitter_order.h"
#include "wavelet/haar.h"

namespace relamp {

EmitterSurface emitterSurface(const Mesh& mesh, const EmitterCluster& cluster, const Mat4& toWorld) {
    EmitterSurface s;
    s.twoSided = cluster.twoSided;
    s.pattern = cluster.pattern;
    if (s.pattern) s.toCaptured = glm::inverse(toWorld);
    s.lobe = cluster.lobe;
    if (!s.lobe.even()) s.lobe.axis = glm::normalize(Mat3(toWorld) * s.lobe.axis);
    const auto moved = [&](uint32_t v) { return Vec3(toWorld * Vec4(mesh.positions[v], 1)); };
    const bool mirrored = glm::determinant(Mat3(toWorld)) < 0;
    float sum = 0;
    DVec3 centre(0);
    for (uint32_t t : cluster.triangles) {
        std::array<Vec3, 3> c{moved(mesh.triangles[t][0]), moved(mesh.triangles[t][1]), moved(mesh.triangles[t][2])};
        if (mirrored) std::swap(c[1], c[2]);
        const Vec3 cross = glm::cross(c[1] - c[0], c[2] - c[0]);
        const float twice = glm::length(cross);
        if (!(twice > 0)) continue;
        const Vec3 middle = (c[0] + c[1] + c[2]) / 3.0f;
        float radius = 0;
        for (const Vec3& p : c) radius = std::max(radius, glm::length(p - middle));
        s.corners.push_back(c);
        s.centres.push_back(middle);
        s.normals.push_back(cross / twice);
        s.areas.push_back(twice / 2);
        s.radii.push_back(radius);
        sum += twice / 2;
        s.cumulativeArea.push_back(sum);
        centre += double(twice / 2) * DVec3(middle);
    }
    if (sum > 0) s.centroid = Vec3(centre / double(sum));
    for (size_t t = 0; t < s.centres.size(); ++t)
        s.radius = std::max(s.radius, glm::length(s.centres[t] - s.centroid) + s.radii[t]);
    return s;
}

EmitterSurface orderedEmitterSurface(const Scene& scene, const EmitterCluster& cluster) {
    EmitterCluster ordered;
    ordered.twoSided = cluster.twoSided;
    ordered.pattern = cluster.pattern;
    ordered.lobe = cluster.lobe;
    ordered.triangles = alongEmitter(scene.mesh, cluster.triangles, scene.axes);
    return emitterSurface(scene.mesh, ordered);
}

float triangleFormFactor(const Vec3& point, const Vec3& normal, const std::array<Vec3, 3>& corners, bool twoSided) {
    const Vec3 faceNormal = glm::cross(corners[1] - corners[0], corners[2] - corners[0]);
    if (!twoSided && glm::dot(faceNormal, point - corners[0]) <= 0) return 0;
    // Clip at the horizon: at most four corners remain.
    Vec3 kept[4];
    int count = 0;
    for (int i = 0; i < 3; ++i) {
        const Vec3 a = corners[size_t(i)] - point, b = corners[size_t((i + 1) % 3)] - point;
        const float ha = glm::dot(a, normal), hb = glm::dot(b, normal);
        if (ha >= 0) kept[count++] = a;
        if ((ha > 0 && hb < 0) || (ha < 0 && hb > 0)) kept[count++] = a + (b - a) * (ha / (ha - hb));
    }
    if (count < 3) return 0;
    for (int i = 0; i < count; ++i) {
        const float length = glm::length(kept[i]);
        if (!(length > 1e-20f))
            return 0;  // the point is a corner of the emitter: no solid angle is defined, none is taken
        kept[i] /= length;
    }
    float sum = 0;
    for (int i = 0; i < count; ++i) {
        const Vec3 a = kept[i], b = kept[(i + 1) % count];
        const Vec3 cross = glm::cross(a, b);
        const float sine = glm::length(cross);
        if (sine < 1e-12f) continue;
        sum += std::atan2(sine, glm::dot(a, b)) / sine * glm::dot(cross, normal);
    }
    return std::clamp(std::abs(sum) / (2 * pi), 0.0f, 1.0f);
}

namespace {

constexpr int mostSamples = 256;

/// What an emitter shows to a point: triangles, near ones cut up so that the form factor is spread evenly over each
/// component.
struct Pieces {
    std::vector<std::array<Vec3, 3>> corners;
    std::vector<float> factors;
    float add(const Vec3& point, const Vec3& normal, const std::array<Vec3, 3>& c, const Vec3& centre, float radius,
              bool twoSided, int depth) {
        const Vec3 to = centre - point;
        const float d2 = glm::dot(to, to);
        if (depth < 6 && d2 < 16 * radius * radius) {
            const Vec3 m[3] = {(c[0] + c[1]) / 2.0f, (c[1] + c[2]) / 2.0f, (c[2] + c[0]) / 2.0f};
            float sum = 0;
            for (const auto& part : {std::array{c[0], m[0], m[2]}, std::array{m[0], c[1], m[1]},
                                     std::array{m[2], m[1], c[2]}, std::array{m[0], m[1], m[2]}})
                sum += add(point, normal, part, (part[0] + part[1] + part[2]) / 3.0f, radius / 2, twoSided, depth + 1);
            return sum;
        }
        const float f = triangleFormFactor(point, normal, c, twoSided);
        if (f > 0) {
            corners.push_back(c);
            factors.push_back(f);
        }
        return f;
    }
};

/// Form factors to every triangle of the emitter that shines at the point: exact near, by its centre where it is small
/// and far (within 0.3 %).
float formFactors(const EmitterSurface& emitter, const Vec3& point, const Vec3& normal, Pieces& out) {
    out.corners.clear();
    out.factors.clear();
    float sum = 0;
    for (size_t t = 0; t < emitter.centres.size(); ++t) {
        const Vec3 to = emitter.centres[t] - point;
        const float d2 = glm::dot(to, to), r = emitter.radii[t];
        const float height = glm::dot(to, normal), facing = -glm::dot(to, emitter.normals[t]);
        if (height < -r || (!emitter.twoSided && facing <= 0)) continue;
        if (d2 > 200 * r * r && height > r) {
            const float f = height * std::abs(facing) * emitter.areas[t] / (pi * d2 * d2);
            out.corners.push_back(emitter.corners[t]);
            out.factors.push_back(f);
            sum += f;
        } else {
            sum += out.add(point, normal, emitter.corners[t], emitter.centres[t], r, emitter.twoSided, 0);
        }
    }
    return sum;
}

/// Components that turn their front to the point come first, in the order they had; so many.
size_t frontsFirst(Pieces& pieces, const Vec3& point) {
    Pieces fronts, backs;
    for (size_t t = 0; t < pieces.corners.size(); ++t) {
        const auto& c = pieces.corners[t];
        const bool front = glm::dot(glm::cross(c[1] - c[0], c[2] - c[0]), point - c[0]) > 0;
        (front ? fronts : backs).corners.push_back(c);
        (front ? fronts : backs).factors.push_back(pieces.factors[t]);
    }
    const size_t count = fronts.corners.size();
    pieces.corners.clear();
    pieces.factors.clear();
    for (const Pieces* part : {&fronts, &backs}) {
        pieces.corners.insert(pieces.corners.end(), part->corners.begin(), part->corners.end());
        pieces.factors.insert(pieces.factors.end(), part->factors.begin(), part->factors.end());
    }
    return count;
}

/// Scales the form factors so that they add up to `total`.
void addUpTo(float total, std::span<EmitterSample> samples) {
    float sum = 0;
    for (const EmitterSample& s : samples) sum += s.formFactor;
    for (EmitterSample& s : samples) s.formFactor *= total / sum;
}

Vec3 highestCorner(const std::array<Vec3, 3>& c, const Vec3& point, const Vec3& normal) {
    return *std::max_element(c.begin(), c.end(), [&](const Vec3& a, const Vec3& b) {
        return glm::dot(a - point, normal) < glm::dot(b - point, normal);
    });
}

}  // namespace

int samplesForSolidAngle(float steradians) { return steradians < 0.06f ? 16 : steradians < 1 ? 64 : mostSamples; }

float sampleEmitter(const Scene& scene, const EmitterSurface& emitter, const Vec3& point, const Vec3& normal, int count,
                    uint64_t seed, std::vector<EmitterSample>& samples) {
    samples.clear();
    if (emitter.centres.empty() || glm::dot(emitter.centroid - point, normal) < -emitter.radius) return 0;
    thread_local Pieces components;
    const float total = std::min(1.0f, formFactors(emitter, point, normal, components));
    if (!(total > 0)) return 0;
    // The back of a shade that is open is hidden by its front: samples of either stand for their own side.
    const size_t fronts = emitter.twoSided ? frontsFirst(components, point) : components.corners.size();
    std::vector<float>& factors = components.factors;
    float sum = 0;
    for (float& f : factors) {
        sum += f;
        f = sum;
    }
    const float ofFronts = fronts > 0 ? factors[fronts - 1] : 0;
    size_t ofFrontSamples = 0;
    const bool twoSides = fronts != 0 && fronts != factors.size();
    const bool byAngle = count <= 0;
    if (byAngle) {
        const float distance2 = std::max(glm::dot(emitter.centroid - point, emitter.centroid - point), 1e-20f);
        count = samplesForSolidAngle(emitter.area() / distance2);
        if (twoSides) count = std::min(4 * count, mostSamples);
    }
    const Vec3 origin = rayOrigin(scene, point, normal);
    const Vec2 shift = randomShift(seed, 0x51, 0x7f);
    Ray rays[8];
    int pending = 0;
    const float back = 8 * scene.tracer->surfaceOffset();
    const auto flush = [&] {
        if (!pending) return;
        const uint32_t blocked = scene.tracer->occluded8({rays, size_t(pending)});
        for (int i = 0; i < pending; ++i)
            samples[samples.size() - size_t(pending) + size_t(i)].visible = blocked >> i & 1 ? 0.0f : 1.0f;
        pending = 0;
    };
    const float first = unitFloat(mixBits(seed ^ 0x9d));
    for (int i = 0; i < count; ++i) {
        // Stratified over the components' shares, low-discrepancy inside each component.
        const float pick = (float(i) + first) / float(count) * sum;
        const size_t t = std::min(size_t(std::upper_bound(factors.begin(), factors.end(), pick) - factors.begin()),
                                  factors.size() - 1);
        const Vec2 u = r2Point(uint32_t(i), shift);
        const float root = std::sqrt(u.x);
        const auto& c = components.corners[t];
        Vec3 target = (1 - root) * c[0] + root * (1 - u.y) * c[1] + root * u.y * c[2];
        // Below the horizon: that part is clipped away, so a point above it stands for it.
        for (int k = 0; k < 3 && glm::dot(target - point, normal) <= 0; ++k)
            target = (target + highestCorner(c, point, normal)) / 2.0f;
        const Vec3 to = target - origin;
        const float distance = glm::length(to);
        EmitterSample s;
        // Points lie evenly over a component's area, its form factor does not: cosines and distance at the point set
        // that right.
        const Vec3 straight = target - point, twiceArea = glm::cross(c[1] - c[0], c[2] - c[0]);
        const float d2 = glm::dot(straight, straight), fraction = factors[t] - (t ? factors[t - 1] : 0.0f);
        const float kernel =
            std::abs(glm::dot(twiceArea, straight)) * std::max(0.0f, glm::dot(straight, normal)) / (2 * pi * d2 * d2);
        s.formFactor = d2 > 0 && fraction > 0 ? std::clamp(kernel / fraction, 0.25f, 4.0f) : 1.0f;
        ofFrontSamples += t < fronts;
        s.direction = distance > 0 ? to / distance : normal;
        s.level = emitter.levelAt(target, -s.direction);
        samples.push_back(s);
        rays[pending++] = {origin, s.direction, 0, std::max(0.0f, distance * (1 - 1e-4f) - back)};
        if (pending == 8) flush();
    }
    flush();
    if (twoSides && byAngle && count < mostSamples) {
        const auto backs = samples.begin() + std::ptrdiff_t(ofFrontSamples);
        const auto shown = std::count_if(backs, samples.end(), [](const EmitterSample& s) { return s.visible > 0; });
        if (shown > 0 && shown < samples.end() - backs)  // one sees a part of the back
            return sampleEmitter(scene, emitter, point, normal, mostSamples, seed, samples);
    }
    if (ofFrontSamples == 0 || ofFrontSamples == samples.size()) {
        addUpTo(total, samples);
    } else {
        addUpTo(total * ofFronts / sum, std::span(samples).first(ofFrontSamples));
        addUpTo(total * (1 - ofFronts / sum), std::span(samples).subspan(ofFrontSamples));
    }
    return total;
}

NearField computeNearField(const Scene& scene, const EmitterClusters& clusters, const NearFieldOptions& options,
                           Progress& progress) {
    NearField result;
    result.emitters = clusters.emitters.size();
    const size_t n = scene.mesh.vertexCount();
    result.formFactor.assign(n * result.emitters, 0);
    result.unshadowed.assign(n * result.emitters, 0);
    addNearField(scene, clusters, options, result, progress);
    return result;
}

void addNearField(const Scene& scene, const EmitterClusters& clusters, const NearFieldOptions& options,
                  NearField& result, Progress& progress) {
    const size_t n = scene.mesh.vertexCount();
    std::vector<EmitterSurface> surfaces;
    for (const EmitterCluster& e : clusters.emitters) surfaces.push_back(orderedEmitterSurface(scene, e));
    progress.begin("Near-field maps", n);
    parallelBlocks(
        n, 64,
        [&](size_t begin, size_t end) {
            std::vector<EmitterSample> samples;
            for (size_t v = begin; v < end; ++v) {
                if (!scene.referenced[v] || (options.only && !(*options.only)[v])) continue;
                for (size_t e = 0; e < surfaces.size(); ++e) {
                    const float total =
                        sampleEmitter(scene, surfaces[e], scene.mesh.positions[v], scene.mesh.normals[v], 0,
                                      mixBits(options.seed) ^ (uint64_t(scene.rank[v]) * 31 + e), samples);
                    float seen = 0, open = total;
                    for (const EmitterSample& s : samples) {
                        seen += s.formFactor * s.visible * s.level;
                        open += s.formFactor * (s.level - 1);
                    }
                    result.formFactor[v * result.emitters + e] = seen;
                    result.unshadowed[v * result.emitters + e] = open;
                }
            }
        },
        &progress);
}

SparseCoefs nearFieldCoefs(const Scene& scene, const EmitterSurface& emitter, uint32_t vertex,
                           const DirectionGrid& grid, int count, float energyFraction) {
    std::vector<float> cells(size_t(grid.cells()), 0.0f);
    std::vector<EmitterSample> samples;
    const Vec3 normal = scene.mesh.normals[vertex];
    sampleEmitter(scene, emitter, scene.mesh.positions[vertex], normal, count, vertex, samples);
    for (const EmitterSample& s : samples) {
        const float cosine = glm::dot(s.direction, normal);
        if (s.visible > 0 && cosine > 1e-4f)
            cells[size_t(grid.cellOf(s.direction))] += s.formFactor * pi / cosine / grid.cellSolidAngle();
    }
    const float scale = std::sqrt(grid.cellSolidAngle());
    for (float& value : cells) value = std::min(value, 1.0f) * scale;
    haarForward(cells, grid.side);
    return sparsify(cells, energyFraction);
}

}  // namespace relamp
