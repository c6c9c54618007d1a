#include "capture/capture_source.h"

#include "base/is_there.h"
#include "capture/capture_formats.h"
#include "capture/lighting_states.h"

namespace relamp {
namespace fs = std::filesystem;

fs::path findImage(const fs::path& folder, const std::string& filePath) {
    fs::path plain = folder / filePath;
    if (isFile(plain)) return plain;
    std::string slashes = filePath;
    std::replace(slashes.begin(), slashes.end(), '\\', '/');
    for (const fs::path& base : {plain, folder / slashes}) {
        if (isFile(base)) return base;
        for (const char* ending : {".exr", ".hdr", ".png", ".jpg", ".jpeg", ".tif", ".tiff", ".EXR", ".HDR", ".PNG",
                                   ".JPG", ".JPEG", ".TIF", ".TIFF"})
            if (fs::path named = base.string() + ending; isFile(named)) return named;
    }
    return plain;
}

std::optional<fs::path> findMeshIn(std::span<const fs::path> places, std::span<const char* const> names) {
    constexpr const char* usual[] = {"mesh.ply", "mesh.obj", "mesh.glb", "mesh.gltf", "mesh.stl", "mesh.off"};
    for (const fs::path& place : places)
        for (const auto& list : {std::span<const char* const>(usual), names})
            for (const char* name : list)
                if (isFile(place / name)) return (place / name).lexically_normal();
    return std::nullopt;
}

Vec3 upOfCameras(const std::vector<Camera>& cameras) {
    const Vec3 up(guessUp(cameras).value_or(DVec3(0, 0, 1)));
    for (int c = 0; c < 3; ++c)
        if (std::abs(up[c]) > 0.9994f) {
            Vec3 axis(0);
            axis[c] = up[c] < 0 ? -1.0f : 1.0f;
            return axis;
        }
    return up;
}

fs::path placeOf(const fs::path& folder, const std::string& named) {
    std::error_code ignored;
    if (fs::path(named).is_absolute() || fs::exists(folder / named, ignored)) return folder / named;
    return fs::exists(named, ignored) ? fs::path(named) : folder / named;
}

CaptureSource captureSource(const fs::path& folder, const CaptureFix& fix, Progress& progress) {
    std::error_code ignored;
    if (!fs::is_directory(folder, ignored))
        throw Error("{}: {}", folder.string(), isThere(folder) ? "is not a folder" : whyNoFile(folder));
    std::optional<FoundCapture> found = findCapture(folder);
    for (const CaptureFormat& format : captureFormats())
        if (format.named && !(fix.*format.named).empty())
            found = FoundCapture{&format, placeOf(folder, fix.*format.named)};
    if (!found) {
        const fs::path usual = folder / "transforms.json";
        throw Error("{}: {}, and no other cameras are found; a capture has {}", usual.string(), whyNoFile(usual),
                    captureMarks());
    }
    progress.begin(found->format->reading, 1);
    CaptureSource source = found->format->read(folder, found->cameras, fix, progress);
    source.format = found->format->name;
    source.cameras = found->cameras;
    assignStates(fix.states, source);
    assignEnvironments(fix.environments, source);
    return source;
}

}  // namespace relamp
