// Reprojection differences between two captures of one scene whose cameras are in different files (doors.py).
//
//     doors SOURCE OTHER
//     doors --formats        the names of all formats
//
// Vertices of the mesh are projected through the cameras of both; views are matched by the numbers of their names.
// Prints JSON: the format, views, and how far pixels lie apart, in the mean and at most.
#include <cstdio>
#include <map>
#include <nlohmann/json.hpp>

#include "capture/capture_formats.h"
#include "capture/load_capture.h"

namespace {

using namespace relamp;

Capture withoutImages(const char* folder, Progress& progress) {
    LoadOptions options;
    options.images = false;
    return loadCapture(folder, options, progress);
}

/// What a view is known by: the number at the end of its name where it has one, however it is written.
std::string keyOf(const View& view) {
    const std::string stem = std::filesystem::path(view.name).stem().string();
    const size_t last = stem.find_last_not_of("0123456789");
    const std::string digits = last == std::string::npos ? stem : stem.substr(last + 1);
    if (digits.empty()) return stem;
    const size_t first = std::min(digits.find_first_not_of('0'), digits.size() - 1);
    return digits.substr(first);
}

}  // namespace

int main(int argc, char** argv) try {
    if (argc == 2 && argv[1] == std::string("--formats")) {
        for (const CaptureFormat& format : captureFormats()) std::printf("%s\n", format.name);
        return 0;
    }
    if (argc != 3) return std::fprintf(stderr, "doors SOURCE OTHER, or doors --formats\n"), 2;
    Progress progress;
    const Capture source = withoutImages(argv[1], progress), other = withoutImages(argv[2], progress);
    std::map<std::string, const Camera*> cameras;
    for (const View& view : source.views) cameras[keyOf(view)] = &view.camera;
    const size_t vertices = std::min(source.mesh.vertexCount(), other.mesh.vertexCount()),
                 step = std::max<size_t>(1, vertices / 5000);
    size_t matched = 0, pixels = 0, lost = 0;
    double sum = 0, worst = 0;
    for (const View& view : other.views) {
        const auto at = cameras.find(keyOf(view));
        if (at == cameras.end()) continue;
        ++matched;
        for (size_t v = 0; v < vertices; v += step) {
            const auto wanted = at->second->projectByFormula(DVec3(source.mesh.positions[v]));
            if (!wanted || wanted->x < 0 || wanted->y < 0 || wanted->x > at->second->width ||
                wanted->y > at->second->height)
                continue;
            const auto found = view.camera.projectByFormula(DVec3(other.mesh.positions[v]));
            if (!found) {
                ++lost;
                continue;
            }
            const double off = glm::distance(*wanted, *found);
            sum += off, worst = std::max(worst, off), ++pixels;
        }
    }
    const nlohmann::json result{{"format", other.format},
                                {"views", matched},
                                {"of", source.views.size()},
                                {"mean", pixels ? sum / double(pixels) : -1.0},
                                {"worst", worst},
                                {"lost", lost},
                                {"notes", other.notes}};
    std::printf("%s\n", result.dump().c_str());
    return 0;
} catch (const std::exception& error) {
    std::fprintf(stderr, "doors: %s\n", error.what());
    return 3;
}
