#include "solve/registration/registration_fit.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "base/random.h"
#include "base/statistics.h"
#include "solve/registration/edge_distance.h"
#include "solve/registration/pose_motion.h"

namespace relamp {
namespace {

constexpr size_t mostViews = 10;        ///< that a pair is compared over
constexpr double mostPixels = 6.4e7;    ///< of all blurred photographs together
constexpr float widestKernel = 6;       ///< pixels: photographs are made smaller for more
constexpr float nodeSpacing = 0.0125f;  ///< of the diagonal
constexpr size_t mostBlocks = 16;       ///< of pairs, each with normal equations of its own

}  // namespace

RegistrationFit::RegistrationFit(const Capture& capture, const Scene& scene, const RadianceSamples& samples,
                                 const std::vector<uint8_t>& mirrors)
    : capture_(capture),
      scene_(scene),
      graph_(buildDisplacementGraph(scene, nodeSpacing * scene.diagonal)),
      places_(choosePlaces(capture, scene, samples, mirrors)) {
    unknowns_.moved.assign(graph_.nodes.size(), 0);
    double pixels = 0;
    for (const View& view : capture.views) {
        unknowns_.poses.push_back({view.name, DVec3(0), DVec3(0)});
        cameras_.push_back(view.camera);
        pixels += double(view.image.width) * double(view.image.height);
        stateOfView_.push_back(view.state);
        states_ = std::max(states_, view.state + 1);
    }
    edges_.resize(capture.views.size());
    parallelFor(edges_.size(), 1,
                [&](size_t i) { edges_[i] = edgeDistance(capture.views[i], samples.geometry[i], scene); });
    factor_ = std::max(1, int(std::ceil(std::sqrt(pixels / mostPixels))));
}

float RegistrationFit::width() const {
    int widest = 0;
    for (const View& view : capture_.views) widest = std::max(widest, view.image.width / factor_);
    return float(widest);
}

void RegistrationFit::blur(float sigma, float clear) {
    images_.clear();
    clear_ = std::min(2 * sigma, clear) * float(factor_);
    const int smaller = std::max(1, int(2 * sigma / widestKernel));
    for (const View& view : capture_.views)
        images_.emplace_back(view.image, factor_ * smaller, sigma / float(smaller), places_.dark);
    parallelFor(places_.vertex.size(), 256, [&](size_t place) { project(place); });
    takeMotions();
    observeEverywhere();
}

double RegistrationFit::usualScale() const {
    std::vector<float> sizes;
    for (size_t k = 0; k < places_.pairs.size(); k += 7)
        for (const PairResidual& r : residualsOf(places_.pairs[k])) sizes.push_back(float(std::abs(r.value)));
    return std::max(0.01, 3.0 * double(medianOf(std::move(sizes))));
}

DVec3 RegistrationFit::pointOf(size_t place) const {
    const uint32_t v = places_.vertex[place];
    return DVec3(scene_.mesh.positions[v]) + DVec3(scene_.mesh.normals[v]) * graph_.at(v, unknowns_.moved);
}

void RegistrationFit::project(size_t place) {
    for (uint32_t k = places_.firstObservation[place]; k < places_.firstObservation[place + 1]; ++k) {
        PlaceObservation& o = places_.observations[k];
        o.pixels = pixelsByPoint(cameras_[o.view], pointOf(place)).value_or(std::array<float, 6>{});
    }
}

Eigen::Matrix<double, 2, 6> RegistrationFit::pixelsByPose(size_t place, const PlaceObservation& o) const {
    return relamp::pixelsByPose(cameras_[o.view], pointOf(place), o.pixels, places_.depth[o.view]);
}

void RegistrationFit::takeMotions() {
    motions_.assign(cameras_.size(), PoseMatrix::Zero());
    std::vector<double> counts(cameras_.size(), 0);
    for (size_t place = 0; place < places_.vertex.size(); place += 7)
        for (uint32_t k = places_.firstObservation[place]; k < places_.firstObservation[place + 1]; ++k) {
            const auto moves = pixelsByPose(place, places_.observations[k]);
            motions_[places_.observations[k].view] += moves.transpose() * moves;
            counts[places_.observations[k].view] += 1;
        }
    for (size_t i = 0; i < motions_.size(); ++i) {
        if (counts[i] > 0) motions_[i] /= counts[i];
        motions_[i].diagonal().array() += 1e-9 + (counts[i] > 0 ? 0 : 1);
    }
}

void RegistrationFit::observeEverywhere() {
    parallelFor(places_.vertex.size(), 256, [&](size_t place) { observe(place); });
}

void RegistrationFit::observe(size_t place) {
    const DVec3 normal(scene_.mesh.normals[places_.vertex[place]]);
    for (uint32_t k = places_.firstObservation[place]; k < places_.firstObservation[place + 1]; ++k) {
        PlaceObservation& o = places_.observations[k];
        o.valid = false;
        const Camera& camera = cameras_[o.view];
        const std::optional<Vec2> at = camera.project(pointOf(place));
        if (!at) continue;
        const LogImage::At shown = images_[o.view].at(*at);
        if (!shown.valid) continue;
        const size_t pixel = size_t(at->y) * size_t(capture_.views[o.view].image.width) + size_t(at->x);
        if (float(edges_[o.view][pixel]) < clear_) continue;
        const PoseVector byPose =
            pixelsByPose(place, o).transpose() * Eigen::Vector2d(double(shown.slope.x), double(shown.slope.y));
        for (size_t i = 0; i < 6; ++i) o.byPose[i] = byPose(Eigen::Index(i));
        // The surface moving by n is the camera shifting by -n.
        const DVec3 n = glm::transpose(glm::dmat3(camera.worldFromCamera)) * normal;
        o.byShape = -(byPose(3) * n.x + byPose(4) * n.y + byPose(5) * n.z) / places_.depth[o.view];
        o.value = shown.value;
        o.valid = true;
    }
}

std::vector<PairResidual> RegistrationFit::residualsOf(const PlacePair& pair, bool ofLeftOutViews) const {
    std::vector<PairResidual> all;
    for (uint32_t state = 0; state < states_; ++state) addResiduals(pair, state, ofLeftOutViews, all);
    return all;
}

void RegistrationFit::addResiduals(const PlacePair& pair, uint32_t state, bool ofLeftOutViews,
                                   std::vector<PairResidual>& all) const {
    std::vector<PairResidual> found, measured;
    uint32_t a = places_.firstObservation[pair.from], b = places_.firstObservation[pair.to];
    const uint32_t aEnd = places_.firstObservation[pair.from + 1], bEnd = places_.firstObservation[pair.to + 1];
    while (a < aEnd && b < bEnd) {
        const PlaceObservation &from = places_.observations[a], &to = places_.observations[b];
        if (from.view == to.view && from.valid && to.valid && (states_ == 1 || stateOfView_[from.view] == state))
            (isLeftOut(from.view) ? measured : found)
                .push_back({&from, &to, double(from.value - to.value), double(std::min(from.weight, to.weight))});
        a += from.view <= to.view;
        b += to.view <= from.view;
    }
    if (found.size() < 3) return;
    if (found.size() > mostViews) {
        // Other ones for each pair, so that every view takes part somewhere.
        std::rotate(found.begin(), found.begin() + std::ptrdiff_t(mixBits(pair.from) % found.size()), found.end());
        found.resize(mostViews);
    }
    std::vector<double> values;
    values.reserve(found.size());
    for (const PairResidual& r : found) values.push_back(r.value);
    const double middle = meanMedianOf(std::move(values));
    double sum = 0, weights = 0;
    for (PairResidual& r : found) {
        const double off = (r.value - middle) / scale_;
        r.weight /= 1 + off * off;
        sum += r.weight * r.value;
        weights += r.weight;
    }
    std::vector<PairResidual>& asked = ofLeftOutViews ? measured : found;
    for (PairResidual& r : asked) r.value -= sum / weights;
    all.insert(all.end(), asked.begin(), asked.end());
}

RegistrationFit::Loss RegistrationFit::misfit(bool leftOutRegions, bool leftOutViews) const {
    using Sum = Eigen::Vector2d;
    const Sum none = Sum::Zero();
    const Sum sum = parallelSum<Sum>(places_.pairs.size(), 1024, none, [&](size_t begin, size_t end) {
        Sum part = Sum::Zero();
        for (size_t k = begin; k < end; ++k) {
            if (leftOutRegions && !places_.pairs[k].leftOut) continue;
            for (const PairResidual& r : residualsOf(places_.pairs[k], leftOutViews)) {
                const double off = r.value / scale_;
                part += Sum(scale_ * scale_ * std::log1p(off * off), 1);
            }
        }
        return part;
    });
    return {sum(1) > 0 ? sum(0) / sum(1) : 0, sum(1)};
}

void RegistrationFit::addPriors(const RegistrationPriors& priors, NormalEquations& equations) const {
    for (size_t i = 0; i < cameras_.size(); ++i) {
        PoseVector now;
        for (int k = 0; k < 3; ++k) {
            now(k) = unknowns_.poses[i].turn[k];
            now(3 + k) = unknowns_.poses[i].shift[k] / places_.depth[i];
        }
        // Six unknowns share the motion.
        equations.addPosePrior(i, 6 / (priors.posePixels * priors.posePixels) * motions_[i], -now);
    }
    if (!priors.shape) return;
    const double diagonal = double(scene_.diagonal);
    const double still = 1 / std::pow(priors.displacement * diagonal, 2),
                 stiff = 1 / std::pow(priors.bend * diagonal, 2);
    for (uint32_t n = 0; n < unknowns_.moved.size(); ++n) {
        equations.addNodePrior({{n, 1.0}}, -unknowns_.moved[n], still);
        const std::vector<uint32_t>& near = graph_.neighbours[n];
        if (near.empty()) continue;
        std::vector<std::pair<uint32_t, double>> bend{{n, 1.0}};
        double now = unknowns_.moved[n];
        for (const uint32_t m : near) {
            bend.push_back({m, -1 / double(near.size())});
            now -= unknowns_.moved[m] / double(near.size());
        }
        equations.addNodePrior(bend, -now, stiff);
    }
}

void RegistrationFit::step(const RegistrationPriors& priors, bool all) {
    // As many as fit into 256 MiB: an entry for each node and unknown of the poses.
    const double entries = double(unknowns_.moved.size()) * 6 * double(cameras_.size());
    const size_t blocks = std::clamp(size_t(3.3e7 / std::max(1.0, entries)), size_t(1), mostBlocks);
    std::vector<NormalEquations> parts(blocks, NormalEquations(cameras_.size(), unknowns_.moved.size()));
    parallelFor(blocks, 1, [&](size_t part) {
        const size_t begin = places_.pairs.size() * part / blocks, end = places_.pairs.size() * (part + 1) / blocks;
        for (size_t k = begin; k < end; ++k) {
            const PlacePair& pair = places_.pairs[k];
            if (pair.leftOut && !all) continue;
            // Each state has a mean of its own.
            for (uint32_t state = 0; state < states_; ++state) {
                std::vector<PairResidual> residuals;
                addResiduals(pair, state, false, residuals);
                if (!residuals.empty())
                    parts[part].add(residuals, graph_.shares[places_.vertex[pair.from]],
                                    graph_.shares[places_.vertex[pair.to]]);
            }
        }
    });
    NormalEquations equations = std::move(parts[0]);
    for (size_t part = 1; part < blocks; ++part) equations.add(parts[part]);
    const Loss loss = misfit(false, false);
    if (loss.count < 100) return;
    equations.scale(1 / (std::max(1e-8, loss.value) * priors.repeated));
    addPriors(priors, equations);
    const NormalEquations::Step step = equations.solve(priors.shape);
    if (!step.valid) return;
    for (size_t n = 0; n < unknowns_.moved.size(); ++n) unknowns_.moved[n] += step.nodes(Eigen::Index(n));
    for (size_t i = 0; i < cameras_.size(); ++i) {
        for (int k = 0; k < 3; ++k) {
            unknowns_.poses[i].turn[k] += step.poses(Eigen::Index(6 * i) + k);
            unknowns_.poses[i].shift[k] += step.poses(Eigen::Index(6 * i) + 3 + k) * places_.depth[i];
        }
        cameras_[i] = corrected(capture_.views[i].camera, unknowns_.poses[i]);
    }
    observeEverywhere();
}

void RegistrationFit::set(const Unknowns& unknowns) {
    unknowns_ = unknowns;
    for (size_t i = 0; i < cameras_.size(); ++i) cameras_[i] = corrected(capture_.views[i].camera, unknowns_.poses[i]);
    if (!images_.empty()) observeEverywhere();
}

double RegistrationFit::pixels() const {
    double sum = 0, count = 0;
    for (size_t place = 0; place < places_.vertex.size(); place += 7)
        for (uint32_t k = places_.firstObservation[place]; k < places_.firstObservation[place + 1]; ++k) {
            const size_t view = places_.observations[k].view;
            const DVec3 before(scene_.mesh.positions[places_.vertex[place]]);
            const auto a = capture_.views[view].camera.project(before), b = cameras_[view].project(pointOf(place));
            if (!a || !b) continue;
            sum += double(glm::dot(*b - *a, *b - *a));
            count += 1;
        }
    return count > 0 ? std::sqrt(sum / count) : 0;
}

double RegistrationFit::displacement() const {
    double sum = 0;
    for (const double m : unknowns_.moved) sum += m * m;
    return std::sqrt(sum / double(std::max<size_t>(1, unknowns_.moved.size())));
}

RegistrationFix RegistrationFit::fix(size_t vertices) const {
    RegistrationFix fix;
    fix.poses = unknowns_.poses;
    double most = 0;
    for (const double m : unknowns_.moved) most = std::max(most, std::abs(m));
    if (most == 0) return fix;
    fix.step = float(most / 10000);
    for (uint32_t v = 0; v < vertices; ++v)
        fix.steps.push_back(int(std::lround(graph_.at(v, unknowns_.moved) / double(fix.step))));
    return fix;
}

}  // namespace relamp
