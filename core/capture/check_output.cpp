// The check as JSON for scripts and as text for people.
#include <nlohmann/json.hpp>

#include "base/printable.h"
#include "capture/check.h"

namespace relamp {

nlohmann::json toJson(const CaptureCheck& check) {
    using nlohmann::json;
    json views = json::array();
    for (const ViewCheck& v : check.views)
        views.push_back({{"name", v.name},
                         {"width", v.width},
                         {"height", v.height},
                         {"mesh_fraction", v.meshFraction},
                         {"light_fraction_of_background", v.lightFraction},
                         {"clipped_fraction", v.clippedFraction},
                         {"masked_fraction", v.maskedFraction},
                         {"nan", v.nan},
                         {"infinite", v.infinite},
                         {"negative", v.negative},
                         {"mean_radiance", v.meanRadiance},
                         {"vertices_inside", v.verticesInside},
                         {"exposure_stops", v.exposureStops},
                         {"exposure_scatter_stops", v.exposureScatterStops},
                         {"compared_vertices", v.comparedVertices}});
    const MeshReport& m = check.mesh;
    const auto point = [&](const Vec3& from) {
        const DVec3 p = check.origin + DVec3(from);
        return json::array({p.x, p.y, p.z});
    };
    json result = {{"format", check.format},
                   {"views", views},
                   {"mesh",
                    {{"vertices", m.vertices},
                     {"triangles", m.triangles},
                     {"nan_vertices", m.nanVertices},
                     {"bad_index_faces", m.badIndexFaces},
                     {"degenerate_faces", m.degenerateFaces},
                     {"duplicate_faces", m.duplicateFaces},
                     {"polygons", m.polygons},
                     {"unreferenced_vertices", m.unreferencedVertices},
                     {"non_manifold_edges", m.nonManifoldEdges},
                     {"boundary_edges", m.boundaryEdges},
                     {"normals_from_file", m.normalsFromFile},
                     {"min", point(check.meshMin)},
                     {"max", point(check.meshMax)}}},
                   {"coverage",
                    {{"seen_fraction", check.seenFraction},
                     {"backdrop", check.backdrop},
                     {"seen_twice_fraction", check.seenTwiceFraction},
                     {"views_per_vertex", check.meanViewsPerVertex}}},
                   {"exposure_spread_stops", check.exposureSpreadStops},
                   {"axes",
                    {{"up", check.up},
                     {"up_guess", check.upGuess},
                     {"up_agreement", check.upAgreement},
                     {"look_backwards", check.lookBackwards}}},
                   {"notes", check.notes},
                   {"warnings", check.warnings}};
    if (check.advice) result["advice"] = {{"words", check.advice->words}, {"option", check.advice->option}};
    // The names of version 1, for scripts.
    for (json& v : result["views"])
        for (const char* what : {"mesh", "clipped", "masked"})
            v[fmt::format("{}_share", what)] = v[fmt::format("{}_fraction", what)];
    for (json& v : result["views"]) v["light_share_of_background"] = v["light_fraction_of_background"];
    for (const char* what : {"seen", "seen_twice"})
        result["coverage"][fmt::format("{}_share", what)] = result["coverage"][fmt::format("{}_fraction", what)];
    for (const auto& [name, count] : check.states) result["states"].push_back({{"name", name}, {"views", count}});
    for (size_t s = 0; s < check.environments.size(); ++s) result["states"][s]["environment"] = check.environments[s];
    result["camera_distance"] = check.cameraDistance;
    if (const auto& c = check.colours)
        result["mesh_colours"] = {{"images", c->images},           {"views", c->views},
                                  {"correlation", c->correlation}, {"shift", c->shift},
                                  {"worst_shift", c->worstShift},  {"worst_view", c->worstView},
                                  {"resolution", c->resolution}};
    if (const auto& r = check.reconstruction)
        result["reconstruction"] = {{"points", r->points},
                                    {"observations", r->observations},
                                    {"reprojection_error", r->errorPixels},
                                    {"stated_error", r->statedErrorPixels},
                                    {"behind", r->behind},
                                    {"points_on_mesh", check.pointsOnMesh},
                                    {"mesh_to_points", check.meshToPoints}};
    return result;
}

std::string toText(const CaptureCheck& check) {
    size_t longest = 4;
    for (const ViewCheck& v : check.views) longest = std::max(longest, std::min<size_t>(v.name.size(), 40));
    std::string text = check.format.empty() ? "" : fmt::format("cameras: {}\n\n", check.format);
    text += fmt::format("{:<{}}  {:>11}  {:>7}  {:>7}  {:>7}  {:>9}  {:>7}  {:>6}\n", "view", longest, "size", "mesh",
                        "clipped", "masked", "mean", "inside", "stops");
    for (const ViewCheck& v : check.views)
        text += fmt::format("{:<{}}  {:>11}  {:>6.1f}%  {:>6.2f}%  {:>6.1f}%  {:>9.4g}  {:>6.1f}%  {:>+6.2f}\n", v.name,
                            longest, fmt::format("{} x {}", v.width, v.height), 100 * v.meshFraction,
                            100 * v.clippedFraction, 100 * v.maskedFraction, v.meanRadiance, 100 * v.verticesInside,
                            v.exposureStops);
    for (size_t s = 0; s < check.states.size(); ++s)
        text += fmt::format("lighting state {}: {} views{}\n", printable(check.states[s].first), check.states[s].second,
                            s < check.environments.size() ? ", environment: " + printable(check.environments[s]) : "");
    const MeshReport& m = check.mesh;
    const Vec3 size = check.meshMax - check.meshMin;
    text += fmt::format("\nmesh: {} vertices, {} triangles, {:.3g} x {:.3g} x {:.3g} m\n", m.vertices, m.triangles,
                        size.x, size.y, size.z);
    const struct {
        size_t count;
        const char* what;
    } defects[] = {{m.nanVertices, "vertices not finite"},
                   {m.badIndexFaces, "faces with a bad index, dropped"},
                   {m.degenerateFaces, "faces without area, dropped"},
                   {m.duplicateFaces, "duplicate faces, dropped"},
                   {m.polygons, "polygons cut into triangles"},
                   {m.unreferencedVertices, "vertices without a face"},
                   {m.nonManifoldEdges, "non-manifold edges"},
                   {m.boundaryEdges, "edges of holes or rims"}};
    for (const auto& defect : defects)
        if (defect.count) text += fmt::format("  {} {}\n", defect.count, defect.what);
    text += fmt::format("coverage: {:.1f} % of the vertices seen, {:.1f} % twice or more, {:.2f} views each\n",
                        100 * check.seenFraction, 100 * check.seenTwiceFraction, check.meanViewsPerVertex);
    text += fmt::format("exposure: {:.2f} stops between the views\n", check.exposureSpreadStops);
    if (const auto& r = check.reconstruction)
        text += fmt::format(
            "reconstruction: {} points, {} observations, reprojection error {:.4f} pixels (the model says {:.4f}), "
            "{:.1f} % of the points on the mesh\n",
            r->points, r->observations, r->errorPixels, r->statedErrorPixels, 100 * std::max(0.0, check.pointsOnMesh));
    if (const auto& c = check.colours)
        text += fmt::format(
            "the mesh's own colours{}: photographs lie {:.2f} pixels off (median of {} views; worst {:.2f}, {}), "
            "correlation {:.2f} at {:.1f} pixels\n",
            c->images ? fmt::format(" ({} {})", c->images, c->images == 1 ? "image" : "images") : "", c->shift,
            c->views, c->worstShift, c->worstView, c->correlation, c->resolution);
    text += fmt::format("axes: up is {}, the cameras say {}\n", check.up,
                        check.upGuess.empty() ? "nothing" : check.upGuess);
    for (const std::string& note : check.notes) text += fmt::format("note: {}\n", note);
    for (const std::string& warning : check.warnings) text += fmt::format("warning: {}\n", warning);
    return text;
}

}  // namespace relamp
