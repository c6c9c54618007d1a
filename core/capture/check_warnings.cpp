#include "capture/check_warnings.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"

namespace relamp {
namespace {

std::string percent(double fraction) { return fmt::format("{:.1f} %", 100 * fraction); }

}  // namespace

void warn(const Capture& capture, CaptureCheck& check) {
    const auto say = [&](const std::string& sentence) { check.warnings.push_back(sentence); };
    // What else there is to say would point at poses and mesh, which may be right.
    if (!check.views.empty() &&
        std::all_of(check.views.begin(), check.views.end(), [](const ViewCheck& v) { return v.maskedFraction >= 1; }))
        return say(
            "No photograph has a pixel that can be used: all are masked, NaN, infinite or negative. Nothing can be "
            "estimated.");
    // Then poses and coverage are wrong for one reason.
    const bool misplaced = check.advice || check.lookBackwards;
    if (check.advice) say(check.advice->words);
    if (check.lookBackwards)
        say("The mesh lies behind most cameras: the matrices seem to use OpenCV axes (+Y down, +Z forward), OpenGL "
            "axes are expected: --flip-cameras.");
    if (!check.upGuess.empty() && check.upGuess != check.up)
        say(
            fmt::format("The cameras' up is nearest to {}, the file says {}: set \"up\" in transforms.json, or --up, "
                        "if the world stands on its side.",
                        check.upGuess, check.up));
    if (check.views.size() < 3)
        say(fmt::format("There are only {} views; light and reflectance are hard to tell apart.", check.views.size()));
    for (const ViewCheck& v : check.views) {
        if (v.meshFraction < 0.02 && !misplaced)
            say(fmt::format("{}: the mesh covers {} of the image; pose, up or scale may be wrong.", v.name,
                            percent(v.meshFraction)));
        if (v.maskedFraction > 0.9)
            say(fmt::format("{}: {} of the pixels are left out.", v.name, percent(v.maskedFraction)));
        if (v.clippedFraction > 0.01)
            say(fmt::format("{}: {} of the pixels are clipped; brackets would recover them.", v.name,
                            percent(v.clippedFraction)));
        if (v.nan + v.infinite > 0) say(fmt::format("{}: {} pixels are NaN or infinite.", v.name, v.nan + v.infinite));
        // Where the vertices disagree among themselves the surface is glossy, and nothing can be said.
        if (!check.advice && v.comparedVertices >= enoughVertices &&
            std::abs(v.exposureStops) > std::max(0.25, v.exposureScatterStops))
            say(
                fmt::format("{}: is {:.2f} stops {} than the other views of the same surface; all views must share one "
                            "exposure scale.",
                            v.name, std::abs(v.exposureStops), v.exposureStops > 0 ? "brighter" : "darker"));
        if (v.maskedFraction < 1 && v.meanRadiance == 0 && !capture.views.empty() &&
            !capture.views[0].image.pixels.empty())
            say(fmt::format("{}: is black all over.", v.name));
    }
    if (check.backdrop)
        say("An object before a masked or black background: none of its light is seen. The light and the brightness "
            "scale are assumed (a mean albedo of 0.5 under white light); "
            "--gauge white-patch or --gauge albedo tells them. The light must stand still while the camera moves: an "
            "object that turns before a fixed camera and light is lit from elsewhere in each photograph.");
    if (check.seenTwiceFraction < 0.3 && !misplaced)
        say(fmt::format("Only {} of the vertices are seen by two views or more.", percent(check.seenTwiceFraction)));
    const MeshReport& m = check.mesh;
    if (m.nanVertices)
        say(fmt::format("The mesh has {} vertices that are not finite; their faces were dropped.", m.nanVertices));
    if (m.badIndexFaces)
        say(fmt::format("The mesh has {} faces that name vertices which do not exist; they were dropped.",
                        m.badIndexFaces));
    if (m.nonManifoldEdges) say(fmt::format("The mesh has {} edges of three or more faces.", m.nonManifoldEdges));
    if (m.boundaryEdges)
        say(fmt::format("The mesh has holes or open rims ({} edges); light can leak in through holes.",
                        m.boundaryEdges));
    if (check.reconstruction && check.reconstruction->observations) {
        const ReconstructionFigures& r = *check.reconstruction;
        if (r.errorPixels > 2)
            say(fmt::format("COLMAP's points miss their pixels by {:.1f} on average; poses or lens model are poor.",
                            r.errorPixels));
        if (r.behind * 100 > r.observations)
            say(fmt::format("{} of COLMAP's observations do not project; the lens model folds back inside the image.",
                            percent(double(r.behind) / double(r.observations))));
    }
    if (const auto& c = check.colours; c && !check.advice && !misplaced) {
        // A few pixels are what automatic cameras are off by, and registration puts right.
        const double width = check.views.empty() ? 0 : double(check.views[0].width);
        if (c->correlation > 0.4 && c->shift > std::max({3.0, 0.005 * width, c->resolution}))
            say(
                fmt::format("The photographs lie {:.1f} pixels from the mesh's own colours (median of {} views; {}: "
                            "{:.1f}): poses, lens or mesh are off by as much.",
                            c->shift, c->views, c->worstView, c->worstShift));
        else if (c->correlation > 0.4 && c->worstShift > std::max({6.0, 0.01 * width, 2 * c->resolution}))
            say(fmt::format("{}: lies {:.1f} pixels from the mesh's own colours, the others {:.1f}; its pose is off.",
                            c->worstView, c->worstShift, c->shift));
    }
    if (check.pointsOnMesh >= 0 && check.pointsOnMesh < 0.3 && !check.advice) {
        std::string sentence =
            fmt::format("Only {} of COLMAP's points lie on the mesh; it seems to come from another run or unit.",
                        percent(check.pointsOnMesh));
        if (check.meshToPoints > 5 || (check.meshToPoints > 0 && check.meshToPoints < 0.2))
            sentence += fmt::format(" It is {:.3g} times as large as their cloud: try --mesh-scale {:.1g}.",
                                    check.meshToPoints, 1 / check.meshToPoints);
        say(sentence);
    }
    const float size = glm::length(check.meshMax - check.meshMin);
    // Nobody holds a camera closer than a few centimetres, or farther than a street, from what is to be relit.
    if (check.reconstruction && check.cameraDistance > 0 && (check.cameraDistance < 0.05 || check.cameraDistance > 100))
        say(
            fmt::format("The cameras stand {:.3g} units from the mesh, and COLMAP does not know metres: if that were "
                        "1.5 m, --scale {:.2g} would set it right.",
                        check.cameraDistance, 1.5 / check.cameraDistance));
    else if (check.unitQuestion) say(check.unitQuestion->words);
    else if ((size > 1000 || size < 0.01f) && !check.advice)
        say(fmt::format("The mesh is {:.3g} m across; lengths are taken to be metres.", size));
}

}  // namespace relamp
