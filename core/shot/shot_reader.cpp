// What the document of shot.json says of a shot. Versions 2 and 3: older documents are upgraded first.
#include "base/atomic_file.h"
#include "base/error.h"
#include "base/json_fields.h"
#include "base/printable.h"
#include "capture/load_capture.h"
#include "pipeline/reproduction.h"
#include "shot/shot_document.h"

namespace relamp {
namespace {
namespace fs = std::filesystem;

std::string text(const JsonFields& fields, const char* key, const std::string& fallback = "") {
    return fields.get<std::string>(key, fallback);
}

/// "lobe": how an emitter shines by direction; absent: evenly.
EmissionLobe lobeOf(const JsonFields& emitter) {
    const JsonFields f = emitter.object("lobe");
    EmissionLobe lobe;
    lobe.power = f.get("power", 0.0f);
    if (!(lobe.power >= 0 && lobe.power <= 1000))
        throw Error("{}: is {}, expected 0 to 1000", f.name("power"), lobe.power);
    lobe.axis = f.get("axis", lobe.axis);
    const float length = glm::length(lobe.axis);
    if (!(length > 0)) throw Error("{}: is 0 0 0, expected a direction", f.name("axis"));
    lobe.axis /= length;
    return lobe;
}

void readEmitters(const JsonFields& document, Estimate& e, std::vector<DVec3>& centroids) {
    document.need("emitters");
    for (const JsonFields& f : document.list("emitters")) {
        EmitterCluster c;
        c.id = text(f, "id", fmt::format("emitter-{}", centroids.size() + 1));
        c.radiance = f.get<Vec3>("radiance");
        for (int k = 0; k < 3; ++k)
            if (c.radiance[k] < 0)
                throw Error("{}[{}]: is {}, expected 0 or more", f.name("radiance"), k, c.radiance[k]);
        centroids.push_back(f.get<DVec3>("centroid"));
        c.normal = f.get("normal", Vec3(0));
        c.area = f.get("area_m2", 0.0f);
        c.twoSided = f.get("two_sided", false);
        c.unobserved = f.get("unobserved", false);
        c.lobe = lobeOf(f);
        c.positionSigma = f.get("position_stddev", Vec3(0));
        c.evidence.viewsSeen = f.get("views_seen", 0);
        c.evidence.clippedFraction = f.get("clipped_fraction", 0.0f);
        if (f.has("radiance_stddev")) e.emitterSigma.push_back(f.get<Vec3>("radiance_stddev"));
        e.identifiability.push_back(f.get("identifiability", 0.0f));
        e.lighting.emitterRadiance.push_back(c.radiance);
        e.emitters.emitters.push_back(std::move(c));
    }
}

/// -1: none.
int environmentOfFile(const Json& file, const std::string& where) {
    const std::string name = textOf(file, where);
    if (name == "none") return -1;
    for (int k = 0; k < int(mostStates); ++k)
        if (name == environmentStem(k) + ".exr") return k;
    throw Error("{}: is {}, expected environment.exr, environment-2.exr, ... or none", where, printable(name));
}

/// Shots of captures with one lighting state, and those of earlier versions, have none.
void readStates(const JsonFields& document, Estimate& e) {
    for (const JsonFields& s : document.list("states")) {
        LightingState state{text(s, "name"), {}};
        if (const std::string fault = faultOfStateName(state.name); !fault.empty())
            throw Error("{}: {}", s.name("name"), fault);
        if (e.states.size() == mostStates) throw Error("states: has more than {} entries", mostStates);
        if (const Json* views = s.find("views"); views && views->is_array())
            for (const Json& view : *views) state.views.push_back(textOf(view, s.name("views")));
        for (EmitterCluster& c : e.emitters.emitters) c.inState.push_back(1);
        for (const JsonFields& l : s.list("emitters")) {
            const std::string id = text(l, "id");
            const float level = l.get("level", 1.0f);
            if (!(level >= 0 && level < 1e6f)) throw Error("{}: is {}, expected 0 or more", l.name("level"), level);
            for (EmitterCluster& c : e.emitters.emitters)
                if (c.id == id) c.inState.back() = level;
        }
        // Documents before version 3 do not say: all states have one environment.
        if (const Json* file = s.find("environment"))
            state.environment = environmentOfFile(*file, s.name("environment"));
        for (int k = int(e.otherEnvironments.size()); k < state.environment; ++k) e.otherEnvironments.emplace_back();
        e.states.push_back(std::move(state));
    }
}

/// The file a measured lobe comes from: a copy in the shot's own folder `merl` goes first, so that a shot can be given
/// away with what it needs.
std::shared_ptr<const MeasuredGloss> measuredOf(const JsonFields& lobe, const fs::path& folder) {
    const fs::path named = text(lobe, "file");
    if (named.empty()) throw Error("{}: is missing", lobe.name("file"));
    std::error_code failed;
    const fs::path copy = folder / "merl" / named.filename(),
                   file = fs::exists(copy, failed) ? copy : (folderPlace(folder) / named).lexically_normal();
    if (!fs::exists(file, failed))
        throw Error(
            "{}: {} is not there; the shot was solved with this measured reflectance, put the file there or into the "
            "shot's folder merl",
            lobe.name("file"), file.string());
    return std::make_shared<const MeasuredGloss>(glossOf(readMerl(file), file));
}

BrdfBasis basisOf(const JsonFields& document, const fs::path& folder) {
    BrdfBasis basis;
    document.need("basis");
    for (const JsonFields& l : document.list("basis")) {
        const std::string kind = text(l, "kind", "lambert");
        Lobe lobe;
        int k = 0;
        while (k < int(Lobe::Kind::mixture) && kind != kindName(Lobe::Kind(k))) ++k;
        if (k == int(Lobe::Kind::mixture))
            throw Error(
                "{}: is {}, expected lambert, ggx, ggx_dielectric, ggx_grazing, cook_torrance, ward, lafortune_back, "
                "lafortune_forward or measured",
                l.name("kind"), kind);
        lobe.kind = Lobe::Kind(k);
        if (lobe.kind == Lobe::Kind::measured) lobe.measured = measuredOf(l, folder);
        lobe.alpha = l.get("alpha", 1.0f);
        if (!(lobe.alpha > 0)) throw Error("{}: is {}, expected more than 0", l.name("alpha"), lobe.alpha);
        lobe.name = text(l, "name", kind);
        basis.lobes.push_back(lobe);
    }
    if (basis.lobes.empty() || basis.lobes[0].kind != Lobe::Kind::lambert) throw Error("basis: expected lambert first");
    return basis;
}

/// What is null or absent of a plan is not known.
SolvePlan planOf(const JsonFields& object) {
    SolvePlan plan;
    for (const JsonFields& s : object.list("stages"))
        plan.stages.push_back({text(s, "name"), s.get("predicted_s", -1.0), s.get("measured_s", -1.0),
                               s.get("predicted_mib", -1.0), s.get("measured_mib", -1.0)});
    for (const JsonFields& o : object.list("left_out"))
        plan.leftOut.push_back({text(o, "what"), text(o, "reason"), o.get("saved_s", 0.0), o.get("saved_mib", 0.0)});
    plan.planningSeconds = object.get("planning_s", 0.0);
    if (object.has("suspected_light")) {
        const JsonFields light = object.object("suspected_light");
        plan.suspectedLight = SuspectedLight{light.get("position", DVec3(0)), light.get("misfit_explained", 0.0),
                                             light.get("standard_errors", 0.0), light.get("fraction", 0.0)};
    }
    return plan;
}

/// How well the photographs are explained; the first shots do not say it.
Reproduction reproductionOf(const JsonFields& object) {
    Reproduction r;
    r.median = object.get("psnr", 0.0);
    r.observed = object.get("observed_psnr", 0.0);
    r.heldOut = object.get("held_out_psnr", 0.0);
    r.advice = text(object, "advice");
    r.cause = causeNamed(text(object, "cause", "none")).value_or(MisfitCause::none);
    for (const JsonFields& v : object.list("views"))
        r.views.push_back({text(v, "name"), v.get("psnr", 0.0), v.get("observed_psnr", 0.0),
                           v.get("held_out_psnr", 0.0), size_t(v.get("pixels", uint64_t(0)))});
    return r;
}

PhotometricFix photometricOf(const JsonFields& object) {
    PhotometricFix fix;
    fix.falloff2 = object.get("falloff2", 0.0f);
    fix.falloff4 = object.get("falloff4", 0.0f);
    for (const char* key : {"falloff2", "falloff4"})
        if (std::abs(object.get(key, 0.0f)) > 10) throw Error("{}: is beyond 10", object.name(key));
    for (const JsonFields& g : object.list("gains")) {
        const Rgb gain = g.get<Vec3>("gain");
        if (!(std::min({gain.x, gain.y, gain.z}) > 1e-6f) || !(maxChannel(gain) < 1e6f))
            throw Error("{}: is out of range", g.name("gain"));
        fix.gains.push_back({text(g, "view"), gain});
    }
    return fix;
}

RegistrationFix registrationOf(const JsonFields& object) {
    RegistrationFix fix;
    const auto unit = [&](const char* key) {
        const float step = object.get(key, 0.0f);
        if (!(std::abs(step) < 1e6f)) throw Error("{}: is out of range", object.name(key));
        return step;
    };
    const auto displacements = [&](const char* key) {
        std::vector<int> all;
        for (const float steps : object.numbers(key)) {
            if (!(std::abs(steps) <= 10000)) throw Error("{}: expected -10000 to 10000", object.name(key));
            all.push_back(int(steps));
        }
        return all;
    };
    fix.step = unit("displacement_unit");
    fix.steps = displacements("displacements");
    fix.outlineStep = unit("outline_unit");
    fix.outlineSteps = displacements("outline_displacements");
    fix.flatStep = unit("flat_unit");
    fix.flatSteps = displacements("flat_displacements");
    for (const JsonFields& p : object.list("poses")) {
        fix.poses.push_back({text(p, "view"), p.get<DVec3>("turn"), p.get<DVec3>("shift")});
        withContext(p.name("turn"), [&] { corrected(Camera(), fix.poses.back()); });
    }
    return fix;
}

/// A list of numbers that a mesh has no more of: 16 million, which a float still counts.
std::vector<uint32_t> indicesOf(const JsonFields& object, const char* key) {
    std::vector<uint32_t> result;
    for (const float value : object.numbers(key)) {
        if (!(value >= 0 && value < 16777216.0f && value == std::floor(value)))
            throw Error("{}: expected whole numbers from 0 to 16777215", object.name(key));
        result.push_back(uint32_t(value));
    }
    return result;
}

/// A list of vertices, and three numbers for each in another.
std::vector<std::pair<uint32_t, Vec3>> vertexVectors(const JsonFields& object, const char* vertices, const char* key) {
    const std::vector<uint32_t> indices = indicesOf(object, vertices);
    const std::vector<float> at = object.numbers(key);
    if (at.size() != 3 * indices.size())
        throw Error("{}: expected three numbers for each of {} vertices", object.name(key), indices.size());
    std::vector<std::pair<uint32_t, Vec3>> result;
    for (size_t i = 0; i < indices.size(); ++i)
        result.emplace_back(indices[i], Vec3(at[3 * i], at[3 * i + 1], at[3 * i + 2]));
    return result;
}

MeshMend mendOf(const JsonFields& object) {
    MeshMend mend;
    mend.removed = indicesOf(object, "removed_triangles");
    mend.shadowless = indicesOf(object, "shadowless_triangles");
    for (const auto& [vertex, position] : vertexVectors(object, "moved_vertices", "positions"))
        mend.moved.push_back({vertex, position});
    if (object.has("turned_vertices"))
        for (const auto& [vertex, normal] : vertexVectors(object, "turned_vertices", "normals"))
            mend.turned.push_back({vertex, normal});
    mend.shining = indicesOf(object, "shining_vertices");
    mend.bothSides = indicesOf(object, "both_sides_vertices");
    const std::vector<float> added = object.numbers("added_positions");
    const std::vector<uint32_t> corners = indicesOf(object, "added_triangles");
    if (added.size() % 3 != 0) throw Error("{}: expected three numbers a vertex", object.name("added_positions"));
    if (corners.size() % 3 != 0) throw Error("{}: expected three numbers a triangle", object.name("added_triangles"));
    for (size_t i = 0; i < added.size(); i += 3) mend.addedPositions.push_back({added[i], added[i + 1], added[i + 2]});
    for (size_t i = 0; i < corners.size(); i += 3) {
        for (size_t k = 0; k < 3; ++k)
            if (corners[i + k] >= mend.addedPositions.size())
                throw Error("{}: vertex {} of {}", object.name("added_triangles"), corners[i + k],
                            mend.addedPositions.size());
        mend.added.push_back({corners[i], corners[i + 1], corners[i + 2]});
    }
    return mend;
}

CaptureFix captureFixOf(const JsonFields& object) {
    CaptureFix fix;
    fix.up = text(object, "up");
    fix.meshUp = text(object, "mesh_up");
    fix.flipCameras = object.get("flip_cameras", false);
    fix.mirror = text(object, "mirror");
    fix.meshMirror = text(object, "mesh_mirror");
    fix.scale = object.get("scale", 1.0);
    fix.meshScale = object.get("mesh_scale", 1.0);
    fix.colmap = text(object, "colmap");
    fix.images = text(object, "images");
    fix.mesh = text(object, "mesh");
    if (object.has("smooth_normals")) fix.smoothNormals = std::min(object.get("smooth_normals", 0), 100);
    fix.fromBrackets = object.get("from_brackets", false);
    fix.registration = registrationOf(object.object("registration"));
    fix.mend = mendOf(object.object("mesh_mend"));
    for (const JsonFields& s : object.list("states")) {
        fix.states.push_back({text(s, "name"), text(s, "pattern")});
        if (const std::string fault = faultOfStateName(fix.states.back().name); !fault.empty())
            throw Error("{}: {}", s.name("name"), fault);
    }
    for (const JsonFields& s : object.list("state_environments"))
        fix.environments.push_back({text(s, "state"), text(s, "environment")});
    fix.photometric = photometricOf(object.object("photometric"));
    for (const JsonFields& p : object.list("proxy_lights"))
        fix.proxies.push_back({p.get<DVec3>("centre"), p.get("radius", 0.0f), p.get("sigma", Vec3(0)),
                               p.get("found", false), glm::max(p.get("radiance", Rgb(0)), Rgb(0)), lobeOf(p)});
    if (!fix.meshUp.empty()) withContext(object.name("mesh_up"), [&] { axisFromName(fix.meshUp); });
    if (!fix.mirror.empty()) withContext(object.name("mirror"), [&] { mirrorAxis(fix.mirror); });
    if (!fix.meshMirror.empty()) withContext(object.name("mesh_mirror"), [&] { mirrorAxis(fix.meshMirror); });
    if (!fix.up.empty()) withContext(object.name("up"), [&] { axisFromName(fix.up); });
    return fix;
}

GaugeReport gaugeOf(const JsonFields& object) {
    const JsonFields from = object.object("from");
    return {text(object, "kind"),
            text(object, "evidence"),
            object.get("scale", Rgb(1)),
            object.get("sigma", Rgb(0)),
            from.get("emitters", Rgb(0)),
            from.get("background", Rgb(0)),
            from.get("gloss", Rgb(0)),
            from.get("bounces", Rgb(0)),
            from.get("light_probes", Rgb(0)),
            from.get("known_patches", Rgb(0))};
}

ProbeFit probeOf(const JsonFields& object) {
    ProbeFit probe;
    probe.name = text(object, "name");
    probe.by = text(object, "fitted_to");
    probe.used = object.get("used", false);
    probe.yawDegrees = object.get("yaw_degrees", 0.0f);
    probe.yawSigma = object.get("yaw_sigma", 0.0f);
    probe.gain = object.get("gain", Rgb(1));
    probe.gainSigma = object.get("gain_sigma", 0.0f);
    probe.noise = object.get("noise", 0.0f);
    probe.held = object.get("held", 0.0f);
    probe.compared = object.get("compared", 0.0f);
    probe.residual = object.get("residual", 0.0f);
    probe.contradicted = object.get("contradicted", false);
    probe.measuredNoise = object.get("measured_noise", 0.0f);
    probe.words = text(object, "words");
    return probe;
}

PriorStrength priorOf(const JsonFields& object) {
    PriorStrength strength;
    strength.factor = object.get("factor", 1.0f);
    strength.chosenBy = text(object, "chosen_by", "usual");
    for (const JsonFields& t : object.list("tried"))
        strength.trials.push_back({t.get("factor", 1.0f), t.get("misfit", 0.0), t.get("error", 0.0)});
    return strength;
}

StabilityReport stabilityOf(const JsonFields& object) {
    StabilityReport stability{object.get("kkt_residual", 0.0), object.get("condition_number", 0.0),
                              object.get("effective_rank", 0), object.get("unknowns", 0), text(object, "reason")};
    stability.weakest = text(object, "weakest");
    stability.weakestSigma = object.get("weakest_sigma", 0.0f);
    stability.spectrum = object.numbers("spectrum");
    return stability;
}

}  // namespace

void readShotDocument(const Json& json, const fs::path& folder, Shot& shot, std::vector<DVec3>& centroids) {
    const JsonFields document(json);
    Estimate& e = shot.estimate;
    shot.captureFolder = (folderPlace(folder) / document.get<std::string>("capture")).lexically_normal();
    e.mode = text(document, "mode", "near-field");
    shot.quality = text(document, "quality", "standard");
    shot.seed = document.get("seed", uint64_t(1));
    readEmitters(document, e, centroids);
    readStates(document, e);
    e.reflectance.basis = basisOf(document, folder);
    for (const JsonFields& t : document.list("timeline"))
        e.timeline.push_back({t.get("seconds", 0.0), text(t, "stage"), t.get("iteration", 0), t.get("objective", 0.0),
                              t.get("rmse", 0.0)});
    shot.fix = captureFixOf(document.object("capture_fix"));
    for (const JsonFields& l : document.list("left_out")) e.leftOut.push_back({text(l, "what"), text(l, "why")});
    e.plan = planOf(document.object("plan"));
    e.reproduction = reproductionOf(document.object("reproduction"));
    e.gauge = gaugeOf(document.object("gauge"));
    for (const JsonFields& p : document.list("light_probes")) e.probes.push_back(probeOf(p));
    for (const JsonFields& p : document.list("known_patches"))
        e.patches.push_back({text(p, "name"), p.get("told", Rgb(0)), p.get("found", Rgb(0)), p.get("noise", 0.0f),
                             p.get("doubtful", false), text(p, "words"), p.get("used", true)});
    for (const JsonFields& c : document.list("palette"))
        e.palette.push_back({c.get<Vec3>("albedo"), c.get("fraction", 0.0f)});
    const JsonFields priors = document.object("priors");
    e.lightSmoothness = priorOf(priors.object("light_smoothness"));
    e.albedoSmoothness = priorOf(priors.object("albedo_smoothness"));
    e.stability = stabilityOf(document.object("stability"));
    const JsonFields resources = document.object("resources"), bounced = document.object("interreflection");
    shot.resources = {resources.get("seconds", 0.0), resources.get("peak_mib", 0.0), resources.get("threads", 0)};
    e.interreflection = bounced.get("kept", false);
    e.bouncedFraction = bounced.get("fraction", 0.0f);
    e.cancelled = document.get("stopped_early", false);
}

}  // namespace relamp
