#include "shot/frame_layers.h"

#include <array>
#include <cctype>

#include "shot/cryptomatte.h"
#include "shot/frame_jobs.h"

namespace relamp {
namespace {

constexpr const char* cryptomatteLayer = "CryptoEmitter";

struct Named {
    const char* name;
    bool LayerRequest::*wanted;
};
constexpr std::array<Named, 9> layerNames{{{"groups", &LayerRequest::groups},
                                           {"albedo", &LayerRequest::albedo},
                                           {"correction", &LayerRequest::correction},
                                           {"residual", &LayerRequest::residual},
                                           {"normal", &LayerRequest::normal},
                                           {"position", &LayerRequest::position},
                                           {"depth", &LayerRequest::depth},
                                           {"cryptomatte", &LayerRequest::cryptomatte},
                                           {"confidence", &LayerRequest::confidence}}};

/// Nuke drops leading digits, other readers split at the first dot: letters, digits and underscores only.
std::string channelSafe(const std::string& name) {
    std::string safe;
    for (char c : name) safe += std::isalnum(static_cast<unsigned char>(c)) ? c : '_';
    if (safe.empty() || !std::isalpha(static_cast<unsigned char>(safe[0]))) safe = "L_" + safe;
    return safe;
}

/// Names of the light groups: channel-safe, and no two alike.
std::vector<std::string> groupNames(const std::vector<std::string>& emitters) {
    std::vector<std::string> names{"world"};
    const auto taken = [&](const std::string& name) {
        return name == "rest" || std::find(names.begin(), names.end(), name) != names.end();
    };
    for (const std::string& emitter : emitters) {
        const std::string safe = channelSafe(emitter);
        std::string name = safe;
        for (int i = 2; taken(name); ++i) name = fmt::format("{}_{}", safe, i);
        names.push_back(name);
    }
    names.push_back("rest");
    return names;
}

ChannelPart colours(const std::string& layer, const char* axes = "RGB", bool half = true) {
    ChannelPart part{layer, {}};
    for (const char* axis = axes; *axis; ++axis) part.channels.push_back({layer + "." + *axis, half});
    return part;
}

}  // namespace

LayerNaming layerNaming(const std::string& name) {
    if (name == "blender") return LayerNaming::blender;
    if (name == "arnold") return LayerNaming::arnold;
    throw BadOption("--naming {}: unknown, expected blender or arnold", name);
}

LayerRequest layerRequest(const std::string& layers) {
    LayerRequest request;
    if (layers == "all") {
        for (const Named& layer : layerNames) request.*layer.wanted = true;
        request.all = true;
        return request;
    }
    for (size_t at = 0; at < layers.size();) {
        const size_t comma = std::min(layers.find(',', at), layers.size());
        const std::string name = layers.substr(at, comma - at);
        const auto known =
            std::find_if(layerNames.begin(), layerNames.end(), [&](const Named& layer) { return name == layer.name; });
        if (known == layerNames.end())
            throw BadOption(
                "--layers {}: unknown, expected groups, albedo, correction, residual, normal, position, depth, "
                "cryptomatte, confidence or all",
                name);
        request.*known->wanted = true;
        at = comma + 1;
    }
    return request;
}

double closeGroups(FrameStrip& strip, bool detail) {
    const Frame& frame = strip.frame;
    strip.rest.resize(frame.beauty.size());
    double worst = 0;
    for (size_t p = 0; p < strip.rest.size(); ++p) {
        Rgb sum = frame.world[p];
        for (const auto& group : frame.byEmitter) sum += group[p];
        strip.rest[p] = frame.beauty[p] - sum;
        worst = std::max(worst,
                         double(maxChannel(glm::abs(detail ? strip.rest[p] + sum - frame.beauty[p] : strip.rest[p]))));
    }
    return worst;
}

std::vector<Rgb> bakedFactor(const Frame& captured) {
    constexpr float most = 64;
    std::vector<Rgb> factor(captured.beauty.size(), Rgb(1));
    for (size_t p = 0; p < factor.size(); ++p) {
        if (captured.emittersSeen[p][0].emitter >= 0 || !(captured.alpha[p] > 0)) continue;
        for (int c = 0; c < 3; ++c) {
            const float all = captured.beauty[p][c];
            if (all > 0) factor[p][c] = std::max(1.0f, all / std::max(captured.world[p][c], all / most));
        }
    }
    return factor;
}

FrameLayers::FrameLayers(const LayerRequest& request, LayerNaming naming, const std::vector<std::string>& emitterNames,
                         const DVec3& origin)
    : request_(request), naming_(naming), names_(emitterNames), origin_(origin) {
    for (const std::string& name : names_) cryptomatteIds_.push_back(cryptomatteId(name));
}

std::vector<ChannelPart> FrameLayers::parts(bool multipart) const {
    std::vector<ChannelPart> parts{{"rgba", {{"R", true}, {"G", true}, {"B", true}, {"A", true}}}};
    if (request_.groups)
        for (const std::string& group : groupNames(names_))
            parts.push_back(colours((naming_ == LayerNaming::arnold ? "RGBA_" : "Combined_") + group));
    if (request_.albedo) parts.push_back(colours("albedo"));
    if (request_.correction) parts.push_back(colours("correction"));
    if (request_.residual) parts.push_back(colours("residual"));
    if (request_.normal) parts.push_back(colours("normal", "XYZ", false));
    if (request_.position) parts.push_back(colours("position", "XYZ", false));
    if (request_.depth) parts.push_back(colours("depth", "Z", false));
    if (request_.confidence) parts.push_back(colours("confidence", "Y"));
    if (request_.cryptomatte)
        for (size_t level = 0; level < cryptomatteLevels; ++level)
            parts.push_back(colours(fmt::format("{}{:02}", cryptomatteLayer, level), "RGBA", false));
    if (multipart) return parts;
    for (size_t i = 1; i < parts.size(); ++i)
        parts[0].channels.insert(parts[0].channels.end(), parts[i].channels.begin(), parts[i].channels.end());
    parts.resize(1);
    return parts;
}

void FrameLayers::fill(const FrameStrip& strip, const std::vector<float*>& out) const {
    const Frame& frame = strip.frame;
    const size_t pixels = frame.beauty.size();
    size_t channel = 0;
    const auto put = [&](const std::vector<Vec3>& values) {
        for (int c = 0; c < 3; ++c, ++channel)
            for (size_t p = 0; p < pixels; ++p) out[channel][p] = values.empty() ? 0.0f : values[p][c];
    };
    const auto putOne = [&](const std::vector<float>& values) {
        std::copy(values.begin(), values.end(), out[channel++]);
    };
    put(frame.beauty);
    putOne(frame.alpha);
    if (request_.groups) {
        put(frame.world);
        for (const auto& group : frame.byEmitter) put(group);
        put(strip.rest);
    }
    if (request_.albedo) put(frame.albedo);
    if (request_.correction) put(strip.correction);
    if (request_.residual) put(strip.residual);
    if (request_.normal) put(frame.normal);
    if (request_.position)
        for (int c = 0; c < 3; ++c, ++channel)
            for (size_t p = 0; p < pixels; ++p)
                out[channel][p] = frame.position.empty()   ? 0.0f
                                  : frame.depth[p] < 1e30f ? float(origin_[c] + double(frame.position[p][c]))
                                                           : frame.position[p][c];
    if (request_.depth) putOne(frame.depth);
    if (request_.confidence) putOne(strip.confidence);
    if (!request_.cryptomatte) return;
    for (size_t rank = 0; rank < Frame::ranks; ++rank, channel += 2)
        for (size_t p = 0; p < pixels; ++p) {
            const EmitterContribution seen =
                frame.emittersSeen.empty() ? EmitterContribution{} : frame.emittersSeen[p][rank];
            out[channel][p] = seen.emitter < 0 ? 0.0f : cryptomatteIds_[size_t(seen.emitter)];
            out[channel + 1][p] = seen.fraction;
        }
}

std::map<std::string, std::string> FrameLayers::header() const {
    return request_.cryptomatte ? cryptomatteHeader(cryptomatteLayer, names_) : std::map<std::string, std::string>{};
}

}  // namespace relamp
