// relamp, the command line. Links no window and no GL. stdout carries the result only, stderr log and progress.
#include <CLI/CLI.hpp>

#include <signal.h>
#include <unistd.h>

#include <atomic>
#include <cstdio>
#include <new>
#include <nlohmann/json.hpp>

#include "base/log.h"
#include "capture/capture_formats.h"
#include "commands.h"
#include "plan_command.h"
#include "report_command.h"
#include "stress_command.h"

namespace {

relamp::Progress* currentProgress = nullptr;
std::atomic<int> caughtSignal{0};

extern "C" void onSignal(int number) {
    caughtSignal = number;
    if (currentProgress) currentProgress->requestStop();
}

/// --progress auto|bar|json|none.
void showProgress(relamp::Progress& progress, std::string mode) {
    if (mode == "auto") mode = isatty(2) ? "bar" : "none";
    if (mode == "bar")
        progress.setListener([](const std::string& label, double fraction) {
            std::fprintf(stderr, "\r\033[K%s %3.0f %%", label.c_str(), fraction * 100);
        });
    else if (mode == "json")
        progress.setListener([](const std::string& label, double fraction) {
            std::fprintf(stderr, "%s\n", nlohmann::json{{"stage", label}, {"share", fraction}}.dump().c_str());
        });
}

/// How the capture's files are to be read: the same options for every verb that takes a capture.
void addCaptureOptions(CLI::App& verb, relamp::CaptureFix& fix) {
    verb.add_option("--colmap", fix.colmap,
                    "Folder of a COLMAP model (cameras, images, points3D as .bin or .txt), for example sparse/0");
    verb.add_option("--images", fix.images, "Folder of the photographs");
    verb.add_option("--mesh", fix.mesh, "Mesh: PLY, OBJ, STL or OFF");
    verb.add_option("--up", fix.up, "What is up in the files: x, y, z, -x, -y, -z or three numbers X,Y,Z");
    verb.add_option("--scale", fix.scale, "Metres one unit of the files is long")->check(CLI::PositiveNumber);
    verb.add_option("--mesh-scale", fix.meshScale, "Units of the cameras one unit of the mesh is long")
        ->check(CLI::PositiveNumber);
    verb.add_option("--smooth-normals", fix.smoothNormals,
                    "Rounds of smoothing for the normals of a noisy mesh; unless given, a solve asks the photographs")
        ->check(CLI::Range(0, 100));
    verb.add_flag("--flip-cameras", fix.flipCameras, "Camera matrices have OpenCV's axes (Y down, looking along +Z)");
    verb.add_option_function<std::vector<std::string>>(
            "--proxy-light",
            [&fix](const std::vector<std::string>& lights) {
                try {
                    for (const std::string& light : lights) fix.proxies.push_back(relamp::cli::proxyLightOf(light));
                } catch (const relamp::cli::UsageError& error) { throw CLI::ValidationError(error.what()); }
            },
            "A light that the mesh does not hold: X,Y,Z or X,Y,Z,RADIUS in metres of relamp's world (Z up); its power "
            "is solved for. May be given more than once")
        ->allow_extra_args(false)
        ->take_all();
    verb.add_flag("--from-brackets", fix.fromBrackets, "Merge the frames' exposures even where HDR images are named");
}

}  // namespace

int main(int argc, char** argv) {
    using namespace relamp;
    CLI::App app{"relamp: relight a captured scene. It separates what the lights did from what the surfaces are."};
    app.set_version_flag("--version", "relamp " RELAMP_VERSION);
    app.require_subcommand(1);
    std::string progressMode = "auto";
    bool quiet = false;
    app.add_option("--progress", progressMode, "Progress on stderr")
        ->check(CLI::IsMember({"auto", "bar", "json", "none"}));
    app.add_flag("--quiet", quiet, "No log lines");
    app.fallthrough();

    std::filesystem::path path;
    bool json = false;
    cli::SolveArguments solve;
    cli::RenderArguments render;
    cli::ExportArguments exported;
    cli::CompareArguments compare;
    cli::MergeArguments merge;
    CaptureFix fix;

    std::string editPath;
    CLI::App* editVerb = app.add_subcommand("edit", "Open the window (starts relamp-editor)");
    editVerb->add_option("path", editPath, "Capture folder or saved shot");

    CLI::App* checkVerb =
        app.add_subcommand("check", "Import doctor: poses, coverage, exposure, clipped pixels, mesh defects");
    checkVerb->add_option("capture", path, "Capture folder")->required();
    checkVerb->add_flag("--json", json, "One JSON object");

    addCaptureOptions(*checkVerb, fix);

    // What is to be estimated and how: the same options for `solve` and `plan`.
    const auto addSolveOptions = [&solve](CLI::App& verb) {
        verb.add_option("capture", solve.capture, "Capture folder with " + captureMarks())->required();
        verb.add_option("--mode", solve.mode, "near-field, or distant-only: the baseline that knows no lights")
            ->check(CLI::IsMember({"near-field", "distant-only"}))
            ->capture_default_str();
        verb.add_option("--quality", solve.quality, "draft, standard or fine")
            ->check(CLI::IsMember({"draft", "standard", "fine"}))
            ->capture_default_str();
        verb.add_option("--bounce", solve.bounce,
                        "Light that surfaces send each other: auto (as the photographs say), on, off")
            ->check(CLI::IsMember({"auto", "on", "off"}))
            ->capture_default_str();
        verb.add_option("--smooth-light", solve.smoothLight,
                        "How smooth distant light is taken to be: a factor on the usual, or auto (as photographs that "
                        "are left out say)")
            ->capture_default_str();
        verb.add_option("--smooth-surfaces", solve.smoothSurfaces, "The same for the colour of surfaces")
            ->capture_default_str();
        verb.add_option(
                "--basis", solve.basis,
                "Lobes that surfaces may have: built-in (13), wide (55, a component takes up to three), lambert (none)")
            ->check(CLI::IsMember({"built-in", "wide", "lambert"}))
            ->capture_default_str();
        verb.add_option("--merl", solve.merl,
                        "Folder of measured reflectance (MERL .binary files): each joins the basis as one lobe");
        verb.add_option("--palette", solve.palette,
                        "How many materials of one colour each the scene has, where it has few; 0: nothing is said")
            ->check(CLI::Range(0, 64))
            ->capture_default_str();
        verb.add_option("--photometric", solve.photometric,
                        "Exposure, white balance and lens fall-off that differ between photographs: taken out where "
                        "they clearly do (auto), or off")
            ->check(CLI::IsMember({"auto", "off"}))
            ->capture_default_str();
        verb.add_option("--mesh-triangles", solve.meshTriangles,
                        "About how many triangles of the mesh the solve uses; 0 for all. Unless given, meshes above "
                        "300000 are solved on 150000; the shot has the whole mesh")
            ->check(CLI::NonNegativeNumber);
        verb.add_option("--grid-side", solve.gridSide, "Side of the visibility grid (power of two)");
        verb.add_option("--threads", solve.threads, "Threads, 0 for all cores")->check(CLI::NonNegativeNumber);
        verb.add_option("--seed", solve.seed, "Seed of every random choice")->capture_default_str();
        verb.add_flag("--find-light", solve.findLight,
                      "Look for a light that no photograph shows, by its shading and shadows");
        verb.add_flag("--everything", solve.everything,
                      "Leave nothing out beforehand: every part of the model is fitted");
        addCaptureOptions(verb, solve.fix);
    };
    CLI::App* planVerb = app.add_subcommand(
        "plan", "What a solve would do and what it would leave out, why, and what that takes and saves");
    addSolveOptions(*planVerb);
    planVerb->add_flag("--json", json, "One JSON object");

    CLI::App* solveVerb = app.add_subcommand("solve", "Separate distant light, emitters and reflectance");
    addSolveOptions(*solveVerb);
    solveVerb->add_option("-o,--output", solve.output, "Shot folder, NAME.relamp")->required();
    solveVerb->add_option("--time-budget", solve.timeBudget, "Seconds after which the best answer so far is kept")
        ->check(CLI::NonNegativeNumber);
    solveVerb
        ->add_option("--gauge", solve.gauge,
                     "What fixes the brightness scale: auto, white-patch=V,X,Y, emitter=ID:R,G,B, albedo=A")
        ->capture_default_str();
    solveVerb->add_flag(
        "--resume", solve.resume,
        "Go on from the checkpoint that a killed or interrupted solve of the same capture left beside the shot");
    solveVerb->add_flag("--accept-poor", solve.acceptPoor,
                        "End with 0 and not with 4 where the photographs are badly explained");
    solveVerb->add_flag("--overwrite", solve.overwrite, "Replace an existing shot");

    CLI::App* renderVerb = app.add_subcommand("render", "Relit frames");
    renderVerb->add_option("shot", render.shot, "Shot folder")->required();
    renderVerb
        ->add_option("-o,--output", render.output,
                     "Image (EXR, or PNG/JPEG for a look); with several frames a name with #### or %04d")
        ->required();
    renderVerb->add_option(
        "--edits", render.edits,
        "Edits document (JSON) in place of the shot's own look; with `keys` it changes over the frames");
    renderVerb->add_option("--env", render.environment, "A latitude-longitude file, none, or recovered");
    renderVerb->add_option("--env-yaw", render.yaw, "Degrees about the vertical");
    renderVerb
        ->add_option("--camera", render.camera,
                     "A view's number, a camera file, all, turntable:N, or path:V,V,...:N (a spline through views)")
        ->capture_default_str();
    renderVerb->add_option("--frames", render.frames, "Of a sequence: 1-3,5,7-20:2");
    renderVerb->add_option("--size", render.size, "WxH in place of the camera's own");
    renderVerb->add_option("--layers", render.layers,
                           "all, or names: groups, albedo, correction, residual, normal, position, depth, cryptomatte");
    renderVerb->add_option("--naming", render.naming, "Light groups as Combined_GROUP (blender) or RGBA_GROUP (arnold)")
        ->check(CLI::IsMember({"blender", "arnold"}))
        ->capture_default_str();
    renderVerb->add_flag("--multipart", render.multipart, "One part a layer");
    renderVerb
        ->add_option("--ratio", render.ratio,
                     "Relight the photograph itself: x new / old (quotient), or + new - old (difference)")
        ->expected(0, 1)
        ->default_str("quotient")
        ->check(CLI::IsMember({"quotient", "difference"}));
    renderVerb
        ->add_option("--view", render.view, "What PNG and JPEG show: standard (sRGB), auto (exposed by itself), raw")
        ->check(CLI::IsMember({"standard", "auto", "raw"}))
        ->capture_default_str();
    renderVerb->add_option("--samples", render.samples, "Samples a pixel")->check(CLI::PositiveNumber);
    renderVerb->add_option("--threads", render.threads, "Threads, 0 for all cores")->check(CLI::NonNegativeNumber);
    renderVerb->add_option("--seed", render.seed, "Seed of the sampling")->capture_default_str();
    renderVerb->add_flag("--skip-existing", render.skipExisting, "Leave frames that exist");

    CLI::App* exportVerb = app.add_subcommand(
        "export", "The scene for other programs: lights as JSON, USD and glTF, environment, materials, cameras");
    exportVerb->add_option("shot", exported.shot, "Shot folder")->required();
    exportVerb->add_option("-o,--output", exported.output, "Folder for the files")->required();
    exportVerb->add_option("--edits", exported.edits, "Edits document (JSON) in place of the shot's own look");
    exportVerb->add_option("--threads", exported.threads, "Threads, 0 for all cores")->check(CLI::NonNegativeNumber);
    exportVerb->add_flag("--overwrite", exported.overwrite, "Write into a folder that holds something");

    CLI::App* compareVerb =
        app.add_subcommand("compare", "Near-field against distant-only: figures and images in one HTML page");
    compareVerb->add_option("capture", compare.capture, "Capture folder")->required();
    compareVerb->add_option("-o,--output", compare.output, "Folder for the page")->required();
    compareVerb->add_option("--quality", compare.quality, "draft, standard or fine")
        ->check(CLI::IsMember({"draft", "standard", "fine"}))
        ->capture_default_str();
    compareVerb->add_option("--threads", compare.threads, "Threads, 0 for all cores")->check(CLI::NonNegativeNumber);
    compareVerb->add_option("--seed", compare.seed, "Seed of every random choice")->capture_default_str();

    addCaptureOptions(*compareVerb, compare.fix);

    CLI::App* mergeVerb = app.add_subcommand("merge-hdr", "Radiance from photographs of one view at several exposures");
    mergeVerb->add_option("images", merge.images, "Photographs, 8 or 16 bit, or camera raw")->required()->expected(-2);
    mergeVerb->add_option("-o,--output", merge.output, "Image, .exr or .hdr")->required();
    mergeVerb->add_option("--times", merge.times, "Exposure times in seconds, with commas, in place of EXIF's");
    mergeVerb->add_option("--response", merge.response, "Write the camera's response curve (JSON)");
    mergeVerb->add_option("--use-response", merge.useResponse,
                          "Use a curve written with --response, so that several sets get one scale");
    mergeVerb->add_option("--ghosts", merge.ghosts, "Write a mask: black where something moved between the exposures");
    mergeVerb->add_flag("--keep-ghosts", merge.keepGhosts, "Average all exposures, whether or not they agree");
    mergeVerb->add_flag("--no-align", merge.noAlign, "Do not shift hand-held exposures onto each other");
    mergeVerb->add_option("--smoothness", merge.smoothness, "Of the response curve")
        ->check(CLI::PositiveNumber)
        ->capture_default_str();
    mergeVerb->add_option("--threads", merge.threads, "Threads, 0 for all cores")->check(CLI::NonNegativeNumber);

    cli::ReportArguments report;
    CLI::App* reportVerb = app.add_subcommand(
        "report",
        "How a shot was solved: error against run time, per view, spectrum, what was left out; one HTML page");
    reportVerb->add_option("shot", report.shot, "Shot folder")->required();
    reportVerb->add_option("-o,--output", report.output, "HTML page; CSV and SVG files go beside it")->required();
    reportVerb
        ->add_option(
            "--against-distant", report.againstDistant,
            "Solve the capture with distant light only as well: auto (when it takes less than a minute), on, off")
        ->check(CLI::IsMember({"auto", "on", "off"}))
        ->capture_default_str();
    reportVerb->add_option("--truth", report.truth, "Folder of known truth: vertices.ply, env.exr, relight.json");
    reportVerb->add_option("--threads", report.threads, "Threads, 0 for all cores")->check(CLI::NonNegativeNumber);

    cli::StressArguments stress;
    CLI::App* stressVerb = app.add_subcommand("stress", "Stiff and extreme variants: a stability table");
    stressVerb->add_option("path", stress.path, "Capture or shot folder")->required();
    stressVerb->add_option("--only", stress.only, "Only cases whose name holds this text");
    stressVerb->add_flag("--json", stress.json, "One JSON object");
    stressVerb->add_option("--threads", stress.threads, "Threads, 0 for all cores")->check(CLI::NonNegativeNumber);

    CLI::App* infoVerb = app.add_subcommand("info", "What is in a shot or a capture");
    infoVerb->add_option("path", path, "Shot or capture folder")->required();
    infoVerb->add_flag("--json", json, "One JSON object");
    addCaptureOptions(*infoVerb, fix);

    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) { return app.exit(error) == 0 ? 0 : 2; }

    Progress progress;
    currentProgress = &progress;
    struct sigaction action {};
    action.sa_handler = onSignal;
    sigaction(SIGINT, &action, nullptr);
    sigaction(SIGTERM, &action, nullptr);
    signal(SIGXFSZ, SIG_IGN);  // a file that may not grow further is a failed write, not an end
    const bool bar = progressMode == "bar" || (progressMode == "auto" && isatty(2));
    if (!quiet)
        setLogSink([bar](LogLevel level, const std::string& line) {
            std::fprintf(stderr, "%s%s%s\n", bar ? "\r\033[K" : "", level == LogLevel::warning ? "warning: " : "",
                         line.c_str());
        });
    showProgress(progress, progressMode);

    const auto fail = [&](int code, const char* what) {
        std::fprintf(stderr, "%srelamp: %s\n", bar ? "\r\033[K" : "", what);
        return code;
    };
    try {
        int code = 0;
        if (*editVerb) code = cli::edit(editPath);
        else if (*checkVerb) code = cli::check(path, fix, json, progress);
        else if (*planVerb) code = cli::plan(solve, json, progress);
        else if (*solveVerb) code = cli::solve(solve, progress);
        else if (*renderVerb) code = cli::render(render, progress);
        else if (*exportVerb) code = cli::exportShot(exported, progress);
        else if (*compareVerb) code = cli::compare(compare, progress);
        else if (*mergeVerb) code = cli::mergeHdr(merge, progress);
        else if (*reportVerb) code = cli::report(report, progress);
        else if (*stressVerb) code = cli::stress(stress, progress);
        else if (*infoVerb) code = cli::info(path, fix, json, progress);
        if (bar) std::fputs("\r\033[K", stderr);
        return code;
    } catch (const Cancelled&) {
        return fail(128 + (caughtSignal ? caughtSignal.load() : SIGINT), "stopped");
    } catch (const cli::UsageError& error) { return fail(2, error.what()); } catch (const OutOfResources& error) {
        return fail(6, error.what());
    } catch (const Error& error) { return fail(3, error.what()); } catch (const std::bad_alloc&) {
        return fail(6, "out of memory");
    } catch (const std::exception& error) { return fail(1, error.what()); }
}
