#include "capture/capture_source.h"

#include "base/is_there.h"
#include "capture/capture_formats.h"

namespace relamp {
namespace fs = std::filesystem;

fs::path findImage(const fs::path& folder, const std::string& filePath) {
    fs::path plain = folder / filePath;
    if (isFile(plain)) return plain;
    std::string slashes = filePath;
    std::replace(slashes.begin(), slashes.end(), '\\', '/');
    for (const fs::path& base : {plain, folder / slashes}) {
        if (isFile(base)) return base;
        for (const char* ending : {".exr", ".hdr", ".png", ".jpg", ".jpeg", ".tif", ".tiff"})
            if (fs::path named = base.string() + ending; isFile(named)) return named;
    }
    return plain;
}

fs::path placeOf(const fs::path& folder, const std::string& named) {
    std::error_code ignored;
    if (fs::path(named).is_absolute() || fs::exists(folder / named, ignored)) return folder / named;
    return fs::exists(named, ignored) ? fs::path(named) : folder / named;
}

CaptureSource captureSource(const fs::path& folder, const CaptureFix& fix, Progress& progress) {
    std::error_code ignored;
    if (!fs::is_directory(folder, ignored)) throw Error("{}: is not a folder", folder.string());
    const auto formats = captureFormats();
    // Where nothing is found, the reader of the first format says what is missing.
    FoundCapture found{&formats.front(), folder / "transforms.json"};
    if (const auto here = findCapture(folder)) found = *here;
    for (const CaptureFormat& format : formats)
        if (format.named && !(fix.*format.named).empty()) found = {&format, placeOf(folder, fix.*format.named)};
    progress.begin(found.format->reading, 1);
    CaptureSource source = found.format->read(folder, found.cameras, fix, progress);
    source.cameras = found.cameras;
    return source;
}

}  // namespace relamp
