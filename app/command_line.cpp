#include "command_line.h"

#include <CLI/CLI.hpp>

#include <charconv>
#include <sstream>

#include "capture/capture_formats.h"
#include "option_rules.h"
#include "print_result.h"
#include "shot/export_frame.h"

namespace relamp::cli {
namespace {

/// Says what was expected: the checks of CLI11 name the largest number there is. What is no number is its own to tell.
CLI::Validator above(double least, bool itself, const char* kind, const char* words) {
    return CLI::Validator(
        [=](std::string& given) {
            double value = 0;
            const auto [end, error] = std::from_chars(given.data(), given.data() + given.size(), value);
            const bool good = error != std::errc() || value > least || (itself && value == least);
            return good ? std::string() : fmt::format("{}: expected {}", given, words);
        },
        kind);
}
CLI::Validator positive() { return above(0, false, "POSITIVE", "a number above 0"); }
CLI::Validator notNegative() { return above(0, true, "NONNEGATIVE", "0 or more"); }

/// What a capture may be, a line a format, below the options.
std::string captureFormatList() {
    std::string words = "Capture formats, known by content; of several in a folder the first counts:\n";
    for (const CaptureFormat& format : captureFormats())
        words += fmt::format("  {:<26}{}\n", format.name, format.marks);
    return words;
}

/// How the capture's files are to be read: the same options for every verb that takes a capture.
void addCaptureOptions(CLI::App& verb, CaptureFix& fix) {
    verb.footer(captureFormatList());
    verb.add_option("--colmap", fix.colmap,
                    "Folder of a COLMAP model (cameras, images, points3D as .bin or .txt), for example sparse/0");
    verb.add_option("--images", fix.images, "Folder of the photographs");
    verb.add_option("--mesh", fix.mesh, "Mesh: PLY, OBJ, glTF (.glb, .gltf), STL or OFF");
    verb.add_option("--up", fix.up, "What is up in the files: x, y, z, -x, -y, -z or three numbers X,Y,Z");
    verb.add_option("--mesh-up", fix.meshUp,
                    "What is up in the mesh's file, if not what is up in the others (glTF: y)");
    verb.add_option("--scale", fix.scale, "Metres one unit of the files is long")->check(positive());
    verb.add_option("--mesh-scale", fix.meshScale, "Units of the cameras one unit of the mesh is long")
        ->check(positive());
    verb.add_option("--smooth-normals", fix.smoothNormals,
                    "Rounds of smoothing for the normals of a noisy mesh; unless given, a solve asks the photographs")
        ->check(CLI::Range(0, 100));
    verb.add_flag("--flip-cameras", fix.flipCameras, "Camera matrices have OpenCV's axes (Y down, looking along +Z)");
    verb.add_option(
            "--mirror", fix.mirror,
            "The cameras are a left-handed program's: reverses their axis x, y or z, in the world and in the camera")
        ->check(CLI::IsMember({"x", "y", "z"}));
    verb.add_option("--mesh-mirror", fix.meshMirror, "Reverses the mesh's axis x, y or z")
        ->check(CLI::IsMember({"x", "y", "z"}));
    verb.add_option_function<std::vector<std::string>>(
            "--proxy-light",
            [&fix](const std::vector<std::string>& lights) {
                try {
                    for (const std::string& light : lights) fix.proxies.push_back(proxyLightOf(light));
                } catch (const UsageError& error) { throw CLI::ValidationError(error.what()); }
            },
            "A light that the mesh does not hold: X,Y,Z or X,Y,Z,RADIUS in metres of relamp's world (Z up); its power "
            "is solved for. May be given more than once")
        ->allow_extra_args(false)
        ->take_all();
    verb.add_option_function<std::vector<std::string>>(
            "--state",
            [&fix](const std::vector<std::string>& states) {
                try {
                    for (const std::string& state : states) fix.states.push_back(statePatternOf(state));
                } catch (const Error& error) { throw CLI::ValidationError(error.what()); }
            },
            "NAME=PATTERN: photographs whose names match (* and ?, or a folder) were taken in the lighting state NAME, "
            "between which only lights were switched. May be given more than once")
        ->allow_extra_args(false)
        ->take_all();
    verb.add_option_function<std::vector<std::string>>(
            "--state-environment",
            [&fix](const std::vector<std::string>& states) {
                try {
                    for (const std::string& state : states) fix.environments.push_back(stateEnvironmentOf(state));
                } catch (const Error& error) { throw CLI::ValidationError(error.what()); }
            },
            "NAME=own: the lighting state NAME has an environment of its own, such as another time of day; NAME=none: "
            "no distant light at all; NAME=OTHER: that of state OTHER; NAME=shared. May be given more than once")
        ->allow_extra_args(false)
        ->take_all();
    verb.add_flag("--from-brackets", fix.fromBrackets, "Merge the frames' exposures even where HDR images are named");
}

/// What is to be estimated and how: the same options for `solve` and `plan`.
void addSolveOptions(CLI::App& verb, SolveArguments& solve) {
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
    verb.add_option(
            "--light-probe", solve.probes,
            "Latitude-longitude image of the light on the set (EXR, HDR): how it is turned and its exposure are "
            "found. May be given more than once")
        ->allow_extra_args(false)
        ->take_all();
    verb.add_option("--mirror-ball", solve.mirrorBalls,
                    "[FILE@]VIEW[:X,Y,RADIUS]: a mirror ball in a photograph taken with the camera of a view, or in "
                    "the view's own; about where it is, in pixels. May be given more than once")
        ->allow_extra_args(false)
        ->take_all();
    verb.add_option(
            "--grey", solve.grey,
            "VIEW:X,Y,RADIUS[=ALBEDO]: grey card or ball in a view, a disc of pixels on the mesh; its albedo is "
            "0.18 unless given. May be given more than once")
        ->allow_extra_args(false)
        ->take_all();
    verb.add_option("--chart", solve.charts,
                    "VIEW:X,Y,X,Y,X,Y,X,Y: a chart of 24 patches in a view: the middles of dark skin, bluish green, "
                    "black and white. May be given more than once")
        ->allow_extra_args(false)
        ->take_all();
    verb.add_option("--palette", solve.palette,
                    "How many materials of one colour each the scene has, where it has few; 0: nothing is said")
        ->check(CLI::Range(0, 64))
        ->capture_default_str();
    verb.add_option("--photometric", solve.photometric,
                    "Exposure, white balance and lens fall-off that differ between photographs: taken out where "
                    "they clearly do (auto), or off")
        ->check(CLI::IsMember({"auto", "off"}))
        ->capture_default_str();
    verb.add_option("--registration", solve.registration,
                    "Cameras and mesh that are off against each other: moved where photographs clearly agree better "
                    "so (auto), or off")
        ->check(CLI::IsMember({"auto", "off"}))
        ->capture_default_str();
    verb.add_option("--mesh-triangles", solve.meshTriangles,
                    "About how many triangles of the mesh the solve uses; 0 for all. Unless given, meshes above "
                    "300000 are solved on 150000; the shot has the whole mesh")
        ->check(notNegative());
    verb.add_option("--texture", solve.texture,
                    "Albedo per texel: auto (where photographs are finer than the mesh), off, or the side of the "
                    "texture in texels, 64 to 8192")
        ->capture_default_str();
    verb.add_option("--grid-side", solve.gridSide, "Side of the visibility grid (power of two)");
    verb.add_option("--threads", solve.threads, "Threads, 0 for all cores")->check(notNegative());
    verb.add_option("--seed", solve.seed, "Seed of every random choice")->check(notNegative())->capture_default_str();
    verb.add_flag("--find-light", solve.findLight,
                  "Look for a light that no photograph shows, by its shading and shadows");
    verb.add_flag("--everything", solve.everything, "Leave nothing out beforehand: every part of the model is fitted");
    addCaptureOptions(verb, solve.fix);
}

CLI::App* addEdit(CLI::App& app, CommandLine& line) {
    CLI::App* verb = app.add_subcommand("edit", "Open the window (starts relamp-editor)");
    verb->add_option("path", line.editPath, "Capture folder or saved shot");
    return verb;
}

CLI::App* addCheck(CLI::App& app, CommandLine& line) {
    CLI::App* verb =
        app.add_subcommand("check", "Import doctor: poses, coverage, exposure, clipped pixels, mesh defects");
    verb->add_option("capture", line.path, "Capture folder")->required();
    verb->add_flag("--json", line.json, "One JSON object");

    addCaptureOptions(*verb, line.fix);
    return verb;
}

CLI::App* addPlan(CLI::App& app, CommandLine& line) {
    CLI::App* verb = app.add_subcommand(
        "plan", "What a solve would do and what it would leave out, why, and what that takes and saves");
    addSolveOptions(*verb, line.solve);
    verb->add_flag("--json", line.json, "One JSON object");
    return verb;
}

CLI::App* addSolve(CLI::App& app, CommandLine& line) {
    CLI::App* verb = app.add_subcommand("solve", "Separate distant light, emitters and reflectance");
    addSolveOptions(*verb, line.solve);
    CLI::Option* capture = verb->get_option("capture")->required(false);
    verb->add_option("-o,--output", line.solve.output, "Shot folder, NAME.relamp; with --list the folder of the shots")
        ->required();
    verb->add_option("--list", line.solve.list,
                     "Solve the captures of a file, a line each: CAPTURE, or CAPTURE, a tab and the shot's name")
        ->excludes(capture);
    verb->add_option("--items", line.solve.items, "Only these of the list, from 1: 3 or 1-4,9");
    verb->add_flag("--skip-existing", line.solve.skipExisting, "Leave shots of the list that are there already");
    verb->add_option("--time-budget", line.solve.timeBudget, "Seconds after which the best answer so far is kept")
        ->check(notNegative());
    verb->add_option("--gauge", line.solve.gauge,
                     "What fixes the brightness scale: auto, white-patch=V,X,Y, emitter=ID:R,G,B, albedo=A")
        ->capture_default_str();
    verb->add_flag(
        "--resume", line.solve.resume,
        "Go on from the checkpoint that a killed or interrupted solve of the same capture left beside the shot");
    verb->add_flag("--accept-poor", line.solve.acceptPoor,
                   "End with 0 and not with 4 where the photographs are badly explained");
    verb->add_flag("--overwrite", line.solve.overwrite, "Replace an existing shot");
    return verb;
}

void addPlateOptions(CLI::App& verb, RenderArguments& a) {
    CLI::Option* plate =
        verb.add_option("--plate", a.plate, "Relight a plate that a moving camera took: plate.####.exr, or one image");
    CLI::Option* camera = verb.add_option(
        "--plate-camera", a.plateCamera,
        "Its tracked camera: .chan, .usda (FILE#NAME), transforms.json, or the folder of a COLMAP model");
    plate->needs(camera);
    camera->needs(plate);
    verb.add_option("--plate-camera-offset", a.plateOffset, "The track's frame N is the plate's N + this")
        ->check(CLI::Range(-1'000'000'000, 1'000'000'000))
        ->needs(plate);
    verb.add_option("--plate-lens", a.plateLens,
                    "Lens and distortion with the keys of transforms.json, not the track's")
        ->needs(plate);
    verb.add_option("--plate-rotation", a.plateRotation, "Rotation order of a .chan file")
        ->check(CLI::IsMember({"XYZ", "XZY", "YXZ", "YZX", "ZXY", "ZYX"}))
        ->capture_default_str()
        ->needs(plate);
    verb.add_option("--plate-curve", a.plateCurve,
                    "Transfer curve of the plate's values; auto: linear for floating point, sRGB for integers")
        ->check(CLI::IsMember({"auto", "linear", "srgb", "rec709", "gamma22", "gamma24"}))
        ->capture_default_str()
        ->needs(plate);
    verb.add_option(
            "--plate-match", a.plateMatch,
            "Gain and white balance against the capture: auto (a frame's own where they change), shot, frames, off")
        ->check(CLI::IsMember({"auto", "shot", "frames", "off"}))
        ->capture_default_str()
        ->needs(plate);
    verb.add_option("--plate-steady", a.plateSteady, "Frames before and after that steady a frame's light")
        ->check(CLI::Range(0, 16))
        ->capture_default_str();
    verb.add_option("--plate-unsure", a.plateUnsure,
                    "Where the model rests on little: what it says (model), the factor of surfaces around (smooth), or "
                    "the plate as it is (keep)")
        ->check(CLI::IsMember({"model", "smooth", "keep"}))
        ->capture_default_str();
    CLI::Option* matte =
        verb.add_option("--matte", a.matte, "What the capture does not hold is white: matte.####.exr")->needs(plate);
    verb.add_option("--matte-light", a.matteLight,
                    "What is held out stays (keep), or takes the light at its place (relight)")
        ->check(CLI::IsMember({"keep", "relight"}))
        ->capture_default_str()
        ->needs(matte);
}

CLI::App* addRender(CLI::App& app, CommandLine& line) {
    CLI::App* verb = app.add_subcommand("render", "Relit frames");
    verb->add_option("shot", line.render.shot, "Shot folder")->required();
    verb->add_option("-o,--output", line.render.output,
                     "Image (EXR, or PNG/JPEG for a look); with several frames a name with #### or %04d")
        ->required();
    verb->add_option("--edits", line.render.edits,
                     "Edits document (JSON) in place of the shot's own look; with `keys` it changes over the frames");
    verb->add_option("--env", line.render.environment, "A latitude-longitude file, none, or recovered");
    verb->add_option("--state", line.render.state,
                     "Lighting state of the photographs whose light frames have and edits start from; unless given, "
                     "that of the view, without --edits and edits in the shot");
    verb->add_option("--env-yaw", line.render.yaw, "Degrees about the vertical")->check(CLI::Range(-1e6, 1e6));
    verb->add_option("--camera", line.render.camera,
                     "A view's number, a camera file, all, turntable:N, or path:V,V,...:N (a spline through views)")
        ->default_str("0, or the plate of the look");
    verb->add_option("--frames", line.render.frames, "Of a sequence: 1-3,5,7-20:2");
    verb->add_option("--size", line.render.size, "WxH in place of the camera's own");
    verb->add_option("--layers", line.render.layers,
                     "all, or names: groups, albedo, correction, residual, normal, position, depth, cryptomatte, "
                     "confidence");
    verb->add_option("--naming", line.render.naming, "Light groups as Combined_GROUP (blender) or RGBA_GROUP (arnold)")
        ->check(CLI::IsMember({"blender", "arnold"}))
        ->capture_default_str();
    verb->add_flag("--multipart", line.render.multipart, "One part a layer");
    verb->add_option("--exr-compression", line.render.exrCompression,
                     "How EXR is packed; pxr24, dwaa and dwab lose a little")
        ->check(CLI::IsMember(std::vector<std::string>(std::begin(exrCompressions), std::end(exrCompressions))))
        ->capture_default_str();
    verb->add_option("--exr-depth", line.render.exrDepth, "Colours of EXR as half or float; data are always float")
        ->check(CLI::IsMember({"half", "float"}))
        ->capture_default_str();
    verb->add_option("--ratio", line.render.ratio,
                     "Relight the photograph itself: x new / old (quotient), or + new - old (difference)")
        ->expected(0, 1)
        ->default_str("quotient")
        ->check(CLI::IsMember({"quotient", "difference"}));
    verb->add_option("--view", line.render.view,
                     "What PNG and JPEG show: standard (sRGB), auto (exposed by itself), raw")
        ->check(CLI::IsMember({"standard", "auto", "raw"}))
        ->capture_default_str();
    verb->add_option("--samples", line.render.samples, "Samples a pixel")->check(positive());
    verb->add_option("--denoise", line.render.denoise, "Filter the light on matte surfaces; auto: not in ratio frames")
        ->check(CLI::IsMember({"auto", "on", "off"}))
        ->capture_default_str();
    verb->add_option("--threads", line.render.threads, "Threads, 0 for all cores")->check(notNegative());
    verb->add_option("--seed", line.render.seed, "Seed of the sampling")->check(notNegative())->capture_default_str();
    verb->add_flag("--skip-existing", line.render.skipExisting, "Leave frames that exist");
    addPlateOptions(*verb, line.render);
    return verb;
}

CLI::App* addExport(CLI::App& app, CommandLine& line) {
    CLI::App* verb = app.add_subcommand(
        "export", "The scene for other programs: lights as JSON, USD and glTF, environment, materials, cameras");
    verb->add_option("shot", line.exported.shot, "Shot folder")->required();
    verb->add_option("-o,--output", line.exported.output, "Folder for the files")->required();
    verb->add_option("--edits", line.exported.edits, "Edits document (JSON) in place of the shot's own look");
    verb->add_option("--state", line.exported.state,
                     "Lighting state of the photographs whose light is written, and edits start from; unless given, "
                     "lights as bright as they get");
    verb->add_option("--threads", line.exported.threads, "Threads, 0 for all cores")->check(notNegative());
    verb->add_flag("--overwrite", line.exported.overwrite, "Write into a folder that holds something");
    return verb;
}

CLI::App* addPaint(CLI::App& app, CommandLine& line) {
    CLI::App* verb = app.add_subcommand("paint", "Powers and colours of lights from an image of what they shall do");
    verb->add_option("shot", line.paint.shot, "Shot folder")->required();
    verb->add_option("--target", line.paint.target,
                     "Image of the wanted radiance (EXR, linear); where it is transparent anything may be")
        ->required();
    verb->add_option("--mask", line.paint.mask, "Image of how much each pixel counts: white all, black nothing");
    verb->add_option("--camera", line.paint.camera, "The target's camera: a view's number or a camera file")
        ->capture_default_str();
    verb->add_option("--edits", line.paint.edits,
                     "Edits document (JSON) to start from in place of the shot's own look");
    verb->add_option("--lights", line.paint.lights, "Ids or names of the lights that may change; else all that shine")
        ->delimiter(',')
        ->allow_extra_args(false);
    verb->add_flag("--environment", line.paint.environment, "The environment's exposure and tint may change too");
    verb->add_flag("--keep-colours", line.paint.keepColours, "Change powers alone");
    verb->add_option("--keep", line.paint.keep, "How much lights stay as they are")
        ->check(CLI::Range(1e-6, 1e3))
        ->capture_default_str();
    verb->add_option("-o,--output", line.paint.output, "Edits document to write; without it, standard output");
    verb->add_option("--threads", line.paint.threads, "Threads, 0 for all cores")->check(notNegative());
    verb->add_option("--seed", line.paint.seed, "Seed of the sampling")->check(notNegative())->capture_default_str();
    return verb;
}

CLI::App* addCompare(CLI::App& app, CommandLine& line) {
    CLI::App* verb =
        app.add_subcommand("compare", "Near-field against distant-only: figures and images in one HTML page");
    verb->add_option("capture", line.compare.capture, "Capture folder")->required();
    verb->add_option("-o,--output", line.compare.output, "Folder for the page")->required();
    verb->add_option("--quality", line.compare.quality, "draft, standard or fine")
        ->check(CLI::IsMember({"draft", "standard", "fine"}))
        ->capture_default_str();
    verb->add_option("--threads", line.compare.threads, "Threads, 0 for all cores")->check(notNegative());
    verb->add_option("--seed", line.compare.seed, "Seed of every random choice")
        ->check(notNegative())
        ->capture_default_str();

    addCaptureOptions(*verb, line.compare.fix);
    return verb;
}

CLI::App* addMerge(CLI::App& app, CommandLine& line) {
    CLI::App* verb = app.add_subcommand("merge-hdr", "Radiance from photographs of one view at several exposures");
    verb->add_option("images", line.merge.images, "Photographs, 8 or 16 bit, or camera raw")->required()->expected(-2);
    verb->add_option("-o,--output", line.merge.output, "Image, .exr or .hdr")->required();
    verb->add_option("--times", line.merge.times, "Exposure times in seconds, with commas, in place of EXIF's");
    verb->add_option("--response", line.merge.response, "Write the camera's response curve (JSON)");
    verb->add_option("--use-response", line.merge.useResponse,
                     "Use a curve written with --response, so that several sets get one scale");
    verb->add_option("--ghosts", line.merge.ghosts, "Write a mask: black where something moved between the exposures");
    verb->add_flag("--keep-ghosts", line.merge.keepGhosts, "Average all exposures, whether or not they agree");
    verb->add_flag("--no-align", line.merge.noAlign, "Do not shift hand-held exposures onto each other");
    verb->add_option("--smoothness", line.merge.smoothness, "Of the response curve")
        ->check(positive())
        ->capture_default_str();
    verb->add_option("--threads", line.merge.threads, "Threads, 0 for all cores")->check(notNegative());
    return verb;
}

CLI::App* addReport(CLI::App& app, CommandLine& line) {
    CLI::App* verb = app.add_subcommand(
        "report",
        "How a shot was solved: error against run time, per view, spectrum, what was left out; one HTML page");
    verb->add_option("shot", line.report.shot, "Shot folder")->required();
    verb->add_option("-o,--output", line.report.output, "HTML page; CSV and SVG files go beside it")->required();
    verb->add_option(
            "--against-distant", line.report.againstDistant,
            "Solve the capture with distant light only as well: auto (when it takes less than a minute), on, off")
        ->check(CLI::IsMember({"auto", "on", "off"}))
        ->capture_default_str();
    verb->add_option("--truth", line.report.truth, "Folder of known truth: vertices.ply, env.exr, relight.json");
    verb->add_option("--threads", line.report.threads, "Threads, 0 for all cores")->check(notNegative());
    return verb;
}

CLI::App* addScan(CLI::App& app, CommandLine& line) {
    CLI::App* verb = app.add_subcommand(
        "scan", "Photographs of projected Gray codes become a capture: mesh, cameras, the projector's place");
    verb->add_option("folder", line.scan.folder, "Folder with cameras.json and a folder of photographs for each camera")
        ->required();
    verb->add_option("-o,--output", line.scan.output, "Capture folder to write")->required();
    verb->add_option("--cameras", line.scan.cameras, "Calibration, in place of cameras.json in the folder");
    verb->add_option("--bits", line.scan.bits,
                     "Bits along the projector's columns and rows, as 10,9; else by the number of photographs");
    verb->add_option("--projector-size", line.scan.projector, "Its pixels, as 1024x768; else as many as the bits have");
    verb->add_option("--up", line.scan.up,
                     "What is up in the calibration: x, y, z, -x, -y, -z or X,Y,Z; else as the cameras were held");
    verb->add_option("--max-gap", line.scan.mostGap,
                     "Millimetres by which rays may miss each other; else four times their median")
        ->check(positive());
    verb->add_option("--triangles", line.scan.triangles, "About how many the mesh has at most")
        ->check(CLI::Range(size_t(1000), size_t(100'000'000)))
        ->capture_default_str();
    verb->add_option("--threads", line.scan.threads, "Threads, 0 for all cores")->check(notNegative());
    verb->add_flag("--overwrite", line.scan.overwrite, "Write into a folder that holds something");
    verb->add_flag("--json", line.scan.json, "One JSON object");
    return verb;
}

CLI::App* addStress(CLI::App& app, CommandLine& line) {
    CLI::App* verb = app.add_subcommand("stress", "Stiff and extreme variants: a stability table");
    verb->add_option("path", line.stress.path, "Capture or shot folder")->required();
    verb->add_option("--only", line.stress.only, "Only cases whose name holds this text");
    verb->add_flag("--json", line.stress.json, "One JSON object");
    verb->add_option("--threads", line.stress.threads, "Threads, 0 for all cores")->check(notNegative());
    return verb;
}

CLI::App* addInfo(CLI::App& app, CommandLine& line) {
    CLI::App* verb = app.add_subcommand("info", "What is in a shot or a capture");
    verb->add_option("path", line.path, "Shot or capture folder")->required();
    verb->add_flag("--json", line.json, "One JSON object");
    addCaptureOptions(*verb, line.fix);
    return verb;
}

}  // namespace

std::optional<CommandLine> parseCommandLine(int argc, char** argv, int& exitCode) {
    CLI::App app{"relamp: relight a captured scene. It separates what the lights did from what the surfaces are."};
    app.set_version_flag("--version", "relamp " RELAMP_VERSION);
    app.require_subcommand(1);
    CommandLine line;
    app.add_option("--progress", line.progressMode, "Progress on stderr")
        ->check(CLI::IsMember({"auto", "bar", "json", "none"}));
    app.add_flag("--quiet", line.quiet, "No log lines");
    app.fallthrough();
    const std::pair<CLI::App*, Verb> verbs[] = {
        {addEdit(app, line), Verb::edit},      {addCheck(app, line), Verb::check},
        {addPlan(app, line), Verb::plan},      {addSolve(app, line), Verb::solve},
        {addRender(app, line), Verb::render},  {addExport(app, line), Verb::exportShot},
        {addPaint(app, line), Verb::paint},    {addCompare(app, line), Verb::compare},
        {addMerge(app, line), Verb::mergeHdr}, {addReport(app, line), Verb::report},
        {addScan(app, line), Verb::scan},      {addStress(app, line), Verb::stress},
        {addInfo(app, line), Verb::info},
    };
    try {
        app.parse(argc, argv);
        for (const CLI::App* verb : app.get_subcommands()) refuseEmpty(*verb);
    } catch (const CLI::ParseError& error) {
        std::ostringstream out, wrong;
        exitCode = app.exit(error, out, wrong) == 0 ? 0 : 2;
        // The library says that a command is missing, not that it knows none of this name.
        if (const std::vector<std::string> rest = app.remaining();
            dynamic_cast<const CLI::RequiredError*>(&error) && app.get_subcommands().empty() && !rest.empty())
            wrong.str(fmt::format("There is no command {}.\nRun with --help for more information.\n", rest.front()));
        std::fputs(printable(wrong.str(), true).c_str(), stderr);
        if (exitCode == 0) printResult(out.str());
        return std::nullopt;
    }
    for (const auto& [verb, name] : verbs)
        if (*verb) line.verb = name;
    return line;
}

}  // namespace relamp::cli
