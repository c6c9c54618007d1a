#include "shot/shot_file.h"

#include <fcntl.h>
#include <sys/resource.h>
#include <unistd.h>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/log.h"
#include "capture/load_capture.h"
#include "image/environment_map.h"
#include "scene/mesh_io.h"

namespace relamp {
namespace fs = std::filesystem;
using Json = nlohmann::json;

double peakMib() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return double(usage.ru_maxrss) / 1024;
}

namespace {

Json toJson(const Rgb& c) { return {c.x, c.y, c.z}; }

Json evidenceJson(const EmitterEvidence& e) {
    return {{"scene_contrast", e.sceneContrast}, {"local_contrast", e.localContrast}, {"uniformity", e.uniformity}, {"view_spread", e.viewSpread},
            {"edge_drop", e.edgeDrop}, {"demanded_albedo", e.demandedAlbedo}, {"samples", e.samples}};
}

const char* kindName(Lobe::Kind kind) { return kind == Lobe::Kind::lambert ? "lambert" : kind == Lobe::Kind::ggx ? "ggx" : "ggx_dielectric"; }

const Json& need(const Json& object, const char* key) {
    const auto at = object.find(key);
    if (at == object.end()) throw Error("{}: is missing", key);
    return *at;
}

Rgb colour(const Json& value, const std::string& where) {
    if (!value.is_array() || value.size() != 3 || !value[0].is_number() || !value[1].is_number() || !value[2].is_number()) throw Error("{}: expected three numbers", where);
    return {value[0].get<float>(), value[1].get<float>(), value[2].get<float>()};
}

}  // namespace

Json shotInfo(const Shot& shot) {
    const Estimate& e = shot.estimate;
    Json info;
    info["version"] = 1;
    info["mode"] = e.mode;
    info["quality"] = shot.quality;
    info["emitters"] = Json::array();
    for (size_t i = 0; i < e.emitters.emitters.size(); ++i) {
        const EmitterCluster& c = e.emitters.emitters[i];
        Json j{{"id", c.id}, {"name", c.id}, {"centroid", toJson(c.centroid)}, {"normal", toJson(c.normal)}, {"area_m2", c.area}, {"triangles", c.triangles.size()},
               {"power", toJson(e.lighting.emitterRadiance[i])}, {"two_sided", c.twoSided}, {"views_seen", c.evidence.viewsSeen}, {"clipped_share", c.evidence.clippedShare},
               {"evidence", evidenceJson(c.evidence)}};
        if (i < e.emitterSigma.size()) j["power_stddev"] = toJson(e.emitterSigma[i]);
        if (i < e.identifiability.size()) j["identifiability"] = e.identifiability[i];
        info["emitters"].push_back(j);
    }
    info["rejected_patches"] = Json::array();
    for (const RejectedPatch& r : e.emitters.rejected)
        info["rejected_patches"].push_back({{"centroid", toJson(r.centroid)}, {"radiance", toJson(r.radiance)}, {"reason", r.reason}, {"evidence", evidenceJson(r.evidence)}});
    info["environment"] = {{"kept_coefficients", e.lighting.leaves.size()}, {"grid_side", e.environmentSide}};
    info["gauge"] = {{"kind", e.gauge.kind}, {"evidence", e.gauge.evidence}, {"scale", toJson(e.gauge.scale)}};
    info["basis"] = Json::array();
    for (const Lobe& l : e.reflectance.basis.lobes) info["basis"].push_back({{"kind", kindName(l.kind)}, {"alpha", l.alpha}, {"name", l.name}});
    info["left_out"] = Json::array();
    for (const LeftOut& l : e.leftOut) info["left_out"].push_back({{"what", l.what}, {"why", l.why}});
    info["timeline"] = Json::array();
    for (const TimelineEntry& t : e.timeline)
        info["timeline"].push_back({{"seconds", t.seconds}, {"stage", t.stage}, {"iteration", t.iteration}, {"objective", t.objective}, {"rmse", t.rmse}});
    info["stability"] = {{"condition_number", e.stability.conditionNumber}, {"kkt_residual", e.stability.kktResidual}, {"effective_rank", e.stability.effectiveRank},
                         {"unknowns", e.stability.unknowns}, {"reason", e.stability.reason}};
    info["resources"] = {{"seconds", shot.resources.seconds}, {"peak_mib", shot.resources.peakMib}, {"threads", shot.resources.threads}};
    info["stopped_early"] = e.cancelled;
    return info;
}

void saveShot(const Shot& shot, const Mesh& mesh, const fs::path& folder, bool overwrite) {
    std::error_code failed;
    const bool exists = fs::exists(folder, failed);
    if (exists && !overwrite) throw Error("{}: exists already, add --overwrite to replace it", folder.string());
    const fs::path parent = fs::absolute(folder).lexically_normal().parent_path();
    const fs::path fresh = parent / fmt::format(".{}.{}", folder.filename().string(), ::getpid());
    fs::create_directories(fresh, failed);
    if (failed) throw Error("{}: cannot be made ({})", folder.string(), failed.message());
    try {
        Json document = shotInfo(shot);
        if (exists && fs::exists(folder / "shot.json")) {
            const Json old = Json::parse(readBytes(folder / "shot.json"), nullptr, false);
            if (old.is_object())
                for (const auto& [key, value] : old.items())
                    if (!document.contains(key)) document[key] = value;
        }
        const fs::path target = parent / folder.filename();
        document["capture"] = fs::proximate(fs::absolute(shot.captureFolder), target).string();
        document["look"] = lookToJson(shot.look);
        document["seed"] = shot.seed;
        const DirectionGrid grid{shot.estimate.environmentSide};
        const Image map = latLongFromCells(shot.estimate.environment, grid, 1024);
        std::vector<Channel> channels(3);
        const char* names[] = {"R", "G", "B"};
        for (int c = 0; c < 3; ++c) {
            channels[size_t(c)].name = names[c];
            channels[size_t(c)].half = false;  // a sun exceeds what half floats hold
            for (const Rgb& p : map.pixels) channels[size_t(c)].values.push_back(p[c]);
        }
        writeChannels(fresh / "environment.exr", map.width, map.height, channels);
        const Reflectance& r = shot.estimate.reflectance;
        std::vector<VertexProperty> properties;
        const char* suffix[] = {"r", "g", "b"};
        const auto add = [&](const std::string& name, const std::vector<Rgb>& values) {
            for (int c = 0; c < 3; ++c) {
                VertexProperty p{fmt::format("{}_{}", name, suffix[c]), {}, false};
                for (const Rgb& v : values) p.values.push_back(v[c]);
                properties.push_back(std::move(p));
            }
        };
        add("albedo", r.weight[0]);
        for (size_t k = 0; k < r.weight.size(); ++k) add(fmt::format("weight_{}", k), r.weight[k]);
        properties.push_back({"observed", {r.observed.begin(), r.observed.end()}, true});
        properties.push_back({"emitter", {shot.estimate.emitters.emitterOfVertex.begin(), shot.estimate.emitters.emitterOfVertex.end()}, true});
        properties.push_back({"confidence", r.confidence, false});
        writeVertexPly(fresh / "reflectance.ply", mesh, properties);
        writeBytesAtomically(fresh / "shot.json", document.dump(1) + "\n");
        if (exists) {
            // What relamp did not write stays.
            for (const auto& entry : fs::directory_iterator(folder)) {
                const std::string name = entry.path().filename().string();
                if (name != "shot.json" && name != "environment.exr" && name != "reflectance.ply" && name != "cache") fs::rename(entry.path(), fresh / name, failed);
            }
            if (::renameat2(AT_FDCWD, fresh.c_str(), AT_FDCWD, fs::absolute(folder).c_str(), RENAME_EXCHANGE) != 0) {
                fs::remove_all(folder, failed);
                fs::rename(fresh, folder);
            } else {
                fs::remove_all(fresh, failed);
            }
        } else {
            fs::rename(fresh, folder);
        }
    } catch (const fs::filesystem_error& error) {
        fs::remove_all(fresh, failed);
        throw Error("{}: cannot be written ({})", folder.string(), error.code().message());
    } catch (...) {
        fs::remove_all(fresh, failed);
        throw;
    }
}

Shot openShot(const fs::path& folder, bool withImages, Progress& progress) {
    Shot shot;
    shot.folder = folder;
    const fs::path file = folder / "shot.json";
    if (!fs::exists(file)) throw Error("{}: is not a shot, there is no shot.json in it", folder.string());
    const Json document = Json::parse(readBytes(file, 256 << 20), nullptr, false);
    if (!document.is_object()) throw Error("{}: is not valid JSON", file.string());
    Estimate& e = shot.estimate;
    Json emitters;
    withContext(file.string(), [&] {
        try {
            if (need(document, "version").get<int>() != 1) throw Error("version: is {}, expected 1", document["version"].dump());
            shot.captureFolder = (fs::absolute(folder) / need(document, "capture").get<std::string>()).lexically_normal();
            e.mode = document.value("mode", "near-field");
            shot.quality = document.value("quality", "standard");
            shot.seed = document.value("seed", uint64_t(1));
            emitters = need(document, "emitters");
            for (const Json& l : need(document, "basis")) {
                Lobe lobe;
                const std::string kind = l.value("kind", "lambert");
                lobe.kind = kind == "ggx" ? Lobe::Kind::ggx : kind == "ggx_dielectric" ? Lobe::Kind::ggxDielectric : Lobe::Kind::lambert;
                lobe.alpha = l.value("alpha", 1.0f);
                lobe.name = l.value("name", kind);
                e.reflectance.basis.lobes.push_back(lobe);
            }
            if (document.contains("look")) shot.look = lookFromJson(document["look"], folder);
            for (const Json& t : document.value("timeline", Json::array()))
                e.timeline.push_back({t.value("seconds", 0.0), t.value("stage", ""), t.value("iteration", 0), t.value("objective", 0.0), t.value("rmse", 0.0)});
            for (const Json& l : document.value("left_out", Json::array())) e.leftOut.push_back({l.value("what", ""), l.value("why", "")});
            const Json gauge = document.value("gauge", Json::object());
            e.gauge = {gauge.value("kind", ""), gauge.value("evidence", ""), Rgb(1)};
            const Json stability = document.value("stability", Json::object());
            e.stability = {stability.value("kkt_residual", 0.0), stability.value("condition_number", 0.0), stability.value("effective_rank", 0), stability.value("unknowns", 0), stability.value("reason", "")};
            const Json resources = document.value("resources", Json::object());
            shot.resources = {resources.value("seconds", 0.0), resources.value("peak_mib", 0.0), resources.value("threads", 0)};
            e.cancelled = document.value("stopped_early", false);
        } catch (const Json::exception& error) {
            throw Error("a field has the wrong kind ({})", error.what());
        }
    });
    LoadOptions load;
    load.images = withImages;
    shot.capture = loadCapture(shot.captureFolder, load, progress);
    const size_t n = shot.capture.mesh.vertexCount();
    const DirectionGrid grid{e.environmentSide};
    e.environment = integrateOverCells(readEnvironment(folder / "environment.exr"), grid);
    const fs::path ply = folder / "reflectance.ply";
    const std::vector<VertexProperty> properties = readVertexPly(ply);
    const auto property = [&](const std::string& name) -> const std::vector<float>& {
        for (const VertexProperty& p : properties)
            if (p.name == name) {
                if (p.values.size() != n) throw Error("{}: {} has {} values, the mesh has {} vertices", ply.string(), name, p.values.size(), n);
                return p.values;
            }
        throw Error("{}: property {} is missing", ply.string(), name);
    };
    e.reflectance.weight.assign(e.reflectance.basis.lobes.size(), std::vector<Rgb>(n));
    for (size_t k = 0; k < e.reflectance.weight.size(); ++k)
        for (int c = 0; c < 3; ++c) {
            const auto& values = property(fmt::format("weight_{}_{}", k, "rgb"[c]));
            for (size_t v = 0; v < n; ++v) e.reflectance.weight[k][v][c] = values[v];
        }
    for (float o : property("observed")) e.reflectance.observed.push_back(uint8_t(o));
    e.reflectance.confidence = property("confidence");
    const auto& emitter = property("emitter");
    EmitterClusters& clusters = e.emitters;
    clusters.emitters.resize(emitters.size());
    clusters.emitterOfVertex.assign(n, -1);
    for (size_t v = 0; v < n; ++v) {
        const int i = int(emitter[v]);
        if (i < 0 || size_t(i) >= emitters.size()) continue;
        clusters.emitterOfVertex[v] = i;
        clusters.emitters[size_t(i)].vertices.push_back(uint32_t(v));
    }
    clusters.emitterOfTriangle.assign(shot.capture.mesh.triangles.size(), -1);
    for (uint32_t t = 0; t < clusters.emitterOfTriangle.size(); ++t) {
        const Triangle& k = shot.capture.mesh.triangles[t];
        const int i = clusters.emitterOfVertex[k[0]];
        if (i < 0 || clusters.emitterOfVertex[k[1]] != i || clusters.emitterOfVertex[k[2]] != i) continue;
        clusters.emitterOfTriangle[t] = i;
        clusters.emitters[size_t(i)].triangles.push_back(t);
    }
    withContext(file.string(), [&] {
        for (size_t i = 0; i < emitters.size(); ++i) {
            const std::string where = fmt::format("emitters[{}]", i);
            EmitterCluster& c = clusters.emitters[i];
            c.id = emitters[i].value("id", fmt::format("emitter-{}", i + 1));
            c.radiance = colour(need(emitters[i], "power"), where + ".power");
            c.centroid = colour(need(emitters[i], "centroid"), where + ".centroid");
            c.normal = emitters[i].contains("normal") ? colour(emitters[i]["normal"], where + ".normal") : Vec3(0);
            c.area = emitters[i].value("area_m2", 0.0f);
            c.twoSided = emitters[i].value("two_sided", false);
            c.evidence.viewsSeen = emitters[i].value("views_seen", 0);
            c.evidence.clippedShare = emitters[i].value("clipped_share", 0.0f);
            if (emitters[i].contains("power_stddev")) e.emitterSigma.push_back(colour(emitters[i]["power_stddev"], where + ".power_stddev"));
            e.identifiability.push_back(emitters[i].value("identifiability", 0.0f));
            e.lighting.emitterRadiance.push_back(c.radiance);
        }
    });
    return shot;
}

}  // namespace relamp
