// Near fields by the compute shader against the processor and closed forms. Runs in any OpenGL 4.3, llvmpipe too;
// without EGL it says so.
#include "viewport/gpu_near.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <numeric>

#include "base/box.h"
#include "base/error.h"
#include "base/random.h"
#include "support/estimates.h"
#include "support/shapes.h"

namespace relamp::ui {
namespace {

/// A ground with two movable parts and an emitter above it.
struct Stand {
    EditedGeometry geometry;
    LiveVertices vertices;
    LiveOccluders occluders;
    DeviceBlockers blockers;
    NearEmitter emitter;
    std::vector<uint32_t> wanted;
    Mesh own[3];  ///< of the parts, in their own frames

    /// `movement`: of the first part, a box.
    Stand(const Mesh& ground, const Mesh& shape, const Mat4& movement = Mat4(1), bool twoSided = false) {
        geometry.parts.resize(3);
        add(ground, 0, Mat4(1));
        add(test::box({-0.3f, -0.3f, 0.4f}, {0.3f, 0.3f, 0.6f}, 2), 1, movement);
        add(shape, 2, Mat4(1));
        EmitterCluster cluster;
        cluster.twoSided = twoSided;
        cluster.triangles.resize(shape.triangles.size());
        std::iota(cluster.triangles.begin(), cluster.triangles.end(), 0u);
        emitter.tree = LiveEmitterTree(emitterSurface(shape, cluster));
        emitter.part = 2;
        emitter.centre = emitter.tree.surface().centroid;
        emitter.radius = emitter.tree.surface().radius;
        vertices.mesh = std::make_shared<const Mesh>(geometry.mesh);
        occluders.ground = tracerOf(geometry, 0);
        occluders.offset = occluders.ground->surfaceOffset();
        occluders.parts.resize(3);
        carry(1, movement);
        carry(2, Mat4(1));
        blockers.follow(occluders, geometry.mesh, geometry.partOfTriangle);
    }

    void carry(uint32_t b, const Mat4& matrix) {
        LivePart& part = occluders.parts[b];
        part.matrix = matrix;
        part.inverse = glm::inverse(matrix);
        if (!part.tracer) {
            own[b] = partMesh(geometry.mesh, geometry.partOfTriangle, b, part.inverse);
            part.tracer = std::make_shared<const RayTracer>(own[b]);
        }
        Box box;
        for (const Vec3& p : own[b].positions) box.grow(Vec3(matrix * Vec4(p, 1)));
        part.centre = box.centre();
        part.radius = 0.5001f * box.diagonal();
    }

    NearQuery query(int level, uint64_t seed = 3) const {
        return {emitter, vertices, occluders, blockers, wanted, level, seed};
    }
    NearAnswer expected(uint32_t v, int level, uint64_t seed = 3) const {
        NearAnswer out;
        const Vec3 point = vertices.mesh->positions[v], to = emitter.centre - point;
        const bool close = level < 3 && glm::dot(to, to) < 6.25f * emitter.radius * emitter.radius;
        out.factor =
            nearFactor(emitter, occluders, point, vertices.mesh->normals[v], level == 1 ? coarseCut : fineCut,
                       nearSamples(level) * (close ? 2 : 1), mixBits(mixBits(seed + emitter.part) ^ v), out.open);
        return out;
    }

private:
    void add(const Mesh& mesh, uint32_t part, const Mat4& matrix) {
        for (uint32_t v = 0; v < mesh.vertexCount(); ++v) {
            if (part == 0) wanted.push_back(uint32_t(vertices.kind.size()));
            vertices.kind.push_back(part == 0   ? LiveVertices::ground
                                    : part == 2 ? LiveVertices::emitting
                                                : LiveVertices::carried);
            vertices.part.push_back(part);
        }
        const auto first = uint32_t(geometry.mesh.vertexCount());
        for (size_t v = 0; v < mesh.vertexCount(); ++v) {
            geometry.mesh.positions.push_back(Vec3(matrix * Vec4(mesh.positions[v], 1)));
            geometry.mesh.normals.push_back(mesh.normals[v]);
        }
        for (const Triangle& t : mesh.triangles) {
            geometry.mesh.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
            geometry.partOfTriangle.push_back(part);
        }
    }
};

class GpuNear : public testing::Test {
protected:
    std::string why;
    std::shared_ptr<NearDevice> device = makeGpuNear(true, &why);
    void SetUp() override {
        if (why.find("EGL is not installed") != std::string::npos || why == "EGL offers no display")
            GTEST_SKIP() << why;
        ASSERT_TRUE(device) << "EGL is here but no context with OpenGL 4.3 could be made: " << why;
    }
    std::vector<NearAnswer> ask(const NearQuery& query) {
        std::vector<NearAnswer> out(query.wanted.size(), NearAnswer{-7, -7});
        device->start(query);
        device->finish(out);
        return out;
    }
    /// Mean difference as a fraction of the mean light, and the largest difference of the unshadowed factors.
    void expectSame(const Stand& stand, int level, const std::string& what) {
        const std::vector<NearAnswer> found = ask(stand.query(level));
        double off = 0, sum = 0, shadowed = 0;
        for (size_t i = 0; i < found.size(); ++i) {
            const NearAnswer expected = stand.expected(stand.wanted[i], level);
            EXPECT_NEAR(found[i].open, expected.open, 1e-4f * expected.open + 1e-7f) << what << ", vertex " << i;
            off += std::abs(double(found[i].factor) - double(expected.factor));
            sum += double(expected.open);
            shadowed += double(expected.open - expected.factor);
        }
        EXPECT_GT(sum, 0) << what;
        EXPECT_GT(shadowed, 1e-3 * sum) << what << ": no shadow was tested";
        EXPECT_LT(off, 2e-3 * sum) << what << " on " << device->name();
    }
};

Mesh ground(int cuts = 20) { return test::sheet({-2, -2, 0}, {4, 0, 0}, {0, 4, 0}, cuts, cuts); }

TEST_F(GpuNear, TakesTheProcessorsSamples) {
    const Mat4 turned =
        glm::mat4(Vec4(0.8f, 0.6f, 0, 0), Vec4(-0.6f, 0.8f, 0, 0), Vec4(0, 0, 1.5f, 0), Vec4(0.2f, 0.1f, 0, 1));
    const Stand far(ground(), test::ball({0.3f, 0, 1.8f}, 0.3f, 6, 12)),
        moved(ground(), test::squareAbove(0.5f, 0.2f, -0.3f, 1.2f, 3), turned),
        close(ground(12), test::squareAbove(1.5f, 0.2f, 0.1f, 0.8f, 2), Mat4(1), true);
    for (const int level : {1, 2, 3}) {
        expectSame(far, level, "ball");
        expectSame(moved, level, "square, box turned");
        expectSame(close, level, "large square, two-sided");
    }
    expectSame(Stand(ground(5), test::ball({0.3f, 0, 1.8f}, 0.3f, 6, 12)), 4, "ball");
}

TEST_F(GpuNear, UnderADiscIsTheClosedForm) {
    const float radius = 0.7f, height = 1.1f;
    Stand stand(test::sheet({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, 2, 2), test::discAbove(radius, height, 180),
                test::translation({20, 0, 0}));
    const std::vector<NearAnswer> found = ask(stand.query(4));
    const float expected = radius * radius / (radius * radius + height * height);
    bool met = false;
    for (size_t i = 0; i < found.size(); ++i)
        if (glm::length(stand.vertices.mesh->positions[stand.wanted[i]]) < 1e-5f) {
            EXPECT_NEAR(found[i].open, expected, 2e-3f * expected);
            EXPECT_EQ(found[i].factor, found[i].open) << "nothing stands between";
            met = true;
        }
    EXPECT_TRUE(met);
}

TEST_F(GpuNear, AMovedPartTakesItsShadowAlong) {
    const Mesh emitter = test::squareAbove(0.1f, 0, 0, 3);
    Stand stand(ground(), emitter);
    const auto seen = [&](const std::vector<NearAnswer>& answers, float x) {
        float sum = 0;
        for (size_t i = 0; i < answers.size(); ++i)
            if (glm::length(stand.vertices.mesh->positions[stand.wanted[i]] - Vec3(x, 0, 0)) < 0.25f)
                sum += answers[i].factor;
        return sum;
    };
    const std::vector<NearAnswer> before = ask(stand.query(2));
    EXPECT_EQ(seen(before, 0), 0);
    EXPECT_GT(seen(before, 1), 0);
    stand.carry(1, test::translation({0.8f, 0, 0}));  // between the emitter and x = 1; the trees stay as they are
    const std::vector<NearAnswer> after = ask(stand.query(2));
    EXPECT_GT(seen(after, 0), 0);
    EXPECT_EQ(seen(after, 1), 0);
    stand.emitter.shadows = false;
    for (const NearAnswer& a : ask(stand.query(1))) EXPECT_EQ(a.factor, a.open);
}

TEST_F(GpuNear, GivesTheSameBitsEveryTimeAndAnswersInOrder) {
    const Stand one(ground(), test::ball({0.3f, 0, 1.8f}, 0.3f, 6, 12)),
        two(ground(9), test::squareAbove(0.5f, 0.2f, -0.3f, 1.2f, 3));
    const auto same = [](const std::vector<NearAnswer>& a, const std::vector<NearAnswer>& b) {
        return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const NearAnswer& x, const NearAnswer& y) {
            return x.factor == y.factor && x.open == y.open;
        });
    };
    const std::vector<NearAnswer> first = ask(one.query(1)), second = ask(two.query(2));
    std::vector<NearAnswer> again(first.size()), other(second.size());
    device->start(one.query(1));
    device->start(two.query(2));
    device->finish(again);
    device->finish(other);
    EXPECT_TRUE(same(first, again));
    EXPECT_TRUE(same(second, other));
    device->clear();
    EXPECT_TRUE(same(first, ask(one.query(1))));
    EXPECT_FALSE(same(first, ask(one.query(1, 99))));
}

TEST_F(GpuNear, RefusesWhatWasNotAskedFor) {
    const Stand stand(ground(4), test::squareAbove(0.5f, 0.2f, -0.3f, 1.2f, 3));
    std::vector<NearAnswer> out(3);
    EXPECT_THROW(device->finish(out), Error);
    device->start(stand.query(1));
    EXPECT_THROW(device->finish(out), Error);
}

TEST_F(GpuNear, ChoiceKeepsTheFasterOneAndForceTheDevice) {
    const Stand stand(ground(), test::ball({0.3f, 0, 1.8f}, 0.3f, 6, 12));
    Progress progress;
    NearPlace place;
    place.choose(&stand.emitter, stand.vertices, stand.occluders, stand.blockers, device, false, 3, progress);
    EXPECT_GT(place.processorMs(), 0);
    EXPECT_GT(place.deviceMs(), 0);
    EXPECT_EQ(place.device().empty(), place.deviceMs() >= place.processorMs());
    for (const NearEmitter* emitter : {&stand.emitter, static_cast<const NearEmitter*>(nullptr)}) {
        place.choose(emitter, stand.vertices, stand.occluders, stand.blockers, device, true, 3, progress);
        EXPECT_EQ(place.device(), device->name());
    }
}

}  // namespace
}  // namespace relamp::ui
