#include "viewport/scene_extent.h"

#include "base/statistics.h"

namespace relamp::ui {

SceneExtent extentOf(const Mesh& mesh) {
    SceneExtent extent;
    std::vector<uint8_t> used(mesh.vertexCount(), 0);
    for (const Triangle& t : mesh.triangles)
        for (uint32_t v : t) used[v] = 1;
    Vec3 low(0), high(0), lowest(0), highest(0);
    for (int axis = 0; axis < 3; ++axis) {
        std::vector<float> values;
        values.reserve(mesh.vertexCount());
        for (size_t v = 0; v < mesh.vertexCount(); ++v)
            if (used[v] && isFinite(mesh.positions[v])) values.push_back(mesh.positions[v][axis]);
        if (values.empty()) return extent;
        low[axis] = selectQuantile(values, 0.01), high[axis] = selectQuantile(values, 0.99);
        const auto [least, most] = std::minmax_element(values.begin(), values.end());
        lowest[axis] = *least, highest[axis] = *most;
    }
    extent.low = low, extent.high = high;
    extent.centre = 0.5f * (low + high);
    extent.radius = std::max(0.5f * glm::length(high - low), 1e-4f);
    extent.wholeCentre = 0.5f * (lowest + highest);
    extent.wholeRadius = std::max(0.5f * glm::length(highest - lowest), 1e-4f);
    extent.ground = std::abs(low.z) < 0.004f * extent.radius ? 0.0f : low.z;
    return extent;
}

float roundStep(float value) {
    const float decade = std::pow(10.0f, std::floor(std::log10(std::max(value, 1e-12f))));
    for (float factor : {1.0f, 2.0f, 5.0f})
        if (value <= factor * decade * 1.0001f) return factor * decade;
    return 10 * decade;
}

}  // namespace relamp::ui
