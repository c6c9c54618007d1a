// A shot as the document of shot.json.
#include <charconv>
#include <nlohmann/json.hpp>

#include "base/statistics.h"
#include "pipeline/plan.h"
#include "relight/state_look.h"
#include "shot/shot_document.h"

namespace relamp {
namespace {
namespace fs = std::filesystem;

Json toJson(const Rgb& c) { return {c.x, c.y, c.z}; }
Json toJson(const DVec3& p) { return {p.x, p.y, p.z}; }
Json toJson(const EmissionLobe& lobe) { return {{"axis", toJson(DVec3(lobe.axis))}, {"power", lobe.power}}; }

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

Json emittersJson(const Shot& shot) {
    const Estimate& e = shot.estimate;
    Json list = Json::array();
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
               {"radiance", toJson(e.lighting.emitterRadiance[i])},
               {"two_sided", c.twoSided},
               {"views_seen", c.evidence.viewsSeen},
               {"clipped_fraction", c.evidence.clippedFraction},
               {"evidence", evidenceJson(c.evidence)}};
        if (!c.level.empty()) j["level_range"] = {quantileOf(c.level, 0.05), quantileOf(c.level, 0.95)};
        if (!c.lobe.even()) j["lobe"] = toJson(c.lobe);
        if (c.unobserved) j["unobserved"] = true;
        if (c.positionSigma != Vec3(0)) j["position_stddev"] = toJson(c.positionSigma);
        if (i < e.emitterSigma.size()) j["radiance_stddev"] = toJson(e.emitterSigma[i]);
        if (i < e.identifiability.size()) j["identifiability"] = e.identifiability[i];
        list.push_back(j);
    }
    return list;
}

/// The photographs' lighting states, with the level of each emitter in them.
Json statesJson(const Estimate& e) {
    Json states = Json::array();
    for (size_t s = 0; s < e.states.size(); ++s) {
        Json levels = Json::array();
        for (const EmitterCluster& c : e.emitters.emitters)
            levels.push_back({{"id", c.id}, {"level", std::max(0.0f, c.levelIn(s))}});
        states.push_back({{"name", e.states[s].name}, {"views", e.states[s].views}, {"emitters", levels}});
        if (!environmentsDiffer(e)) continue;
        const int environment = e.states[s].environment;
        states.back()["environment"] = environment < 0 ? "none" : environmentStem(environment) + ".exr";
    }
    return states;
}

Json probeJson(const ProbeFit& probe) {
    return {{"name", probe.name},
            {"fitted_to", probe.by},
            {"used", probe.used},
            {"doubtful", probe.doubtful()},
            {"yaw_degrees", probe.yawDegrees},
            {"yaw_sigma", probe.yawSigma},
            {"gain", toJson(probe.gain)},
            {"gain_sigma", probe.gainSigma},
            {"noise", probe.noise},
            {"held", probe.held},
            {"compared", probe.compared},
            {"residual", probe.residual},
            {"contradicted", probe.contradicted},
            {"measured_noise", probe.measuredNoise},
            {"words", probe.words}};
}

Json gaugeJson(const GaugeReport& gauge) {
    Json json = {{"kind", gauge.kind}, {"evidence", gauge.evidence}, {"scale", toJson(gauge.scale)}};
    if (gauge.sigma.x > 0)
        json.update({{"sigma", toJson(gauge.sigma)},
                     {"from",
                      {{"emitters", toJson(gauge.fromEmitters)},
                       {"background", toJson(gauge.fromBackground)},
                       {"gloss", toJson(gauge.fromGloss)},
                       {"bounces", toJson(gauge.fromBounces)}}}});
    if (gauge.fromProbes != Rgb(0)) json["from"]["light_probes"] = toJson(gauge.fromProbes);
    if (gauge.fromPatches != Rgb(0)) json["from"]["known_patches"] = toJson(gauge.fromPatches);
    return json;
}

Json priorsJson(const Estimate& e) {
    Json priors;
    for (const auto& [name, strength] :
         {std::pair{"light_smoothness", &e.lightSmoothness}, std::pair{"albedo_smoothness", &e.albedoSmoothness}}) {
        Json& j =
            priors[name] = {{"factor", strength->factor}, {"chosen_by", strength->chosenBy}, {"tried", Json::array()}};
        for (const PriorStrength::Trial& t : strength->trials)
            j["tried"].push_back({{"factor", t.factor}, {"misfit", t.misfit}, {"error", t.error}});
    }
    return priors;
}

Json stabilityJson(const StabilityReport& stability) {
    Json json = {{"condition_number", stability.conditionNumber},
                 {"kkt_residual", stability.kktResidual},
                 {"effective_rank", stability.effectiveRank},
                 {"unknowns", stability.unknowns},
                 {"reason", stability.reason},
                 {"spectrum", stability.spectrum}};
    if (!stability.weakest.empty())
        json.update({{"weakest", stability.weakest}, {"weakest_sigma", stability.weakestSigma}});
    return json;
}

/// Places that are found from the current folder only are kept absolute, so that the shot opens from everywhere.
Json proxiesToJson(const std::vector<ProxyLight>& proxies) {
    Json list = Json::array();
    for (const ProxyLight& p : proxies) {
        list.push_back(
            {{"centre", toJson(p.centre)}, {"radius", p.radius}, {"sigma", toJson(p.sigma)}, {"found", p.found}});
        if (p.observed()) list.back()["radiance"] = toJson(p.radiance);
        if (!p.lobe.even()) list.back()["lobe"] = toJson(p.lobe);
    }
    return list;
}

/// The shortest decimal that is this float when it is read again: half the digits of its double.
double shortest(float value) {
    char digits[32];
    double result = double(value);
    std::from_chars(digits, std::to_chars(digits, digits + sizeof digits, value).ptr, result);
    return result;
}

Json mendToJson(const MeshMend& mend) {
    Json moved = Json::array(), at = Json::array(), turned = Json::array(), normals = Json::array();
    for (const MeshMend::MovedVertex& m : mend.moved) {
        moved.push_back(m.vertex);
        for (int k = 0; k < 3; ++k) at.push_back(shortest(m.position[k]));
    }
    for (const MeshMend::TurnedVertex& t : mend.turned) {
        turned.push_back(t.vertex);
        for (int k = 0; k < 3; ++k) normals.push_back(shortest(t.normal[k]));
    }
    Json added = Json::array(), triangles = Json::array();
    for (const Vec3& p : mend.addedPositions)
        for (int k = 0; k < 3; ++k) added.push_back(shortest(p[k]));
    for (const Triangle& t : mend.added)
        for (const uint32_t v : t) triangles.push_back(v);
    return {{"removed_triangles", mend.removed}, {"shadowless_triangles", mend.shadowless},
            {"moved_vertices", moved},           {"positions", at},
            {"turned_vertices", turned},         {"normals", normals},
            {"shining_vertices", mend.shining},  {"both_sides_vertices", mend.bothSides},
            {"added_positions", added},          {"added_triangles", triangles}};
}

Json registrationJson(const RegistrationFix& fix) {
    Json json{{"poses", Json::array()},
              {"displacement_unit", fix.step},
              {"displacements", fix.steps},
              {"outline_unit", fix.outlineStep},
              {"outline_displacements", fix.outlineSteps},
              {"flat_unit", fix.flatStep},
              {"flat_displacements", fix.flatSteps}};
    for (const PoseFix& p : fix.poses)
        json["poses"].push_back({{"view", p.view}, {"turn", toJson(p.turn)}, {"shift", toJson(p.shift)}});
    return json;
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
    if (!fix.meshUp.empty()) json["mesh_up"] = fix.meshUp;
    if (!fix.mirror.empty()) json["mirror"] = fix.mirror;
    if (!fix.meshMirror.empty()) json["mesh_mirror"] = fix.meshMirror;
    if (fix.smoothNormals >= 0) json["smooth_normals"] = fix.smoothNormals;
    if (!fix.registration.empty()) json["registration"] = registrationJson(fix.registration);
    if (!fix.mend.empty()) json["mesh_mend"] = mendToJson(fix.mend);
    for (const StatePattern& state : fix.states)
        json["states"].push_back({{"name", state.name}, {"pattern", state.pattern}});
    for (const StateEnvironment& one : fix.environments)
        json["state_environments"].push_back({{"state", one.state}, {"environment", one.environment}});
    if (!fix.photometric.empty()) json["photometric"] = photometricJson(fix.photometric);
    return json;
}

}  // namespace

std::string environmentStem(int environment) {
    return environment == 0 ? "environment" : fmt::format("environment-{}", environment + 1);
}

Json shotInfo(const Shot& shot) {
    const Estimate& e = shot.estimate;
    Json info;
    info["version"] = environmentsDiffer(e) ? 3 : 2;
    info["mode"] = e.mode;
    info["quality"] = shot.quality;
    info["emitters"] = emittersJson(shot);
    info["rejected_patches"] = Json::array();
    for (const RejectedPatch& r : e.emitters.rejected)
        info["rejected_patches"].push_back({{"centroid", toJson(shot.capture.origin + DVec3(r.centroid))},
                                            {"radiance", toJson(r.radiance)},
                                            {"reason", r.reason},
                                            {"evidence", evidenceJson(r.evidence)}});
    info["environment"] = {{"leaves", e.lighting.leaves.size()}, {"grid_side", e.environmentSide}};
    info["gauge"] = gaugeJson(e.gauge);
    if (!e.states.empty()) info["states"] = statesJson(e);
    for (const ProbeFit& probe : e.probes) info["light_probes"].push_back(probeJson(probe));
    for (const PatchFit& patch : e.patches)
        info["known_patches"].push_back({{"name", patch.name},
                                         {"told", toJson(patch.told)},
                                         {"found", toJson(patch.found)},
                                         {"noise", patch.noise},
                                         {"doubtful", patch.doubtful},
                                         {"used", patch.used},
                                         {"words", patch.words}});
    for (const PaletteColour& colour : e.palette)
        info["palette"].push_back({{"albedo", toJson(colour.albedo)}, {"fraction", colour.fraction}});
    info["priors"] = priorsJson(e);
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
    info["stability"] = stabilityJson(e.stability);
    info["plan"] = planJson(e.plan);
    if (e.reproduction.measured()) info["reproduction"] = reproductionJson(e.reproduction);
    info["resources"] = {
        {"seconds", shot.resources.seconds}, {"peak_mib", shot.resources.peakMib}, {"threads", shot.resources.threads}};
    info["interreflection"] = {{"kept", e.interreflection}, {"fraction", e.bouncedFraction}};
    const AlbedoTexture* texture = e.reflectance.texture.get();
    info["texture"] =
        texture ? Json{{"file", "albedo.exr"}, {"width", texture->width}, {"height", texture->height}} : Json();
    if (texture && !texture->confidence.empty()) info["texture"]["confidence"] = "albedo_confidence.exr";
    info["stopped_early"] = e.cancelled;
    return info;
}

namespace {

/// Gives the files of a look's document, and of its keys', as `place` says.
void placeFiles(Json& look, const std::function<std::string(const fs::path&)>& place) {
    const auto put = [&](Json& object, const char* key) {
        if (const auto at = object.find(key); at != object.end()) *at = place(at->get<std::string>());
    };
    put(look["environment"], "file");
    if (const auto plate = look.find("plate"); plate != look.end())
        for (const char* key : plateFileKeys)
            if (plate->contains(key)) {
                const fs::path whole = fs::absolute((*plate)[key].get<std::string>()).lexically_normal();
                (*plate)[std::string(key) + "_absolute"] = whole.string();
                put(*plate, key);
            }
    for (Json& added : look["added_emitters"])
        if (const auto shaping = added.find("shaping"); shaping != added.end())
            for (const char* key : {"ies_file", "gobo_file", "surface_file"}) put(*shaping, key);
    if (const auto keys = look.find("keys"); keys != look.end())
        for (Json& key : *keys) placeFiles(key["look"], place);
}

}  // namespace

Json shotDocument(const Shot& shot, const fs::path& folder) {
    const auto fromHere = [&](const fs::path& place) { return fs::proximate(fs::absolute(place), folder).string(); };
    Json document = shotInfo(shot);
    document["capture"] = fromHere(shot.captureFolder);
    document["capture_absolute"] = fs::absolute(shot.captureFolder).lexically_normal().string();
    for (size_t k = 0; k < shot.estimate.reflectance.basis.lobes.size(); ++k)
        if (const auto& measured = shot.estimate.reflectance.basis.lobes[k].measured)
            document["basis"][k]["file"] = fromHere(measured->file);
    document["look"] = lookToJson(shot.look, shot.capture.origin);
    placeFiles(document["look"], fromHere);
    document["seed"] = shot.seed;
    document["capture_fix"] = fixToJson(shot.fix, shot.captureFolder);
    return document;
}

}  // namespace relamp
