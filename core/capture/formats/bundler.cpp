// Bundler's bundle.out (v0.3 and v0.4) with its list of photographs, which RealityCapture, COLMAP and others write too.
//
// From Bundler's manual: P = R X + t, p = -P / P.z, p' = f (1 + k1 |p|^2 + k2 |p|^4) p, with the origin in the middle
// of the image, y up, the camera looking along -z. The size of the image stands nowhere: it is the photograph's.
#include "base/atomic_file.h"
#include "base/is_there.h"
#include "base/text_scanner.h"
#include "capture/formats/readers.h"

namespace relamp {
namespace fs = std::filesystem;
namespace {

bool isBundlerHead(std::string_view head) { return head.starts_with("# Bundle file v0."); }

/// STEM.list.txt (COLMAP), FILE.list.txt, list.txt, list.txt one folder up (Bundler itself).
fs::path listOf(const fs::path& file) {
    const fs::path folder = file.parent_path();
    std::string stem = file.stem().string();
    if (stem.ends_with(".bundle")) stem.resize(stem.size() - 7);
    for (const fs::path& list : {folder / (stem + ".list.txt"), folder / (file.filename().string() + ".list.txt"),
                                 folder / "list.txt", folder / "../list.txt"})
        if (isFile(list)) return list;
    throw Error("list.txt with the photographs' names is not there");
}

/// The first word of each line: "path [0 focal length]". Names with spaces run up to the end or to " 0 ".
std::vector<std::string> namesFrom(const std::string& text) {
    std::vector<std::string> names;
    TextScanner scanner(text);
    while (!scanner.atEnd()) {
        std::string_view line = scanner.line();
        const size_t focal = line.rfind(" 0 ");
        if (focal != line.npos && TextScanner::number(line.substr(focal + 3))) line = line.substr(0, focal);
        while (!line.empty() && TextScanner::isSpace(line.back())) line.remove_suffix(1);
        if (!line.empty()) names.emplace_back(line);
        if (names.size() > foreignViews) throw Error("has more than {} lines", foreignViews);
    }
    return names;
}

ForeignCameras parseBundler(const fs::path& file, const ForeignFolder& around, Progress& progress) {
    const fs::path list = listOf(file);
    const auto names =
        withContext(list.filename().string(), [&] { return namesFrom(readBytes(list, foreignFileBytes)); });
    const std::string text = readBytes(file, size_t(2) << 30);
    TextScanner scanner(text);
    scanner.line();  // "# Bundle file v0.3"
    const auto next = [&](const char* field) { return numberFrom(scanner.word(), field); };
    const double count = next("number of cameras");
    next("number of points");
    if (!(count >= 0 && count <= double(foreignViews)) || count != std::floor(count))
        throw Error("number of cameras is {}, expected at most {}", count, foreignViews);
    if (count != double(names.size()))
        throw Error("holds {:.0f} cameras, and {} names {} photographs", count, list.filename().string(), names.size());
    ForeignCameras result;
    result.otherFiles = {list};
    size_t withoutPose = 0;
    for (const std::string& name : names)
        withContext(name.substr(0, 200), [&] {
            progress.check();
            const double f = next("f"), k1 = next("k1"), k2 = next("k2");
            glm::dmat3 axes;  // rows of camera-from-world are the camera's axes, OpenGL's already
            for (int row = 0; row < 3; ++row)
                for (int c = 0; c < 3; ++c) axes[row][c] = next("R");
            const double tx = next("t"), ty = next("t"), tz = next("t");
            if (f == 0) return void(++withoutPose);
            ForeignView view{name, {}};
            Camera& camera = view.camera;
            camera.worldFromCamera = poseFromOpenGl(axes, -(axes[0] * tx + axes[1] * ty + axes[2] * tz), "R");
            const auto [width, height] = around.sizeOf(name);
            setSize(camera, width, height);
            camera.focalX = camera.focalY = f;
            camera.centreX = 0.5 * width, camera.centreY = 0.5 * height;
            setLens(camera, {.k1 = k1, .k2 = k2});
            checkIntrinsics(camera, {"f", "f", "the middle's x", "the middle's y"});
            result.views.push_back(std::move(view));
        });
    noteLeftOut(result.notes, withoutPose, names.size(), "have no pose");
    return result;
}

std::optional<fs::path> findBundler(const fs::path& folder) {
    constexpr const char* names[] = {"bundle.out", "bundle/bundle.out", "bundle.rd.out"};
    return findByHead(folder, names, ".out", isBundlerHead);
}

bool ownsBundler(const std::string& name) { return name.ends_with(".out"); }

}  // namespace

const ForeignReader bundlerReader{findBundler, ownsBundler, parseBundler};

}  // namespace relamp
