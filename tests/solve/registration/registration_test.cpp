// Cameras turned and shifted and a sheet bent by known amounts are brought back; where nothing is off nothing is moved.
#include "solve/registration/registration.h"

#include <gtest/gtest.h>

#include "base/parallel.h"
#include "radiance/gather.h"
#include "solve/registration/places.h"
#include "support/shaken_sheet.h"

namespace relamp {
namespace {

using test::ShakenSheet;

RegistrationEstimate estimate(const ShakenSheet& sheet, bool far = false, int threads = 0) {
    const ThreadLimit limit(threads);
    Progress progress;
    const RadianceSamples samples = gatherRadiance(sheet.capture, sheet.scene, {}, progress);
    return estimateRegistration(sheet.capture, sheet.scene, samples, {sheet.scene.mesh.vertexCount(), true, far},
                                progress);
}

TEST(Registration, LeavesAnExactCaptureAlone) {
    const RegistrationEstimate found = estimate(ShakenSheet());
    EXPECT_GT(found.before, 0);
    EXPECT_FALSE(found.needed()) << toText(found);
    EXPECT_LT(found.pixels, 0.25);
    EXPECT_TRUE(found.fix.empty());
}

TEST(Registration, LeavesWhatMirrorsOut) {
    const ShakenSheet sheet;
    Progress progress;
    const RadianceSamples samples = gatherRadiance(sheet.capture, sheet.scene, {}, progress);
    std::vector<uint8_t> mirrors(sheet.scene.mesh.vertexCount(), 0);
    for (size_t v = 0; v < mirrors.size(); ++v) mirrors[v] = sheet.scene.mesh.positions[v].x > 0;
    const Places all = choosePlaces(sheet.capture, sheet.scene, samples, {}),
                 places = choosePlaces(sheet.capture, sheet.scene, samples, mirrors);
    EXPECT_TRUE(std::any_of(all.vertex.begin(), all.vertex.end(), [&](uint32_t v) { return mirrors[v]; }));
    ASSERT_FALSE(places.vertex.empty());
    EXPECT_TRUE(std::none_of(places.vertex.begin(), places.vertex.end(), [&](uint32_t v) { return mirrors[v]; }));
}

TEST(Registration, BringsCamerasAndABentSheetBack) {
    const ShakenSheet truth;
    ShakenSheet sheet(100);
    sheet.bend();
    sheet.shake();
    const double pixels = sheet.pixelsFrom(truth.capture), bent = sheet.bentBy();
    ASSERT_GT(pixels, 0.8);
    const RegistrationEstimate found = estimate(sheet);
    ASSERT_TRUE(found.needed()) << toText(found);
    applyRegistration(found.fix, sheet.capture);
    EXPECT_LT(sheet.pixelsFrom(truth.capture), 0.4 * pixels);
    EXPECT_LT(sheet.bentBy(), 0.7 * bent);
    // Once is enough.
    sheet.scene = test::sceneOf(sheet.capture.mesh);
    EXPECT_FALSE(estimate(sheet).needed());
}

TEST(Registration, CamerasThatAreFarOffAreBroughtNearFirst) {
    const ShakenSheet truth;
    ShakenSheet sheet;
    sheet.shake(3);
    ASSERT_GT(sheet.pixelsFrom(truth.capture), 3);  // of 160
    const double apart = sheet.apartFrom(truth.capture);
    const RegistrationEstimate far = estimate(sheet, true);
    ASSERT_EQ(far.farPoses.size(), size_t(ShakenSheet::views)) << toText(far);
    EXPECT_TRUE(far.fix.empty());
    EXPECT_GT(far.farPixels, 1);
    applyRegistration({far.farPoses}, sheet.capture);
    EXPECT_LT(sheet.apartFrom(truth.capture), 0.4 * apart);
    const RegistrationEstimate found = estimate(sheet);
    EXPECT_TRUE(found.farPoses.empty());
    applyRegistration(found.fix, sheet.capture);
    EXPECT_LT(sheet.apartFrom(truth.capture), 0.1 * apart);
}

TEST(Registration, FindsAHollowThatTheMeshFills) {
    ShakenSheet sheet;
    sheet.fillHollow();
    const double bent = sheet.bentBy();
    const RegistrationEstimate found = estimate(sheet);
    EXPECT_TRUE(found.reshaped()) << toText(found);
    applyRegistration(found.fix, sheet.capture);
    EXPECT_LT(sheet.bentBy(), 0.4 * bent);
}

TEST(Registration, HoldsTheMeshWhereToldTo) {
    ShakenSheet sheet;
    sheet.bend();
    sheet.shake();
    Progress progress;
    const RadianceSamples samples = gatherRadiance(sheet.capture, sheet.scene, {}, progress);
    const RegistrationEstimate found = estimateRegistration(sheet.capture, sheet.scene, samples,
                                                            {sheet.scene.mesh.vertexCount(), false, false}, progress);
    EXPECT_TRUE(found.needed());
    EXPECT_EQ(found.fix.poses.size(), size_t(ShakenSheet::views));
    EXPECT_TRUE(found.fix.steps.empty());
}

TEST(Registration, LeavesAPlainSheetAlone) {
    // Nothing to hold on to: every pixel alike.
    ShakenSheet sheet;
    for (View& view : sheet.capture.views)
        for (int y = 0; y < ShakenSheet::height; ++y)
            for (int x = 0; x < ShakenSheet::width; ++x) view.image.at(x, y) = Rgb(0.5f);
    sheet.shake();
    const RegistrationEstimate found = estimate(sheet);
    EXPECT_FALSE(found.needed()) << toText(found);
    EXPECT_LT(found.pixels, 1e-6);
}

TEST(Registration, SaysSoWhereTooFewPlacesAreSeen) {
    ShakenSheet sheet;
    sheet.capture.views.resize(2);
    const RegistrationEstimate found = estimate(sheet);
    EXPECT_FALSE(found.needed());
    EXPECT_NE(toText(found).find("too few"), std::string::npos);
}

TEST(Registration, HasTheSameBitsOnOneAndManyThreads) {
    ShakenSheet sheet;
    sheet.bend();
    sheet.shake();
    EXPECT_TRUE(estimate(sheet, false, 1).fix == estimate(sheet).fix);
}

}  // namespace
}  // namespace relamp
