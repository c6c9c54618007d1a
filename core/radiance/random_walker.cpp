#include "radiance/random_walker.h"

#include <cmath>

namespace relamp {
namespace {

constexpr int mostSteps = 400;
constexpr double accuracy = 1e-5;  ///< of the residual

double dot(const std::vector<double>& a, const std::vector<double>& b) {
    double sum = 0;
    for (size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
    return sum;
}

}  // namespace

std::vector<float> randomWalkerLabels(const VertexGraph& graph, const std::vector<float>& edgeWeight,
                                      const std::vector<LabelPrior>& priors) {
    const size_t count = priors.size();
    std::vector<float> labels(count, 0.5f);
    std::vector<uint32_t> rowOf(count, ~0u), unknown;
    for (uint32_t v = 0; v < count; ++v) {
        if (std::isinf(priors[v].weight)) {
            labels[v] = priors[v].label;
            continue;
        }
        rowOf[v] = uint32_t(unknown.size());
        unknown.push_back(v);
    }
    const size_t rows = unknown.size();
    std::vector<double> diagonal(rows, 0), right(rows, 0), x(rows, 0.5);
    for (size_t i = 0; i < rows; ++i) {
        const uint32_t v = unknown[i];
        diagonal[i] = double(priors[v].weight);
        right[i] = double(priors[v].weight) * double(priors[v].label);
        for (uint32_t e = graph.start[v]; e < graph.start[v + 1]; ++e) {
            diagonal[i] += double(edgeWeight[e]);
            const uint32_t w = graph.to[e];
            if (rowOf[w] == ~0u) right[i] += double(edgeWeight[e]) * double(labels[w]);
        }
    }
    const auto multiply = [&](const std::vector<double>& in, std::vector<double>& out) {
        for (size_t i = 0; i < rows; ++i) {
            const uint32_t v = unknown[i];
            double sum = diagonal[i] * in[i];
            for (uint32_t e = graph.start[v]; e < graph.start[v + 1]; ++e)
                if (const uint32_t j = rowOf[graph.to[e]]; j != ~0u) sum -= double(edgeWeight[e]) * in[j];
            out[i] = sum;
        }
    };
    std::vector<double> residual(rows), scaled(rows), direction(rows), product(rows);
    multiply(x, product);
    const auto scale = [&] {
        for (size_t i = 0; i < rows; ++i) scaled[i] = diagonal[i] > 0 ? residual[i] / diagonal[i] : 0;
    };
    for (size_t i = 0; i < rows; ++i) residual[i] = right[i] - product[i];
    scale();
    direction = scaled;
    double now = dot(residual, scaled);
    const double least = accuracy * accuracy * now;
    for (int step = 0; step < mostSteps && now > least; ++step) {
        multiply(direction, product);
        const double curvature = dot(direction, product);
        if (!(curvature > 0)) break;
        for (size_t i = 0; i < rows; ++i) {
            x[i] += now / curvature * direction[i];
            residual[i] -= now / curvature * product[i];
        }
        scale();
        const double next = dot(residual, scaled);
        for (size_t i = 0; i < rows; ++i) direction[i] = scaled[i] + next / now * direction[i];
        now = next;
    }
    for (size_t i = 0; i < rows; ++i) labels[unknown[i]] = float(x[i]);
    return labels;
}

}  // namespace relamp
