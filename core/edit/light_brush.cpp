#include "edit/light_brush.h"

#include "base/error.h"
#include "edit/emitter_edits.h"

namespace relamp {
namespace {

constexpr size_t stillAtMost = 4096;

/// Matte albedo at a vertex of the live mesh; black on added shapes.
Rgb albedoAt(const LiveFrame& frame, const Estimate& estimate, const Look& look, size_t vertex) {
    const uint32_t origin = frame.origin ? (*frame.origin)[vertex] : uint32_t(vertex);
    if (origin == ~0u) return Rgb(0);
    const Rgb albedo = estimate.reflectance.at(origin).albedo();
    return look.neutralMaterials ? Rgb(luminance(albedo)) : albedo;
}

Rgb wantedOf(const Rgb& now, const LightBrush& brush, float amount) {
    switch (brush.kind) {
        case LightBrush::Kind::brighter: return now * std::exp2(brush.stops * amount);
        case LightBrush::Kind::darker: return now * std::exp2(-brush.stops * amount);
        case LightBrush::Kind::colour: break;
    }
    const float level = luminance(brush.colour);
    return level > 0 ? glm::mix(now, brush.colour * (luminance(now) / level), amount) : now;
}

}  // namespace

LightGoal brushedGoal(const LiveFrame& frame, const Estimate& estimate, const Look& look,
                      std::span<const PaintedVertex> painted, const LightBrush& brush, const PaintedLights& lights) {
    const size_t n = frame.radiance.size();
    for (const size_t e : lights.emitters)
        if (e >= frame.formFactor.size()) throw Error("light {} does not exist", e);
    std::vector<float> amount(n, 0);
    float sum = 0;
    for (const PaintedVertex& p : painted) {
        if (p.vertex >= n) throw Error("vertex {} does not exist", p.vertex);
        amount[p.vertex] = std::max(amount[p.vertex], std::clamp(p.amount, 0.0f, 1.0f));
    }
    for (const float a : amount) sum += a;
    std::vector<uint8_t> emitting(n, 0);
    if (frame.emitterOfTriangle)
        for (size_t t = 0; t < frame.mesh->triangles.size(); ++t)
            if ((*frame.emitterOfTriangle)[t] >= 0)
                for (const uint32_t v : frame.mesh->triangles[t]) emitting[v] = 1;

    LightGoal goal;
    goal.response.resize(lights.emitters.size() + (lights.environment ? 1 : 0));
    goal.present.assign(goal.response.size(), Rgb(1));
    const size_t step = std::max<size_t>(1, n / stillAtMost);
    const float still = brush.stillness * sum / float(std::max<size_t>(1, n / step));
    for (size_t v = 0; v < n; ++v) {
        if (emitting[v] || !(amount[v] > 0 || v % step == 0)) continue;
        const Rgb now = frame.radiance[v], albedo = albedoAt(frame, estimate, look, v);
        if (!(maxChannel(now) > 0)) continue;
        Rgb rest = now;
        for (size_t k = 0; k < goal.response.size(); ++k) {
            const Rgb light = k < lights.emitters.size() ? albedo * frame.formFactor[lights.emitters[k]][v] *
                                                               frame.emitterRadiance[lights.emitters[k]]
                                                         : albedo * frame.distantMatte[v];
            goal.response[k].push_back(light);
            rest -= light;
        }
        goal.weight.push_back(amount[v] > 0 ? amount[v] : still);
        goal.target.push_back(wantedOf(now, brush, amount[v]));
        goal.rest.push_back(glm::max(rest, Rgb(0)));
    }
    return goal;
}

void scaleLights(Look& look, const Estimate& estimate, const std::vector<std::string>& ids, bool environment,
                 const std::vector<Rgb>& scale) {
    for (size_t k = 0; k < ids.size(); ++k) {
        if (!(maxChannel(scale[k]) > 0)) setEnabled(look, ids[k], false);
        else if (const auto now = radianceOf(look, estimate, ids[k]))
            setRadiance(look, estimate, ids[k], *now * scale[k]);
    }
    if (!environment) return;
    const float level = luminance(scale.back());
    if (level > 0) {
        look.environment.exposureStops += std::log2(level);
        look.environment.tint *= scale.back() / level;
    } else {
        look.environment.source = EnvironmentLook::Source::none;
    }
}

std::string wordsOf(const LightGoalAnswer& answer, const std::vector<std::string>& names, bool environment) {
    std::string words;
    for (size_t k = 0; k < answer.scale.size(); ++k) {
        const float level = luminance(answer.scale[k]);
        const std::string& name = environment && k + 1 == answer.scale.size() ? "environment" : names[k];
        if (level > 0 && std::abs(std::log2(level)) < 0.005f) continue;
        words += words.empty() ? "" : ", ";
        words += level > 0 ? fmt::format("{} {:+.2f} stops", name, std::log2(level)) : name + " off";
    }
    if (words.empty()) words = "No light changed";
    if (answer.tooDark > 0.1f)
        words +=
            fmt::format("; {:.0f} % stays too dark: no light that may change reaches it alone", 100 * answer.tooDark);
    if (answer.tooBright > 0.1f)
        words += fmt::format("; {:.0f} % stays too bright: other light falls on it", 100 * answer.tooBright);
    return words;
}

}  // namespace relamp
