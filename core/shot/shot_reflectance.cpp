#include "shot/shot_reflectance.h"

#include <algorithm>
#include <cmath>

#include "base/box.h"
#include "base/error.h"
#include "base/is_there.h"
#include "brdf/layered_albedo.h"
#include "shot/shot_texture.h"

namespace relamp {
namespace fs = std::filesystem;

namespace {

constexpr const char* ownFile = "reflectance.ply";
constexpr const char* addedFile = "added.ply";
constexpr const char* levelColumn = "emission_level";

/// Vertices of the mesh without the balls that were fitted to photographs: those of the file, and proxies that were
/// told.
size_t writtenVertices(const std::vector<ProxyLight>& proxies, const Mesh& mesh) {
    size_t fitted = 0;
    while (fitted < proxies.size() && proxies[proxies.size() - 1 - fitted].observed()) ++fitted;
    return mesh.vertexCount() - std::min(mesh.vertexCount(), fitted * proxyVertices);
}

/// The emitter of each written vertex. What a fitted ball took the place of counts as the ball's.
std::vector<float> emitterColumn(const Shot& shot, const Mesh& mesh, size_t vertices) {
    const std::vector<int>& emitter = shot.estimate.emitters.emitterOfVertex;
    std::vector<float> column(emitter.begin(), emitter.begin() + std::ptrdiff_t(std::min(vertices, emitter.size())));
    std::vector<uint8_t> used(mesh.vertexCount(), 0);
    for (const Triangle& t : mesh.triangles)
        for (const uint32_t v : t) used[v] = 1;
    for (size_t ball = vertices; ball < emitter.size(); ball += proxyVertices) {
        Box box;
        for (size_t v = ball; v < std::min(ball + proxyVertices, emitter.size()); ++v) box.grow(mesh.positions[v]);
        const float reach = 0.55f * maxChannel(box.size());
        for (size_t v = 0; v < column.size(); ++v)
            if (!used[v] && glm::length(mesh.positions[v] - box.centre()) < reach) column[v] = float(emitter[ball]);
    }
    return column;
}

/// Of emitters that shine unevenly, else 1; empty where all shine evenly.
std::vector<float> levelsOf(const EmitterClusters& clusters, size_t vertices) {
    std::vector<float> levels;
    for (const EmitterCluster& e : clusters.emitters) {
        if (e.level.empty()) continue;
        levels.resize(vertices, 1);
        for (size_t i = 0; i < e.vertices.size(); ++i) levels[e.vertices[i]] = e.level[i];
    }
    return levels;
}

/// Vertices of the mesh: the file's, `added` that follow them, proxies.
size_t firstAddedOf(const std::vector<ProxyLight>& proxies, const Mesh& mesh, size_t added) {
    return mesh.vertexCount() - std::min(mesh.vertexCount(), proxies.size() * proxyVertices + added);
}

/// Part of a mesh with what is known of it.
struct Part {
    Mesh mesh;
    std::vector<FaceTexcoords> texcoords;
    std::vector<VertexProperty> properties;

    void write(const fs::path& file, const DVec3& origin) const {
        writeVertexPly(file, mesh, properties, origin, texcoords);
    }
};

/// The part whose vertices `number` gives a new one; ~0: they are not in it.
Part partOf(const Mesh& whole, const std::vector<uint32_t>& number, const std::vector<VertexProperty>& properties,
            const AlbedoTexture* texture) {
    Part part;
    for (const VertexProperty& p : properties) part.properties.push_back({p.name, {}, p.asInt});
    for (size_t v = 0; v < number.size(); ++v) {
        if (number[v] == ~0u) continue;
        part.mesh.positions.push_back(whole.positions[v]);
        part.mesh.normals.push_back(whole.normals[v]);
        for (size_t i = 0; i < properties.size(); ++i)
            if (v < properties[i].values.size()) part.properties[i].values.push_back(properties[i].values[v]);
    }
    for (uint32_t t = 0; t < whole.triangles.size(); ++t) {
        const auto [a, b, c] = whole.triangles[t];
        const Triangle corners{number[a], number[b], number[c]};
        if (std::any_of(corners.begin(), corners.end(), [](uint32_t v) { return v == ~0u; })) continue;
        part.mesh.triangles.push_back(corners);
        if (texture) part.texcoords.push_back(texcoordsOf(*texture, t));
    }
    return part;
}

}  // namespace

void writeReflectance(const Shot& shot, const Mesh& mesh, const fs::path& folder) {
    const size_t vertices = writtenVertices(shot.fix.proxies, mesh), added = shot.fix.mend.addedPositions.size(),
                 firstAdded = firstAddedOf(shot.fix.proxies, mesh, added);
    const Reflectance& r = shot.estimate.reflectance;
    std::vector<VertexProperty> properties;
    const char* suffix[] = {"r", "g", "b"};
    const auto add = [&](const std::string& name, const std::vector<Rgb>& values) {
        for (int c = 0; c < 3; ++c) {
            VertexProperty p{fmt::format("{}_{}", name, suffix[c]), {}, false};
            for (const Rgb& v : values) p.values.push_back(v[c]);
            properties.push_back(std::move(p));
        }
    };
    add("albedo", albedoUnderCoating(r.basis, r.weight));
    for (size_t k = 0; k < r.weight.size(); ++k) add(fmt::format("weight_{}", k), r.weight[k]);
    properties.push_back({"observed", {r.observed.begin(), r.observed.end()}, true});
    properties.push_back({"emitter", emitterColumn(shot, mesh, vertices), true});
    properties.push_back({"confidence", r.confidence, false});
    if (!r.sigma.empty()) properties.push_back({"albedo_sigma", r.sigma, false});
    if (std::vector<float> levels = levelsOf(shot.estimate.emitters, mesh.vertexCount()); !levels.empty())
        properties.push_back({levelColumn, std::move(levels), false});
    if (const NearFieldCorrection& fix = shot.estimate.nearFieldCorrection; !fix.empty()) {
        properties.push_back({"corrected_emitter", {fix.emitter.begin(), fix.emitter.end()}, true});
        properties.push_back({"added_form_factor", fix.formFactor, false});
    }
    std::vector<uint32_t> own(mesh.vertexCount(), ~0u), ofAdded = own;
    uint32_t count = 0;
    for (size_t v = 0; v < vertices; ++v) {
        if (v >= firstAdded && v < firstAdded + added) ofAdded[v] = uint32_t(v - firstAdded);
        else own[v] = count++;
    }
    partOf(mesh, own, properties, r.texture.get()).write(folder / ownFile, shot.capture.origin);
    if (added) partOf(mesh, ofAdded, properties, r.texture.get()).write(folder / addedFile, shot.capture.origin);
}

Mesh readShotMesh(const fs::path& folder, MeshReport& report) {
    Mesh mesh = readMesh(folder / ownFile, &report);
    if (!isThere(folder / addedFile)) return mesh;
    MeshReport reportOfAdded;
    const Mesh added = readMesh(folder / addedFile, &reportOfAdded);
    const auto first = uint32_t(mesh.vertexCount());
    const Vec3 shift(reportOfAdded.origin - report.origin);
    for (const Vec3& p : added.positions) mesh.positions.push_back(p + shift);
    mesh.normals.insert(mesh.normals.end(), added.normals.begin(), added.normals.end());
    for (const auto& [a, b, c] : added.triangles) mesh.triangles.push_back({first + a, first + b, first + c});
    return mesh;
}

ReflectanceFiles::ReflectanceFiles(const fs::path& folder, const Capture& capture, size_t added)
    : folder_(folder),
      vertices_(capture.mesh.vertexCount()),
      written_(writtenVertices(capture.proxies, capture.mesh)),
      firstAdded_(firstAddedOf(capture.proxies, capture.mesh, added)),
      added_(added),
      own_(readVertexPly(folder / ownFile)) {
    if (added) ofAdded_ = readVertexPly(folder / addedFile);
}

bool ReflectanceFiles::has(const std::string& name) const {
    return std::any_of(own_.begin(), own_.end(), [&](const VertexProperty& p) { return p.name == name; });
}

std::vector<float> ReflectanceFiles::column(const std::string& name, float missing) const {
    const auto read = [&](const std::vector<VertexProperty>& properties, const fs::path& file, size_t expected,
                          size_t orExpected) {
        const auto p = std::find_if(properties.begin(), properties.end(),
                                    [&](const VertexProperty& one) { return one.name == name; });
        if (p == properties.end()) throw Error("{}: property {} is missing", file.string(), name);
        if (p->values.size() != expected && p->values.size() != orExpected)
            throw Error("{}: {} has {} values, the mesh has {} vertices", file.string(), name, p->values.size(),
                        expected);
        for (size_t v = 0; v < p->values.size(); ++v)
            if (!std::isfinite(p->values[v]))
                throw Error("{}: {} of vertex {} is not a finite number", file.string(), name, v);
        return p->values;
    };
    std::vector<float> values = read(own_, folder_ / ownFile, vertices_ - added_, written_ - added_);
    if (added_) {
        const std::vector<float> more = read(ofAdded_, folder_ / addedFile, added_, added_);
        values.insert(values.begin() + std::ptrdiff_t(firstAdded_), more.begin(), more.end());
    }
    values.resize(vertices_, missing);
    return values;
}

Reflectance ReflectanceFiles::reflectance(const BrdfBasis& basis) const {
    Reflectance r;
    r.basis = basis;
    r.weight.assign(basis.lobes.size(), std::vector<Rgb>(vertices_));
    for (size_t k = 0; k < r.weight.size(); ++k)
        for (int c = 0; c < 3; ++c) {
            const std::vector<float> values = column(fmt::format("weight_{}_{}", k, "rgb"[c]));
            for (size_t v = 0; v < vertices_; ++v) r.weight[k][v][c] = values[v];
        }
    for (float o : column("observed")) r.observed.push_back(uint8_t(std::clamp(o, 0.0f, 255.0f)));
    r.confidence = column("confidence");
    if (has("albedo_sigma")) r.sigma = column("albedo_sigma");
    return r;
}

std::vector<float> ReflectanceFiles::emissionLevel() const {
    return has(levelColumn) ? column(levelColumn, 1) : std::vector<float>();
}

NearFieldCorrection ReflectanceFiles::nearFieldCorrection(size_t emitters) const {
    NearFieldCorrection fix;
    if (!has("corrected_emitter") || !has("added_form_factor")) return fix;
    for (float e : column("corrected_emitter", -1)) fix.emitter.push_back(e >= 0 && e < float(emitters) ? int(e) : -1);
    fix.formFactor = column("added_form_factor");
    return fix;
}

std::vector<TexturedFace> ReflectanceFiles::texturedFaces() const {
    std::vector<TexturedFace> faces = readTexturedFaces(folder_ / ownFile);
    for (TexturedFace& face : faces)
        for (uint32_t& v : face.corners) v += v >= firstAdded_ ? uint32_t(added_) : 0;
    if (!added_) return faces;
    for (TexturedFace face : readTexturedFaces(folder_ / addedFile)) {
        for (uint32_t& v : face.corners) v += uint32_t(firstAdded_);
        faces.push_back(face);
    }
    return faces;
}

}  // namespace relamp
