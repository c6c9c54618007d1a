#include "solve/gloss/gloss.h"

#include <array>

#include "base/log.h"
#include "base/parallel.h"
#include "solve/gloss/arriving_light.h"
#include "solve/gloss/lobe_choice.h"
#include "transport/shared_directions.h"

namespace relamp {

void addObservations(const Capture& capture, const Scene& scene, const RadianceSamples& samples, uint32_t vertex,
                     std::vector<GlossyObservation>& observations) {
    const size_t first = observations.size();
    for (uint32_t s = samples.start[vertex]; s < samples.start[vertex + 1]; ++s) {
        const RadianceSample& r = samples.samples[s];
        if (r.clipped || r.weight < 0.25f) continue;
        GlossyObservation observation;
        observation.vertex = vertex;
        observation.view = r.view;
        observation.state = samples.stateOf(r.view);
        observation.radiance = r.radiance;
        const float y = (r.radiance.x + r.radiance.y + r.radiance.z) / 3;
        observation.sigma = std::sqrt(samples.sigma(y) * samples.sigma(y) / r.weight + 0.03f * 0.03f * y * y);
        observation.towardEye =
            glm::normalize(Vec3(capture.views[r.view].camera.position()) - scene.mesh.positions[vertex]);
        observations.push_back(observation);
    }
    const auto byState = [](const GlossyObservation& a, const GlossyObservation& b) { return a.state < b.state; };
    if (samples.states > 1) std::stable_sort(observations.begin() + ptrdiff_t(first), observations.end(), byState);
}

std::vector<GlossyObservation> glossyObservations(const Capture& capture, const Scene& scene,
                                                  const RadianceSamples& samples, uint32_t component,
                                                  const GlossOptions& options) {
    std::vector<uint32_t> vertices;
    for (uint32_t v = 0; v < scene.mesh.vertexCount(); ++v)
        if (scene.material[v] == component && samples.countOf(v) >= 2) vertices.push_back(v);
    std::sort(vertices.begin(), vertices.end(), [&](uint32_t a, uint32_t b) { return scene.rank[a] < scene.rank[b]; });
    std::vector<GlossyObservation> observations;
    const double step = std::max(1.0, double(vertices.size()) / double(options.maxVertices));
    for (double at = 0; at < double(vertices.size()); at += step)
        addObservations(capture, scene, samples, vertices[size_t(at)], observations);
    return observations;
}

std::vector<size_t> startsOfVertices(const std::vector<GlossyObservation>& observations) {
    std::vector<size_t> starts;
    for (size_t i = 0; i < observations.size(); ++i)
        if (i == 0 || !observations[i].sharesMatte(observations[i - 1])) starts.push_back(i);
    starts.push_back(observations.size());
    return starts;
}

namespace {

/// `each(i, row, mirrored)` for the row of every observation (glossyInfluence), by all threads.
template <class Each>
void forEachRow(const DirectionScene& in, const Lobe& lobe, const std::vector<GlossyObservation>& observations,
                const LobeRowOptions& options, Progress& progress, const Each& each) {
    const std::vector<size_t> starts = startsOfVertices(observations);
    progress.begin("Glossy influence", starts.size() - 1);
    parallelFor(
        starts.size() - 1, 4,
        [&](size_t g) {
            thread_local SharedDirections shared;
            thread_local std::vector<float> row;
            row.resize(in.leaves.size() + in.emitters.size());
            LobeRowOptions here = options;
            here.state = observations[starts[g]].state;
            drawSharedDirections(in, observations[starts[g]].vertex, here, shared);
            for (size_t i = starts[g]; i < starts[g + 1]; ++i) {
                Rgb mirrored(0);
                glossyInfluence(in, shared, lobe, observations[i].towardEye, here, row.data(), &mirrored);
                each(i, row.data(), mirrored);
            }
        },
        &progress);
}

}  // namespace

InfluenceMatrix glossyRows(const Scene& scene, const std::vector<EmitterSurface>& emitters,
                           const std::vector<int>& emitterOfTriangle, const LightLeaves& leaves, const Lobe& lobe,
                           const std::vector<GlossyObservation>& observations, const LobeRowOptions& options,
                           Progress& progress, std::vector<Rgb>* mirrored) {
    InfluenceMatrix matrix;
    matrix.rows = observations.size();
    matrix.columns = leaves.size() + emitters.size();
    matrix.values.assign(matrix.rows * matrix.columns, 0.0f);
    if (mirrored) mirrored->assign(observations.size(), Rgb(0));
    const DirectionScene in{scene, emitters, emitterOfTriangle, leaves};
    forEachRow(in, lobe, observations, options, progress, [&](size_t i, const float* row, const Rgb& shown) {
        std::copy(row, row + matrix.columns, matrix.row(i));
        if (mirrored) (*mirrored)[i] = shown;
    });
    return matrix;
}

namespace {

constexpr std::array<float, 2> roughnessSteps{1.16f, 1.07f};

/// Residual and weight of one lobe: per vertex the Lambert part is eliminated, held at zero where it would be negative.
struct LobeFit {
    Rgb weight{0};
    double residual = 0;      // mean squared, in sigmas, robust
    double zeroFraction = 0;  // vertices without a Lambert part
};

LobeFit fitLobe(const std::vector<GlossyObservation>& observations, const std::vector<Rgb>& response,
                bool withLambert) {
    LobeFit fit;
    const std::vector<size_t> starts = startsOfVertices(observations);
    std::vector<float> robust(observations.size(), 1);
    std::vector<uint8_t> zero(starts.size() * 3, 0);
    std::vector<Rgb> residual(observations.size());
    size_t zeros = 0;
    for (int round = 0; round < 8; ++round) {
        for (int c = 0; c < 3; ++c) {
            double rr = 0, ry = 0;
            for (size_t g = 0; g + 1 < starts.size(); ++g) {
                double meanR = 0, meanY = 0, weight = 0;
                const bool centred = withLambert && !zero[g * 3 + size_t(c)];
                for (size_t i = starts[g]; i < starts[g + 1]; ++i) {
                    const double w = robust[i] / (double(observations[i].sigma) * observations[i].sigma);
                    meanR += w * response[i][c];
                    meanY += w * observations[i].radiance[c];
                    weight += w;
                }
                meanR = centred ? meanR / weight : 0;
                meanY = centred ? meanY / weight : 0;
                for (size_t i = starts[g]; i < starts[g + 1]; ++i) {
                    const double w = robust[i] / (double(observations[i].sigma) * observations[i].sigma);
                    rr += w * (response[i][c] - meanR) * (response[i][c] - meanR);
                    ry += w * (response[i][c] - meanR) * (observations[i].radiance[c] - meanY);
                }
            }
            fit.weight[c] = rr > 0 ? float(std::max(0.0, ry / rr)) : 0.0f;
        }
        zeros = 0;
        double sum = 0;
        size_t count = 0;
        for (size_t g = 0; g + 1 < starts.size(); ++g) {
            for (int c = 0; c < 3; ++c) {
                double mean = 0, weight = 0;
                for (size_t i = starts[g]; i < starts[g + 1]; ++i) {
                    const double w = robust[i] / (double(observations[i].sigma) * observations[i].sigma);
                    mean += w * (observations[i].radiance[c] - fit.weight[c] * response[i][c]);
                    weight += w;
                }
                mean /= weight;
                zero[g * 3 + size_t(c)] = mean < 0;
                zeros += mean < 0;
                if (mean < 0 || !withLambert) mean = 0;
                for (size_t i = starts[g]; i < starts[g + 1]; ++i)
                    residual[i][c] = float(observations[i].radiance[c] - fit.weight[c] * response[i][c] - mean);
            }
            for (size_t i = starts[g]; i < starts[g + 1]; ++i) {
                const double u = double(glm::dot(residual[i], residual[i])) / 3 /
                                 (double(observations[i].sigma) * observations[i].sigma);
                robust[i] = float(1 / (1 + u / 16));
                sum += 16 * std::log1p(u / 16);
                ++count;
            }
        }
        fit.residual = count ? sum / double(count) : 0;
    }
    fit.zeroFraction = starts.size() > 1 ? double(zeros) / double(3 * (starts.size() - 1)) : 0;
    return fit;
}

/// Of the measured parts, by their shares; analytic lobes have none.
Rgb glossColour(const Lobe& lobe) {
    if (lobe.measured) return lobe.measured->colour;
    Rgb sum(0);
    float fractions = 0;
    for (const Lobe& part : lobe.parts) {
        sum += part.fraction * glossColour(part);
        fractions += part.fraction;
    }
    return fractions > 0 ? sum / fractions : Rgb(1);
}

/// What one lobe of weight 1 sends at each observation, from directions of its own.
std::vector<Rgb> ownResponse(const DirectionScene& in, const Lighting& lighting, const Lobe& lobe,
                             const std::vector<GlossyObservation>& observations, const LobeRowOptions& options,
                             Progress& progress) {
    std::vector<Rgb> response(observations.size());
    forEachRow(in, lobe, observations, options, progress,
               [&](size_t i, float* row, Rgb& mirrored) { response[i] = mirrored + lightOfRow(row, lighting); });
    return response;
}

/// A lobe with and without a Lambert part beside it.
struct LobeTrial {
    LobeFit both, alone;
    bool metal = false;  ///< the Lambert part does not earn its unknowns
    LobeTrial(const std::vector<GlossyObservation>& observations, const std::vector<Rgb>& response, float lambertGain)
        : both(fitLobe(observations, response, true)),
          alone(fitLobe(observations, response, false)),
          metal(alone.residual < double(lambertGain) * both.residual) {}
    const LobeFit& fit() const { return metal ? alone : both; }
};

/// Per kind the lobe of the basis that explains most, where one comes near the best of all, with the roughness between
/// those of the basis that explains still more: by directions that all share. Empty where even the best explains too
/// little.
std::vector<Lobe> screenLobes(const ArrivingLight& arriving, const BrdfBasis& basis,
                              const std::vector<GlossyObservation>& observations, const GlossOptions& options,
                              float residualMatte) {
    constexpr double beaten = 1.08;
    const size_t n = basis.lobes.size();
    std::vector<double> residual(n, 1e300);
    parallelFor(n - 1, 1, [&](size_t i) {
        const LobeTrial trial(observations, arriving.through(basis.lobes[i + 1]), options.lambertGain);
        residual[i + 1] = std::min(trial.both.residual, trial.alone.residual);
    });
    const double least = *std::min_element(residual.begin() + 1, residual.end());
    if (options.lambertGain < 1e6f && !(least < double(std::max(0.92f, options.leastGain + 0.02f) * residualMatte)))
        return {};
    std::vector<Lobe> chosen;
    for (size_t k = 1; k < n; ++k) {
        const bool bestOfKind = std::none_of(basis.lobes.begin() + 1, basis.lobes.end(), [&](const Lobe& l) {
            const size_t other = size_t(&l - basis.lobes.data());
            return l.kind == basis.lobes[k].kind &&
                   (residual[other] < residual[k] || (residual[other] == residual[k] && other < k));
        });
        if (!bestOfKind || !(residual[k] <= beaten * least)) continue;
        Lobe lobe = basis.lobes[k];
        double best = LobeTrial(observations, arriving.through(lobe), options.lambertGain).fit().residual;
        for (const float step : roughnessSteps)
            for (const float factor : {step, 1 / step}) {
                const Lobe other = withRoughness(lobe, factor);
                if (other.alpha == lobe.alpha) continue;
                const double there =
                    LobeTrial(observations, arriving.through(other), options.lambertGain).fit().residual;
                if (!(there < best)) continue;
                best = there;
                lobe = other;
                break;
            }
        chosen.push_back(std::move(lobe));
    }
    return chosen;
}

}  // namespace

MetalEvidence metalEvidence(const InfluenceMatrix& rows, const Lighting& lighting,
                            const std::vector<GlossyObservation>& observations) {
    MetalEvidence evidence;
    std::vector<Rgb> response(rows.rows);
    parallelFor(rows.rows, 64, [&](size_t i) { response[i] = lightOfRow(rows.row(i), lighting); });
    evidence.asMetal = fitLobe(observations, response, false).residual;
    size_t vertices = 0;
    for (size_t i = 0; i < observations.size(); ++i)
        vertices += i == 0 || !observations[i].sharesMatte(observations[i - 1]);
    const double without = fitLobe(observations, std::vector<Rgb>(observations.size(), Rgb(0)), true).residual;
    evidence.alikeFromEverywhere = observations.size() > vertices
                                       ? without * double(observations.size()) / double(observations.size() - vertices)
                                       : 0;
    return evidence;
}

Lobe withRoughness(const Lobe& lobe, float factor) {
    using enum Lobe::Kind;
    if (lobe.kind == lafortuneBack || lobe.kind == lafortuneForward || lobe.kind == measured || lobe.kind == mixture ||
        lobe.kind == lambert)
        return lobe;
    Lobe result = lobe;
    const float roughness = std::clamp(std::sqrt(lobe.alpha) * factor, 0.06f, 0.9f);
    result.alpha = roughness * roughness;
    result.name = fmt::format("{} roughness {:.3f}", lobe.name.substr(0, lobe.name.find(" roughness")), roughness);
    return result;
}

ComponentGloss fitGloss(const Capture& capture, const Scene& scene, const RadianceSamples& samples,
                        const std::vector<EmitterSurface>& emitters, const std::vector<int>& emitterOfTriangle,
                        const Lighting& lighting, const BrdfBasis& basis, uint32_t component,
                        const GlossOptions& options, Progress& progress) {
    ComponentGloss result;
    result.component = component;
    result.observations = glossyObservations(capture, scene, samples, component, options);
    if (result.observations.size() < 40) return result;
    const LobeFit without = fitLobe(result.observations, std::vector<Rgb>(result.observations.size(), Rgb(0)), true);
    result.residualMatte = result.residual = float(without.residual);
    double best = options.lambertGain > 1e6f ? 1e300 : without.residual;
    float gain = 1;  // the residual must fall below this fraction of the best
    const DirectionScene in{scene, emitters, emitterOfTriangle, lighting.leaves};
    const auto attempt = [&](const Lobe& lobe) {
        const LobeTrial trial(result.observations,
                              ownResponse(in, lighting, lobe, result.observations, options.rows, progress),
                              options.lambertGain);
        const LobeFit& fit = trial.fit();
        if (fit.residual >= double(gain) * best) return false;
        best = fit.residual;
        result.lobe = lobe;
        result.weight = glm::min(fit.weight, Rgb(4));
        result.matte = !trial.metal;
        result.residual = float(fit.residual);
        return true;
    };
    const bool few = options.mostLobes <= 1 && std::all_of(basis.lobes.begin(), basis.lobes.end(), [](const Lobe& l) {
                         return l.kind <= Lobe::Kind::ggxDielectric;
                     });
    const bool screen = few && options.screen && basis.lobes.size() > 2;
    if (screen) {
        const ArrivingLight arriving(scene, emitters, emitterOfTriangle, lighting, result.observations, options.rows,
                                     progress);
        for (const Lobe& lobe : screenLobes(arriving, basis, result.observations, options, result.residualMatte))
            attempt(lobe);
    } else if (few) {
        for (size_t k = 1; k < basis.lobes.size(); ++k) attempt(basis.lobes[k]);
    }
    if (!few) {
        const auto response = lobeResponses(scene, emitters, emitterOfTriangle, lighting, basis.lobes,
                                            result.observations, options.rows, progress);
        std::vector<LobeChoice> choices =
            chooseLobes(basis.lobes, response, result.observations, true, options.mostLobes);
        for (LobeChoice& c : chooseLobes(basis.lobes, response, result.observations, false, options.mostLobes))
            choices.push_back(std::move(c));
        const auto size = [](const LobeChoice& c) { return c.lobe.parts.size(); };
        std::stable_sort(choices.begin(), choices.end(),
                         [&](const LobeChoice& a, const LobeChoice& b) { return size(a) < size(b); });
        for (const LobeChoice& c : choices) {
            gain = c.lobe.kind == Lobe::Kind::mixture ? 0.95f : 1.0f;
            attempt(c.lobe);
        }
        gain = 1;
    }
    if (!result.lobe || (options.lambertGain < 1e6f && result.residual > options.leastGain * result.residualMatte)) {
        result.lobe.reset();
        return result;
    }
    // Metals show their light sharply: their roughness is sought with directions of their own.
    for (float step : roughnessSteps)
        if ((!screen || !result.matte) && withRoughness(*result.lobe, step).alpha != result.lobe->alpha &&
            !attempt(withRoughness(*result.lobe, step)))
            attempt(withRoughness(*result.lobe, 1 / step));
    // A coating over a matte surface reflects all colours alike [Shafer85]; where it seems coloured, the light is not
    // yet right. A measured material's gloss has the colour it was measured with.
    const Rgb own = glm::max(glossColour(*result.lobe), Rgb(1e-3f)), scaled = result.weight / own;
    if (result.matte && scaled.x * scaled.y * scaled.z > 0)
        result.weight = own * std::cbrt(scaled.x * scaled.y * scaled.z);
    return result;
}

}  // namespace relamp
