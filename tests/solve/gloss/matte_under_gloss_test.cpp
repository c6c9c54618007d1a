#include "solve/gloss/matte_under_gloss.h"

#include <gtest/gtest.h>

#include "tests/solve/glazed_ball.h"

namespace relamp {
namespace {

TEST(MatteUnderGloss, TakesOffWhatTheCoatingMirrors) {
    test::CoatedBall ball;
    const std::vector<uint8_t> none(ball.scene.mesh.vertexCount(), 0);
    MatteObservations seen = matteObservations(ball.scene, ball.samples, none);
    ASSERT_GT(seen.vertices.size(), 100u);
    MatteObservations under = seen;
    Progress progress;
    matteUnderGloss(ball.capture, ball.scene, ball.samples, {}, {}, ball.lighting, ball.gloss, {}, under, progress);
    const auto medianError = [&](const MatteObservations& m) {
        std::vector<float> errors;
        for (size_t i = 0; i < m.vertices.size(); ++i)
            errors.push_back(std::abs(m.radiance[i].y / ball.matte[m.vertices[i]].y - 1));
        std::nth_element(errors.begin(), errors.begin() + ptrdiff_t(errors.size() / 2), errors.end());
        return errors[errors.size() / 2];
    };
    EXPECT_GT(medianError(seen), 0.25f);
    EXPECT_LT(medianError(under), 0.04f);
    for (size_t i = 0; i < under.vertices.size(); ++i)
        for (int c = 0; c < 3; ++c) EXPECT_GT(under.sigma[i][c], 0.02f * under.radiance[i][c]);
}

TEST(MatteUnderGloss, LeavesOtherComponentsAndSwallowedObservationsAlone) {
    test::CoatedBall ball;
    const std::vector<uint8_t> none(ball.scene.mesh.vertexCount(), 0);
    const MatteObservations seen = matteObservations(ball.scene, ball.samples, none);
    MatteObservations under = seen;
    Progress progress;
    ComponentGloss elsewhere = ball.gloss;
    elsewhere.component = 1;
    matteUnderGloss(ball.capture, ball.scene, ball.samples, {}, {}, ball.lighting, elsewhere, {}, under, progress);
    ComponentGloss tooMuch = ball.gloss;
    tooMuch.weight = Rgb(1000);
    matteUnderGloss(ball.capture, ball.scene, ball.samples, {}, {}, ball.lighting, tooMuch, {}, under, progress);
    for (size_t i = 0; i < seen.vertices.size(); ++i) EXPECT_EQ(under.radiance[i], seen.radiance[i]);
}

}  // namespace
}  // namespace relamp
