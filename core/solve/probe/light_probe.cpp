#include "solve/probe/light_probe.h"

#include "base/error.h"
#include "base/log.h"
#include "base/parallel.h"
#include "base/statistics.h"
#include "image/environment_map.h"
#include "image/image_io.h"

namespace relamp {
namespace {

constexpr int compareWidth = 256;       // texels of 1.4 degrees, as coarse as the cells of the background
constexpr int patchCells = 8;           // a patch: 8 x 8 cells of side 128, 7 degrees
constexpr double robustLog = 0.25;      // Cauchy scale of log radiance
constexpr float leastCompared = 0.01f;  // of all directions
constexpr float darkest = 0.01f;        // of the mean: where logarithms end

/// The probe's mean over blocks of texels; a block counts where half of it is held.
Image coarseProbe(const LightProbe& probe) {
    const Image& fine = probe.latLong;
    const int factor = std::max(1, fine.width / compareWidth);
    Image coarse(std::max(2, fine.width / factor), std::max(1, fine.height / factor));
    coarse.usable.assign(coarse.pixels.size(), 0);
    parallelFor(size_t(coarse.height), 8, [&](size_t y) {
        for (int x = 0; x < coarse.width; ++x) {
            DVec3 sum(0);
            int held = 0;
            for (int k = 0; k < factor * factor; ++k) {
                const int fx = x * factor + k % factor, fy = int(y) * factor + k / factor;
                if (!fine.usableAt(fx, fy)) continue;
                sum += DVec3(fine.at(fx, fy));
                ++held;
            }
            if (2 * held < factor * factor || held == 0) continue;
            coarse.at(x, int(y)) = Rgb(sum / double(held));
            coarse.usable[y * size_t(coarse.width) + size_t(x)] = 1;
        }
    });
    return coarse;
}

/// A direction in which photographs show the background.
struct SeenDirection {
    float u, y;  // of an image that is not turned: columns from the left in [0, 1), rows from the top
    Rgb radiance;
    uint32_t patch;
    int quarter;  // of the sphere's patches, for the deviation of the yaw
};

/// What photographs show against what the probe holds, for any yaw.
class BackgroundMatch {
public:
    BackgroundMatch(const LightProbe& probe, const RadianceSamples& samples) : image_(coarseProbe(probe)) {
        double light = 0, probed = 0;
        size_t count = 0;
        const DirectionGrid& grid = samples.backgroundGrid;
        const int patches = grid.side / patchCells;
        for (int c = 0; c < grid.cells(); ++c) {
            if (samples.backgroundPixels[size_t(c)] < 4 || samples.backgroundClipped[size_t(c)]) continue;
            const Vec2 uv = latLongFromDirection(grid.direction(c));
            const int px = c % grid.side / patchCells, py = c / grid.side / patchCells;
            seen_.push_back({uv.x, uv.y * float(image_.height) - 0.5f, samples.background[size_t(c)],
                             uint32_t(py * patches + px), (px % 2) + 2 * (py % 2)});
            light += double(luminance(seen_.back().radiance));
        }
        cells_ = grid.cells();
        patchCount_ = size_t(patches) * size_t(patches);
        for (size_t i = 0; i < image_.pixels.size(); ++i)
            if (image_.usable[i]) {
                probed += double(luminance(image_.pixels[i]));
                ++count;
            }
        floorSeen_ = darkest * float(light / double(std::max<size_t>(1, seen_.size())));
        floorProbe_ = darkest * float(probed / double(std::max<size_t>(1, count)));
    }
    bool empty() const { return seen_.empty() || !(floorSeen_ > 0) || !(floorProbe_ > 0); }
    const std::vector<SeenDirection>& seen() const { return seen_; }
    size_t patches() const { return patchCount_; }
    /// Fraction of all directions.
    float fractionOf(size_t count) const { return float(count) / float(cells_); }

    /// The probe where `s` looks when it is turned by `yaw` degrees; false: it holds nothing there.
    bool at(const SeenDirection& s, double yaw, Rgb& radiance) const {
        // Turned counter-clockwise by yaw, what the world shows at azimuth a lay at a - yaw: farther right.
        const double x = (double(s.u) + yaw / 360) * image_.width - 0.5, left = std::floor(x);
        const int x0 = int(left), y0 = int(std::floor(s.y));
        const float fx = float(x - left), fy = s.y - float(y0);
        radiance = Rgb(0);
        for (int k = 0; k < 4; ++k) {
            const int column = ((x0 + k % 2) % image_.width + image_.width) % image_.width,
                      row = std::clamp(y0 + k / 2, 0, image_.height - 1);
            const size_t i = size_t(row) * size_t(image_.width) + size_t(column);
            if (!image_.usable[i]) return false;
            radiance += (k % 2 ? fx : 1 - fx) * (k / 2 ? fy : 1 - fy) * image_.pixels[i];
        }
        return true;
    }
    /// Log of what is seen over what is held.
    Rgb logRatio(const SeenDirection& s, const Rgb& held) const {
        return glm::log((s.radiance + floorSeen_) / (held + floorProbe_));
    }

    /// Robust spread of the log ratios (mean Cauchy loss) about their own robust mean, which is `middle`. `without`: a
    /// quarter that has no say, -1: none.
    double spread(double yaw, int without, DVec3& middle) const {
        std::vector<Rgb> ratios;
        ratios.reserve(seen_.size());
        Rgb held;
        for (const SeenDirection& s : seen_)
            if (s.quarter != without && at(s, yaw, held)) ratios.push_back(logRatio(s, held));
        if (ratios.size() < 16) return 1e300;
        middle = {};
        for (int round = 0; round < 6; ++round) {
            DVec3 sum(0), weights(0);
            for (const Rgb& r : ratios)
                for (int c = 0; c < 3; ++c) {
                    const double d = (r[c] - middle[c]) / (round == 0 ? 1e30 : robustLog), w = 1 / (1 + d * d);
                    sum[c] += w * r[c];
                    weights[c] += w;
                }
            middle = sum / weights;
        }
        double loss = 0;
        for (const Rgb& r : ratios)
            for (int c = 0; c < 3; ++c) loss += std::log1p(std::pow((r[c] - middle[c]) / robustLog, 2));
        return loss / double(3 * ratios.size());
    }
    double spread(double yaw, int without) const {
        DVec3 middle;
        return spread(yaw, without, middle);
    }
    /// The yaw of the least spread within `reach` degrees of `yaw`.
    double refined(double yaw, double reach, int without) const {
        for (double step = reach / 2; step > 0.02; step /= 2) {
            const double here = spread(yaw, without), less = spread(yaw - step, without),
                         more = spread(yaw + step, without);
            if (less < here && less <= more) yaw -= step;
            else if (more < here) yaw += step;
        }
        return yaw;
    }

private:
    Image image_;
    std::vector<SeenDirection> seen_;
    int cells_ = 1;
    size_t patchCount_ = 0;
    float floorSeen_ = 0, floorProbe_ = 0;
};

double degreesApart(double a, double b) { return std::remainder(a - b, 360.0); }

/// The factor between background and probe, from the energy of what is not an outlier.
Rgb gainAt(const BackgroundMatch& match, double yaw, const DVec3& middle) {
    DVec3 seen(0), probed(0);
    Rgb held;
    for (const SeenDirection& s : match.seen()) {
        if (!match.at(s, yaw, held)) continue;
        const DVec3 off = DVec3(match.logRatio(s, held)) - middle;
        for (int c = 0; c < 3; ++c) {
            const double w = 1 / (1 + std::pow(off[c] / robustLog, 2));
            seen[c] += w * s.radiance[c];
            probed[c] += w * held[c];
        }
    }
    Rgb gain(1);
    for (int c = 0; c < 3; ++c) gain[c] = probed[c] > 0 && seen[c] > 0 ? float(seen[c] / probed[c]) : 0.0f;
    return gain;
}

/// Deviation between patches of what is seen and what is held, and the number of patches.
float noiseAt(const BackgroundMatch& match, double yaw, const Rgb& gain, size_t& patches) {
    struct Patch {
        Rgb seen{0}, held{0};
        int cells = 0;
    };
    std::vector<Patch> all(match.patches());
    Rgb held;
    double mean = 0;
    for (const SeenDirection& s : match.seen()) {
        if (!match.at(s, yaw, held)) continue;
        Patch& p = all[s.patch];
        p.seen += s.radiance;
        p.held += gain * held;
        mean += double(luminance(s.radiance));
        ++p.cells;
    }
    size_t cells = 0;
    for (const Patch& p : all) cells += size_t(p.cells);
    const float dark = darkest * float(mean / double(std::max<size_t>(1, cells)));
    std::vector<float> off;
    for (const Patch& p : all) {
        if (2 * p.cells < patchCells * patchCells) continue;
        const Rgb ratio = glm::log((p.seen + dark * float(p.cells)) / (p.held + dark * float(p.cells)));
        for (int c = 0; c < 3; ++c) off.push_back(std::abs(ratio[c]));
    }
    patches = off.size() / 3;
    constexpr float deviationOfMedian = 1.4826f;
    return deviationOfMedian * medianOf(std::move(off));
}

}  // namespace

LightProbe readLightProbe(const std::filesystem::path& file) {
    LightProbe probe;
    probe.name = file.filename().string();
    ImageReport report;
    probe.latLong = readImage(file, &report);
    Image& image = probe.latLong;
    if (std::abs(double(image.width) / image.height - 2) > 0.02 || image.width < 16)
        throw Error("{}: is {} x {} pixels, expected a latitude-longitude image twice as wide as high, 16 x 8 at least",
                    file.string(), image.width, image.height);
    // Alpha says nothing of a light probe unless it hides something.
    const size_t bad = report.nan + report.infinite;
    if (bad * 10 > image.pixels.size())
        throw Error("{}: {:.0f} % of its texels are not finite numbers, expected a tenth at most", file.string(),
                    100.0 * double(bad) / double(image.pixels.size()));
    float brightest = 0;
    for (size_t i = 0; i < image.pixels.size(); ++i)
        if (image.usable.empty() || image.usable[i]) brightest = std::max(brightest, maxChannel(image.pixels[i]));
    if (!(brightest > 0)) throw Error("{}: holds no light: every texel is black or left out", file.string());
    if (const size_t clipped = leaveOutClipped(image))
        logWarning("{}: {:.1f} % of its texels are clipped, so it says nothing in their directions", probe.name,
                   100.0 * double(clipped) / double(image.pixels.size()));
    return probe;
}

size_t leaveOutClipped(Image& image) {
    constexpr float sameLevel = 0.999f, farAbove = 2;
    constexpr size_t leastTexels = 8, mostParts = 4;  // more than a quarter of the image is a pattern
    const size_t count = image.pixels.size();
    std::vector<uint8_t> clipped(count, 0);
    for (int c = 0; c < 3; ++c) {
        float most = 0;
        std::vector<float> values;
        for (size_t i = 0; i < count; ++i)
            if (image.usable.empty() || image.usable[i]) {
                values.push_back(image.pixels[i][c]);
                most = std::max(most, values.back());
            }
        const auto atTop =
            size_t(std::count_if(values.begin(), values.end(), [&](float v) { return v >= sameLevel * most; }));
        if (atTop < leastTexels || atTop * mostParts > count || !(most > farAbove * medianOf(std::move(values))))
            continue;
        for (size_t i = 0; i < count; ++i)
            if ((image.usable.empty() || image.usable[i]) && image.pixels[i][c] >= sameLevel * most) clipped[i] = 1;
    }
    const auto found = size_t(std::count(clipped.begin(), clipped.end(), 1));
    if (found == 0) return 0;
    if (image.usable.empty()) image.usable.assign(count, 1);
    for (size_t i = 0; i < count; ++i)
        if (clipped[i]) image.usable[i] = 0;
    return found;
}

ProbeFit fitToBackground(const LightProbe& probe, const RadianceSamples& samples) {
    ProbeFit fit;
    fit.name = probe.name;
    const Image& image = probe.latLong;
    double held = 0, all = 0;
    for (int y = 0; y < image.height; ++y) {
        const double area = std::cos(piD * (0.5 - (y + 0.5) / image.height));
        for (int x = 0; x < image.width; ++x) {
            all += area;
            if (image.usableAt(x, y)) held += area;
        }
    }
    fit.held = float(held / all);
    if (probe.aligned) {
        fit.by = "camera";
        fit.noise = fit.measuredNoise = ProbeFit::unknownNoise;
    }
    const BackgroundMatch match(probe, samples);
    if (match.empty()) return fit;

    double yaw = 0, best = 1e300;
    std::vector<double> spreads(probe.aligned ? 1 : 360);
    parallelFor(spreads.size(), 8, [&](size_t k) { spreads[k] = match.spread(double(k), -1); });
    for (size_t k = 0; k < spreads.size(); ++k)
        if (spreads[k] < best) {
            best = spreads[k];
            yaw = double(k);
        }
    if (!(best < 1e300)) return fit;
    if (!probe.aligned) {
        yaw = match.refined(yaw, 1, -1);
        double squares = 0;
        for (int quarter = 0; quarter < 4; ++quarter)
            squares += std::pow(degreesApart(match.refined(yaw, 2, quarter), yaw), 2);
        fit.yawSigma = float(std::max(0.02, std::sqrt(0.75 * squares)));
    }
    DVec3 middle;
    match.spread(yaw, -1, middle);
    const Rgb gain = gainAt(match, yaw, middle);
    size_t compared = 0, patches = 0;
    Rgb ignored;
    for (const SeenDirection& s : match.seen()) compared += match.at(s, yaw, ignored);
    fit.compared = match.fractionOf(compared);
    if (fit.compared < leastCompared || !(std::min({gain.x, gain.y, gain.z}) > 0)) return fit;
    const float noise = noiseAt(match, yaw, gain, patches);
    if (patches < 4) return fit;
    fit.by = "background";
    fit.yawDegrees = float(std::remainder(yaw, 360.0));
    fit.gain = gain;
    fit.noise = fit.measuredNoise = std::max(noise, ProbeFit::leastNoise);
    fit.gainSigma = std::max(0.01f, fit.noise / std::sqrt(float(patches)));
    return fit;
}

FittedProbe fittedProbe(const LightProbe& probe, const ProbeFit& fit, const Mat3& axes) {
    FittedProbe fitted;
    fitted.fit = fit;
    fitted.grid.axes = axes;
    // Upright cells are found many times faster than turned ones.
    const DirectionGrid upright{FittedProbe::side};
    const auto onGrid = [&](const Image& latLong) {
        std::vector<Rgb> cells = integrateOverCells(yawed(latLong, fit.yawDegrees), upright);
        return axes == Mat3(1) ? cells : turnedCells(cells, upright, fitted.grid, 4);
    };
    fitted.radiance = onGrid(probe.latLong);
    for (Rgb& r : fitted.radiance) r = glm::max(r, Rgb(0)) * fit.gain;
    fitted.held.assign(fitted.radiance.size(), 1);
    if (probe.latLong.usable.empty()) return fitted;
    Image covered(probe.latLong.width, probe.latLong.height);
    for (size_t i = 0; i < covered.pixels.size(); ++i) covered.pixels[i] = Rgb(probe.latLong.usable[i] ? 1.0f : 0.0f);
    const std::vector<Rgb> coverage = onGrid(covered);
    for (size_t c = 0; c < coverage.size(); ++c) fitted.held[c] = coverage[c].x > 0.98f;
    return fitted;
}

ProbeAnchor probeAnchor(const FittedProbe& probe, const LightLeaves& leaves, size_t environment) {
    ProbeAnchor anchor{std::vector<Rgb>(leaves.size(), Rgb(0)), std::vector<float>(leaves.size(), 0), probe.fit.noise,
                       probe.fit.gainSigma};
    const std::vector<uint32_t> leafOf = leaves.leafOfCells(probe.grid, environment);
    std::vector<DVec3> sum(leaves.size(), DVec3(0));
    std::vector<uint32_t> cells(leaves.size(), 0), held(leaves.size(), 0);
    for (size_t c = 0; c < leafOf.size(); ++c) {
        ++cells[leafOf[c]];
        if (!probe.held[c]) continue;
        ++held[leafOf[c]];
        sum[leafOf[c]] += DVec3(probe.radiance[c]);
    }
    for (size_t i = 0; i < leaves.size(); ++i) {
        if (held[i] == 0) continue;
        anchor.radiance[i] = Rgb(sum[i] / double(held[i]));
        anchor.held[i] = float(held[i]) / float(cells[i]);
    }
    return anchor;
}

Rgb detailOf(const FittedProbes& probes, const LightAnchors& anchors, size_t cell, uint32_t leaf) {
    for (size_t p = 0; p < probes.size(); ++p) {
        if (probes[p]->fit.doubtful() || anchors.probes[p].held[leaf] < 1 || !probes[p]->held[cell]) continue;
        const Rgb mean = anchors.probes[p].radiance[leaf];
        Rgb detail(1);
        for (int c = 0; c < 3; ++c)
            if (mean[c] > 0) detail[c] = probes[p]->radiance[cell][c] / mean[c];
        return detail;
    }
    return Rgb(1);
}

void shapeByProbes(const FittedProbes& probes, const LightAnchors& anchors, const DirectionGrid& grid,
                   const std::vector<uint32_t>& leafOf, std::vector<float>& shape) {
    const int parts = FittedProbe::side / grid.side;
    std::vector<float> details(shape.size(), 1), most(anchors.leaves.size(), 0);
    for (size_t cell = 0; cell < shape.size(); ++cell) {
        const uint32_t leaf = leafOf[cell];
        double detail = 0;
        for (int k = 0; k < parts * parts; ++k) {
            const size_t x = cell % size_t(grid.side) * size_t(parts) + size_t(k % parts),
                         y = cell / size_t(grid.side) * size_t(parts) + size_t(k / parts);
            detail += double(luminance(detailOf(probes, anchors, y * FittedProbe::side + x, leaf)));
        }
        details[cell] = float(detail / (parts * parts));
        most[leaf] = std::max(most[leaf], details[cell]);
    }
    // Lobes meet cells by chance: one that is much brighter than its leaf would be noise in their rows.
    constexpr float mostContrast = 3;
    for (size_t cell = 0; cell < shape.size(); ++cell)
        if (const uint32_t leaf = leafOf[cell]; anchors.leaves[leaf].coverage < 0.95f && most[leaf] <= mostContrast)
            shape[cell] = details[cell];
}

void judge(ProbeFit& fit) {
    fit.used = !fit.by.empty() && fit.noise <= ProbeFit::mostNoise;
    if (fit.by.empty()) {
        fit.words = fmt::format(
            "{}: photographs show too little background to tell how it is turned and exposed; it was left out",
            fit.name);
        return;
    }
    const std::string gain = fmt::format("exposure {:.3g} {:.3g} {:.3g} times", fit.gain.x, fit.gain.y, fit.gain.z),
                      found = fit.yawSigma > 0 ? fmt::format("turned by {:.1f} +- {:.1f} degrees, {}", fit.yawDegrees,
                                                             fit.yawSigma, gain)
                                               : gain;
    if (!fit.used)
        fit.words = fmt::format(
            "{}: does not show the light of these photographs: {}, it differs from the {} by "
            "{:.0f} %; it was left out",
            fit.name, found, fit.contradicted ? "light that the shading asks for" : "background that they show",
            100 * fit.noise);
    else if (fit.by == "camera")
        fit.words = fmt::format("{}: no background shows how it was exposed, so it tells nothing of the scale{}",
                                fit.name, fit.contradicted ? "; the shading of the surfaces contradicts it" : "");
    else
        fit.words = fmt::format("{}: {}, agrees with the background of the photographs within {:.0f} %{}", fit.name,
                                found, 100 * fit.measuredNoise,
                                fit.contradicted ? fmt::format("; the shading of the surfaces contradicts it, so it "
                                                               "counts as known to {:.0f} %",
                                                               100 * fit.noise)
                                : fit.doubtful() ? "; that is much for a light probe, so it has little weight"
                                                 : "");
}

}  // namespace relamp
