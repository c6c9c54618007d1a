#include "solve/gloss/lobe_choice.h"

#include <array>
#include <limits>

#include "base/parallel.h"
#include "base/random.h"
#include "brdf/projection.h"
#include "transport/near_field.h"

namespace relamp {

std::vector<std::vector<Rgb>> lobeResponses(const Scene& scene, const std::vector<EmitterSurface>& emitters,
                                            const std::vector<int>& emitterOfTriangle, const Lighting& lighting,
                                            const std::vector<Lobe>& lobes,
                                            const std::vector<GlossyObservation>& observations,
                                            const LobeRowOptions& options, Progress& progress) {
    std::vector<std::vector<Rgb>> responses(lobes.size(), std::vector<Rgb>(observations.size(), Rgb(0)));
    constexpr std::array<float, 4> widths{0.006f, 0.03f, 0.12f, 0.45f};
    const int each = std::max(8, options.lobeSamples / 3);
    progress.begin("Trying lobes", observations.size());
    parallelFor(
        observations.size(), 16,
        [&](size_t at) {
            struct Arriving {
                Vec3 direction;  // local
                Rgb radiance;    // times cosine over density
            };
            thread_local std::vector<Arriving> arriving;
            thread_local std::vector<EmitterSample> samples;
            thread_local std::vector<float> totals;
            arriving.clear();
            const GlossyObservation& observation = observations[at];
            const Vec3 normal = scene.mesh.normals[observation.vertex],
                       position = scene.mesh.positions[observation.vertex];
            if (glm::dot(normal, observation.towardEye) <= 1e-3f) return;
            const Mat3 frame = frameAround(normal, lighting.leaves.axes());
            const Vec3 eye = glm::transpose(frame) * observation.towardEye, origin = rayOrigin(scene, position, normal);
            const auto density = [&](const Vec3& light) {
                float sum = light.z / pi * float(options.cosineSamples);
                for (const float alpha : widths) sum += float(each) * ggxSampleDensity(light, eye, alpha);
                return sum;
            };
            LobeRowOptions here = options;
            here.state = observation.state;
            const int environment = lighting.leaves.environmentOf(here.state);
            const std::vector<Rgb> shines = here.shining(lighting);
            totals.assign(emitters.size(), 0);
            const uint32_t rank = scene.rank[observation.vertex];
            for (size_t e = 0; e < emitters.size(); ++e) {
                totals[e] = sampleEmitter(scene, emitters[e], position, normal, options.emitterSamples,
                                          mixBits(options.seed + rank) + e, samples);
                for (const EmitterSample& s : samples) {
                    const Vec3 light = glm::transpose(frame) * s.direction;
                    if (s.visible == 0 || light.z <= 0) continue;
                    const float area = light.z / (pi * totals[e]) * float(samples.size()),
                                evenness = s.formFactor * float(samples.size()) / totals[e];
                    arriving.push_back({light, shines[e] * (s.level * evenness * light.z / (area + density(light)))});
                }
            }
            Ray rays[8];
            Hit hits[8];
            Vec3 local[8];
            size_t pending = 0;
            const auto flush = [&] {
                if (!pending) return;
                scene.tracer->closest8({rays, pending}, {hits, pending});
                for (size_t i = 0; i < pending; ++i) {
                    const float drawn = density(local[i]);
                    if (!(drawn > 0)) continue;
                    if (!hits[i]) {
                        if (environment < 0) continue;
                        const float shape = options.shapeAt(rays[i].direction, environment);
                        const size_t leaf = lighting.leaves.leafOf(rays[i].direction, size_t(environment));
                        arriving.push_back({local[i], lighting.leafRadiance[leaf] * (shape * local[i].z / drawn)});
                        continue;
                    }
                    const int e = emitterOfTriangle.empty() ? -1 : emitterOfTriangle[hits[i].triangle];
                    if (e < 0 && options.outgoing &&
                        glm::dot(scene.mesh.faceNormal(hits[i].triangle), rays[i].direction) < 0)
                        arriving.push_back({local[i], here.outgoingAt(scene, hits[i]) * (local[i].z / drawn)});
                    if (e < 0 || !(totals[size_t(e)] > 0)) continue;
                    if (!emitters[size_t(e)].twoSided &&
                        glm::dot(scene.mesh.faceNormal(hits[i].triangle), rays[i].direction) >= 0)
                        continue;
                    const float area = local[i].z / (pi * totals[size_t(e)]) * float(options.emitterSamples);
                    const float level =
                        emitters[size_t(e)].levelAt(origin + hits[i].distance * rays[i].direction, -rays[i].direction);
                    arriving.push_back({local[i], shines[size_t(e)] * (level * local[i].z / (area + drawn))});
                }
                pending = 0;
            };
            const auto shoot = [&](const Vec3& light) {
                if (light.z <= 0) return;
                local[pending] = light;
                rays[pending++] = {origin, frame * light, 0, 1e30f};
                if (pending == 8) flush();
            };
            for (size_t w = 0; w < widths.size(); ++w) {
                const Vec2 shift = randomShift(options.seed, rank, 11 + w);
                for (int i = 0; i < each; ++i) shoot(sampleGgx(eye, widths[w], r2Point(uint32_t(i), shift)));
            }
            const Vec2 shift = randomShift(options.seed, rank, 8);
            for (int i = 0; i < options.cosineSamples; ++i) {
                const Vec2 u = r2Point(uint32_t(i), shift);
                const float radius = std::sqrt(u.x), angle = 2 * pi * u.y;
                shoot({radius * std::cos(angle), radius * std::sin(angle), std::sqrt(std::max(0.0f, 1 - u.x))});
            }
            flush();
            for (size_t k = 1; k < lobes.size(); ++k) {
                Rgb sum(0);
                for (const Arriving& a : arriving) sum += evaluateLobe(lobes[k], a.direction, eye) * a.radiance;
                responses[k][at] = sum;
            }
        },
        &progress);
    return responses;
}

namespace {

/// The normal equations of one channel, the Lambert part of each vertex eliminated.
struct Equations {
    std::vector<double> gram, moment;
    double size = 0;
    double objective(const std::vector<double>& x) const {
        const size_t n = moment.size();
        double sum = size;
        for (size_t k = 0; k < n; ++k) {
            if (x[k] == 0) continue;
            double row = 0;
            for (size_t j = 0; j < n; ++j) row += gram[k * n + j] * x[j];
            sum += x[k] * (row - 2 * moment[k]);
        }
        return std::max(0.0, sum);
    }
};

}  // namespace

std::vector<LobeChoice> chooseLobes(const std::vector<Lobe>& lobes, const std::vector<std::vector<Rgb>>& responses,
                                    const std::vector<GlossyObservation>& observations, bool withLambert,
                                    size_t mostLobes) {
    const size_t n = lobes.size(), count = observations.size();
    std::vector<size_t> starts;
    for (size_t i = 0; i < count; ++i)
        if (i == 0 || !observations[i].sharesMatte(observations[i - 1])) starts.push_back(i);
    starts.push_back(count);
    std::vector<float> robust(count, 1);
    std::vector<LobeChoice> choices;
    constexpr int rounds = 3;
    for (int round = 0; round < rounds; ++round) {
        std::array<Equations, 3> channels;
        parallelFor(3, 1, [&](size_t c) {
            Equations& q = channels[c];
            q.gram.assign(n * n, 0);
            q.moment.assign(n, 0);
            std::vector<double> mean(n), left(n);
            for (size_t g = 0; g + 1 < starts.size(); ++g) {
                std::fill(mean.begin(), mean.end(), 0.0);
                double meanY = 0, weight = 0;
                const auto weightOf = [&](size_t i) {
                    return double(robust[i]) / (double(observations[i].sigma) * double(observations[i].sigma));
                };
                if (withLambert) {
                    for (size_t i = starts[g]; i < starts[g + 1]; ++i) {
                        const double w = weightOf(i);
                        for (size_t k = 1; k < n; ++k) mean[k] += w * double(responses[k][i][int(c)]);
                        meanY += w * double(observations[i].radiance[int(c)]);
                        weight += w;
                    }
                    for (double& m : mean) m /= weight;
                    meanY /= weight;
                }
                for (size_t i = starts[g]; i < starts[g + 1]; ++i) {
                    const double w = weightOf(i), y = double(observations[i].radiance[int(c)]) - meanY;
                    for (size_t k = 1; k < n; ++k) left[k] = double(responses[k][i][int(c)]) - mean[k];
                    for (size_t k = 1; k < n; ++k) {
                        q.moment[k] += w * left[k] * y;
                        for (size_t j = 1; j <= k; ++j) q.gram[k * n + j] += w * left[k] * left[j];
                    }
                    q.size += w * y * y;
                }
            }
            for (size_t k = 1; k < n; ++k)
                for (size_t j = 1; j < k; ++j) q.gram[j * n + k] = q.gram[k * n + j];
        });
        choices.clear();
        std::vector<size_t> allowed;
        std::array<std::vector<double>, 3> weights;
        while (allowed.size() < std::min(mostLobes, n - 1)) {
            std::vector<double> error(n, std::numeric_limits<double>::infinity());
            parallelFor(n - 1, 1, [&](size_t i) {
                const size_t k = i + 1;
                if (std::find(allowed.begin(), allowed.end(), k) != allowed.end()) return;
                std::vector<size_t> tried = allowed;
                tried.push_back(k);
                error[k] = 0;
                for (const Equations& q : channels)
                    error[k] += q.objective(nonNegativeLeastSquares(q.gram, q.moment, tried));
            });
            allowed.push_back(size_t(std::min_element(error.begin(), error.end()) - error.begin()));
            Lobe mixture{Lobe::Kind::mixture, 1, ""};
            float largest = 0;
            for (size_t c = 0; c < 3; ++c)
                weights[c] = nonNegativeLeastSquares(channels[c].gram, channels[c].moment, allowed);
            for (const size_t k : allowed) {
                const float fraction = float(weights[0][k] + weights[1][k] + weights[2][k]);
                if (!(fraction > 0)) continue;
                mixture.parts.push_back(lobes[k]);
                mixture.parts.back().fraction = fraction;
                if (fraction > largest) {
                    largest = fraction;
                    mixture.alpha = lobes[k].alpha;
                }
                mixture.name += (mixture.name.empty() ? "" : " + ") + lobes[k].name;
            }
            if (mixture.parts.size() < allowed.size()) break;  // the last one adds nothing
            for (Lobe& part : mixture.parts) part.fraction /= largest;
            choices.push_back({mixture.parts.size() == 1 ? mixture.parts[0] : mixture, error[allowed.back()]});
        }
        if (choices.empty() || round + 1 == rounds) break;
        // Outliers of the best mixture count little in the next round.
        for (size_t g = 0; g + 1 < starts.size(); ++g) {
            std::array<double, 3> matte{};
            std::vector<Rgb> left(starts[g + 1] - starts[g]);
            for (int c = 0; c < 3; ++c) {
                double sum = 0, weight = 0;
                for (size_t i = starts[g]; i < starts[g + 1]; ++i) {
                    double y = double(observations[i].radiance[c]);
                    for (size_t k = 1; k < n; ++k)
                        if (weights[size_t(c)][k] > 0) y -= weights[size_t(c)][k] * double(responses[k][i][c]);
                    left[i - starts[g]][c] = float(y);
                    const double w =
                        double(robust[i]) / (double(observations[i].sigma) * double(observations[i].sigma));
                    sum += w * y;
                    weight += w;
                }
                if (withLambert) matte[size_t(c)] = sum / weight;
            }
            for (size_t i = starts[g]; i < starts[g + 1]; ++i) {
                const Rgb r = left[i - starts[g]] - Rgb(matte[0], matte[1], matte[2]);
                robust[i] = 1 / (1 + glm::dot(r, r) / (3 * observations[i].sigma * observations[i].sigma) / 16);
            }
        }
    }
    return choices;
}

}  // namespace relamp
