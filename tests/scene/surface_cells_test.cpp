#include "scene/surface_cells.h"

#include <gtest/gtest.h>

#include "support/shapes.h"

namespace relamp {
namespace {

TEST(SurfaceCells, EndWhereTheHueChanges) {
    const Scene scene = test::sceneOf(test::sheet({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 40, 40));
    std::vector<Rgb> colour(scene.mesh.vertexCount());
    const auto red = [&](uint32_t v) { return scene.mesh.positions[v].x < 0.49f; };
    for (uint32_t v = 0; v < colour.size(); ++v) colour[v] = red(v) ? Rgb(0.6f, 0.1f, 0.1f) : Rgb(0.5f);
    const std::vector<uint8_t> skip(colour.size(), 0);
    const SurfaceCells cells = surfaceCells(scene, colour, skip, {});
    ASSERT_GT(cells.count, 20u);
    ASSERT_LT(cells.count, 80u);
    std::vector<size_t> reds(cells.count, 0), all(cells.count, 0);
    for (uint32_t v = 0; v < colour.size(); ++v) {
        ASSERT_LT(cells.cellOf[v], cells.count);
        reds[cells.cellOf[v]] += red(v);
        ++all[cells.cellOf[v]];
    }
    // A cell reaches across the border where it would have to go five times as far inside.
    size_t strays = 0;
    for (uint32_t c = 0; c < cells.count; ++c) strays += std::min(reds[c], all[c] - reds[c]);
    EXPECT_LT(double(strays), 0.02 * double(colour.size()));
    double within = 0, across = 0;
    size_t bordersWithin = 0, bordersAcross = 0;
    for (const CellBorder& b : cells.borders) {
        ASSERT_LT(b.a, b.b);
        const bool same = (2 * reds[b.a] > all[b.a]) == (2 * reds[b.b] > all[b.b]);
        (same ? within : across) += b.alike;
        ++(same ? bordersWithin : bordersAcross);
    }
    EXPECT_GT(within / double(bordersWithin), 4 * across / double(bordersAcross));
}

TEST(SurfaceCells, LeaveOutWhatIsToBeSkipped) {
    const Scene scene = test::sceneOf(test::sheet({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 20, 20));
    std::vector<uint8_t> skip(scene.mesh.vertexCount(), 0);
    for (uint32_t v = 0; v < skip.size(); ++v) skip[v] = scene.mesh.positions[v].y > 0.7f;
    const SurfaceCells cells = surfaceCells(scene, std::vector<Rgb>(skip.size(), Rgb(0)), skip, {});
    for (uint32_t v = 0; v < skip.size(); ++v) EXPECT_EQ(cells.cellOf[v] == noCell, skip[v] != 0);
}

}  // namespace
}  // namespace relamp
