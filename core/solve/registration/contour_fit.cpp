#include "solve/registration/contour_fit.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/statistics.h"
#include "solve/registration/normal_equations.h"
#include "solve/registration/pose_motion.h"

namespace relamp {
namespace {

constexpr float contourSpacing = 0.004f;        ///< of the nodes, of the diagonal
constexpr double contourDisplacement = 0.0005;  ///< of the diagonal, at least: standard deviation of a node
constexpr double contourOfMedian = 0.5;         ///< of the median that outlines are off by: the same
constexpr double contourBend = 0.5;             ///< of that: of a node from the mean of its neighbours
constexpr double contourSigma = 0.3;            ///< pixels: of an outline's place
constexpr double contourRepeated = 4;           ///< points that tell as much as an independent one
constexpr int contourRounds = 3;

class ContourFit {
public:
    ContourFit(const Capture& capture, const Scene& scene, const RegistrationFix& start, size_t vertices,
               const std::vector<uint8_t>& emits, float floor, Progress& progress)
        : capture_(capture),
          scene_(scene),
          start_(scene.mesh),
          graph_(buildDisplacementGraph(scene, contourSpacing * scene.diagonal)),
          vertices_(vertices),
          emits_(emits),
          floor_(floor),
          progress_(progress) {
        moved_.assign(scene.mesh.vertexCount(), 0);
        const std::vector<Vec3> before = vertexNormalsFromFaces(start_);
        for (size_t v = 0; v < start.steps.size(); ++v)
            start_.positions[v] += start_.normals[v] * (start.step * float(start.steps[v]));
        turnNormals(before, start.steps.size(), start_);
        for (size_t i = 0; i < capture.views.size(); ++i)
            cameras_.push_back(start.poses.empty() ? capture.views[i].camera
                                                   : corrected(capture.views[i].camera, start.poses[i]));
        place();
        displacement_ = std::max(contourDisplacement * double(scene.diagonal), contourOfMedian * medianDisplacement());
    }

    void leaveOutViews(bool leaveOut) { viewsLeftOut_ = leaveOut; }
    size_t points() const { return points_.size(); }
    size_t pointsWithin(float pixels) const {
        return size_t(std::count_if(points_.begin(), points_.end(),
                                    [&](const ContourPoint& p) { return std::abs(p.offset) <= pixels; }));
    }
    double medianOff(bool ofLeftOutViews) const {
        std::vector<float> off;
        for (const ContourPoint& p : points_)
            if (!ofLeftOutViews || isLeftOut(p.view)) off.push_back(std::abs(p.offset));
        return double(medianOf(std::move(off)));
    }

    void run() {
        for (int k = 0; k < contourRounds && !progress_.outOfTime(); ++k) {
            step();
            place();
            progress_.advance();
        }
    }

    /// `start` with displacements of the first `vertices` vertices for their outlines.
    RegistrationFix fix(RegistrationFix start) const {
        double most = 0;
        for (size_t v = 0; v < vertices_; ++v) most = std::max(most, std::abs(moved_[v]));
        if (most == 0) return start;
        start.outlineStep = float(most / 10000);
        for (size_t v = 0; v < vertices_; ++v)
            start.outlineSteps.push_back(int(std::lround(moved_[v] / double(start.outlineStep))));
        return start;
    }

private:
    bool isLeftOut(size_t view) const { return viewsLeftOut_ && view % 4 == 3; }

    bool isStill(uint32_t v) const { return !emits_.empty() && emits_[v]; }

    /// Mesh and outlines as things stand.
    void place() {
        mesh_ = start_;
        const std::vector<Vec3> before = vertexNormalsFromFaces(mesh_);
        for (size_t v = 0; v < vertices_; ++v) mesh_.positions[v] += scene_.mesh.normals[v] * float(moved_[v]);
        turnNormals(before, vertices_, mesh_);
        const RayTracer tracer(mesh_, scene_.diagonal, RayTracer::For::cameras);
        points_ = findContours(capture_.views, cameras_, mesh_, tracer, floor_, progress_);
        std::erase_if(points_, [&](const ContourPoint& p) { return isStill(p.vertex[0]) || isStill(p.vertex[1]); });
    }

    void step() {
        NormalEquations equations(0, graph_.nodes.size());
        const double scale = std::max(2 * contourSigma, 1.5 * medianOff(false));
        for (const ContourPoint& p : points_) {
            if (isLeftOut(p.view)) continue;
            const std::optional<double> outwards = pixelsByDisplacement(p);
            if (!outwards) continue;
            const double off = double(p.offset) / scale;
            equations.addNodePrior(meanOf(p, *outwards), double(p.offset),
                                   1 / ((1 + off * off) * contourSigma * contourSigma * contourRepeated));
        }
        for (uint32_t n = 0; n < graph_.nodes.size(); ++n) {
            equations.addNodePrior({{n, 1.0}}, 0, 1 / (displacement_ * displacement_));
            std::vector<std::pair<uint32_t, double>> row{{n, 1.0}};
            for (const uint32_t m : graph_.neighbours[n]) row.push_back({m, -1 / double(graph_.neighbours[n].size())});
            if (row.size() > 1) equations.addNodePrior(row, 0, 1 / std::pow(contourBend * displacement_, 2));
        }
        const NormalEquations::Step found = equations.solve(true);
        if (!found.valid) return;
        const std::vector<double> nodes(found.nodes.begin(), found.nodes.end());
        for (uint32_t v = 0; v < vertices_; ++v)
            if (!isStill(v)) moved_[v] += graph_.at(v, nodes);
    }

    /// Pixels that the outline goes outwards by a metre of displacement.
    std::optional<double> pixelsByDisplacement(const ContourPoint& p) const {
        const Camera& camera = cameras_[p.view];
        const std::optional<std::array<float, 6>> moves = pixelsByPoint(camera, pointOf(p));
        if (!moves) return {};
        const DVec3 normal = 0.5 * DVec3(scene_.mesh.normals[p.vertex[0]] + scene_.mesh.normals[p.vertex[1]]);
        const Vec3 n(glm::transpose(glm::dmat3(camera.worldFromCamera)) * normal);
        const Vec2 pixels((*moves)[0] * n.x + (*moves)[1] * n.y + (*moves)[2] * n.z,
                          (*moves)[3] * n.x + (*moves)[4] * n.y + (*moves)[5] * n.z);
        return double(glm::dot(p.outward, pixels));
    }

    /// Metres along the normal, of what outlines are off by.
    double medianDisplacement() const {
        std::vector<float> metres;
        for (const ContourPoint& p : points_)
            if (const std::optional<double> outwards = pixelsByDisplacement(p); outwards && *outwards > 0)
                metres.push_back(std::abs(p.offset) / float(*outwards));
        return metres.empty() ? 0 : double(medianOf(std::move(metres)));
    }

    /// `factor` times the mean displacement of the point's two vertices, by that of the nodes.
    std::vector<std::pair<uint32_t, double>> meanOf(const ContourPoint& p, double factor) const {
        std::vector<std::pair<uint32_t, double>> row;
        for (const uint32_t v : p.vertex)
            for (size_t k = 0; k < 4; ++k) {
                const auto [node, weight] = std::pair(graph_.shares[v].node[k], double(graph_.shares[v].weight[k]));
                if (weight == 0) continue;
                const auto at = std::find_if(row.begin(), row.end(), [&](const auto& r) { return r.first == node; });
                if (at == row.end()) row.push_back({node, 0.5 * factor * weight});
                else at->second += 0.5 * factor * weight;
            }
        return row;
    }

    DVec3 pointOf(const ContourPoint& p) const {
        return 0.5 * (DVec3(mesh_.positions[p.vertex[0]]) + DVec3(mesh_.positions[p.vertex[1]]));
    }

    const Capture& capture_;
    const Scene& scene_;
    Mesh start_;  ///< after what the fit starts from
    const DisplacementGraph graph_;
    size_t vertices_;
    const std::vector<uint8_t>& emits_;
    float floor_;
    Progress& progress_;
    bool viewsLeftOut_ = false;
    double displacement_ = 0;    ///< metres: standard deviation of a node
    std::vector<double> moved_;  ///< of each vertex since then, metres along its normal in the file
    std::vector<Camera> cameras_;
    Mesh mesh_;
    std::vector<ContourPoint> points_;
};

}  // namespace

std::string toText(const ContourEstimate& e) {
    return fmt::format("outlines of the mesh lie {:.2f} pixels from the photographs' ({:.2f} before)", e.after,
                       e.before);
}

ContourEstimate alignContours(const Capture& capture, const Scene& scene, const RegistrationFix& start, size_t vertices,
                              const std::vector<uint8_t>& emits, float floor, Progress& progress, double most) {
    ContourEstimate found;
    found.most = most;
    ContourFit fit(capture, scene, start, vertices, emits, floor, progress);
    found.points = fit.points();
    fit.leaveOutViews(true);
    found.before = found.after = fit.medianOff(true);
    if (found.points < leastPoints || !(found.before > closeEnough)) return found;
    progress.begin("Outlines of the mesh brought to the photographs'", 2 * contourRounds);
    fit.run();
    found.after = fit.medianOff(true);
    if (!found.needed()) return found;
    fit.leaveOutViews(false);
    fit.run();
    found.fix = fit.fix(start);
    return found;
}

size_t outlinesInPlace(const Capture& capture, const Scene& scene, const RegistrationFix& fix, float floor,
                       Progress& progress) {
    constexpr float inPlace = 1;  // pixels
    return ContourFit(capture, scene, fix, 0, {}, floor, progress).pointsWithin(inPlace);
}

}  // namespace relamp
