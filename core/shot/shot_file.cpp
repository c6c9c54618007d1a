#include "shot/shot_file.h"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstring>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/is_there.h"
#include "base/log.h"
#include "brdf/layered_albedo.h"
#include "capture/load_capture.h"
#include "image/environment_map.h"
#include "image/image_io.h"
#include "pipeline/plan.h"
#include "scene/mesh_io.h"
#include "shot/shot_leftovers.h"

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
Json toJson(const DVec3& p) { return {p.x, p.y, p.z}; }

Json evidenceJson(const EmitterEvidence& e) {
    return {{"scene_contrast", e.sceneContrast},
            {"local_contrast", e.localContrast},
            {"uniformity", e.uniformity},
            {"view_spread", e.viewSpread},
            {"edge_drop", e.edgeDrop},
            {"demanded_albedo", e.demandedAlbedo},
            {"samples", e.samples}};
}

Json reproductionJson(const Reproduction& r) {
    Json j{{"psnr", r.median},
           {"observed_psnr", r.observed},
           {"held_out_psnr", r.heldOut > 0 ? Json(r.heldOut) : Json()},
           {"poor", r.poor()},
           {"cause", causeName(r.cause)},
           {"advice", r.advice},
           {"views", Json::array()}};
    for (const ViewReproduction& v : r.views)
        j["views"].push_back({{"name", v.name},
                              {"psnr", v.psnr},
                              {"observed_psnr", v.observed},
                              {"held_out_psnr", v.heldOut > 0 ? Json(v.heldOut) : Json()},
                              {"pixels", v.pixels}});
    return j;
}

const Json& need(const Json& object, const char* key, const std::string& where) {
    const auto at = object.find(key);
    if (at == object.end()) throw Error("{}{}: is missing", where, key);
    return *at;
}

DVec3 place(const Json& value, const std::string& where) {
    if (!value.is_array() || value.size() != 3 || !value[0].is_number() || !value[1].is_number() ||
        !value[2].is_number())
        throw Error("{}: expected three numbers", where);
    const DVec3 p(value[0].get<double>(), value[1].get<double>(), value[2].get<double>());
    if (!isFinite(Vec3(p))) throw Error("{}: expected three finite numbers", where);
    return p;
}

Rgb colour(const Json& value, const std::string& where) { return Rgb(place(value, where)); }

/// A field of T's kind; `fallback` when it is absent. `where` is put before the key in messages ("emitters[2].").
template <class T>
T field(const Json& object, const char* key, const T& fallback, const std::string& where = "") {
    const auto at = object.find(key);
    if (at == object.end() || at->is_null()) return fallback;
    if constexpr (std::is_same_v<T, std::string>) {
        if (!at->is_string()) throw Error("{}{}: expected a text", where, key);
    } else if constexpr (std::is_same_v<T, bool>) {
        if (!at->is_boolean()) throw Error("{}{}: expected true or false", where, key);
    } else {
        if (!at->is_number()) throw Error("{}{}: expected a number", where, key);
        const double x = at->template get<double>();
        if (!std::isfinite(x) ||
            (std::is_integral_v<T> && (x < 0 || x > 1.8e19 || (sizeof(T) < 8 && x > 2147483647.0))))
            throw Error("{}{}: is {:g}, which is out of range", where, key, x);
    }
    return at->template get<T>();
}

const Json& objectOf(const Json& document, const char* key) {
    static const Json empty = Json::object();
    const auto at = document.find(key);
    if (at == document.end()) return empty;
    if (!at->is_object()) throw Error("{}: expected an object", key);
    return *at;
}

const Json& listOf(const Json& document, const char* key) {
    static const Json empty = Json::array();
    const auto at = document.find(key);
    if (at == document.end()) return empty;
    if (!at->is_array()) throw Error("{}: expected a list", key);
    for (size_t i = 0; i < at->size(); ++i)
        if (!(*at)[i].is_object()) throw Error("{}[{}]: expected an object", key, i);
    return *at;
}

/// What a shot says of its plan; what is null or absent is not known.
SolvePlan planOf(const Json& document) {
    SolvePlan plan;
    const Json& object = objectOf(document, "plan");
    withContext("plan", [&] {
        for (const Json& s : listOf(object, "stages"))
            plan.stages.push_back({field<std::string>(s, "name", ""), field(s, "predicted_s", -1.0),
                                   field(s, "measured_s", -1.0), field(s, "predicted_mib", -1.0),
                                   field(s, "measured_mib", -1.0)});
        for (const Json& o : listOf(object, "left_out"))
            plan.leftOut.push_back({field<std::string>(o, "what", ""), field<std::string>(o, "reason", ""),
                                    field(o, "saved_s", 0.0), field(o, "saved_mib", 0.0)});
        plan.planningSeconds = field(object, "planning_s", 0.0);
    });
    return plan;
}

/// What a shot says of how well its photographs are explained; shots of before say nothing.
Reproduction reproductionOf(const Json& document) {
    Reproduction r;
    const Json& object = objectOf(document, "reproduction");
    withContext("reproduction", [&] {
        r.median = field(object, "psnr", 0.0);
        r.observed = field(object, "observed_psnr", 0.0);
        r.heldOut = field(object, "held_out_psnr", 0.0);
        r.advice = field<std::string>(object, "advice", "");
        r.cause = causeNamed(field<std::string>(object, "cause", "none")).value_or(MisfitCause::none);
        for (const Json& v : listOf(object, "views"))
            r.views.push_back({field<std::string>(v, "name", ""), field(v, "psnr", 0.0), field(v, "observed_psnr", 0.0),
                               field(v, "held_out_psnr", 0.0), field(v, "pixels", size_t(0))});
    });
    return r;
}

PhotometricFix photometricOf(const Json& document) {
    PhotometricFix fix;
    const Json& object = objectOf(document, "photometric");
    withContext("capture_fix.photometric", [&] {
        fix.falloff2 = field(object, "falloff2", 0.0f);
        fix.falloff4 = field(object, "falloff4", 0.0f);
        if (std::abs(fix.falloff2) > 10 || std::abs(fix.falloff4) > 10) throw Error("falloff2, falloff4: beyond 10");
        for (const Json& g : listOf(object, "gains")) {
            const std::string where = fmt::format("gains[{}].", fix.gains.size());
            const Rgb gain = colour(need(g, "gain", where), where + "gain");
            if (!(std::min({gain.x, gain.y, gain.z}) > 1e-6f) || !(maxChannel(gain) < 1e6f))
                throw Error("{}gain: is out of range", where);
            fix.gains.push_back({field<std::string>(g, "view", "", where), gain});
        }
    });
    return fix;
}

/// The file a measured lobe comes from: a copy in the shot's own folder `merl` goes first, so that a shot can be given
/// away with what it needs.
std::shared_ptr<const MeasuredGloss> measuredOf(const Json& lobe, const fs::path& folder, const std::string& where) {
    const fs::path named = field<std::string>(lobe, "file", "", where);
    if (named.empty()) throw Error("{}file: is missing", where);
    std::error_code failed;
    const fs::path copy = folder / "merl" / named.filename(),
                   file = fs::exists(copy, failed) ? copy : (fs::absolute(folder) / named).lexically_normal();
    if (!fs::exists(file, failed))
        throw Error(
            "{}file: {} is not there; the shot was solved with this measured reflectance, put the file there or into "
            "the shot's folder merl",
            where, file.string());
    return std::make_shared<const MeasuredGloss>(glossOf(readMerl(file), file));
}

BrdfBasis basisOf(const Json& document, const fs::path& folder) {
    BrdfBasis basis;
    need(document, "basis", "");
    for (const Json& l : listOf(document, "basis")) {
        const std::string where = fmt::format("basis[{}].", basis.lobes.size()),
                          kind = field<std::string>(l, "kind", "lambert", where);
        Lobe lobe;
        int k = 0;
        while (k < int(Lobe::Kind::mixture) && kind != kindName(Lobe::Kind(k))) ++k;
        if (k == int(Lobe::Kind::mixture))
            throw Error(
                "{}kind: is {}, expected lambert, ggx, ggx_dielectric, ggx_grazing, cook_torrance, ward, "
                "lafortune_back, lafortune_forward or measured",
                where, kind);
        lobe.kind = Lobe::Kind(k);
        if (lobe.kind == Lobe::Kind::measured) lobe.measured = measuredOf(l, folder, where);
        lobe.alpha = field(l, "alpha", 1.0f, where);
        if (!(lobe.alpha > 0)) throw Error("{}alpha: is {}, expected more than 0", where, lobe.alpha);
        lobe.name = field(l, "name", kind, where);
        basis.lobes.push_back(lobe);
    }
    if (basis.lobes.empty() || basis.lobes[0].kind != Lobe::Kind::lambert) throw Error("basis: expected lambert first");
    return basis;
}

/// Puts the new folder in the old one's place in one step; afterwards `fresh` is what was there before.
void exchange(const fs::path& fresh, const fs::path& target) {
    if (::renameat2(AT_FDCWD, fresh.c_str(), AT_FDCWD, target.c_str(), RENAME_EXCHANGE) == 0) return;
    const fs::path aside = fresh.string() + ".old";
    fs::rename(target, aside);
    std::error_code failed;
    fs::rename(fresh, target, failed);
    if (failed) {
        fs::rename(aside, target);
        throw fs::filesystem_error("rename", target, failed);
    }
    fs::rename(aside, fresh);
}

}  // namespace

Json shotInfo(const Shot& shot) {
    const Estimate& e = shot.estimate;
    Json info;
    info["version"] = 1;
    info["mode"] = e.mode;
    info["quality"] = shot.quality;
    info["emitters"] = Json::array();
    std::vector<std::string> ids;
    for (const EmitterCluster& c : e.emitters.emitters) ids.push_back(c.id);
    const std::vector<std::string> names = emitterNames(ids, shot.look);
    for (size_t i = 0; i < e.emitters.emitters.size(); ++i) {
        const EmitterCluster& c = e.emitters.emitters[i];
        Json j{{"id", c.id},
               {"name", names[i]},
               {"centroid", toJson(shot.capture.origin + DVec3(c.centroid))},
               {"normal", toJson(c.normal)},
               {"area_m2", c.area},
               {"triangles", c.triangles.size()},
               {"power", toJson(e.lighting.emitterRadiance[i])},
               {"two_sided", c.twoSided},
               {"views_seen", c.evidence.viewsSeen},
               {"clipped_share", c.evidence.clippedFraction},
               {"evidence", evidenceJson(c.evidence)}};
        if (c.unobserved) j["unseen"] = true;
        if (c.positionSigma != Vec3(0)) j["position_stddev"] = toJson(c.positionSigma);
        if (i < e.emitterSigma.size()) j["power_stddev"] = toJson(e.emitterSigma[i]);
        if (i < e.identifiability.size()) j["identifiability"] = e.identifiability[i];
        info["emitters"].push_back(j);
    }
    info["rejected_patches"] = Json::array();
    for (const RejectedPatch& r : e.emitters.rejected)
        info["rejected_patches"].push_back({{"centroid", toJson(shot.capture.origin + DVec3(r.centroid))},
                                            {"radiance", toJson(r.radiance)},
                                            {"reason", r.reason},
                                            {"evidence", evidenceJson(r.evidence)}});
    info["environment"] = {{"kept_coefficients", e.lighting.leaves.size()}, {"grid_side", e.environmentSide}};
    info["gauge"] = {{"kind", e.gauge.kind}, {"evidence", e.gauge.evidence}, {"scale", toJson(e.gauge.scale)}};
    if (e.gauge.sigma.x > 0)
        info["gauge"].update({{"sigma", toJson(e.gauge.sigma)},
                              {"from",
                               {{"emitters", toJson(e.gauge.fromEmitters)},
                                {"background", toJson(e.gauge.fromBackground)},
                                {"gloss", toJson(e.gauge.fromGloss)},
                                {"bounces", toJson(e.gauge.fromBounces)}}}});
    for (const PaletteColour& colour : e.palette)
        info["palette"].push_back({{"albedo", toJson(colour.albedo)}, {"share", colour.fraction}});
    for (const auto& [name, strength] :
         {std::pair{"light_smoothness", &e.lightSmoothness}, std::pair{"albedo_smoothness", &e.albedoSmoothness}}) {
        Json& j = info["priors"][name] = {
            {"factor", strength->factor}, {"chosen_by", strength->chosenBy}, {"tried", Json::array()}};
        for (const PriorStrength::Trial& t : strength->trials)
            j["tried"].push_back({{"factor", t.factor}, {"misfit", t.misfit}, {"error", t.error}});
    }
    info["basis"] = Json::array();
    for (const Lobe& l : e.reflectance.basis.lobes)
        info["basis"].push_back({{"kind", kindName(l.kind)}, {"alpha", l.alpha}, {"name", l.name}});
    info["left_out"] = Json::array();
    for (const LeftOut& l : e.leftOut) info["left_out"].push_back({{"what", l.what}, {"why", l.why}});
    info["timeline"] = Json::array();
    for (const TimelineEntry& t : e.timeline)
        info["timeline"].push_back({{"seconds", t.seconds},
                                    {"stage", t.stage},
                                    {"iteration", t.iteration},
                                    {"objective", t.objective},
                                    {"rmse", t.rmse}});
    info["stability"] = {{"condition_number", e.stability.conditionNumber},
                         {"kkt_residual", e.stability.kktResidual},
                         {"effective_rank", e.stability.effectiveRank},
                         {"unknowns", e.stability.unknowns},
                         {"reason", e.stability.reason},
                         {"spectrum", e.stability.spectrum}};
    info["plan"] = planJson(e.plan);
    if (!e.stability.weakest.empty())
        info["stability"].update({{"weakest", e.stability.weakest}, {"weakest_sigma", e.stability.weakestSigma}});
    if (e.reproduction.measured()) info["reproduction"] = reproductionJson(e.reproduction);
    info["resources"] = {
        {"seconds", shot.resources.seconds}, {"peak_mib", shot.resources.peakMib}, {"threads", shot.resources.threads}};
    info["interreflection"] = {{"kept", e.interreflection}, {"share", e.bouncedFraction}};
    info["stopped_early"] = e.cancelled;
    return info;
}

namespace {

/// Places that are found from the current folder only are kept absolute, so that the shot opens from everywhere.
Json proxiesToJson(const std::vector<ProxyLight>& proxies) {
    Json list = Json::array();
    for (const ProxyLight& p : proxies)
        list.push_back(
            {{"centre", toJson(p.centre)}, {"radius", p.radius}, {"sigma", toJson(p.sigma)}, {"found", p.found}});
    return list;
}

Json photometricJson(const PhotometricFix& fix) {
    Json json{{"falloff2", fix.falloff2}, {"falloff4", fix.falloff4}, {"gains", Json::array()}};
    for (const auto& g : fix.gains) json["gains"].push_back({{"view", g.view}, {"gain", toJson(g.gain)}});
    return json;
}

Json fixToJson(const CaptureFix& fix, const fs::path& capture) {
    const auto kept = [&](const std::string& place) {
        std::error_code ignored;
        if (place.empty() || fs::exists(capture / place, ignored) || !fs::exists(place, ignored)) return place;
        return fs::absolute(place).lexically_normal().string();
    };
    Json json = {{"up", fix.up},
                 {"flip_cameras", fix.flipCameras},
                 {"scale", fix.scale},
                 {"mesh_scale", fix.meshScale},
                 {"colmap", kept(fix.colmap)},
                 {"images", kept(fix.images)},
                 {"mesh", kept(fix.mesh)},
                 {"from_brackets", fix.fromBrackets},
                 {"proxy_lights", proxiesToJson(fix.proxies)}};
    if (fix.smoothNormals >= 0) json["smooth_normals"] = fix.smoothNormals;
    if (!fix.photometric.empty()) json["photometric"] = photometricJson(fix.photometric);
    return json;
}

}  // namespace

void saveShot(const Shot& shot, const Mesh& mesh, const fs::path& folder, bool overwrite) {
    std::error_code failed;
    fs::path target = fs::absolute(folder).lexically_normal();
    if (!target.has_filename()) target = target.parent_path();  // a slash at the end
    mendShot(target);
    const bool exists = fs::exists(target, failed);
    if (exists && !overwrite) throw Error("{}: exists already, add --overwrite to replace it", folder.string());
    if (exists && (!fs::is_directory(target, failed) ||
                   (!fs::exists(target / "shot.json", failed) && !fs::is_empty(target, failed))))
        throw Error("{}: is not a shot, so it is not overwritten", folder.string());
    const fs::path fresh = target.parent_path() / fmt::format(".{}.{}", target.filename().string(), ::getpid());
    fs::create_directories(fresh, failed);
    if (failed) throw Error("{}: cannot be made ({})", folder.string(), failed.message());
    const FolderHold holdFresh(fresh), holdOld(target);
    try {
        Json document = shotInfo(shot);
        if (exists && isThere(target / "shot.json")) {
            const Json old = Json::parse(readBytes(target / "shot.json"), nullptr, false);
            if (old.is_object())
                for (const auto& [key, value] : old.items())
                    if (!document.contains(key)) document[key] = value;
        }
        document["capture"] = fs::proximate(fs::absolute(shot.captureFolder), target).string();
        for (size_t k = 0; k < shot.estimate.reflectance.basis.lobes.size(); ++k)
            if (const auto& measured = shot.estimate.reflectance.basis.lobes[k].measured)
                document["basis"][k]["file"] = fs::proximate(fs::absolute(measured->file), target).string();
        document["look"] = lookToJson(shot.look, shot.capture.origin);
        if (shot.look.environment.source == EnvironmentLook::Source::file)
            document["look"]["environment"]["file"] =
                fs::proximate(fs::absolute(shot.look.environment.file), target).string();
        document["seed"] = shot.seed;
        document["capture_fix"] = fixToJson(shot.fix, shot.captureFolder);
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
        // The cells themselves, so that opening need not integrate the image again.
        fs::create_directories(fresh / "cache");
        for (int c = 0; c < 3; ++c) {
            channels[size_t(c)].values.clear();
            for (const Rgb& p : shot.estimate.environment) channels[size_t(c)].values.push_back(p[c]);
        }
        writeChannels(fresh / "cache" / "environment_cells.exr", grid.side, grid.side, channels);
        if (!shot.estimate.environmentSigma.empty()) {
            const Image deviations = latLongFromCells(shot.estimate.environmentSigma, grid, 256);
            for (int c = 0; c < 3; ++c) {
                channels[size_t(c)].values.clear();
                for (const Rgb& p : deviations.pixels) channels[size_t(c)].values.push_back(p[c]);
            }
            writeChannels(fresh / "environment_sigma.exr", deviations.width, deviations.height, channels);
        }
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
        add("albedo", albedoUnderCoating(r.basis, r.weight));
        for (size_t k = 0; k < r.weight.size(); ++k) add(fmt::format("weight_{}", k), r.weight[k]);
        properties.push_back({"observed", {r.observed.begin(), r.observed.end()}, true});
        properties.push_back(
            {"emitter",
             {shot.estimate.emitters.emitterOfVertex.begin(), shot.estimate.emitters.emitterOfVertex.end()},
             true});
        properties.push_back({"confidence", r.confidence, false});
        if (!r.sigma.empty()) properties.push_back({"albedo_sigma", r.sigma, false});
        writeVertexPly(fresh / "reflectance.ply", mesh, properties, shot.capture.origin);
        writeBytesAtomically(fresh / "shot.json", document.dump(1) + "\n");
        if (!exists) {
            fs::rename(fresh, target);
            flushFolder(target.parent_path());
            return;
        }
        exchange(fresh, target);
        flushFolder(target.parent_path());
    } catch (const fs::filesystem_error& error) {
        fs::remove_all(fresh, failed);
        throw Error("{}: cannot be written ({})", folder.string(), error.code().message());
    } catch (...) {
        fs::remove_all(fresh, failed);
        throw;
    }
    // `fresh` is now the old shot. What relamp did not write moves over; what cannot is left there rather than lost.
    bool left = false;
    for (fs::directory_iterator entry(fresh, failed), end; !failed && entry != end; entry.increment(failed)) {
        const std::string name = entry->path().filename().string();
        if (isPartOfShot(name)) continue;
        std::error_code kept;
        fs::rename(entry->path(), target / name, kept);
        left |= bool(kept);
    }
    if (left || failed) logWarning("{}: some files of the old shot are left in {}", target.string(), fresh.string());
    else fs::remove_all(fresh, failed);
}

namespace {

/// From the cache when it is whole and not older than environment.exr, which an artist may have painted over.
std::vector<Rgb> environmentCells(const fs::path& folder, const DirectionGrid& grid) {
    const fs::path image = folder / "environment.exr", cache = folder / "cache" / "environment_cells.exr";
    std::error_code failed, missing;
    const auto made = fs::last_write_time(cache, missing), painted = fs::last_write_time(image, failed);
    if (!missing && !failed && made >= painted) {
        try {
            const Image cells = readImage(cache);
            if (cells.width == grid.side && cells.height == grid.side) return cells.pixels;
        } catch (const Error&) {
            // A damaged cache is no loss.
        }
    }
    return integrateOverCells(readEnvironment(image), grid);
}

}  // namespace

void checkShotCanBeWritten(const fs::path& folder) {
    std::error_code failed;
    fs::path place = fs::absolute(folder).lexically_normal();
    if (!place.has_filename()) place = place.parent_path();
    do place = place.parent_path();
    while (!fs::exists(place, failed) && place.has_relative_path());
    if (::access(place.c_str(), W_OK | X_OK) != 0)
        throw Error("{}: cannot be written ({}: {})", folder.string(), place.string(), std::strerror(errno));
}

namespace {

Shot readShot(const fs::path& folder, bool withImages, Progress& progress) {
    Shot shot;
    shot.folder = folder;
    const fs::path file = folder / "shot.json";
    if (!isThere(file)) throw Error("{}: is not a shot, there is no shot.json in it", folder.string());
    const Json document = Json::parse(readBytes(file, 256 << 20), nullptr, false);
    if (!document.is_object()) throw Error("{}: is not valid JSON", file.string());
    Estimate& e = shot.estimate;
    Json emitters;
    withContext(file.string(), [&] {
        need(document, "version", "");
        if (const int version = field(document, "version", 1); version != 1)
            throw Error("version: is {}, expected 1", version);
        need(document, "capture", "");
        shot.captureFolder = (fs::absolute(folder) / field<std::string>(document, "capture", "")).lexically_normal();
        e.mode = field<std::string>(document, "mode", "near-field");
        shot.quality = field<std::string>(document, "quality", "standard");
        shot.seed = field(document, "seed", uint64_t(1));
        need(document, "emitters", "");
        emitters = listOf(document, "emitters");
        e.reflectance.basis = basisOf(document, folder);
        size_t i = 0;
        for (const Json& t : listOf(document, "timeline")) {
            const std::string where = fmt::format("timeline[{}].", i++);
            e.timeline.push_back({field(t, "seconds", 0.0, where), field<std::string>(t, "stage", "", where),
                                  field(t, "iteration", 0, where), field(t, "objective", 0.0, where),
                                  field(t, "rmse", 0.0, where)});
        }
        if (document.contains("capture_fix")) {
            const Json& fix = objectOf(document, "capture_fix");
            shot.fix.up = field<std::string>(fix, "up", "", "capture_fix.");
            shot.fix.flipCameras = field(fix, "flip_cameras", false, "capture_fix.");
            shot.fix.scale = field(fix, "scale", 1.0, "capture_fix.");
            shot.fix.meshScale = field(fix, "mesh_scale", 1.0, "capture_fix.");
            if (fix.contains("smooth_normals"))
                shot.fix.smoothNormals = std::min(field(fix, "smooth_normals", 0, "capture_fix."), 100);
            shot.fix.fromBrackets = field(fix, "from_brackets", false, "capture_fix.");
            shot.fix.photometric = photometricOf(fix);
            size_t k = 0;
            for (const Json& p : listOf(fix, "proxy_lights")) {
                const std::string where = fmt::format("capture_fix.proxy_lights[{}].", k++);
                shot.fix.proxies.push_back({place(need(p, "centre", where), where + "centre"),
                                            field(p, "radius", 0.0f, where),
                                            p.contains("sigma") ? colour(p["sigma"], where + "sigma") : Vec3(0),
                                            field(p, "found", false, where)});
            }
            for (const auto& [key, place] : {std::pair{"colmap", &shot.fix.colmap},
                                             std::pair{"images", &shot.fix.images}, std::pair{"mesh", &shot.fix.mesh}})
                *place = field<std::string>(fix, key, "", "capture_fix.");
            if (!shot.fix.up.empty()) withContext("capture_fix.up", [&] { axisFromName(shot.fix.up); });
        }
        i = 0;
        for (const Json& l : listOf(document, "left_out")) {
            const std::string where = fmt::format("left_out[{}].", i++);
            e.leftOut.push_back({field<std::string>(l, "what", "", where), field<std::string>(l, "why", "", where)});
        }
        e.plan = planOf(document);
        e.reproduction = reproductionOf(document);
        const Json& gauge = objectOf(document, "gauge");
        e.gauge = {field<std::string>(gauge, "kind", "", "gauge."), field<std::string>(gauge, "evidence", "", "gauge."),
                   gauge.contains("scale") ? colour(gauge["scale"], "gauge.scale") : Rgb(1)};
        const Json& from = objectOf(gauge, "from");
        for (const auto& [json, key, value] :
             {std::tuple{&gauge, "sigma", &e.gauge.sigma}, std::tuple{&from, "emitters", &e.gauge.fromEmitters},
              std::tuple{&from, "background", &e.gauge.fromBackground}, std::tuple{&from, "gloss", &e.gauge.fromGloss},
              std::tuple{&from, "bounces", &e.gauge.fromBounces}})
            if (json->contains(key)) *value = colour((*json)[key], std::string("gauge.") + key);
        i = 0;
        for (const Json& c : listOf(document, "palette")) {
            const std::string where = fmt::format("palette[{}].", i++);
            if (!c.contains("albedo")) throw Error("{}albedo: missing", where);
            e.palette.push_back({colour(c["albedo"], where + "albedo"), field(c, "share", 0.0f, where)});
        }
        const Json& priors = objectOf(document, "priors");
        for (const auto& [name, strength] :
             {std::pair{"light_smoothness", &e.lightSmoothness}, std::pair{"albedo_smoothness", &e.albedoSmoothness}}) {
            const std::string where = fmt::format("priors.{}.", name);
            const Json& j = objectOf(priors, name);
            strength->factor = field(j, "factor", 1.0f, where);
            strength->chosenBy = field<std::string>(j, "chosen_by", "usual", where);
            for (const Json& t : listOf(j, "tried"))
                strength->trials.push_back({field(t, "factor", 1.0f, where + "tried."),
                                            field(t, "misfit", 0.0, where + "tried."),
                                            field(t, "error", 0.0, where + "tried.")});
        }
        const Json& stability = objectOf(document, "stability");
        e.stability = {field(stability, "kkt_residual", 0.0, "stability."),
                       field(stability, "condition_number", 0.0, "stability."),
                       field(stability, "effective_rank", 0, "stability."),
                       field(stability, "unknowns", 0, "stability."),
                       field<std::string>(stability, "reason", "", "stability."),
                       {}};
        e.stability.weakest = field<std::string>(stability, "weakest", "", "stability.");
        e.stability.weakestSigma = field(stability, "weakest_sigma", 0.0f, "stability.");
        if (const auto spectrum = stability.find("spectrum"); spectrum != stability.end() && spectrum->is_array())
            for (const Json& value : *spectrum)
                if (value.is_number()) e.stability.spectrum.push_back(value.get<float>());
        const Json& resources = objectOf(document, "resources");
        shot.resources = {field(resources, "seconds", 0.0, "resources."),
                          field(resources, "peak_mib", 0.0, "resources."),
                          field(resources, "threads", 0, "resources.")};
        const Json& bounced = objectOf(document, "interreflection");
        e.interreflection = field(bounced, "kept", false, "interreflection.");
        e.bouncedFraction = field(bounced, "share", 0.0f, "interreflection.");
        e.cancelled = field(document, "stopped_early", false);
    });
    EmitterClusters& clusters = e.emitters;
    clusters.emitters.resize(emitters.size());
    std::vector<DVec3> centroids;
    withContext(file.string(), [&] {
        for (size_t i = 0; i < emitters.size(); ++i) {
            const std::string where = fmt::format("emitters[{}].", i);
            const Json& j = emitters[i];
            EmitterCluster& c = clusters.emitters[i];
            c.id = field(j, "id", fmt::format("emitter-{}", i + 1), where);
            c.radiance = colour(need(j, "power", where), where + "power");
            for (int k = 0; k < 3; ++k)
                if (c.radiance[k] < 0) throw Error("{}power[{}]: is {}, expected 0 or more", where, k, c.radiance[k]);
            centroids.push_back(place(need(j, "centroid", where), where + "centroid"));
            c.normal = j.contains("normal") ? colour(j["normal"], where + "normal") : Vec3(0);
            c.area = field(j, "area_m2", 0.0f, where);
            c.twoSided = field(j, "two_sided", false, where);
            c.unobserved = field(j, "unseen", false, where);
            if (j.contains("position_stddev"))
                c.positionSigma = colour(j["position_stddev"], where + "position_stddev");
            c.evidence.viewsSeen = field(j, "views_seen", 0, where);
            c.evidence.clippedFraction = field(j, "clipped_share", 0.0f, where);
            if (j.contains("power_stddev")) e.emitterSigma.push_back(colour(j["power_stddev"], where + "power_stddev"));
            e.identifiability.push_back(field(j, "identifiability", 0.0f, where));
            e.lighting.emitterRadiance.push_back(c.radiance);
        }
    });
    LoadOptions load;
    load.images = withImages;
    load.fix = shot.fix;
    withContext(file.string() + ": capture", [&] { shot.capture = loadCapture(shot.captureFolder, load, progress); });
    // What the document places counts from the capture's own origin.
    for (size_t i = 0; i < centroids.size(); ++i)
        clusters.emitters[i].centroid = Vec3(centroids[i] - shot.capture.origin);
    if (document.contains("look"))
        withContext(file.string(), [&] {
            withContext("look", [&] { shot.look = lookFromJson(document["look"], folder, shot.capture.origin); });
        });
    const size_t n = shot.capture.mesh.vertexCount();
    const fs::path ply = folder / "reflectance.ply";
    const std::vector<VertexProperty> properties = readVertexPly(ply);
    const auto property = [&](const std::string& name) -> const std::vector<float>& {
        for (const VertexProperty& p : properties)
            if (p.name == name) {
                if (p.values.size() != n)
                    throw Error("{}: {} has {} values, the mesh has {} vertices", ply.string(), name, p.values.size(),
                                n);
                for (size_t v = 0; v < n; ++v)
                    if (!std::isfinite(p.values[v]))
                        throw Error("{}: {} of vertex {} is not a finite number", ply.string(), name, v);
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
    for (float o : property("observed")) e.reflectance.observed.push_back(uint8_t(std::clamp(o, 0.0f, 255.0f)));
    e.reflectance.confidence = property("confidence");
    if (std::any_of(properties.begin(), properties.end(),
                    [](const VertexProperty& p) { return p.name == "albedo_sigma"; }))
        e.reflectance.sigma = property("albedo_sigma");
    const DirectionGrid grid{e.environmentSide};
    e.environment = environmentCells(folder, grid);
    const fs::path deviations = folder / "environment_sigma.exr";
    std::error_code unreadable;
    if (fs::exists(deviations, unreadable)) e.environmentSigma = integrateOverCells(readEnvironment(deviations), grid);
    const auto& emitter = property("emitter");
    clusters.emitterOfVertex.assign(n, -1);
    for (size_t v = 0; v < n; ++v) {
        const int i = int(std::clamp(emitter[v], -1.0f, 1e6f));
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
    return shot;
}

}  // namespace

Shot openShot(const fs::path& folder, bool withImages, Progress& progress) {
    mendShot(folder);
    // Another process may put a new shot in its place while this one reads: then once more, so that no file of one
    // meets those of another.
    struct stat before {
    }, after{};
    for (int attempt = 0;; ++attempt) {
        const bool there = ::stat(folder.c_str(), &before) == 0;
        const auto changed = [&] {
            return attempt < 5 && there && ::stat(folder.c_str(), &after) == 0 &&
                   (after.st_ino != before.st_ino || after.st_dev != before.st_dev);
        };
        try {
            Shot shot = readShot(folder, withImages, progress);
            if (!changed()) return shot;
        } catch (const Error&) {
            if (!changed()) throw;
        }
    }
}

}  // namespace relamp
