#include "interrupted.h"

#include <nlohmann/json.hpp>

#include <ctime>

#include "base/atomic_file.h"
#include "base/is_there.h"
#include "base/json_fields.h"
#include "base/local_time.h"
#include "base/log.h"
#include "base/random.h"

namespace relamp::ui {
namespace {
namespace fs = std::filesystem;
using Json = nlohmann::json;

constexpr const char* suffix = ".estimate.json";

fs::path checkpointOf(const fs::path& record) {
    fs::path file = record;
    return file.replace_extension(".checkpoint");
}

Json toJson(const MarkedReference& mark) {
    Json json{{"kind", int(mark.kind)},
              {"view", mark.view},
              {"points", Json::array()},
              {"radius", mark.radius},
              {"albedo", {mark.albedo.x, mark.albedo.y, mark.albedo.z}},
              {"photograph", mark.photograph.string()}};
    for (const Vec2& p : mark.points) json["points"].push_back({p.x, p.y});
    return json;
}

MarkedReference markOf(const Json& json) {
    MarkedReference mark;
    const int kind = json.at("kind").get<int>();
    if (kind < 0 || kind > int(MarkedReference::Kind::chart)) throw Error("a light reference that does not exist");
    mark.kind = MarkedReference::Kind(kind);
    mark.view = json.at("view").get<size_t>();
    for (const Json& p : json.at("points")) mark.points.emplace_back(p.at(0).get<float>(), p.at(1).get<float>());
    const size_t points = mark.kind == MarkedReference::Kind::chart ? 4 : 1;
    if (mark.points.size() != points) throw Error("a light reference without its points");
    mark.radius = json.at("radius").get<float>();
    for (int c = 0; c < 3; ++c) mark.albedo[c] = json.at("albedo").at(size_t(c)).get<float>();
    mark.photograph = json.at("photograph").get<std::string>();
    return mark;
}

Json toJson(const SolveRequest& r) {
    Json json{{"near_field", r.nearField},
              {"quality", r.quality},
              {"budget_s", r.budgetSeconds},
              {"seed", r.seed},
              {"gauge",
               {{"kind", int(r.gauge.kind)},
                {"view", r.gauge.view},
                {"pixel", {r.gauge.pixel.x, r.gauge.pixel.y}},
                {"white_albedo", r.gauge.whiteAlbedo},
                {"emitter", r.gauge.emitter},
                {"radiance", {r.gauge.radiance.x, r.gauge.radiance.y, r.gauge.radiance.z}},
                {"albedo", r.gauge.albedo}}},
              {"palette", r.palette},
              {"light_smoothness", r.lightSmoothness},
              {"albedo_smoothness", r.albedoSmoothness},
              {"basis", r.basis},
              {"merl", r.merl.string()},
              {"bounce", int(r.bounce)}};
    if (r.meshTriangles) json["mesh_triangles"] = *r.meshTriangles;
    if (r.texture) json["texture"] = *r.texture;
    for (const fs::path& probe : r.lightProbes) json["light_probes"].push_back(probe.string());
    for (const MarkedReference& mark : r.marks) json["marks"].push_back(toJson(mark));
    return json;
}

/// Throws nlohmann's exceptions for what is not there, Error for what cannot be.
SolveRequest requestOf(const Json& json) {
    SolveRequest r;
    r.nearField = json.at("near_field").get<bool>();
    r.quality = json.at("quality").get<std::string>();
    r.budgetSeconds = json.at("budget_s").get<double>();
    r.seed = json.at("seed").get<uint64_t>();
    const Json& gauge = json.at("gauge");
    const int kind = gauge.at("kind").get<int>(), bounce = json.at("bounce").get<int>();
    if (kind < 0 || kind > int(GaugeChoice::Kind::albedo) || bounce < 0 || bounce > int(SolveOptions::Bounce::on))
        throw Error("a setting that does not exist");
    r.gauge.kind = GaugeChoice::Kind(kind);
    r.gauge.view = gauge.at("view").get<int>();
    r.gauge.pixel = {gauge.at("pixel").at(0).get<float>(), gauge.at("pixel").at(1).get<float>()};
    r.gauge.whiteAlbedo = gauge.at("white_albedo").get<float>();
    r.gauge.emitter = gauge.at("emitter").get<std::string>();
    for (int c = 0; c < 3; ++c) r.gauge.radiance[c] = gauge.at("radiance").at(size_t(c)).get<float>();
    r.gauge.albedo = gauge.at("albedo").get<float>();
    r.palette = json.at("palette").get<int>();
    r.lightSmoothness = json.at("light_smoothness").get<float>();
    r.albedoSmoothness = json.at("albedo_smoothness").get<float>();
    r.basis = json.at("basis").get<std::string>();
    r.merl = json.at("merl").get<std::string>();
    r.bounce = SolveOptions::Bounce(bounce);
    if (json.contains("mesh_triangles")) r.meshTriangles = json.at("mesh_triangles").get<size_t>();
    if (json.contains("texture")) r.texture = json.at("texture").get<int>();
    if (json.contains("light_probes"))
        for (const Json& probe : json.at("light_probes")) r.lightProbes.emplace_back(probe.get<std::string>());
    if (json.contains("marks"))
        for (const Json& mark : json.at("marks")) r.marks.push_back(markOf(mark));
    return r;
}

/// Throws Error when it cannot be written.
void writeRecord(const InterruptedEstimate& what) {
    const Json json{{"version", 1},
                    {"capture", what.captureFolder.string()},
                    {"project", what.project.string()},
                    {"time", what.time},
                    {"request", toJson(what.request)}};
    writeBytesAtomically(what.record, dumpJson(json, 1, BadText::replace));
}

}  // namespace

PipelineOptions pipelineOptionsOf(const SolveRequest& request) {
    PipelineOptions options;
    options.solve = solveOptionsFor(request.quality);
    options.solve.nearField = request.nearField;
    options.solve.gauge = request.gauge;
    options.solve.seed = request.seed;
    options.solve.palette = size_t(std::max(0, request.palette));
    options.solve.lightSmoothness = request.lightSmoothness;
    options.solve.albedoSmoothness = request.albedoSmoothness;
    options.solve.bounce = request.bounce;
    chooseBasis(request.basis, request.merl, options.solve);
    options.meshTriangles = request.meshTriangles;
    options.texture = request.texture;
    for (const fs::path& probe : request.lightProbes) options.probes.push_back(readLightProbe(probe));
    for (const MarkedReference& mark : request.marks) takeReference(mark, options);
    return options;
}

fs::path interruptedRecord(const fs::path& stateFolder, const fs::path& captureFolder) {
    if (stateFolder.empty()) return {};
    uint64_t hash = 0;
    for (const char c : captureFolder.lexically_normal().string()) hash = mixBits(hash ^ uint8_t(c));
    return stateFolder / "estimates" / fmt::format("{:016x}{}", hash, suffix);
}

std::optional<InterruptedEstimate> readInterrupted(const fs::path& record) {
    if (record.empty() || !isThere(record) || !isThere(checkpointOf(record))) return {};
    if (!ShotLock::take(record).owner().empty()) return {};
    try {
        const Json json = parseJson(readBytes(record, 1 << 20), record.string());
        InterruptedEstimate found;
        found.record = record;
        found.captureFolder = json.at("capture").get<std::string>();
        found.project = json.at("project").get<std::string>();
        found.time = json.at("time").get<std::string>();
        found.request = requestOf(json.at("request"));
        return found;
    } catch (const std::exception& damage) {
        logWarning("{}: is damaged, the estimate cannot go on ({})", record.string(), damage.what());
        return {};
    }
}

std::vector<InterruptedEstimate> findInterrupted(const fs::path& stateFolder) {
    std::vector<InterruptedEstimate> found;
    if (stateFolder.empty()) return found;
    std::error_code error;
    for (fs::directory_iterator entry(stateFolder / "estimates", error), end; !error && entry != end;
         entry.increment(error))
        if (entry->path().filename().string().ends_with(suffix))
            if (std::optional<InterruptedEstimate> one = readInterrupted(entry->path()))
                if (isThere(one->project)) found.push_back(std::move(*one));
    std::sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.time > b.time; });
    return found;
}

std::optional<InterruptedEstimate> interruptedFor(const Document& document, const fs::path& stateFolder) {
    if (!document.samples) return {};
    std::optional<InterruptedEstimate> found = readInterrupted(interruptedRecord(stateFolder, document.captureFolder));
    if (!found) return {};
    try {
        const uint64_t fingerprint = fingerprintOf(*document.capture, pipelineOptionsOf(found->request));
        const FoundCheckpoint file = readCheckpoint(checkpointOf(found->record), fingerprint);
        if (file.checkpoint) {
            found->seconds = file.checkpoint->seconds;
            return found;
        }
        logInfo("an interrupted estimate of this capture cannot go on: {}", file.refused);
    } catch (const Error& error) { logInfo("an interrupted estimate of this capture cannot go on: {}", error.what()); }
    return {};
}

void discardInterrupted(const fs::path& record) {
    if (record.empty()) return;
    std::error_code ignored;
    fs::remove(record, ignored);
    fs::remove(checkpointOf(record), ignored);
}

EstimateKeeper::EstimateKeeper(InterruptedEstimate what, uint64_t fingerprint, double everySeconds)
    : what_(std::move(what)),
      fingerprint_(fingerprint),
      keeper_(checkpointOf(what_.record), fingerprint, everySeconds) {
    if (what_.record.empty()) return;
    std::error_code ignored;
    fs::create_directories(what_.record.parent_path(), ignored);
    lock_ = ShotLock::take(what_.record);
    what_.time = localTime();
}

std::optional<SolveCheckpoint> EstimateKeeper::earlier() const {
    FoundCheckpoint found = readCheckpoint(checkpointOf(what_.record), fingerprint_);
    if (!found.checkpoint) logWarning("{}; the estimate starts anew", found.refused);
    return std::move(found.checkpoint);
}

void EstimateKeeper::take(const SolveCheckpoint& checkpoint) {
    if (!lock_.held()) return;
    if (!std::exchange(recorded_, true)) {
        try {
            writeRecord(what_);
        } catch (const Error& error) {
            logWarning("a killed estimate could not go on: {}", error.what());
            lock_.release();
            return;
        }
    }
    keeper_.take(checkpoint);
}

void EstimateKeeper::stopped() {
    if (lock_.held()) keeper_.flush();
}

void EstimateKeeper::finished() {
    if (lock_.held()) discardInterrupted(what_.record);
}

}  // namespace relamp::ui
