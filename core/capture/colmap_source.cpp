// A capture whose cameras are a COLMAP model: its images, its mesh, and what is up in it.
#include "base/is_there.h"
#include "capture/capture_formats.h"
#include "capture/colmap.h"
#include "capture/colmap_brackets.h"

namespace relamp {
namespace fs = std::filesystem;
namespace {

/// The mesh of a COLMAP capture by the names its own tools give.
fs::path findColmapMesh(const fs::path& folder, const fs::path& model) {
    const fs::path places[] = {folder, folder / "dense", folder / "dense/0", model, model / "..", model / "../.."};
    constexpr const char* own[] = {"meshed-poisson.ply", "meshed-delaunay.ply"};
    if (const auto mesh = findMeshIn(places, own)) return *mesh;
    throw Error(
        "{}: holds no mesh (mesh.ply, mesh.obj, meshed-poisson.ply, dense/meshed-delaunay.ply ...), name it with "
        "--mesh",
        folder.string());
}

fs::path findColmapImages(const fs::path& folder, const fs::path& model, const std::string& first) {
    for (const fs::path& place :
         {folder / "images", folder, model / "images", model / "../images", model / "../../images"})
        if (isFile(place / first)) return place.lexically_normal();
    throw Error("{}: no folder with {} is found (images, ../images, ../../images), name it with --images",
                folder.string(), first);
}

}  // namespace

CaptureSource sourceFromColmap(const fs::path& folder, const fs::path& modelFolder, const CaptureFix& fix,
                               Progress& progress) {
    const ColmapModel model =
        withContext(modelFolder.string(), [&] { return readColmapModel(modelFolder, {}, progress); });
    CaptureSource source;
    source.where = modelFolder.string();
    source.mesh = fix.mesh.empty() ? findColmapMesh(folder, modelFolder) : placeOf(folder, fix.mesh);
    const fs::path images =
        fix.images.empty() ? findColmapImages(folder, modelFolder, model.views[0].name) : placeOf(folder, fix.images);
    std::vector<Camera> cameras;
    for (const ColmapView& view : model.views) cameras.push_back(view.camera);
    for (const ColmapBracket& b : colmapBrackets(images, model.views))
        source.frames.push_back(
            {b.view.name, b.view.name, findImage(images, b.view.name), b.view.camera, b.exposures, true});
    if (source.frames.size() < model.views.size())
        source.notes.push_back(
            fmt::format("{} images are exposures of views that the model holds already; of each view the pose of the "
                        "exposure nearest to +0 stops counts.",
                        model.views.size() - source.frames.size()));
    source.up = upOfCameras(cameras);
    source.notes.push_back(
        fmt::format("{}: {} cameras, {} images, {} points; reprojection error {:.3f} pixels (the model says {:.3f}).",
                    modelFolder.string(), model.cameras, model.views.size(), model.points.size(), model.errorPixels,
                    model.statedErrorPixels));
    if (fix.up.empty())
        source.notes.push_back(fmt::format(
            "COLMAP does not say what is up: {} is taken, from how the cameras were held; --up says otherwise.",
            nameFromAxis(source.up)));
    source.reconstruction = {model.points.size(), model.observations, model.errorPixels, model.statedErrorPixels,
                             model.behind};
    const size_t stride = std::max<size_t>(1, model.points.size() / 20000);
    for (size_t i = 0; i < model.points.size(); i += stride) source.points.emplace_back(model.points[i]);
    return source;
}

}  // namespace relamp
