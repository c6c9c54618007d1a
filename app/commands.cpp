#include "commands.h"

#include <nlohmann/json.hpp>

#include <unistd.h>

#include "base/atomic_file.h"
#include "base/is_there.h"
#include "base/json_fields.h"
#include "base/log.h"
#include "base/parallel.h"
#include "base/printable.h"
#include "base/significant.h"
#include "capture/brackets.h"
#include "capture/check.h"
#include "capture/photograph_reader.h"
#include "pipeline/shot_of.h"
#include "pipeline/texture_stage.h"
#include "print_result.h"
#include "report/compare.h"
#include "shot/checkpoint.h"
#include "shot/shot_document.h"
#include "shot/shot_file.h"
#include "shot/shot_leftovers.h"
#include "shot/shot_lock.h"

namespace relamp::cli {

std::vector<double> numbersOf(const std::string& text, const std::string& option, size_t count) {
    std::vector<double> values;
    size_t at = 0;
    while (at <= text.size()) {
        const size_t comma = std::min(text.find(',', at), text.size());
        const std::string part = text.substr(at, comma - at);
        char* end = nullptr;
        const double value = std::strtod(part.c_str(), &end);
        if (part.empty() || *end || !std::isfinite(float(value)))
            throw UsageError(fmt::format("{}: '{}' is not a number", option, part));
        values.push_back(value);
        at = comma + 1;
    }
    if (values.size() != count)
        throw UsageError(fmt::format("{}: expected {} numbers, got {}", option, count, values.size()));
    return values;
}

namespace {

GaugeChoice gaugeOf(const std::string& text) {
    GaugeChoice gauge;
    if (text == "auto") return gauge;
    const size_t equals = text.find('=');
    const std::string kind = text.substr(0, equals), rest = equals == std::string::npos ? "" : text.substr(equals + 1);
    if (kind == "white-patch") {
        const auto v = numbersOf(rest, "--gauge white-patch", 3);
        if (!(v[0] >= 0 && v[0] < 1e6) || v[0] != std::floor(v[0]) || !(v[1] >= 0) || !(v[2] >= 0))
            throw UsageError("--gauge white-patch: expected a view's number and a pixel, counted from 0");
        gauge.kind = GaugeChoice::Kind::whitePatch;
        gauge.view = int(v[0]);
        gauge.pixel = {v[1], v[2]};
    } else if (kind == "emitter") {
        const size_t colon = rest.find(':');
        if (colon == std::string::npos) throw UsageError("--gauge emitter: expected emitter=ID:R,G,B");
        const auto v = numbersOf(rest.substr(colon + 1), "--gauge emitter", 3);
        if (!(std::min({v[0], v[1], v[2]}) > 0))
            throw UsageError("--gauge emitter: expected a radiance of more than 0 in each channel");
        gauge.kind = GaugeChoice::Kind::emitter;
        gauge.emitter = rest.substr(0, colon);
        gauge.radiance = {v[0], v[1], v[2]};
    } else if (kind == "albedo") {
        gauge.kind = GaugeChoice::Kind::albedo;
        gauge.albedo = numbersOf(rest, "--gauge albedo", 1)[0];
        if (!(gauge.albedo >= 0.001 && gauge.albedo <= 1)) throw UsageError("--gauge albedo: expected 0.001 to 1");
    } else {
        throw UsageError("--gauge " + text +
                         ": unknown, expected auto, white-patch=V,X,Y, emitter=ID:R,G,B or albedo=A");
    }
    return gauge;
}

}  // namespace

ProxyLight proxyLightOf(const std::string& text) {
    const bool sized = std::count(text.begin(), text.end(), ',') == 3;
    const std::vector<double> v = numbersOf(text, "--proxy-light", sized ? 4 : 3);
    if (sized && !(v[3] > 0))
        throw UsageError("--proxy-light: a radius of " + text.substr(text.rfind(',') + 1) + ", expected more than 0");
    return {DVec3(v[0], v[1], v[2]), sized ? float(v[3]) : 0, Vec3(0), false};
}

int edit(const std::string& path) {
    std::error_code error;
    const fs::path self = fs::read_symlink("/proc/self/exe", error);
    const std::string beside = (self.parent_path() / "relamp-editor").string();
    std::string given = path;
    char* arguments[] = {const_cast<char*>("relamp-editor"), given.empty() ? nullptr : given.data(), nullptr};
    if (!error) execv(beside.c_str(), arguments);
    execvp("relamp-editor", arguments);
    throw Error("relamp-editor, the window, is not installed beside {}", self.string());
}

int check(const fs::path& capture, const CaptureFix& fix, bool json, Progress& progress) {
    LoadOptions load;
    load.fix = fix;
    const CaptureCheck result = checkCapture(loadCapture(capture, load, progress), progress);
    printResult(json ? dumpJson(toJson(result), 1) : toText(result));
    return 0;
}

/// A factor on a prior's usual strength; 0: the photographs are asked.
float strengthOf(const std::string& text, const char* option) {
    if (text == "auto") return 0;
    const auto factor = float(numbersOf(text, option, 1)[0]);
    if (!(factor >= 0.01f && factor <= 100))
        throw UsageError(fmt::format("{}: expected auto or a factor from 0.01 to 100", option));
    return factor;
}

std::optional<int> textureFrom(const std::string& text) {
    if (text == "auto") return {};
    if (text == "off") return 0;
    const double side = numbersOf(text, "--texture", 1)[0];
    if (!(side >= leastTextureSide && side <= mostTextureSide) || side != std::floor(side))
        throw UsageError(fmt::format("--texture: expected auto, off, or a side from {} to {} texels", leastTextureSide,
                                     mostTextureSide));
    return int(side);
}

PipelineOptions pipelineOptions(const SolveArguments& a) {
    PipelineOptions options;
    options.solve = solveOptionsFor(a.quality);
    if (a.mode == "distant-only") options.solve.nearField = false;
    else if (a.mode != "near-field")
        throw UsageError("--mode " + a.mode + ": unknown, expected near-field or distant-only");
    if (a.gridSide) {
        if (a.gridSide < 8 || a.gridSide > 256 || (a.gridSide & (a.gridSide - 1)))
            throw UsageError("--grid-side: expected a power of two from 8 to 256");
        options.solve.visibilitySide = a.gridSide;
    }
    options.load.fix = a.fix;
    options.solve.gauge = gaugeOf(a.gauge);
    if (a.bounce != "auto")
        options.solve.bounce = a.bounce == "on" ? SolveOptions::Bounce::on : SolveOptions::Bounce::off;
    options.solve.lightSmoothness = strengthOf(a.smoothLight, "--smooth-light");
    options.solve.albedoSmoothness = strengthOf(a.smoothSurfaces, "--smooth-surfaces");
    options.solve.palette = size_t(a.palette);
    options.solve.seed = a.seed;
    chooseBasis(a.basis, a.merl, options.solve);
    takeReferences(a, options);
    if (a.meshTriangles >= 0) options.meshTriangles = size_t(a.meshTriangles);
    options.texture = textureFrom(a.texture);
    options.everything = a.everything;
    options.findLight = a.findLight;
    options.registration = a.registration == "auto";
    options.photometric = a.photometric == "auto";
    return options;
}

namespace {

/// The folders that a shot will lie in, made before the solve: its lock and its checkpoint lie there too. In the end
/// those that stayed empty go again.
class FoldersForShot {
public:
    explicit FoldersForShot(const fs::path& shot) {
        std::error_code failed;
        const fs::path parent = folderPlace(shot).parent_path();
        for (fs::path place = parent; place.has_relative_path() && !fs::exists(place, failed);
             place = place.parent_path())
            made_.push_back(place);
        fs::create_directories(parent, failed);
        if (failed) throw Error("{}: cannot be made ({})", parent.string(), failed.message());
    }
    ~FoldersForShot() {
        std::error_code notEmpty;
        for (const fs::path& place : made_) fs::remove(place, notEmpty);
    }
    FoldersForShot(const FoldersForShot&) = delete;
    FoldersForShot& operator=(const FoldersForShot&) = delete;

private:
    std::vector<fs::path> made_;  ///< innermost first
};

}  // namespace

int solve(const SolveArguments& a, Progress& progress) {
    if (a.capture.empty()) throw UsageError("solve: expected a capture, or --list FILE");
    if (!a.items.empty() || a.skipExisting) throw UsageError("solve: --items and --skip-existing belong to --list");
    const ThreadLimit limit(a.threads);
    PipelineOptions options = pipelineOptions(a);
    if (isThere(a.output) && !a.overwrite)
        throw Error("{}: exists already, add --overwrite to replace it", a.output.string());
    // Known before the calculation, not after it.
    checkShotCanBeWritten(a.output);
    InputFiles inputs = captureFiles(a.capture, a.fix, progress);
    inputs.addFolder(a.merl);
    for (const fs::path& file : referenceFiles(a)) inputs.add(file);
    checkShotCanBeWritten(a.output, inputs);
    const FoldersForShot folders(a.output);
    const ShotLock lock = ShotLock::take(a.output);
    if (!lock.owner().empty())
        throw Error("{}: is open elsewhere ({}); close it there or choose another name", a.output.string(),
                    lock.owner());
    progress.setBudget(a.timeBudget);
    const fs::path checkpoint = checkpointFile(a.output);
    std::optional<CheckpointKeeper> keeper;
    options.resume = [&](const Capture& capture) -> std::optional<SolveCheckpoint> {
        const uint64_t fingerprint = fingerprintOf(capture, options);
        keeper.emplace(checkpoint, fingerprint);
        if (!a.resume) return {};
        FoundCheckpoint found = readCheckpoint(checkpoint, fingerprint);
        if (!found.checkpoint) logWarning("{}; the solve starts anew", found.refused);
        return std::move(found.checkpoint);
    };
    SolveListener listener;
    listener.checkpoint = [&](const SolveCheckpoint& c) { keeper->take(c); };
    PipelineResult r = runPipeline(a.capture, options, progress, &listener);
    ShotSource source = sourceOf(r, a.capture, a.fix, a.quality, a.seed);
    source.resources = {progress.seconds(), peakMib(), a.threads > 0 ? a.threads : availableThreads()};
    const Shot shot = shotOf(std::move(r.estimate), source);
    try {
        saveShot(shot, r.scene->mesh, a.output, a.overwrite);
    } catch (const OutOfResources& error) {
        // A long calculation is not thrown away while any disk has room for it.
        const fs::path elsewhere =
            fs::temp_directory_path() /
            fmt::format("{}-{}.relamp", fs::absolute(a.output).lexically_normal().stem().string(), getpid());
        try {
            saveShot(shot, r.scene->mesh, elsewhere, true);
        } catch (const Error&) { throw error; }
        throw OutOfResources(fmt::format("{}; the shot was saved as {}", error.what(), elsewhere.string()));
    }
    keeper->remove();
    const Reproduction& reproduction = shot.estimate.reproduction;
    logInfo("solved in {:.1f} s, {:.0f} MiB: {}, {} distant unknowns", shot.resources.seconds, shot.resources.peakMib,
            counted(shot.estimate.emitters.emitters.size(), "light"), shot.estimate.lighting.leaves.size());
    if (!reproduction.poor()) return 0;
    logWarning("quality gate missed: the photographs are reproduced at {:.1f} dB, {:.0f} are wanted. {}",
               reproduction.median, Reproduction::gateDb, reproduction.advice);
    if (a.acceptPoor) return 0;
    logWarning("the shot was written all the same; --accept-poor ends with 0");
    return 4;
}

int compare(const CompareArguments& a, Progress& progress) {
    const ThreadLimit limit(a.threads);
    CompareOptions options;
    options.solve = solveOptionsFor(a.quality);
    options.solve.seed = a.seed;
    options.quality = a.quality;
    options.fix = a.fix;
    const fs::path page = writeComparison(a.capture, a.output, options, progress);
    logInfo("{}: written", page.string());
    return 0;
}

namespace {

/// Of a lighting state of a capture or a shot, where something is said of it.
std::string environmentText(const nlohmann::json& state) {
    const auto at = state.find("environment");
    return at == state.end() ? "" : ", environment: " + printable(at->get<std::string>());
}

/// How well the photographs are explained, a line a view.
std::string reproductionText(const nlohmann::json& r) {
    std::string text = fmt::format("  photographs reproduced at {:.1f} dB (median)", r.at("psnr").get<double>());
    if (!r.at("held_out_psnr").is_null())
        text += fmt::format("; views left out are predicted at {:.1f} dB", r.at("held_out_psnr").get<double>());
    text += "\n";
    double worst = 1e9;
    for (const auto& v : r.at("views")) worst = std::min(worst, v.at("psnr").get<double>());
    for (const auto& v : r.at("views")) {
        text += fmt::format("    {}  {:.1f} dB", v.at("name").get<std::string>(), v.at("psnr").get<double>());
        if (!v.at("held_out_psnr").is_null())
            text += fmt::format(", left out {:.1f} dB", v.at("held_out_psnr").get<double>());
        text += v.at("psnr").get<double>() == worst ? ", worst\n" : "\n";
    }
    if (r.at("poor").get<bool>()) text += fmt::format("  QUALITY GATE MISSED: {}\n", r.at("advice").get<std::string>());
    return text;
}

int showInfo(const fs::path& path, const CaptureFix& fix, bool json, Progress& progress) {
    nlohmann::json result;
    mendShot(path);
    const bool isShot = isThere(path / "shot.json");
    if (isShot) {
        result = parseJson(readBytes(path / "shot.json", size_t(256) << 20), (path / "shot.json").string());
        if (!result.is_object() || !result.contains("emitters") || !result.contains("mode"))
            throw Error("{}: is not a shot's description", (path / "shot.json").string());
        result.erase("look");
        upgradeShotDocument(result);
    } else {
        LoadOptions load;
        load.images = false;
        load.fix = fix;
        const Capture capture = loadCapture(path, load, progress);
        result = {{"views", capture.views.size()},
                  {"vertices", capture.mesh.vertexCount()},
                  {"triangles", capture.mesh.triangles.size()},
                  {"notes", capture.notes}};
        for (const auto& [name, views] : viewsOfStates(capture))
            result["states"].push_back({{"name", name}, {"views", views}});
        for (size_t s = 0; s < capture.environmentOfState.size(); ++s)
            result["states"][s]["environment"] = environmentInWords(capture, s);
    }
    if (json) {
        if (isShot) addKeysOfVersion1(result);
        printResult(dumpJson(result, 1));
        return 0;
    }
    std::string text;  // whole before any of it is shown: a broken file prints nothing
    if (!isShot) {
        text += fmt::format("capture: {} views, {} vertices, {} triangles\n", dumpJson(result["views"]),
                            dumpJson(result["vertices"]), dumpJson(result["triangles"]));
        for (const auto& state : result.value("states", nlohmann::json::array()))
            text += fmt::format("  lighting state {}: {} views{}\n", printable(state["name"].get<std::string>()),
                                dumpJson(state["views"]), environmentText(state));
        printResult(text);
        return 0;
    }
    text += fmt::format("shot ({}), solved in {:.1f} s\n", result["mode"].get<std::string>(),
                        result["resources"]["seconds"].get<double>());
    if (result.contains("reproduction")) text += reproductionText(result["reproduction"]);
    for (const auto& e : result["emitters"])
        text +=
            fmt::format("  {}  radiance {}  area {} m2  seen in {} views  identifiable {:.0f} %\n",
                        e["id"].get<std::string>(), dumpJson(e["radiance"]), significant(e["area_m2"].get<double>(), 4),
                        dumpJson(e["views_seen"]), 100 * e.value("identifiability", 0.0));
    for (const auto& e : result["emitters"]) {
        if (!e.value("unobserved", false)) continue;
        text += fmt::format("  {} is a proxy at {} m: its radiance was solved for, not seen",
                            e["id"].get<std::string>(), dumpJson(e["centroid"]));
        text += e.contains("position_stddev") ? fmt::format("; place found from shading, standard deviation {} m\n",
                                                            dumpJson(e["position_stddev"]))
                                              : "\n";
    }
    for (const auto& state : result.value("states", nlohmann::json::array())) {
        text += fmt::format("  lighting state {}: {} views", printable(state["name"].get<std::string>()),
                            state["views"].size());
        for (const auto& e : state["emitters"])
            text += fmt::format(", {} at {:.3g}", e["id"].get<std::string>(), e["level"].get<double>());
        text += environmentText(state) + "\n";
    }
    text += fmt::format("  environment: {} coefficients\n  gauge: {} ({})\n", dumpJson(result["environment"]["leaves"]),
                        result["gauge"]["kind"].get<std::string>(), result["gauge"]["evidence"].get<std::string>());
    for (const auto& probe : result.value("light_probes", nlohmann::json::array()))
        text += fmt::format("  light probe {}\n", probe["words"].get<std::string>());
    for (const auto& patch : result.value("known_patches", nlohmann::json::array()))
        text += fmt::format("  known albedo: {}\n", patch["words"].get<std::string>());
    if (result["gauge"].contains("sigma")) {
        const auto& sigma = result["gauge"]["sigma"];
        text += fmt::format(
            "  brightness of the light against the surfaces, standard deviation: red {:.1f}, green {:.1f}, blue {:.1f} "
            "%\n",
            100 * sigma[0].get<double>(), 100 * sigma[1].get<double>(), 100 * sigma[2].get<double>());
    }
    if (result["stability"].contains("weakest"))
        text += fmt::format("  least certain: {} ({:.1f} % of the light on the surfaces)\n",
                            result["stability"]["weakest"].get<std::string>(),
                            100 * result["stability"]["weakest_sigma"].get<double>());
    for (const auto& l : result["left_out"])
        text += fmt::format("  left out: {} ({})\n", l["what"].get<std::string>(), l["why"].get<std::string>());
    printResult(text);
    return 0;
}

}  // namespace

int info(const fs::path& path, const CaptureFix& fix, bool json, Progress& progress) {
    try {
        return showInfo(path, fix, json, progress);
    } catch (const nlohmann::json::exception& error) {
        throw Error("{}: a field is missing or has the wrong kind ({})", (path / "shot.json").string(), error.what());
    }
}

namespace {

/// A curve as --response writes it.
ResponseCurve readResponse(const fs::path& file) {
    const nlohmann::json document = parseJson(readBytes(file, size_t(1) << 20), file.string());
    if (!document.is_object() || !document.contains("log_exposure") || !document["log_exposure"].is_object())
        throw Error("{}: log_exposure is missing", file.string());
    ResponseCurve curve = linearResponse();
    curve.linear = false;
    const auto take = [&](const nlohmann::json& holder, const std::string& key, std::array<double, 256>& to) {
        const auto list = holder.find(key);
        if (list == holder.end() || !list->is_array() || list->size() != to.size())
            throw Error("{}: {} is no list of {} numbers", file.string(), key, to.size());
        for (size_t i = 0; i < to.size(); ++i) {
            if (!(*list)[i].is_number() || !std::isfinite((*list)[i].get<double>()))
                throw Error("{}: {}[{}] is no number", file.string(), key, i);
            to[i] = (*list)[i].get<double>();
        }
    };
    for (size_t c = 0; c < 3; ++c) {
        const std::string name(1, "rgb"[c]);
        take(document["log_exposure"], name, curve.logExposure[c]);
        if (!std::is_sorted(curve.logExposure[c].begin(), curve.logExposure[c].end()))
            throw Error("{}: {} falls, expected a curve that grows", file.string(), name);
    }
    take(document, "code_noise", curve.noise);
    for (double& noise : curve.noise) noise = std::max(noise, 0.01);
    return curve;
}

}  // namespace

int mergeHdr(const MergeArguments& a, Progress& progress) {
    const ThreadLimit limit(a.threads);
    std::vector<float> times;
    if (!a.times.empty())
        for (const double time : numbersOf(a.times, "--times", a.images.size())) times.push_back(float(time));
    for (const float t : times)
        if (!(t > 0)) throw UsageError("--times: expected seconds above 0");
    const std::string ending = a.output.extension().string();
    if (ending != ".exr" && ending != ".hdr")
        throw UsageError("--output: expected a name that ends in .exr or .hdr, radiance has no place in others");
    InputFiles files;
    for (const fs::path& image : a.images) files.add(image);
    files.add(a.useResponse);
    for (const fs::path& output : {a.output, a.response, a.ghosts}) files.claim(output);
    BracketOptions options;
    options.smoothness = a.smoothness;
    options.rejectGhosts = !a.keepGhosts;
    options.align = !a.noAlign;
    Bracket set;
    ExposureReference reference;
    for (size_t i = 0; i < a.images.size(); ++i)
        set.push_back(bracketPhoto(a.images[i],
                                   times.empty() ? readExposureTags(a.images[i]) : ExposureTags{double(times[i]), 0, 0},
                                   reference));
    const ResponseCurve response =
        a.useResponse.empty() ? responseOf({set}, options, progress) : readResponse(a.useResponse);
    const MergedBracket merged = mergeBracket(set, response, options, progress);
    writeImage(a.output, merged.image, {{"relamp:saturation", fmt::format("{:.6g}", merged.saturation)}});
    if (!a.response.empty()) {
        nlohmann::json curves;
        for (size_t c = 0; c < 3; ++c) curves[std::string(1, "rgb"[c])] = response.logExposure[c];
        writeBytesAtomically(
            a.response,
            dumpJson({{"about", "ln exposure (radiance x seconds) that gives each 8-bit code; 0 at code 255"},
                      {"log_exposure", curves},
                      {"code_noise", response.noise},
                      {"samples", response.samples},
                      {"residual", response.residual}},
                     1));
    }
    if (!a.ghosts.empty()) {
        Image mask(merged.image.width, merged.image.height, Rgb(1));
        for (size_t i = 0; i < mask.pixels.size(); ++i)
            if (merged.ghost[i]) mask.pixels[i] = Rgb(0);
        writeImage(a.ghosts, mask);
    }
    for (size_t i = 0; i < merged.shifts.size(); ++i)
        if (merged.shifts[i] != PixelShift{})
            logInfo("{}: shifted by {} {} pixels", a.images[i].string(), merged.shifts[i].x, merged.shifts[i].y);
    logInfo(
        "{}: {} exposures, off each other by {:.2f} pixels still, {} pixels changed between them, {} clipped in the "
        "shortest, {} black in the longest; response from {} places, residual {:.2f}",
        a.output.string(), set.size(), merged.misfit, merged.ghosts, merged.clippedPixels, merged.dark,
        response.samples, response.residual);
    return 0;
}

}  // namespace relamp::cli
