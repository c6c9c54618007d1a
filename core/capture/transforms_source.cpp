// A capture whose cameras are in transforms.json: which images and which mesh it means.
#include "base/is_there.h"
#include "capture/capture_formats.h"
#include "image/image_io.h"

namespace relamp {
namespace fs = std::filesystem;
namespace {

fs::path findMesh(const fs::path& folder, const std::string& meshPath, const std::string& file) {
    if (!meshPath.empty()) {
        const fs::path mesh = folder / meshPath;
        if (isFile(mesh)) return mesh;
        throw Error("{}: mesh_path names {}, which {}", file, mesh.string(), whyNoFile(mesh));
    }
    const fs::path places[] = {folder};
    if (const auto mesh = findMeshIn(places)) return *mesh;
    throw Error("{}: mesh_path is missing, and {} holds no mesh.ply, .obj, .glb, .gltf, .stl or .off", file,
                folder.string());
}

}  // namespace

CaptureSource sourceFromTransforms(const fs::path& folder, const fs::path& file, const CaptureFix& fix, Progress&) {
    if (!isFile(file)) throw Error("{}: {}", file.string(), whyNoFile(file));
    const std::string name = file.filename().string();
    const auto images = [&](const std::string& filePath) {
        return findImage(fix.images.empty() ? folder : placeOf(folder, fix.images), filePath);
    };
    const int mirror = fix.mirror.empty() ? -1 : withContext("--mirror", [&] { return mirrorAxis(fix.mirror); });
    Transforms transforms = readTransforms(
        file, [&](const std::string& filePath) { return readImageSize(images(filePath)); }, mirror);
    CaptureSource source;
    source.where = name;
    source.notes = std::move(transforms.notes);
    source.up = transforms.up;
    source.leftHanded = transforms.leftHanded;
    source.environments = std::move(transforms.environments);
    source.mesh = fix.mesh.empty() ? findMesh(folder, transforms.meshPath, name) : placeOf(folder, fix.mesh);
    for (size_t i = 0; i < transforms.frames.size(); ++i) {
        TransformsFrame& frame = transforms.frames[i];
        const std::string& path = frame.filePath.empty() ? frame.exposures[0].filePath : frame.filePath;
        source.frames.push_back(
            {fmt::format("{}: frame {}", name, i), path, images(path), frame.camera, std::move(frame.exposures)});
        source.frames.back().state = std::move(frame.state);
        if (!frame.maskPath.empty()) source.frames.back().mask = images(frame.maskPath);
    }
    return source;
}

}  // namespace relamp
