// Light references in a solve: patches of known albedo, and light probes under the light found.
#include <map>

#include "base/log.h"
#include "solve/light/weighted_gram.h"
#include "solve/steps/steps.h"

namespace relamp {
namespace {

constexpr int patchParts = 3;       // a side, of a patch that is not small
constexpr float smallPatch = 6;     // pixels
constexpr int partPixels = 12;      // a side, looked at in a patch at most
constexpr float patchCount = 1000;  // observations that a patch counts for: model errors must not outvote it
constexpr float patchDoubt = 3;     // deviations
constexpr float leastDoubt = 0.05f;
constexpr float leastDeviationOfPart = 0.02f;  // of the light on it, which is coarse while patches are asked

/// A part of a patch: where its pixels lie on the mesh, and what they show.
struct PatchPart {
    size_t patch = 0;
    std::map<uint32_t, float> vertices;  ///< with their weight in the mean
    Rgb radiance{0};                     ///< mean
};

std::vector<PatchPart> partsOf(const SolveInput& in, size_t index) {
    const KnownPatch& patch = in.options.patches[index];
    const View& view = in.capture.views[patch.view];
    const int side = patch.radius < smallPatch ? 1 : patchParts,
              steps = std::clamp(int(2 * patch.radius), 1, partPixels);
    std::vector<PatchPart> parts(size_t(side * side));
    std::vector<float> count(parts.size(), 0);
    for (int k = 0; k < steps * steps; ++k) {
        const Vec2 at = (Vec2(k % steps, k / steps) + 0.5f) / float(steps) * 2.0f - 1.0f;
        if (glm::length(at) > 1) continue;
        const Vec2 pixel = patch.centre + patch.radius * at;
        const int x = int(std::floor(pixel.x)), y = int(std::floor(pixel.y));
        if (x < 0 || y < 0 || x >= view.image.width || y >= view.image.height || !view.image.usableAt(x, y)) continue;
        const Rgb shown = view.image.at(x, y);
        if (view.saturation > 0 && maxChannel(shown) >= view.saturation) continue;
        const Hit hit = in.scene.cameraTracer->closest(
            {Vec3(view.camera.position()), view.camera.rayDirection(Vec2(x, y) + 0.5f), 0, 1e30f});
        if (!hit) continue;
        const auto cell = [&](float t) { return std::min(side - 1, int((t + 1) / 2 * float(side))); };
        const size_t p = size_t(cell(at.y) * side + cell(at.x));
        const Triangle& t = in.scene.mesh.triangles[hit.triangle];
        parts[p].vertices[t[0]] += 1 - hit.barycentric.x - hit.barycentric.y;
        parts[p].vertices[t[1]] += hit.barycentric.x;
        parts[p].vertices[t[2]] += hit.barycentric.y;
        parts[p].radiance += shown;
        ++count[p];
    }
    std::vector<PatchPart> found;
    for (size_t p = 0; p < parts.size(); ++p) {
        if (count[p] == 0) continue;
        parts[p].patch = index;
        parts[p].radiance /= count[p];
        for (auto& [vertex, weight] : parts[p].vertices) weight /= count[p];
        found.push_back(std::move(parts[p]));
    }
    if (found.empty())
        throw Error("{}: at pixel {:.0f},{:.0f} of view {} no surface of the mesh is seen unclipped", patch.name,
                    patch.centre.x, patch.centre.y, patch.view);
    return found;
}

/// The unknowns of channel c.
Eigen::VectorXd unknownsOf(const Lighting& lighting, int c) {
    const size_t leaves = lighting.leafRadiance.size();
    Eigen::VectorXd x(Eigen::Index(leaves + lighting.emitterRadiance.size()));
    for (size_t i = 0; i < leaves; ++i) x(Eigen::Index(i)) = lighting.leafRadiance[i][c];
    for (size_t e = 0; e < lighting.emitterRadiance.size(); ++e)
        x(Eigen::Index(leaves + e)) = lighting.emitterRadiance[e][c];
    return x;
}

/// The parts of patches with the rows of the light on them; `used`: which patches.
struct LitParts {
    std::vector<PatchPart> parts;
    InfluenceMatrix rows;      ///< of a white matte surface there, in the patch's lighting state
    std::vector<Rgb> bounced;  ///< light from other surfaces, in the same unit
};

LitParts litParts(SolveRun& s, const std::vector<uint8_t>& used) {
    LitParts lit;
    for (size_t p = 0; p < s.in.options.patches.size(); ++p)
        if (used[p])
            for (PatchPart& part : partsOf(s.in, p)) lit.parts.push_back(std::move(part));
    std::map<uint32_t, uint32_t> rowOf;
    for (const PatchPart& part : lit.parts)
        for (const auto& [vertex, weight] : part.vertices) rowOf.emplace(vertex, 0);
    std::vector<uint32_t> vertices;
    for (auto& [vertex, row] : rowOf) {
        row = uint32_t(vertices.size());
        vertices.push_back(vertex);
    }
    const InfluenceMatrix lambert = s.rowsOf(vertices);
    lit.rows.rows = lit.parts.size();
    lit.rows.columns = lambert.columns;
    lit.rows.values.assign(lit.rows.rows * lit.rows.columns, 0.0f);
    lit.bounced.assign(lit.parts.size(), Rgb(0));
    for (size_t i = 0; i < lit.parts.size(); ++i) {
        const size_t state = s.in.samples.stateOf(uint32_t(s.in.options.patches[lit.parts[i].patch].view));
        for (const auto& [vertex, weight] : lit.parts[i].vertices) {
            std::vector<float> row(lambert.row(rowOf[vertex]), lambert.row(rowOf[vertex]) + lambert.columns);
            s.emitters.dim(row.data(), s.light.lighting.leaves, state);
            for (size_t k = 0; k < lambert.columns; ++k) lit.rows.row(i)[k] += weight * row[k];
            if (s.bounce.joined())
                lit.bounced[i] += weight * s.bounce.atVertex[state * s.in.scene.mesh.vertexCount() + vertex];
        }
    }
    return lit;
}

/// Whether the light as it is would ask much of the surface to be more than white, and no light is seen unclipped: then
/// it is not what lights the scene, however well it seems to be known.
bool lightIsRefuted(const SolveRun& s, const Irradiance& irradiance) {
    constexpr float white = 1.02f, most = 0.1f;  // as applyGauge has it
    const std::vector<uint8_t>& clipped = s.light.anchors.emitterClipped;
    if (std::find(clipped.begin(), clipped.end(), 0) != clipped.end()) return false;
    size_t above = 0;
    for (size_t i = 0; i < irradiance.value.size(); ++i)
        above += maxChannel(s.observed.matte.radiance[i] / glm::max(irradiance.value[i], Rgb(1e-20f))) > white;
    return float(above) > most * float(irradiance.value.size());
}

/// What each patch says of the light as it is, which was found without any of them.
std::vector<PatchReading> readingsOf(SolveRun& s) {
    const size_t count = s.in.options.patches.size();
    const LitParts lit = litParts(s, std::vector<uint8_t>(count, 1));
    const Irradiance irradiance = s.irradiance();
    const LightUncertainty light = uncertaintyOf(s, irradiance, false);
    std::vector<Rgb> sigmaAt(s.in.scene.mesh.vertexCount(), Rgb(-1));
    Rgb typical(0);
    for (size_t i = 0; i < light.litSigma.size(); ++i) {
        sigmaAt[s.observed.matte.vertices[i]] = light.litSigma[i];
        typical += light.litSigma[i] / float(light.litSigma.size());
    }
    // Bounced light that joined under any scale is no witness.
    const bool known = typical.x > 0 && typical.y > 0 && typical.z > 0 && luminance(light.fromBounces) < 0.5f &&
                       !lightIsRefuted(s, irradiance);
    std::vector<PatchReading> readings(count);
    for (size_t p = 0; p < count; ++p) {
        DVec3 sum(0), squares(0);
        Rgb rest(0);
        double parts = 0;
        float weights = 0;
        for (size_t i = 0; i < lit.parts.size(); ++i) {
            if (lit.parts[i].patch != p) continue;
            const Rgb found = lightOfRow(lit.rows.row(i), s.light.lighting) + lit.bounced[i];
            DVec3 off(0);
            for (int c = 0; c < 3; ++c)
                off[c] = std::log(std::max(double(lit.parts[i].radiance[c]), 1e-20) /
                                  std::max(double(s.in.options.patches[p].albedo[c]) * double(found[c]), 1e-20));
            sum += off;
            squares += off * off;
            ++parts;
            for (const auto& [vertex, weight] : lit.parts[i].vertices) {
                if (sigmaAt[vertex].x < 0) continue;
                rest += weight * sigmaAt[vertex];
                weights += weight;
            }
        }
        const DVec3 mean = sum / parts,
                    error = glm::sqrt(glm::max(squares / parts - mean * mean, DVec3(0)) / std::max(1.0, parts - 1));
        readings[p].offset = Rgb(mean);
        for (int c = 0; c < 3; ++c)
            readings[p].sigma[c] = float(std::hypot(s.in.options.patches[p].noise, leastDeviationOfPart, error[c]));
        readings[p].restSigma = known ? widenedByModel(s, light, weights > 0 ? rest / weights : typical) : Rgb(10);
    }
    return readings;
}

}  // namespace

bool patchesTakePart(const SolveRun& s) {
    if (s.patchUsed.empty()) return !s.in.options.patches.empty() && s.hasMatte() && s.in.options.nearField;
    return std::find(s.patchUsed.begin(), s.patchUsed.end(), 1) != s.patchUsed.end();
}

void judgePatches(SolveRun& s) {
    if (!s.patchUsed.empty() || !patchesTakePart(s) || s.stopped()) return;
    // A checkpoint from between would go on with light that is judged already.
    s.stepMayBeCut = false;
    const Lighting with = s.light.lighting;
    LightInformation informationWith = s.light.information;
    const bool unfinishedWith = s.light.unfinished;
    const auto fit = [&](const char* stage) {
        fitLight(s, {stage, s.in.options.startIterations});
        if (s.light.environmentBlack)
            std::fill(s.light.lighting.leafRadiance.begin(), s.light.lighting.leafRadiance.end(), Rgb(0));
    };
    try {
        s.patchUsed.assign(s.in.options.patches.size(), 0);
        fit("light without known albedo");
        const std::vector<PatchReading> readings = readingsOf(s);
        const std::vector<uint8_t> used = consistentPatches(readings);
        for (size_t p = 0; p < readings.size(); ++p)
            logInfo("{}: it wants light {:+.1f} {:+.1f} {:+.1f} % brighter; without it that is known to {:.1f} %{}",
                    s.in.options.patches[p].name, 100 * std::expm1(readings[p].offset.x),
                    100 * std::expm1(readings[p].offset.y), 100 * std::expm1(readings[p].offset.z),
                    100 * readings[p].restSigma.y, used[p] ? "" : "; left out");
        s.patchUsed = used;
        if (std::find(used.begin(), used.end(), 0) == used.end()) {
            s.light.lighting = with;
            s.light.information = std::move(informationWith);
            s.light.unfinished = unfinishedWith;
        } else if (patchesTakePart(s)) {
            const Rgb offset = offsetOfPatches(readings, used),
                      factor(std::exp(offset.x), std::exp(offset.y), std::exp(offset.z));
            for (Rgb& l : s.light.lighting.leafRadiance) l *= factor;
            for (Rgb& l : s.light.lighting.emitterRadiance) l *= factor;
            fit("light with known albedo");
        }
    } catch (const OutOfTime&) {
        s.light.lighting = with;
        s.patchUsed.clear();
        throw;
    }
}

ViewRows addPatchRows(SolveRun& s, const ViewRows* views) {
    const LitParts lit =
        litParts(s, s.patchUsed.empty() ? std::vector<uint8_t>(s.in.options.patches.size(), 1) : s.patchUsed);
    const std::vector<PatchPart>& parts = lit.parts;
    ViewRows all = views ? *views : ViewRows{};
    all.count.resize(all.radiance.size(), 1);
    all.tieScale = true;
    const size_t first = all.radiance.size(), columns = lit.rows.columns;
    for (InfluenceMatrix& m : all.influence) {
        m.columns = columns;
        m.rows = first + parts.size();
        m.values.resize(m.rows * columns, 0.0f);
    }
    for (size_t i = 0; i < parts.size(); ++i) {
        const KnownPatch& patch = s.in.options.patches[parts[i].patch];
        for (int c = 0; c < 3; ++c)
            for (size_t k = 0; k < columns; ++k)
                all.influence[c].row(first + i)[k] = patch.albedo[c] * lit.rows.row(i)[k];
        all.radiance.push_back(parts[i].radiance - patch.albedo * lit.bounced[i]);
        all.sigma.push_back(std::max(patch.noise * luminance(parts[i].radiance), 1e-20f));
        const auto partsOfPatch = std::count_if(parts.begin(), parts.end(),
                                                [&](const PatchPart& part) { return part.patch == parts[i].patch; });
        all.count.push_back(patchCount / float(partsOfPatch));
    }
    return all;
}

std::array<Eigen::MatrixXd, 3> patchInformation(SolveRun& s) {
    const ViewRows rows = addPatchRows(s, nullptr);
    std::array<Eigen::MatrixXd, 3> parts;
    for (size_t c = 0; c < 3; ++c) {
        const InfluenceMatrix& b = rows.influence[c];
        parts[c] = weightedGram(
            b,
            [&](size_t i, float* out) {
                const float w = rows.count[i] / (rows.sigma[i] * rows.sigma[i]);
                for (size_t k = 0; k < b.columns; ++k) out[k] = w * b.row(i)[k];
            },
            s.in.progress);
    }
    return parts;
}

std::vector<PatchFit> patchesUnder(SolveRun& s, const Rgb& scale) {
    std::vector<PatchFit> fits;
    const size_t count = s.in.options.patches.size();
    if (count == 0) return fits;
    const LitParts lit = litParts(s, std::vector<uint8_t>(count, 1));
    for (size_t p = 0; p < count; ++p) {
        const KnownPatch& patch = s.in.options.patches[p];
        PatchFit fit;
        fit.name = patch.name, fit.told = patch.albedo, fit.noise = patch.noise;
        fit.used = s.patchUsed.empty() ? patchesTakePart(s) : s.patchUsed[p] != 0;
        Rgb shown(0), white(0);
        for (size_t i = 0; i < lit.parts.size(); ++i) {
            if (lit.parts[i].patch != p) continue;
            shown += lit.parts[i].radiance;
            white += scale * (lightOfRow(lit.rows.row(i), s.light.lighting) + lit.bounced[i]);
        }
        fit.found = shown / glm::max(white, Rgb(1e-20f));
        float off = 0;
        for (int c = 0; c < 3; ++c) off = std::max(off, std::abs(fit.found[c] / std::max(fit.told[c], 1e-6f) - 1));
        fit.doubtful = off > std::max(patchDoubt * patch.noise, leastDoubt);
        fit.words = fmt::format(
            "{}: albedo {:.3f} {:.3f} {:.3f} was told, {:.3f} {:.3f} {:.3f} found{}", fit.name, fit.told.x, fit.told.y,
            fit.told.z, fit.found.x, fit.found.y, fit.found.z,
            !fit.used && s.patchUsed.empty() ? "; took no part in this solve"
            : !fit.used    ? "; left out, because other measurements contradict it by more than three deviations"
            : fit.doubtful ? "; other measurements or other patches contradict it"
                           : "");
        fit.doubtful |= !fit.used;
        if (fit.doubtful) logWarning("{}", fit.words);
        else logInfo("{}", fit.words);
        fits.push_back(std::move(fit));
    }
    return fits;
}

std::array<Eigen::MatrixXd, 3> probeInformation(const SolveRun& s) {
    const LightPrior prior(s.light.lighting.leaves, s.light.anchors, s.light.prior, s.light.influence);
    std::array<Eigen::MatrixXd, 3> parts;
    for (int c = 0; c < 3; ++c) parts[size_t(c)] = prior.fromProbes(unknownsOf(s.light.lighting, c), c);
    return parts;
}

std::vector<ProbeFit> probesUnder(const SolveRun& s, const Irradiance& irradiance) {
    std::vector<ProbeFit> fits;
    const std::vector<ProbeAnchor>& anchors = s.light.anchors.probes;
    if (anchors.empty() || s.light.environmentBlack) return fits;
    const LightPrior prior(s.light.lighting.leaves, s.light.anchors, s.light.prior, s.light.influence);
    const std::vector<Rgb> received = contributionsOf(s, irradiance);
    for (size_t p = 0; p < anchors.size(); ++p) {
        ProbeFit fit = s.in.options.probes[p]->fit;
        double squares = 0, all = 0;
        for (int c = 0; c < 3; ++c) {
            const float gain = float(prior.gainOf(p, unknownsOf(s.light.lighting, c), c));
            if (gain > 0) fit.gain[c] *= gain;
            for (size_t i = 0; i < anchors[p].radiance.size(); ++i) {
                const double probed = double(gain * anchors[p].radiance[i][c]), held = anchors[p].held[i],
                             found = s.light.lighting.leafRadiance[i][c], both = std::max(probed, found);
                if (held < 0.5 || !(both > 0)) continue;
                squares += double(received[i][c]) * std::pow((found - probed) / both, 2);
                all += double(received[i][c]);
            }
        }
        fit.residual = all > 0 ? float(std::sqrt(squares / all)) : 0.0f;
        fits.push_back(std::move(fit));
    }
    return fits;
}

}  // namespace relamp
