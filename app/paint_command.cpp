// relamp paint: powers and colours of lights from an image of what they shall do.
#include <nlohmann/json.hpp>

#include "base/atomic_file.h"
#include "base/is_there.h"
#include "base/json_fields.h"
#include "base/log.h"
#include "base/parallel.h"
#include "capture/own_axes.h"
#include "commands.h"
#include "edit/emitter_edits.h"
#include "edit/light_brush.h"
#include "image/image_io.h"
#include "print_result.h"
#include "relight/frame.h"
#include "shot/frame_jobs.h"
#include "shot/shot_file.h"

namespace relamp::cli {
namespace {

/// What may change: emitters by id, and the environment.
struct Chosen {
    std::vector<std::string> ids;
    std::vector<size_t> emitters;  ///< indices into the relit scene's
    bool environment = false;
};

/// `names` are ids or what the artist calls lights; empty: all that shine or could.
Chosen chosenLights(const PaintArguments& a, const Scene& scene, const Shot& shot, const Look& look) {
    const std::vector<EmitterState> all = emittersOf(scene, shot.estimate, look);
    Chosen out;
    out.environment = a.environment;
    for (const std::string& name : a.lights)
        if (std::none_of(all.begin(), all.end(), [&](const EmitterState& e) { return e.id == name || e.name == name; }))
            throw UsageError(fmt::format("--lights: there is no light named {}", name));
    for (size_t e = 0; e < all.size(); ++e) {
        const bool named = std::any_of(a.lights.begin(), a.lights.end(), [&](const std::string& name) {
            return name == all[e].id || name == all[e].name;
        });
        if (!named && !(a.lights.empty() && all[e].shines())) continue;
        if (!(maxChannel(all[e].groupFactor) > 0))
            throw UsageError(fmt::format("--lights: {} is in a group that is off", all[e].name));
        out.ids.push_back(all[e].id);
        out.emitters.push_back(e);
    }
    if (out.ids.empty() && !out.environment)
        throw UsageError("--lights: no light shines that could change, name one or give --environment");
    return out;
}

/// The look with every chosen light shining, so that its light can be scaled.
Look shiningLook(const Look& look, const Shot& shot, const Scene& scene, const Chosen& chosen) {
    Look out = look;
    for (const std::string& id : chosen.ids) {
        const auto e = findEmitter(scene, shot.estimate, look, id);
        setEnabled(out, id, true);
        if (!(maxChannel(e->radiance) > 0)) setRadiance(out, shot.estimate, id, e->recoveredRadiance);
    }
    return out;
}

/// Weight of a pixel: what the mask says, where the target has one.
std::vector<float> weightsOf(const Image& target, const std::filesystem::path& maskFile) {
    std::vector<float> weight(target.pixels.size(), 1);
    if (!maskFile.empty()) {
        const Image mask = readImage(maskFile, nullptr, true);
        if (mask.width != target.width || mask.height != target.height)
            throw Error("{}: is {} x {}, expected the target's {} x {}", maskFile.string(), mask.width, mask.height,
                        target.width, target.height);
        for (size_t p = 0; p < weight.size(); ++p) weight[p] = std::clamp(luminance(mask.pixels[p]), 0.0f, 1.0f);
    }
    for (size_t p = 0; p < weight.size(); ++p)
        if (!target.usable.empty() && !target.usable[p]) weight[p] = 0;
    return weight;
}

/// The pixels that count, with the light of each group there.
LightGoal goalOf(const Image& target, const std::vector<float>& weight, const Frame& frame, const Chosen& chosen,
                 const Look& before, const Scene& scene, const Shot& shot) {
    LightGoal goal;
    goal.response.resize(chosen.emitters.size() + (chosen.environment ? 1 : 0));
    for (const std::string& id : chosen.ids) {
        const auto e = findEmitter(scene, shot.estimate, before, id);
        goal.present.push_back(Rgb(e->enabled && maxChannel(e->radiance) > 0 ? 1.0f : 0.0f));
    }
    if (chosen.environment) goal.present.emplace_back(1);
    for (size_t p = 0; p < target.pixels.size(); ++p) {
        // Lights themselves and the background are not what is painted.
        if (!(weight[p] > 0) || frame.alpha[p] < 0.99f || frame.emittersSeen[p][0].fraction > 0) continue;
        goal.weight.push_back(weight[p]);
        goal.target.push_back(target.pixels[p]);
        Rgb rest = frame.beauty[p];
        for (size_t k = 0; k < goal.response.size(); ++k) {
            const Rgb light = k < chosen.emitters.size() ? frame.byEmitter[chosen.emitters[k]][p] : frame.world[p];
            goal.response[k].push_back(light);
            rest -= light;
        }
        goal.rest.push_back(glm::max(rest, Rgb(0)));
    }
    if (goal.weight.empty()) throw Error("target: none of its pixels that count shows a surface");
    return goal;
}

}  // namespace

int paint(const PaintArguments& a, Progress& progress) {
    const ThreadLimit limit(a.threads);
    const Shot shot = openShot(a.shot, false, progress);
    Look look = a.edits.empty() ? shot.look : readLook(a.edits, shot.capture.origin);
    InputFiles inputs = shotFiles(shot, progress);
    for (const fs::path& file : {a.edits, a.target, a.mask}) inputs.add(file);
    for (const auto& file : filesOf(look)) inputs.add(file);
    if (!a.output.empty()) {
        inputs.refuse(a.output);
        const fs::path folder = fs::absolute(a.output).parent_path();
        if (!isThere(folder)) throw Error("{}: does not exist", folder.string());
    }
    const Image target = readImage(a.target);
    const std::vector<float> weight = weightsOf(target, a.mask);
    std::vector<FrameJob> jobs;
    try {
        jobs =
            frameJobs(shot.capture, a.camera, "", fmt::format("{}x{}", target.width, target.height), "frame.####.exr");
    } catch (const BadOption& error) { throw UsageError(error.what()); }
    if (jobs.size() != 1) throw UsageError("--camera: expected one view, the target's");

    const Scene scene = buildScene(shot.capture.mesh, progress, ownAxes(shot.capture));
    const Chosen chosen = chosenLights(a, scene, shot, look);
    const Look shining = shiningLook(look, shot, scene, chosen);
    const RelitScene relit = applyLook(scene, shot.estimate, shining, progress);
    FrameOptions options;
    options.denoise = true;
    options.seed = a.seed;
    const Frame frame = renderFrame(relit, jobs[0].camera, options, progress);
    const LightGoal goal = goalOf(target, weight, frame, chosen, look, scene, shot);
    LightGoalOptions how;
    how.colour = !a.keepColours;
    how.keep = a.keep;
    const LightGoalAnswer answer = reachGoal(goal, how);
    look = shining;
    scaleLights(look, shot.estimate, chosen.ids, chosen.environment, answer.scale);

    for (size_t k = 0; k < answer.scale.size(); ++k) {
        const Rgb s = answer.scale[k];
        logInfo("{}: x {:.4g} {:.4g} {:.4g} (red, green, blue)",
                k < chosen.ids.size() ? chosen.ids[k] : std::string("environment"), s.x, s.y, s.z);
    }
    logInfo("error over what is wanted, root mean square: {:.3g} before, {:.3g} now", answer.before, answer.after);
    if (answer.tooDark > 0.01f || answer.tooBright > 0.01f)
        logInfo("{:.0f} % stays too dark and {:.0f} % too bright: no chosen light can change it alone",
                100 * answer.tooDark, 100 * answer.tooBright);
    const std::string document = dumpJson(lookToJson(look, shot.capture.origin), 2) + "\n";
    if (a.output.empty()) printResult(document);
    else writeBytesAtomically(a.output, document);
    return 0;
}

}  // namespace relamp::cli
