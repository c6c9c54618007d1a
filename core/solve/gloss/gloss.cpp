#include "solve/gloss/gloss.h"

#include "base/log.h"
#include "base/parallel.h"
#include "base/random.h"
#include "solve/gloss/lobe_choice.h"
#include "solve/light/qp.h"

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

InfluenceMatrix glossyRows(const Scene& scene, const std::vector<EmitterSurface>& emitters,
                           const std::vector<int>& emitterOfTriangle, const LightLeaves& leaves, const Lobe& lobe,
                           const std::vector<GlossyObservation>& observations, const LobeRowOptions& options,
                           Progress& progress, std::vector<Rgb>* mirrored) {
    InfluenceMatrix matrix;
    matrix.rows = observations.size();
    matrix.columns = leaves.size() + emitters.size();
    matrix.values.assign(matrix.rows * matrix.columns, 0.0f);
    if (mirrored) mirrored->assign(observations.size(), Rgb(0));
    progress.begin("Glossy influence", observations.size());
    parallelFor(
        observations.size(), 16,
        [&](size_t i) {
            LobeRowOptions here = options;
            here.state = observations[i].state;
            glossyInfluence(scene, emitters, emitterOfTriangle, leaves, lobe, observations[i].vertex,
                            observations[i].towardEye, here, matrix.row(i), mirrored ? &(*mirrored)[i] : nullptr);
        },
        &progress);
    return matrix;
}

namespace {

/// Residual and weight of one lobe: per vertex the Lambert part is eliminated, held at zero where it would be negative.
struct LobeFit {
    Rgb weight{0};
    double residual = 0;      // mean squared, in sigmas, robust
    double zeroFraction = 0;  // vertices without a Lambert part
};

LobeFit fitLobe(const std::vector<GlossyObservation>& observations, const std::vector<Rgb>& response,
                bool withLambert) {
    LobeFit fit;
    std::vector<size_t> starts;  // observations are grouped by vertex and state
    for (size_t i = 0; i < observations.size(); ++i)
        if (i == 0 || !observations[i].sharesMatte(observations[i - 1])) starts.push_back(i);
    starts.push_back(observations.size());
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

std::vector<Rgb> responses(const InfluenceMatrix& rows, const Lighting& lighting, std::vector<Rgb> mirrored) {
    parallelFor(rows.rows, 64, [&](size_t i) { mirrored[i] += lightOfRow(rows.row(i), lighting); });
    return mirrored;
}

/// Residual of each lobe but the first with or without a Lambert part, whichever is less, from directions that all
/// lobes share.
std::vector<float> screenLobes(const Scene& scene, const std::vector<EmitterSurface>& emitters,
                               const std::vector<int>& emitterOfTriangle, const Lighting& lighting,
                               const std::vector<Lobe>& lobes, const std::vector<GlossyObservation>& observations,
                               const LobeRowOptions& options, Progress& progress) {
    const std::vector<std::vector<Rgb>> response =
        lobeResponses(scene, emitters, emitterOfTriangle, lighting, lobes, observations, options, progress);
    std::vector<float> residual(lobes.size(), 0);
    parallelFor(lobes.size(), 1, [&](size_t k) {
        if (k > 0)
            residual[k] = float(std::min(fitLobe(observations, response[k], true).residual,
                                         fitLobe(observations, response[k], false).residual));
    });
    return residual;
}

}  // namespace

MetalEvidence metalEvidence(const InfluenceMatrix& rows, const Lighting& lighting,
                            const std::vector<GlossyObservation>& observations) {
    MetalEvidence evidence;
    evidence.asMetal =
        fitLobe(observations, responses(rows, lighting, std::vector<Rgb>(observations.size(), Rgb(0))), false).residual;
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
    const auto attempt = [&](const Lobe& lobe) {
        std::vector<Rgb> mirrored;
        const InfluenceMatrix rows = glossyRows(scene, emitters, emitterOfTriangle, lighting.leaves, lobe,
                                                result.observations, options.rows, progress, &mirrored);
        const std::vector<Rgb> response = responses(rows, lighting, std::move(mirrored));
        const LobeFit both = fitLobe(result.observations, response, true),
                      alone = fitLobe(result.observations, response, false);
        const bool metal = alone.residual < double(options.lambertGain) * both.residual;
        const LobeFit& fit = metal ? alone : both;
        if (fit.residual >= double(gain) * best) return false;
        best = fit.residual;
        result.lobe = lobe;
        result.weight = glm::min(fit.weight, Rgb(4));
        result.matte = !metal;
        result.residual = float(fit.residual);
        return true;
    };
    const bool few = options.mostLobes <= 1 && std::all_of(basis.lobes.begin(), basis.lobes.end(), [](const Lobe& l) {
                         return l.kind <= Lobe::Kind::ggxDielectric;
                     });
    if (few) {
        const bool screen = options.screen && basis.lobes.size() > 2;
        const std::vector<float> screened = screen
                                                ? screenLobes(scene, emitters, emitterOfTriangle, lighting, basis.lobes,
                                                              result.observations, options.rows, progress)
                                                : std::vector<float>(basis.lobes.size(), 0);
        constexpr float beaten = 1.08f;
        const float least = *std::min_element(screened.begin() + 1, screened.end());
        const bool useful =
            options.lambertGain >= 1e6f || least < std::max(0.92f, options.leastGain + 0.02f) * result.residualMatte;
        for (size_t k = 1; k < basis.lobes.size() && useful; ++k)
            if (screened[k] <= beaten * least) attempt(basis.lobes[k]);
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
    for (float step : {1.16f, 1.07f})
        if (withRoughness(*result.lobe, step).alpha != result.lobe->alpha &&
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
