#include "pipeline/carry_corrections.h"

#include <algorithm>
#include <cmath>

namespace relamp {
namespace {

class Carrier {
public:
    Carrier(const DecimatedMesh& working, const Mesh& mesh) : working_(working), mesh_(mesh) {}

    /// Displacements of the working mesh from `before` to `after`, along the normals of the large mesh.
    void carrySteps(const std::vector<Vec3>& before, const std::vector<Vec3>& after, const Mesh& normals, float& step,
                    std::vector<int>& steps) const {
        std::vector<float> move(mesh_.vertexCount(), 0);
        float most = 0;
        for (uint32_t v = 0; v < move.size(); ++v) {
            move[v] = glm::dot(displacement(v, before, after), normals.normals[v]);
            most = std::max(most, std::abs(move[v]));
        }
        steps.clear();
        step = most / 10000;
        if (!(step > 0)) return;
        for (const float m : move) steps.push_back(int(std::lround(m / step)));
    }

    Vec3 displacement(uint32_t v, const std::vector<Vec3>& before, const std::vector<Vec3>& after) const {
        Vec3 sum(0);
        if (const Triangle* t = triangleOf(v))
            for (int k = 0; k < 3; ++k)
                sum += working_.places[v].weight[k] * (after[(*t)[size_t(k)]] - before[(*t)[size_t(k)]]);
        return sum;
    }

    const Triangle* triangleOf(uint32_t v) const {
        const uint32_t t = working_.places[v].triangle;
        return t == SurfacePlace::none ? nullptr : &working_.mesh.triangles[t];
    }

    /// The corner of the working mesh that is nearest among those that are `allowed`; SurfacePlace::none: none is.
    template <class Allowed>
    uint32_t nearest(uint32_t v, Allowed&& allowed) const {
        uint32_t best = SurfacePlace::none;
        float most = -1;
        if (const Triangle* t = triangleOf(v))
            for (int k = 0; k < 3; ++k)
                if (working_.places[v].weight[k] > most && allowed((*t)[size_t(k)])) {
                    most = working_.places[v].weight[k];
                    best = (*t)[size_t(k)];
                }
        return best;
    }
    uint32_t nearest(uint32_t v) const {
        return nearest(v, [](uint32_t) { return true; });
    }

    /// Triangles of the large mesh of which two corners lie on marked ones.
    std::vector<uint32_t> trianglesOn(const std::vector<uint32_t>& ofWorking) const {
        std::vector<uint32_t> found;
        if (ofWorking.empty()) return found;
        const std::vector<uint8_t> marked = marks(ofWorking, working_.mesh.triangles.size());
        for (uint32_t t = 0; t < mesh_.triangles.size(); ++t) {
            int corners = 0;
            for (const uint32_t v : mesh_.triangles[t])
                corners += working_.places[v].triangle != SurfacePlace::none && marked[working_.places[v].triangle];
            if (corners >= 2) found.push_back(t);
        }
        return found;
    }

    /// Vertices whose nearest corner is marked, and those that were added.
    std::vector<uint32_t> verticesOn(const std::vector<uint32_t>& ofWorking) const {
        std::vector<uint32_t> found;
        const std::vector<uint8_t> marked = marks(ofWorking, working_.mesh.vertexCount());
        for (uint32_t v = 0; v < mesh_.vertexCount() && !ofWorking.empty(); ++v)
            if (const uint32_t c = nearest(v); c != SurfacePlace::none && marked[c]) found.push_back(v);
        for (const uint32_t v : ofWorking)
            if (v >= working_.mesh.vertexCount()) found.push_back(added(v));
        return found;
    }

    /// What a vertex that was added to the working mesh is called in the large one.
    uint32_t added(uint32_t v) const {
        return v - uint32_t(working_.mesh.vertexCount()) + uint32_t(mesh_.vertexCount());
    }

    static std::vector<uint8_t> marks(const std::vector<uint32_t>& list, size_t count) {
        std::vector<uint8_t> marked(count, 0);
        for (const uint32_t i : list)
            if (i < count) marked[i] = 1;
        return marked;
    }

private:
    const DecimatedMesh& working_;
    const Mesh& mesh_;
};

/// What is left of triangles beside those that go, of which one corner lies on these, ends where the working mesh ends.
void endAtRims(const Carrier& carrier, const DecimatedMesh& working, const MeshMend& found,
               const std::vector<Vec3>& corrected, const Mesh& mesh, const MeshMend& mend, std::vector<Vec3>& places) {
    if (found.removed.empty()) return;
    const std::vector<uint8_t> goes = Carrier::marks(found.removed, working.mesh.triangles.size()),
                               gone = Carrier::marks(mend.removed, mesh.triangles.size());
    std::vector<uint8_t> stays(working.mesh.vertexCount(), 0);
    for (size_t t = 0; t < goes.size(); ++t)
        for (const uint32_t v : working.mesh.triangles[t]) stays[v] |= uint8_t(!goes[t]);
    for (size_t t = 0; t < gone.size(); ++t)
        for (const uint32_t v : mesh.triangles[t]) {
            if (gone[t] || working.places[v].triangle == SurfacePlace::none || !goes[working.places[v].triangle])
                continue;
            const uint32_t rim = carrier.nearest(v, [&](uint32_t corner) { return stays[corner] != 0; });
            if (rim != SurfacePlace::none) places[v] = corrected[rim];
        }
}

/// A normal of the large mesh, as that of the working mesh beside it turns. One that turns far is a crease's side.
Vec3 carriedNormal(const Vec3& own, const Vec3& beside, const Vec3& turned) {
    constexpr float little = 0.94f;  // cosine
    const Vec3 n = glm::normalize(turned);
    if (glm::dot(beside, n) < little || glm::dot(own, n) < little) return turned;
    return glm::normalize(own + n - beside);
}

}  // namespace

Corrections carriedBack(const Corrections& found, const DecimatedMesh& working, const std::vector<Vec3>& corrected,
                        const Mesh& mesh) {
    const Carrier carrier(working, mesh);
    Corrections result = found;
    RegistrationFix& fix = result.registration;
    Mesh small = working.mesh, large = mesh;
    // One displacement after the other, as applyRegistration does.
    const auto carry = [&](float RegistrationFix::*step, std::vector<int> RegistrationFix::*steps) {
        if ((found.registration.*steps).empty()) return;
        const std::vector<Vec3> before = small.positions;
        RegistrationFix one;
        one.*step = found.registration.*step;
        one.*steps = found.registration.*steps;
        applyRegistration(one, small);
        carrier.carrySteps(before, small.positions, large, fix.*step, fix.*steps);
        one.*step = fix.*step;
        one.*steps = fix.*steps;
        applyRegistration(one, large);
    };
    carry(&RegistrationFix::step, &RegistrationFix::steps);
    carry(&RegistrationFix::outlineStep, &RegistrationFix::outlineSteps);
    carry(&RegistrationFix::flatStep, &RegistrationFix::flatSteps);

    large = mesh;
    applyRegistration({{}, fix.step, fix.steps, fix.outlineStep, fix.outlineSteps, fix.flatStep, fix.flatSteps}, large);
    small = working.mesh;
    const RegistrationFix& f = found.registration;
    applyRegistration({{}, f.step, f.steps, f.outlineStep, f.outlineSteps, f.flatStep, f.flatSteps}, small);
    MeshMend& mend = result.mend;
    mend.removed = carrier.trianglesOn(found.mend.removed);
    mend.shadowless = carrier.trianglesOn(found.mend.shadowless);
    mend.shining = carrier.verticesOn(found.mend.shining);
    mend.bothSides = carrier.verticesOn(found.mend.bothSides);
    std::vector<Vec3> places = large.positions;
    for (uint32_t v = 0; v < places.size(); ++v) places[v] += carrier.displacement(v, small.positions, corrected);
    endAtRims(carrier, working, found.mend, corrected, mesh, mend, places);
    mend.moved.clear();
    for (uint32_t v = 0; v < places.size(); ++v)
        if (places[v] != large.positions[v]) mend.moved.push_back({v, places[v]});
    for (const MeshMend::MovedVertex& m : found.mend.moved)
        if (m.vertex >= working.mesh.vertexCount()) mend.moved.push_back({carrier.added(m.vertex), m.position});
    std::vector<Vec3> turned(working.mesh.vertexCount(), Vec3(0));
    for (const MeshMend::TurnedVertex& t : found.mend.turned) turned[t.vertex] = t.normal;
    mend.turned.clear();
    for (uint32_t v = 0; v < mesh.vertexCount(); ++v)
        if (const uint32_t c = carrier.nearest(v); c != SurfacePlace::none && turned[c] != Vec3(0))
            mend.turned.push_back({v, carriedNormal(large.normals[v], small.normals[c], turned[c])});
    return result;
}

std::vector<uint32_t> inWorkingMesh(const std::vector<uint32_t>& vertices, const DecimatedMesh& working) {
    std::vector<uint32_t> found;
    for (uint32_t v = 0; v < working.vertex.size(); ++v)
        if (std::binary_search(vertices.begin(), vertices.end(), working.vertex[v])) found.push_back(v);
    return found;
}

}  // namespace relamp
