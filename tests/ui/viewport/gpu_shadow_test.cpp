// Shadows of parts in the environment by the compute shader against the processor's rays.
#include "viewport/gpu_shadow.h"

#include <gtest/gtest.h>

#include "base/box.h"
#include "base/error.h"
#include "relight/live/environment.h"
#include "support/estimates.h"
#include "support/shapes.h"

namespace relamp::ui {
namespace {

uint64_t nextVersion() {
    static uint64_t last = 0;
    return ++last;
}

/// Ground with a box as a movable part.
struct ShadowStand {
    LiveGrid grid;
    EditedGeometry geometry;
    LiveVertices vertices;
    LiveOccluders occluders;
    DeviceBlockers blockers;
    std::vector<uint32_t> vertexOfSlot;
    std::vector<Vec3> normal;
    std::vector<uint8_t> masks;
    uint64_t version = nextVersion();

    ShadowStand(int side, float size, const Mat4& matrix) : grid(side) {
        Mesh mesh = test::sheet({-2, -2, 0}, {4, 0, 0}, {0, 4, 0}, 18, 18);
        for (Vec3& n : mesh.normals) n = glm::normalize(Vec3(0.1f, -0.2f, 1));
        const size_t ground = mesh.vertexCount(), triangles = mesh.triangles.size();
        test::append(mesh, test::box(Vec3(-size, -size, 0.4f), Vec3(size, size, 0.4f + size), 3));
        geometry.mesh = mesh;
        for (size_t v = ground; v < mesh.vertexCount(); ++v)
            geometry.mesh.positions[v] = Vec3(matrix * Vec4(mesh.positions[v], 1));
        geometry.partOfTriangle.assign(mesh.triangles.size(), 1);
        std::fill_n(geometry.partOfTriangle.begin(), triangles, 0u);
        vertices.mesh = std::make_shared<const Mesh>(geometry.mesh);
        occluders.ground = tracerOf(geometry, 0);
        occluders.offset = occluders.ground->surfaceOffset();
        occluders.parts.resize(2);
        LivePart& part = occluders.parts[1];
        part.matrix = matrix;
        part.inverse = glm::inverse(matrix);
        part.tracer =
            std::make_shared<const RayTracer>(partMesh(geometry.mesh, geometry.partOfTriangle, 1, part.inverse));
        Box box;
        for (size_t v = ground; v < mesh.vertexCount(); ++v) box.grow(geometry.mesh.positions[v]);
        part.centre = box.centre();
        part.radius = 0.5001f * box.diagonal();
        blockers.follow(occluders, geometry.mesh, geometry.partOfTriangle);
        // Some see all above them, some have a hole in their view; the last slots stand for no vertex.
        for (uint32_t v = 0; v < ground; ++v) {
            vertexOfSlot.push_back(v);
            normal.push_back(mesh.normals[v]);
        }
        for (; vertexOfSlot.size() % 16; normal.emplace_back(0, 0, 1)) vertexOfSlot.push_back(EditedPart::none);
        masks.assign(vertexOfSlot.size() * grid.nibbleBytes(), 0);
        for (size_t s = 0; s < ground; ++s)
            for (size_t c = 0; c < grid.cells(); ++c) {
                unsigned seen = 0;
                for (int q = 0; q < 4; ++q)
                    if (glm::dot(grid.quarter(c, q), normal[s]) > 0) seen |= 1u << q;
                if (s % 3 == 0 && c % 7 == 0) seen &= 5;
                setNibble(&masks[s * grid.nibbleBytes()], c, seen);
            }
    }
    ShadowQuery query() const { return {grid, vertexOfSlot, normal, masks, version, vertices, occluders, blockers, 1}; }
    std::vector<uint16_t> expected(size_t s, bool& whole) const {
        std::vector<uint16_t> entries;
        whole = false;
        if (vertexOfSlot[s] == EditedPart::none) return entries;
        const Vec3 position = vertices.mesh->positions[vertexOfSlot[s]];
        Vec3 axis;
        float angle;
        occluders.parts[1].cone(position, axis, angle);
        whole = traceCone(
            grid, occluders.origin(position, normal[s]), normal[s], axis, angle,
            std::span(masks).subspan(s * grid.nibbleBytes(), grid.nibbleBytes()), true,
            [&](std::span<const Ray> rays) { return occluders.parts[1].occluded8(rays); }, entries);
        return entries;
    }
};

class GpuShadow : public testing::Test {
protected:
    std::string why;
    std::shared_ptr<ShadowDevice> device = makeGpuShadow(true, &why);
    void SetUp() override {
        if (why.find("EGL is not installed") != std::string::npos || why == "EGL offers no display")
            GTEST_SKIP() << why;
        ASSERT_TRUE(device) << "EGL is here but no context with OpenGL 4.3 could be made: " << why;
    }
    ShadowAnswers ask(const ShadowStand& stand) {
        ShadowAnswers out;
        device->start(stand.query());
        device->finish(out);
        return out;
    }
    static std::vector<uint16_t> entriesOf(const ShadowAnswers& answers, size_t slot) {
        size_t at = answers.first[slot / ShadowQuery::run];
        for (size_t s = slot / ShadowQuery::run * ShadowQuery::run; s < slot; ++s)
            at += ((answers.slot[s] & ~ShadowAnswers::whole) + 1) / 2 * 2;
        const auto first = answers.entries.begin() + long(at);
        return {first, first + (answers.slot[slot] & ~ShadowAnswers::whole)};
    }
};

TEST_F(GpuShadow, HidesTheCellsThatTheProcessorFinds) {
    const Mat4 turned =
        glm::mat4(Vec4(0.8f, 0.6f, 0, 0), Vec4(-0.6f, 0.8f, 0, 0), Vec4(0, 0, 1.5f, 0), Vec4(0.2f, 0.1f, 0.3f, 1));
    for (const auto& [side, size] : {std::pair{32, 0.2f}, {32, 0.35f}, {64, 0.1f}, {8, 0.3f}}) {
        const ShadowStand stand(side, size, turned);
        ask(stand);  // it may have had too little room, and then has more
        const ShadowAnswers answers = ask(stand);
        size_t same = 0, entries = 0, wholes = 0, sameWhole = 0, known = 0;
        for (size_t s = 0; s < stand.vertexOfSlot.size(); ++s) {
            if (answers.first[s / ShadowQuery::run] == ShadowAnswers::none) continue;
            ++known;
            bool whole = false;
            const std::vector<uint16_t> expected = stand.expected(s, whole);
            same += entriesOf(answers, s) == expected;
            entries += expected.size();
            wholes += whole;
            sameWhole += whole == ((answers.slot[s] & ShadowAnswers::whole) != 0);
        }
        EXPECT_GT(known, stand.vertexOfSlot.size() / 2) << side;
        EXPECT_GT(2 * entries, known) << side;
        EXPECT_GE(double(same), 0.99 * double(known)) << side << " on " << device->name();
        EXPECT_GE(double(sameWhole), 0.99 * double(known)) << side;
        EXPECT_GT(wholes, 0u) << side;
    }
}

TEST_F(GpuShadow, GivesTheSameEntriesEveryTimeAndFollowsThePart) {
    ShadowStand stand(32, 0.2f, Mat4(1));
    const auto listsOf = [&](const ShadowAnswers& answers) {
        std::vector<std::vector<uint16_t>> out;
        for (size_t s = 0; s < stand.vertexOfSlot.size(); ++s) out.push_back(entriesOf(answers, s));
        return out;
    };
    const auto first = listsOf(ask(stand));
    EXPECT_EQ(first, listsOf(ask(stand)));
    LivePart& part = stand.occluders.parts[1];
    part.matrix = test::translation({0.5f, 0, 0});
    part.inverse = glm::inverse(part.matrix);
    part.centre += Vec3(0.5f, 0, 0);
    const auto moved = listsOf(ask(stand));
    EXPECT_NE(first, moved);
    for (const size_t s : {40u, 150u, 170u}) {
        bool whole = false;
        EXPECT_EQ(moved[s], stand.expected(s, whole)) << s;
    }
    std::fill(stand.masks.begin(), stand.masks.end(), uint8_t(0));
    stand.version = nextVersion();
    for (const auto& list : listsOf(ask(stand))) EXPECT_TRUE(list.empty()) << "what sees nothing loses nothing";
    device->clear();
    EXPECT_THROW(
        {
            ShadowAnswers out;
            device->finish(out);
        },
        Error);
}

}  // namespace
}  // namespace relamp::ui
