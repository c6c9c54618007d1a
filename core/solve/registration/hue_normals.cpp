#include "solve/registration/hue_normals.h"

#include <algorithm>
#include <cmath>

namespace relamp {
namespace {

constexpr float leanDeviation = 0.05f;  ///< radians
constexpr float hueNoise = 0.02f;       ///< of every vertex, beside that of its photographs
constexpr float hueStep = 0.01f;        ///< of the surface's hue from one vertex to the next
constexpr float hueEdge = 0.15f;        ///< steps that are larger are borders of materials
constexpr int hueRounds = 4, hueSweeps = 40;
constexpr float reliefSize = 0.02f;   ///< of the diagonal
constexpr float steepestLean = 0.3f;  ///< radians

class HueLeans {
public:
    HueLeans(const Scene& scene, const std::vector<HueSample>& samples) : samples_(samples) {
        std::vector<int> place(scene.mesh.vertexCount(), -1);
        for (size_t i = 0; i < samples.size(); ++i) place[samples[i].vertex] = int(i);
        start_.push_back(0);
        double spacing = 0;
        for (const HueSample& s : samples) {
            for (uint32_t e = scene.graph.start[s.vertex]; e < scene.graph.start[s.vertex + 1]; ++e)
                if (const int n = place[scene.graph.to[e]]; n >= 0) neighbours_.push_back(uint32_t(n));
            start_.push_back(uint32_t(neighbours_.size()));
            spacing += double(scene.vertexSpacing[s.vertex]);
        }
        const double rings = double(reliefSize * scene.diagonal * float(samples.size())) / std::max(spacing, 1e-9);
        blurs_ = int(std::clamp(rings * rings, 1.0, 400.0));
    }

    std::vector<Vec2> run() {
        const size_t n = samples_.size();
        for (const HueSample& s : samples_) {
            hue_.push_back(hueOf(Rgb(std::log(s.albedo[0]), std::log(s.albedo[1]), std::log(s.albedo[2]))));
            const glm::mat2 j = changeOf(s);
            certainty_.push_back(glm::inverse(glm::mat2(hueNoise * hueNoise + 2 * s.sigma * s.sigma) +
                                              leanDeviation * leanDeviation * j * glm::transpose(j)));
        }
        std::vector<Vec2> own = hue_;
        for (int round = 0; round < hueRounds; ++round) smooth(own);
        std::vector<Vec3> field(n);
        for (size_t i = 0; i < n; ++i) {
            const Vec2 lean = leanDeviation * leanDeviation * glm::transpose(changeOf(samples_[i])) *
                              (certainty_[i] * (hue_[i] - own[i]));
            field[i] = lean.x * samples_[i].tangents[0] + lean.y * samples_[i].tangents[1];
        }
        const std::vector<Vec3> mean = blurred(field);
        std::vector<Vec2> leans(n);
        for (size_t i = 0; i < n; ++i) {
            const Vec3 left = field[i] - mean[i];
            const Vec2 lean(glm::dot(left, samples_[i].tangents[0]), glm::dot(left, samples_[i].tangents[1]));
            leans[i] = lean * std::min(1.0f, steepestLean / std::max(1e-9f, glm::length(lean)));
        }
        return leans;
    }

private:
    static Vec2 hueOf(const Rgb& logs) { return {logs[0] - logs[1], logs[2] - logs[1]}; }
    /// Of the hue with the lean: one column a tangent.
    static glm::mat2 changeOf(const HueSample& s) { return {hueOf(s.change[0]), hueOf(s.change[1])}; }

    /// The surface's hue under weights of the present one.
    void smooth(std::vector<Vec2>& own) const {
        std::vector<float> weights(neighbours_.size());
        for (size_t i = 0; i < own.size(); ++i)
            for (uint32_t e = start_[i]; e < start_[i + 1]; ++e) {
                const Vec2 step = own[neighbours_[e]] - own[i];
                weights[e] = std::exp(-glm::dot(step, step) / (hueEdge * hueEdge)) / (hueStep * hueStep);
            }
        for (int sweep = 0; sweep < hueSweeps; ++sweep)
            for (size_t i = 0; i < own.size(); ++i) {
                glm::mat2 sum = certainty_[i];
                Vec2 right = certainty_[i] * hue_[i];
                for (uint32_t e = start_[i]; e < start_[i + 1]; ++e) {
                    sum += glm::mat2(weights[e]);
                    right += weights[e] * own[neighbours_[e]];
                }
                own[i] = glm::inverse(sum) * right;
            }
    }

    std::vector<Vec3> blurred(std::vector<Vec3> field) const {
        for (int k = 0; k < blurs_; ++k) {
            const std::vector<Vec3> last = field;
            for (size_t i = 0; i < field.size(); ++i) {
                Vec3 sum = last[i];
                for (uint32_t e = start_[i]; e < start_[i + 1]; ++e) sum += last[neighbours_[e]];
                field[i] = sum / float(1 + start_[i + 1] - start_[i]);
            }
        }
        return field;
    }

    const std::vector<HueSample>& samples_;
    std::vector<uint32_t> start_, neighbours_;
    int blurs_ = 1;
    std::vector<Vec2> hue_;
    std::vector<glm::mat2> certainty_;
};

}  // namespace

std::vector<Vec2> hueLeans(const Scene& scene, const std::vector<HueSample>& samples) {
    return samples.empty() ? std::vector<Vec2>() : HueLeans(scene, samples).run();
}

}  // namespace relamp
