#include "relight/relit_scene.h"

#include <map>
#include <numeric>

#include "base/box.h"
#include "base/error.h"
#include "image/environment_map.h"
#include "relight/backdrop.h"
#include "relight/standing_emitters.h"

namespace relamp {
namespace {

/// The mesh of a shape of its own, in the world.
Mesh shapeMesh(const AddedEmitter& added) {
    Mesh m = infoOf(added.shape).mesh(added.size);
    for (Vec3& p : m.positions) p = Vec3(added.matrix * Vec4(p, 1));
    for (Vec3& n : m.normals) n = glm::normalize(glm::transpose(glm::inverse(Mat3(added.matrix))) * n);
    if (glm::determinant(Mat3(added.matrix)) < 0)
        for (Triangle& t : m.triangles) std::swap(t[1], t[2]);
    return m;
}

/// A disk that covers the sun's angle, so far away that its light is parallel over the scene.
EmitterSurface sunSurface(const AddedEmitter& added, float degrees, const Scene& scene) {
    const Vec3 back = glm::normalize(glm::transpose(glm::inverse(Mat3(added.matrix))) * Vec3(0, 0, 1));
    const float distance = 1000 * scene.diagonal;
    Mesh disk = infoOf(EmitterShape::disk).mesh(Vec2(2 * distance * std::tan(degrees * (pi / 360))));
    const Mat3 frame = frameAround(back);
    Box box;
    for (const Vec3& p : scene.mesh.positions) box.grow(p);
    const Vec3 centre = box.centre() + distance * back;
    for (Vec3& p : disk.positions) p = centre + frame * p;
    EmitterCluster all;
    all.triangles.resize(disk.triangles.size());
    std::iota(all.triangles.begin(), all.triangles.end(), 0u);
    return emitterSurface(disk, all);
}

/// Moves the triangles of parts and doubles vertices whose triangles belong to different ones, so that nothing is
/// stretched; of those the ground, else the first, keeps the number.
void moveTriangles(const Mesh& captured, EditedGeometry& out) {
    constexpr uint32_t none = EditedPart::none;
    const size_t n = captured.vertexCount();
    std::vector<uint32_t> owner(n, none);
    for (size_t t = 0; t < out.partOfTriangle.size(); ++t)
        if (!out.partOfTriangle[t])
            for (uint32_t v : captured.triangles[t]) owner[v] = 0;
    std::vector<Mat3> normalMatrix;
    for (const EditedPart& b : out.parts) {
        normalMatrix.push_back(glm::transpose(glm::inverse(Mat3(b.matrix))));
        out.mirrored.push_back(glm::determinant(Mat3(b.matrix)) < 0);
    }
    std::map<std::pair<uint32_t, uint32_t>, uint32_t> copyOf;
    for (size_t t = 0; t < out.partOfTriangle.size(); ++t) {
        const uint32_t part = out.partOfTriangle[t];
        if (!part) continue;
        for (uint32_t& v : out.mesh.triangles[t]) {
            const uint32_t origin = v;
            if (owner[origin] == part) continue;
            if (owner[origin] == none) {
                owner[origin] = part;
            } else {
                const auto [place, isNew] =
                    copyOf.emplace(std::pair(origin, part), uint32_t(out.mesh.positions.size()));
                v = place->second;
                if (!isNew) continue;
                out.mesh.positions.emplace_back();
                out.mesh.normals.push_back(captured.normals[origin]);
                out.vertexOrigin.push_back(out.vertexOrigin[origin]);
            }
            const Mat4& matrix = out.parts[part].matrix;
            out.mesh.positions[v] =
                matrix == Mat4(1) ? captured.positions[origin] : Vec3(matrix * Vec4(captured.positions[origin], 1));
            if (matrix == Mat4(1)) continue;
            Vec3& normal = out.mesh.normals[v];
            normal = normalMatrix[part] * captured.normals[origin];
            if (const float length = glm::length(normal); length > 0) normal /= length;
        }
        if (out.mirrored[part]) std::swap(out.mesh.triangles[t][1], out.mesh.triangles[t][2]);
    }
}

size_t emitterNamed(const std::vector<EmitterCluster>& clusters, const std::string& id, const char* where) {
    for (size_t i = 0; i < clusters.size(); ++i)
        if (clusters[i].id == id) return i;
    throw Error("{}: there is no emitter named {}", where, id);
}

void expectMembers(const std::vector<EmitterCluster>& clusters, const Look& look) {
    for (const LightGroup& group : look.groups)
        for (const std::string& id : group.members)
            if (std::none_of(look.added.begin(), look.added.end(), [&](const AddedEmitter& e) { return e.id == id; }))
                emitterNamed(clusters, id, "groups");
}

/// The triangles of a mesh component that no emitter has yet.
EmitterCluster clusterOfComponent(const Scene& scene, const AddedEmitter& added,
                                  const std::vector<int>& emitterOfTriangle) {
    if (added.seedVertex >= scene.mesh.vertexCount())
        throw Error("added_emitters: {}: seed_vertex {} does not exist, the mesh has {} vertices", added.id,
                    added.seedVertex, scene.mesh.vertexCount());
    EmitterCluster cluster;
    for (uint32_t t = 0; t < scene.mesh.triangles.size(); ++t)
        if (emitterOfTriangle[t] < 0 &&
            scene.component[scene.mesh.triangles[t][0]] == scene.component[added.seedVertex])
            cluster.triangles.push_back(t);
    if (cluster.triangles.empty())
        throw Error("added_emitters: {}: the component of mesh at vertex {} shines already or has no triangles",
                    added.id, added.seedVertex);
    return cluster;
}

/// Puts the triangles of an added shape behind the mesh as a new part.
void appendShape(const Mesh& shape, int emitter, const Mat4& matrix, EditedGeometry& out) {
    const uint32_t first = uint32_t(out.mesh.positions.size());
    for (const Triangle& t : shape.triangles) {
        out.mesh.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
        out.emitterOfTriangle.push_back(emitter);
        out.partOfTriangle.push_back(uint32_t(out.parts.size()));
    }
    out.mesh.positions.insert(out.mesh.positions.end(), shape.positions.begin(), shape.positions.end());
    out.mesh.normals.insert(out.mesh.normals.end(), shape.normals.begin(), shape.normals.end());
    out.vertexOrigin.resize(out.mesh.positions.size(), EditedPart::none);
    out.parts.push_back({emitter, EditedPart::none, matrix});
    out.moved = true;
}

/// The triangles of a cluster alone, moved.
Mesh clusterMesh(const Mesh& captured, const EmitterCluster& cluster, const Mat4& matrix) {
    Mesh m;
    std::map<uint32_t, uint32_t> place;
    const Mat3 normalMatrix = glm::transpose(glm::inverse(Mat3(matrix)));
    const bool mirrored = glm::determinant(Mat3(matrix)) < 0;
    for (uint32_t t : cluster.triangles) {
        Triangle triangle = captured.triangles[t];
        for (uint32_t& v : triangle) {
            const auto [at, isNew] = place.emplace(v, uint32_t(m.positions.size()));
            if (isNew) {
                m.positions.push_back(Vec3(matrix * Vec4(captured.positions[v], 1)));
                const Vec3 normal = normalMatrix * captured.normals[v];
                const float length = glm::length(normal);
                m.normals.push_back(length > 0 ? normal / length : normal);
            }
            v = at->second;
        }
        if (mirrored) std::swap(triangle[1], triangle[2]);
        m.triangles.push_back(triangle);
    }
    return m;
}

/// EditedGeometry::addedFactor for emitters that are moved by these matrices.
std::vector<std::vector<float>> addedFactors(const NearFieldCorrection& correction, const std::vector<Mat4>& moved,
                                             const Mesh& captured, const EditedGeometry& edited) {
    std::vector<std::vector<float>> added(edited.emitters.size());
    if (correction.empty()) return added;
    for (size_t v = 0; v < edited.vertexOrigin.size(); ++v) {
        const uint32_t origin = edited.vertexOrigin[v];
        if (origin == EditedPart::none || edited.mesh.positions[v] != captured.positions[origin]) continue;
        const int e = correction.emitter[origin];
        if (e < 0 || moved[size_t(e)] != Mat4(1)) continue;
        if (added[size_t(e)].empty()) added[size_t(e)].assign(edited.vertexOrigin.size(), 0);
        added[size_t(e)][v] = correction.formFactor[origin];
    }
    return added;
}

void nameEmitters(const std::vector<EmitterCluster>& clusters, const Look& look, std::vector<RelitEmitter>& emitters) {
    std::vector<std::string> ids;
    ids.reserve(clusters.size());
    for (const EmitterCluster& cluster : clusters) ids.push_back(cluster.id);
    const std::vector<std::string> names = emitterNames(ids, look);
    for (size_t e = 0; e < names.size(); ++e) emitters[e].name = names[e];
}

void takeLink(const LightLink& link, const Scene& scene, const char* where, RelitEmitter& emitter) {
    emitter.link = link;
    emitter.reach = reachOf(link, scene, fmt::format("{}: {}.link", where, emitter.id));
}

/// EditedGeometry::partOfTriangle: the part of a triangle's emitter, or of its component of the mesh.
void setParts(const Scene& scene, const ClosedMesh& closed, const std::vector<uint32_t>& ofEmitter,
              const std::vector<uint32_t>& ofComponent, EditedGeometry& out) {
    for (size_t t = 0; t < out.partOfTriangle.size(); ++t) {
        const int e = out.emitterOfTriangle[t];
        const uint32_t origin = closed.vertexOrigin[closed.mesh.triangles[t][0]];
        out.partOfTriangle[t] = e >= 0 ? ofEmitter[size_t(e)] : ofComponent[scene.component[origin]];
    }
}

/// How a recovered emitter that was moved by `matrix` shines over its surface and by direction; null: evenly.
std::shared_ptr<const ShapedEmission> patternOf(const EmitterCluster& cluster, const Mat4& matrix) {
    if (!cluster.pattern && cluster.lobe.even()) return nullptr;
    const bool flat = !cluster.twoSided && glm::length(cluster.normal) > 0.5f;
    return std::make_shared<const ShapedEmission>(cluster.pattern, matrix, cluster.lobe, flat);
}

/// The mesh that is closed where emitters with a part of their own leave it; `kept` where it is that one already.
std::shared_ptr<const ClosedMesh> closedFor(const Scene& scene, const std::vector<EmitterCluster>& clusters,
                                            const std::vector<uint32_t>& partOfEmitter,
                                            std::shared_ptr<const ClosedMesh>* kept) {
    std::vector<uint8_t> leaves(clusters.size());
    for (size_t e = 0; e < clusters.size(); ++e) leaves[e] = partOfEmitter[e] != 0;
    if (kept && *kept && (*kept)->left == leaves) return *kept;
    auto closed = std::make_shared<const ClosedMesh>(closeStandingEmitters(scene, clusters, leaves));
    if (kept) *kept = closed;
    return closed;
}

DirectionGrid gridFor(const Image& map) {
    DirectionGrid grid{64};
    while (grid.side < 512 && grid.side * 2 <= map.width) grid.side *= 2;
    return grid;
}

/// The environment of a lighting state as LightingState::environment has it. No name: the estimate's own.
int environmentNamed(const Estimate& estimate, const std::string& state, const char* field) {
    if (state.empty()) return 0;
    for (const LightingState& s : estimate.states)
        if (s.name == state) return s.environment;
    throw Error("environment.{}: no lighting state of the photographs is called {}", field, state);
}

/// Empty: there is none.
std::vector<Rgb> cellsOf(const Estimate& estimate, int environment) {
    if (environment < 0) return {};
    return environment == 0 ? estimate.environment : estimate.otherEnvironments[size_t(environment - 1)].environment;
}

std::vector<Rgb> recoveredCells(const Estimate& estimate, const EnvironmentLook& look) {
    std::vector<Rgb> cells = cellsOf(estimate, environmentNamed(estimate, look.state, "state"));
    cells.resize(estimate.environment.size(), Rgb(0));
    if (look.mixState.empty()) return cells;
    std::vector<Rgb> other = cellsOf(estimate, environmentNamed(estimate, look.mixState, "mix_state"));
    other.resize(cells.size(), Rgb(0));
    for (size_t c = 0; c < cells.size(); ++c) cells[c] = (1 - look.mix) * cells[c] + look.mix * other[c];
    return cells;
}

/// The panoramas that go with recoveredCells; empty where one of them is missing.
std::vector<Backdrop::Layer> recoveredLayers(const Estimate& estimate, const EnvironmentLook& look) {
    std::vector<Backdrop::Layer> layers;
    const auto add = [&](const std::string& state, float weight) {
        const int environment = environmentNamed(estimate, state, "state");
        if (environment < 0 || !(weight > 0)) return true;
        layers.push_back(
            {environment == 0 ? estimate.background : estimate.otherEnvironments[size_t(environment - 1)].background,
             weight});
        return bool(layers.back().panorama);
    };
    const bool mixed = !look.mixState.empty();
    if (add(look.state, mixed ? 1 - look.mix : 1.0f) && (!mixed || add(look.mixState, look.mix))) return layers;
    return {};
}

}  // namespace

std::vector<Rgb> environmentOf(const Estimate& estimate, const LightingState& state) {
    return cellsOf(estimate, state.environment);
}

std::shared_ptr<const DistantLight> distantOfLook(const Estimate& estimate, const EnvironmentLook& look) {
    DirectionGrid grid{estimate.environmentSide};
    std::vector<Rgb> cells;
    Backdrop seen;
    if (look.source == EnvironmentLook::Source::none) {
        cells.assign(size_t(grid.cells()), Rgb(0));
    } else if (look.source == EnvironmentLook::Source::file) {
        Image map = readEnvironment(look.file);
        grid = gridFor(map);
        cells = integrateOverCells(look.yawDegrees == 0 ? map : yawed(map, look.yawDegrees), grid);
        seen.layers.push_back({std::make_shared<const Panorama>(std::move(map)), 1});
    } else {
        cells = recoveredCells(estimate, look);
        seen.layers = recoveredLayers(estimate, look);
        if (look.yawDegrees != 0)
            cells = integrateOverCells(yawed(latLongFromCells(cells, grid, 1024), look.yawDegrees), grid);
    }
    const Rgb gain = look.tint * std::exp2(look.exposureStops);
    for (Rgb& c : cells) c *= gain;
    seen.yawDegrees = look.yawDegrees;
    seen.gain = gain;
    std::shared_ptr<const Backdrop> backdrop;
    if (!seen.layers.empty()) backdrop = std::make_shared<const Backdrop>(std::move(seen));
    return sided(std::make_shared<const DistantLight>(grid, std::move(cells), std::move(backdrop)), look.sides);
}

EditedGeometry editGeometry(const Scene& scene, const Estimate& estimate, const Look& look, const PartsApart& apart,
                            std::shared_ptr<const ClosedMesh>* kept) {
    const std::vector<EmitterCluster>& clusters = estimate.emitters.emitters;
    EditedGeometry out;
    std::vector<Mat4> matrix(clusters.size(), Mat4(1));
    std::vector<Rgb> radiance = estimate.lighting.emitterRadiance;
    std::vector<uint8_t> shadows(clusters.size(), 1);
    std::vector<LightLink> links(clusters.size());
    for (const EmitterLook& e : look.emitters) {
        const size_t at = emitterNamed(clusters, e.id, "emitters");
        matrix[at] = e.matrix;
        radiance[at] = e.enabled ? radiance[at] * e.powerScale : Rgb(0);
        shadows[at] = e.shadows;
        links[at] = e.link;
    }
    expectMembers(clusters, look);
    for (size_t e = 0; e < clusters.size(); ++e) radiance[e] *= groupFactor(look.groups, clusters[e].id);
    // Which part each triangle is of: its emitter's own, else that of the parts on its component of the mesh, else the
    // ground.
    out.parts.emplace_back();
    std::vector<uint32_t> partOfComponent(scene.components, 0), partOfEmitter(clusters.size() + look.added.size(), 0);
    const auto addComponent = [&](uint32_t component) -> uint32_t {
        if (!partOfComponent[component]) {
            partOfComponent[component] = uint32_t(out.parts.size());
            out.parts.push_back({-1, component, Mat4(1)});
        }
        return partOfComponent[component];
    };
    for (uint32_t component : apart.components) addComponent(component);
    for (const PartLook& part : look.parts) {
        if (part.seedVertex >= scene.mesh.vertexCount())
            throw Error("parts: seed_vertex {} does not exist, the mesh has {} vertices", part.seedVertex,
                        scene.mesh.vertexCount());
        if (part.matrix == Mat4(1)) continue;
        Mat4& movement = out.parts[addComponent(scene.component[part.seedVertex])].matrix;
        movement = part.matrix * movement;
    }
    const auto addEmitter = [&](size_t e, const Mat4& movement) {
        if (movement == Mat4(1) && !apart.emitters) return;
        partOfEmitter[e] = uint32_t(out.parts.size());
        out.parts.push_back({int(e), EditedPart::none, movement});
    };
    out.emitterOfTriangle = estimate.emitters.emitterOfTriangle;
    for (size_t e = 0; e < clusters.size(); ++e) addEmitter(e, matrix[e]);
    const std::shared_ptr<const ClosedMesh> closedMesh = closedFor(scene, clusters, partOfEmitter, kept);
    const ClosedMesh& closed = *closedMesh;
    for (size_t e = 0; e < clusters.size(); ++e) {
        out.emitters.push_back({clusters[e].id,
                                emitterSurface(closed.mesh, closed.emitters[e], matrix[e]),
                                {radiance[e], patternOf(clusters[e], matrix[e])}});
        out.emitters.back().shadows = shadows[e];
        takeLink(links[e], scene, "emitters", out.emitters.back());
    }
    for (size_t i = 0; i < look.added.size(); ++i) {
        const AddedEmitter& added = look.added[i];
        const int e = int(clusters.size() + i);
        const Rgb sent = added.enabled ? added.radiance * groupFactor(look.groups, added.id) : Rgb(0);
        RelitEmitter emitter{added.id, {}, {sent}};
        const EmitterShapeInfo& info = infoOf(added.shape);
        emitter.shadows = added.shadows;
        takeLink(added.link, scene, "added_emitters", emitter);
        if (info.distant) emitter.sunDegrees = std::clamp(added.size.x, 0.01f, 90.0f);
        if (info.distant) emitter.emission.level *= sunRadiance(emitter.sunDegrees);
        if (info.shapeable() && !added.shaping.plain())
            emitter.emission.shaped = withContext(fmt::format("added_emitters: {}", added.id), [&] {
                return std::make_shared<const ShapedEmission>(added.shaping, added.matrix, added.size, info.flat);
            });
        const auto geometry = info.geometry;
        if (geometry == EmitterShapeInfo::Geometry::component) {
            const EmitterCluster cluster = clusterOfComponent(scene, added, out.emitterOfTriangle);
            for (uint32_t t : cluster.triangles) out.emitterOfTriangle[t] = e;
            emitter.surface = emitterSurface(scene.mesh, cluster, added.matrix);
            addEmitter(size_t(e), added.matrix);
        } else if (geometry == EmitterShapeInfo::Geometry::emitter) {
            const EmitterCluster& source = clusters[emitterNamed(clusters, added.source, "added_emitters")];
            emitter.surface = emitterSurface(scene.mesh, source, added.matrix);
            emitter.emission.shaped = patternOf(source, added.matrix);
        }
        out.emitters.push_back(std::move(emitter));
    }
    nameEmitters(clusters, look, out.emitters);
    out.mesh = closed.mesh;
    out.vertexOrigin = closed.vertexOrigin;
    out.untextured = closed.untextured;
    out.emitterOfTriangle.insert(out.emitterOfTriangle.end(), closed.emitterOfNewTriangle.begin(),
                                 closed.emitterOfNewTriangle.end());
    out.moved = out.parts.size() > 1;
    out.partOfTriangle.assign(closed.mesh.triangles.size(), 0);
    if (out.moved) {
        setParts(scene, closed, partOfEmitter, partOfComponent, out);
        moveTriangles(closed.mesh, out);
    }
    for (size_t i = 0; i < look.added.size(); ++i) {
        const AddedEmitter& added = look.added[i];
        if (infoOf(added.shape).geometry == EmitterShapeInfo::Geometry::component) continue;
        if (infoOf(added.shape).distant) {
            RelitEmitter& sun = out.emitters[clusters.size() + i];
            sun.surface = sunSurface(added, sun.sunDegrees, scene);
            out.parts.push_back({int(clusters.size() + i), EditedPart::none, added.matrix});
            continue;
        }
        const bool copy = !infoOf(added.shape).own();
        const Mesh shape =
            copy ? clusterMesh(scene.mesh, clusters[emitterNamed(clusters, added.source, "added_emitters")],
                               added.matrix)
                 : shapeMesh(added);
        appendShape(shape, int(clusters.size() + i), added.matrix, out);
        if (!copy) {
            EmitterCluster all;
            all.triangles.resize(shape.triangles.size());
            std::iota(all.triangles.begin(), all.triangles.end(), 0u);
            out.emitters[clusters.size() + i].surface = emitterSurface(shape, all);
        }
    }
    out.addedFactor = addedFactors(estimate.nearFieldCorrection, matrix, scene.mesh, out);
    return out;
}

RelitScene applyLook(const Scene& scene, const Estimate& estimate, const Look& look, Progress& progress,
                     std::shared_ptr<const DistantLight> distant, uint32_t bounceRays) {
    EditedGeometry geometry = editGeometry(scene, estimate, look);
    RelitScene out;
    out.basis = estimate.reflectance.basis;
    for (const std::vector<Rgb>& captured : estimate.reflectance.weight) {
        std::vector<Rgb> weight(geometry.vertexOrigin.size(), Rgb(0));
        for (size_t v = 0; v < weight.size(); ++v)
            if (geometry.vertexOrigin[v] != EditedPart::none) weight[v] = captured[geometry.vertexOrigin[v]];
        out.weight.push_back(std::move(weight));
    }
    // What was added is known.
    if (const std::vector<float>& captured = estimate.reflectance.confidence;
        captured.size() >= scene.mesh.vertexCount()) {
        out.confidence.assign(geometry.vertexOrigin.size(), 1);
        for (size_t v = 0; v < out.confidence.size(); ++v)
            if (geometry.vertexOrigin[v] != EditedPart::none) out.confidence[v] = captured[geometry.vertexOrigin[v]];
    }
    if (look.neutralMaterials)
        for (auto& lobe : out.weight)
            for (Rgb& w : lobe) w = Rgb(luminance(w));
    out.texture = estimate.reflectance.texture;
    out.neutralMaterials = look.neutralMaterials;
    if (out.texture && std::find(geometry.mirrored.begin(), geometry.mirrored.end(), 1) != geometry.mirrored.end()) {
        out.mirrored.assign(geometry.mesh.triangles.size(), 0);
        for (size_t t = 0; t < out.texture->corners.size(); ++t)
            out.mirrored[t] = geometry.mirrored[geometry.partOfTriangle[t]];
    }
    if (!geometry.untextured.empty()) out.untextured.assign(geometry.mesh.triangles.size(), 0);
    for (const uint32_t t : geometry.untextured) out.untextured[t] = 1;
    out.emitterOfTriangle = std::move(geometry.emitterOfTriangle);
    out.emitters = std::move(geometry.emitters);
    if (std::any_of(out.emitters.begin(), out.emitters.end(), [](const RelitEmitter& e) { return bool(e.reach); }))
        for (const uint32_t origin : geometry.vertexOrigin)
            out.component.push_back(origin == EditedPart::none ? EditedPart::none : scene.component[origin]);
    out.addedFactor = std::move(geometry.addedFactor);
    out.scene = geometry.moved ? buildScene(std::move(geometry.mesh), progress, scene.axes) : scene;
    out.distant = distant ? std::move(distant) : distantOfLook(estimate, look.environment);
    BouncedLightOptions bounce;
    if (bounceRays > 0) bounce.rays.rays = bounceRays;
    if (estimate.interreflection) out.bounced = bouncedLightOf(out, bounce, progress);
    return out;
}

Rgb RelitScene::albedoAt(const Hit& hit, const Vec3& direction, float spread) const {
    if (!hasTexels(hit.triangle)) return weightsAt(hit).albedo();
    const auto shown = [&](const Rgb& albedo) { return neutralMaterials ? Rgb(luminance(albedo)) : albedo; };
    const Vec2 place = placeInTexture(hit);
    const Triangle& t = scene.mesh.triangles[hit.triangle];
    const Vec3 first = scene.mesh.positions[t[0]], a = scene.mesh.positions[t[1]] - first,
               b = scene.mesh.positions[t[2]] - first, normal = glm::cross(a, b);
    const float area = glm::dot(normal, normal);
    if (!(spread > 0) || !(area > 0)) return shown(texture->at(place));
    // What the cone covers of the triangle's plane, an ellipse, as the rectangle around it, in texels.
    constexpr float grazing = 0.05f;
    const Vec3 n = normal / std::sqrt(area);
    const float width = spread * hit.distance, cosine = glm::dot(n, direction);
    Vec3 along = direction - cosine * n;
    const float length = glm::length(along);
    along = length > 1e-4f ? along / length : a / glm::length(a);
    const bool turned = isMirrored(hit.triangle);
    const std::array<Vec2, 3>& c = texture->corners[hit.triangle];
    const auto inTexels = [&](const Vec3& v) {
        const float u = glm::dot(glm::cross(v, b), normal) / area, w = glm::dot(glm::cross(a, v), normal) / area;
        return u * (c[turned ? 2 : 1] - c[0]) + w * (c[turned ? 1 : 2] - c[0]);
    };
    return shown(texture->over(hit.triangle, place, inTexels(along) * (width / std::max(std::abs(cosine), grazing)),
                               inTexels(glm::cross(n, along)) * width));
}

float RelitScene::confidenceAt(const Hit& hit) const {
    if (hasTexels(hit.triangle) && !texture->confidence.empty()) return texture->confidenceAt(placeInTexture(hit));
    if (confidence.empty()) return 1;
    const Triangle& t = scene.mesh.triangles[hit.triangle];
    const Vec2 b = hit.barycentric;
    return (1 - b.x - b.y) * confidence[t[0]] + b.x * confidence[t[1]] + b.y * confidence[t[2]];
}

}  // namespace relamp
