// Directions that lobes, or observations of one vertex, share.
#include "solve/gloss/arriving_light.h"

#include <gtest/gtest.h>

#include "solve/state/gloss_model.h"
#include "tests/solve/glazed_ball.h"

namespace relamp {
namespace {

std::vector<GlossyObservation> observationsOf(const test::CoatedBall& ball, size_t vertices) {
    GlossOptions options;
    options.maxVertices = vertices;
    return glossyObservations(ball.capture, ball.scene, ball.samples, 0, options);
}

TEST(ArrivingLight, KeptOrForgottenItSendsTheSameThroughALobe) {
    const test::CoatedBall ball;
    Progress progress;
    const std::vector<GlossyObservation> observations = observationsOf(ball, 40);
    ASSERT_GE(observations.size(), 80u);
    const std::vector<Lobe> lobes = builtInBasis().lobes;
    const ArrivingLight kept(ball.scene, {}, {}, ball.lighting, observations, {}, progress);
    const auto forgotten = lobeResponses(ball.scene, {}, {}, ball.lighting, lobes, observations, {}, progress);
    for (const size_t k : {size_t(1), lobes.size() - 1}) EXPECT_EQ(kept.through(lobes[k]), forgotten[k]);
}

TEST(ArrivingLight, AgreesWithALobesOwnDirections) {
    const test::CoatedBall ball;
    Progress progress;
    const std::vector<GlossyObservation> observations = observationsOf(ball, 40);
    const ArrivingLight arriving(ball.scene, {}, {}, ball.lighting, observations, {}, progress);
    for (const Lobe& lobe : {withRoughness(*ball.gloss.lobe, 1), withRoughness(*ball.gloss.lobe, 2)}) {
        const InfluenceMatrix rows =
            glossyRows(ball.scene, {}, {}, ball.lighting.leaves, lobe, observations, {}, progress);
        const std::vector<Rgb> through = arriving.through(lobe);
        double off = 0, all = 0;
        for (size_t i = 0; i < observations.size(); ++i) {
            const float own = luminance(lightOfRow(rows.row(i), ball.lighting));
            off += std::abs(double(own - luminance(through[i])));
            all += double(own);
        }
        EXPECT_GT(all, 0);
        EXPECT_LT(off, 0.05 * all) << lobe.name;
    }
}

TEST(GlossyRows, ObservationsThatShareDirectionsHaveTheRowsTheyHaveAlone) {
    const test::CoatedBall ball;
    Progress progress;
    const std::vector<GlossyObservation> observations = observationsOf(ball, 10);
    ASSERT_LT(startsOfVertices(observations).size() - 1, observations.size());
    const LightLeaves& leaves = ball.lighting.leaves;
    const InfluenceMatrix rows = glossyRows(ball.scene, {}, {}, leaves, *ball.gloss.lobe, observations, {}, progress);
    std::vector<float> alone(rows.columns);
    for (size_t i = 0; i < rows.rows; ++i) {
        glossyInfluence(ball.scene, {}, {}, leaves, *ball.gloss.lobe, observations[i].vertex, observations[i].towardEye,
                        {}, alone.data());
        EXPECT_TRUE(std::equal(alone.begin(), alone.end(), rows.row(i))) << i;
    }
}

TEST(GlossModel, CoatingsAreTheSameWithinATwentieth) {
    GlossModel model;
    ComponentGloss coating;
    coating.lobe = Lobe{Lobe::Kind::ggxDielectric, 0.04f, "ggx dielectric roughness 0.200"};
    coating.weight = Rgb(1);
    model.components = {coating};
    const auto same = [&](const auto& change) {
        ComponentGloss other = coating;
        change(other);
        return model.sameCoatings({other});
    };
    EXPECT_TRUE(same([](ComponentGloss& g) { g.weight = Rgb(1.04f), g.lobe->alpha = 0.043f; }));
    EXPECT_FALSE(same([](ComponentGloss& g) { g.weight.y = 1.06f; }));
    EXPECT_FALSE(same([](ComponentGloss& g) { g.lobe->alpha = 0.045f; }));
    EXPECT_FALSE(same([](ComponentGloss& g) { g.lobe->kind = Lobe::Kind::ggx; }));
    EXPECT_FALSE(same([](ComponentGloss& g) { g.component = 1; }));
    EXPECT_FALSE(same([](ComponentGloss& g) { g.matte = false; }));
    EXPECT_FALSE(same([](ComponentGloss& g) { g.lobe.reset(); }));
    EXPECT_FALSE(model.sameCoatings({}));
}

}  // namespace
}  // namespace relamp
