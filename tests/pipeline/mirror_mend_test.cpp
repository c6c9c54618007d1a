// A metal ball of a reconstruction, from its photographs to the mended mesh.
#include <gtest/gtest.h>

#include "pipeline/mend_mesh.h"
#include "support/known_world.h"

namespace relamp {
namespace {

/// The world with a metal ball, whose mesh is as fine as a reconstruction's and has waves there.
struct WavyBall {
    test::TemporaryFolder folder;
    test::KnownWorld world = test::paintKnownWorld(folder / "world", true, 8, 24, false, true);
    Progress progress;
    StageMeter meter{progress};
    PipelineOptions options;
    Capture capture;
    Prepared prepared;
    Vec3 centre{0};
    float radius = 0;
    size_t begin = 0;  ///< the ball's first vertex; the others are behind it

    explicit WavyBall(float waves) {
        options.solve = solveOptionsFor("draft");
        capture = loadCapture(folder / "world", options.load, progress);
        Mesh& mesh = capture.mesh;
        for (size_t v = world.ballBegin; v < world.ballEnd; ++v)
            centre += mesh.positions[v] / float(world.ballEnd - world.ballBegin);
        radius = glm::length(mesh.positions[world.ballBegin] - centre);
        std::erase_if(mesh.triangles,
                      [&](const Triangle& t) { return t[0] >= world.ballBegin && t[0] < world.ballEnd; });
        begin = mesh.vertexCount();
        test::append(mesh, test::ball(centre, radius, 40, 80));
        for (size_t v = begin; v < mesh.vertexCount(); ++v) {
            const Vec3 d = glm::normalize(mesh.positions[v] - centre);
            mesh.positions[v] += waves * std::sin(9 * d.x) * std::sin(8 * d.y + 1) * std::cos(7 * d.z) * d;
        }
        mesh.normals = vertexNormalsFromFaces(mesh);
        prepared = prepare(capture, options, meter, progress);
    }
    /// Largest distance of the ball's vertices from its sphere, metres.
    float off() const {
        float most = 0;
        for (size_t v = begin; v < capture.mesh.vertexCount(); ++v)
            most = std::max(most, std::abs(glm::length(capture.mesh.positions[v] - centre) - radius));
        return most;
    }
    bool noted() const {
        return std::any_of(capture.notes.begin(), capture.notes.end(), [](const std::string& note) {
            return note.find("mirrors its environment") != std::string::npos;
        });
    }
};

TEST(MirrorMend, AWavyBallIsRoundAgainAndSaid) {
    WavyBall w(0.003f);
    const float before = w.off();
    const MeshMend mend = mendMesh(w.options, w.capture, w.prepared, {}, w.meter, w.progress);
    EXPECT_TRUE(w.noted());
    EXPECT_GT(mend.moved.size(), 3000u);
    EXPECT_EQ(mend.turned.size(), mend.moved.size());
    EXPECT_LT(w.off(), 0.3f * before);
}

TEST(MirrorMend, AnExactOneIsLeftAlone) {
    WavyBall w(0);
    const MeshMend mend = mendMesh(w.options, w.capture, w.prepared, {}, w.meter, w.progress);
    EXPECT_FALSE(w.noted());
    EXPECT_TRUE(mend.empty());
}

}  // namespace
}  // namespace relamp
