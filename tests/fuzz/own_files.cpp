// The readers of relamp's own files, which people edit by hand: looks, shots, works found after a crash; and brackets
// as numbers.
#include <nlohmann/json.hpp>

#include "capture/brackets.h"
#include "fuzz/target.h"
#include "image/image_io.h"
#include "relight/look_track.h"
#include "scene/mesh_io.h"
#include "shot/autosave.h"
#include "shot/shot_file.h"
#include "solve/solve_checkpoint.h"
#include "support/estimates.h"
#include "support/temporary_folder.h"

namespace relamp::fuzz {
namespace {

const Target look("look", [](std::string_view bytes) {
    const std::filesystem::path file = fileWith("look.json", bytes);
    const LookTrack track = readLookTrack(file);
    for (const int frame : {-3, 1, 7, 1000}) {
        const Look between = track.at(frame, {});
        if (!(lookFromJson(lookToJson(between), {}) == between))
            throw std::logic_error("a look that does not survive being written");
    }
});

/// A shot whose other files are good.
const std::filesystem::path& goodShot() {
    static const std::filesystem::path path = [] {
        const std::filesystem::path capture = folder() / "shot-capture";
        std::filesystem::create_directories(capture);
        const Mesh mesh = test::sheet({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, 1, 1);
        writeVertexPly(capture / "mesh.ply", mesh, {});
        writeImage(capture / "a.png", Image(8, 6, Rgb(0.5f)));
        fileWith(
            "shot-capture/transforms.json",
            R"({"w": 8, "h": 6, "fl_x": 8, "mesh_path": "mesh.ply", "frames": [{"file_path": "a.png", "transform_matrix": [[1,0,0,0],[0,1,0,0],[0,0,1,3],[0,0,0,1]]}]})");
        Progress progress;
        Shot shot;
        shot.captureFolder = capture;
        shot.estimate = test::matteEstimate(buildScene(mesh, progress), Rgb(0.5f), Rgb(1));
        shot.estimate.environmentSide =
            Estimate().environmentSide;  // the side that is kept beside the image, so that opening is quick
        shot.estimate.environment.assign(size_t(shot.estimate.environmentSide) * size_t(shot.estimate.environmentSide),
                                         Rgb(1));
        saveShot(shot, mesh, folder() / "good.relamp", true);
        return folder() / "good.relamp";
    }();
    return path;
}
const Target shotJson("shot-json", [](std::string_view bytes) {
    goodShot();
    fileWith("good.relamp/shot.json", bytes);
    Progress progress;
    const Shot shot = openShot(goodShot(), false, progress);
    shotInfo(shot);
});
const Target shotPly("shot-ply", [](std::string_view bytes) {
    static const std::string document = [] {
        goodShot();
        return test::TemporaryFolder::read(folder() / "good.relamp/shot.json");
    }();
    fileWith("good.relamp/shot.json", document);
    fileWith("good.relamp/reflectance.ply", bytes);
    Progress progress;
    openShot(goodShot(), false, progress);
});

const Target autosave("autosave", [](std::string_view bytes) {
    fileWith("autosave/work-1-0.autosave.json", bytes);
    Autosave own(folder() / "autosave");
    own.findLost();
});

/// What stands in a checkpoint behind its sum.
const Target checkpoint("checkpoint", [](std::string_view bytes) {
    const std::string again = checkpointBytes(checkpointFromBytes(std::string(bytes)));
    if (checkpointBytes(checkpointFromBytes(again)) != again)
        throw std::logic_error("a checkpoint that does not survive being written");
});

/// Codes and exposures as they come: two to five images of 12 x 12. The response is fitted for one input in eight,
/// because that takes most of the time.
const Target brackets("brackets", [](std::string_view bytes) {
    constexpr int side = 12;
    if (bytes.size() < 8) return;
    const size_t count = 2 + size_t(static_cast<unsigned char>(bytes[0])) % 4;
    std::vector<CodeImage> images(count);
    std::vector<double> exposures;
    size_t at = 1;
    const auto next = [&] { return static_cast<unsigned char>(bytes[at++ % bytes.size()]); };
    for (CodeImage& image : images) {
        image.width = image.height = side;
        image.codes.resize(side * side * 3);
        exposures.push_back(std::exp2((double(next()) - 128) / 8));
        for (uint16_t& code : image.codes) code = uint16_t(next() * 257);
    }
    BracketOptions options;
    Progress progress;
    const auto first = static_cast<unsigned char>(bytes[0]);
    const ResponseCurve response = first >= 32 ? linearResponse() : fitResponse(sampleBracket(images, exposures, 40));
    const MergedBracket merged = mergeCodes(images, exposures, response, options, progress);
    for (const Rgb& p : merged.image.pixels)
        if (!isFinite(p)) throw std::logic_error("a radiance that is no number");
});

}  // namespace
}  // namespace relamp::fuzz
