#include "capture/load_capture.h"

#include "base/parallel.h"
#include "capture/photograph_reader.h"
#include "scene/mesh_io.h"
#include "scene/smooth_normals.h"

namespace relamp {
namespace {

/// Counted from `origin`, and with a hundredth of the mesh's diagonal for a radius of 0.
std::vector<ProxyLight> placedProxies(std::vector<ProxyLight> proxies, const Mesh& mesh, const DVec3& origin) {
    Vec3 low(1e30f), high(-1e30f);
    for (const Triangle& t : mesh.triangles)
        for (uint32_t v : t) {
            low = glm::min(low, mesh.positions[v]);
            high = glm::max(high, mesh.positions[v]);
        }
    for (ProxyLight& p : proxies) {
        p.centre -= origin;
        if (p.radius == 0) p.radius = 0.01f * glm::length(high - low);
    }
    return proxies;
}

}  // namespace

Capture loadCapture(const std::filesystem::path& folder, const LoadOptions& options, Progress& progress) {
    const CaptureFix& fix = options.fix;
    CaptureSource source = captureSource(folder, fix, progress);
    Capture capture;
    capture.folder = folder;
    capture.notes = std::move(source.notes);
    capture.format = source.format;
    capture.states = std::move(source.states);
    capture.environmentOfState = std::move(source.environmentOfState);
    capture.reconstruction = source.reconstruction;
    capture.points = std::move(source.points);
    capture.readAs.leftHanded = source.leftHanded;
    progress.begin("Reading the mesh", 1);
    std::vector<TexturedFace> texcoords;
    MeshPaint paint;
    capture.mesh = readMesh(source.mesh, &capture.meshReport, {}, &texcoords, &paint);
    if (!paint.empty()) capture.paint = std::make_shared<const MeshPaint>(std::move(paint));
    if (!fix.meshMirror.empty())
        mirrorMesh(withContext("--mesh-mirror", [&] { return mirrorAxis(fix.meshMirror); }), capture.mesh,
                   capture.meshReport, texcoords);
    if (!texcoords.empty()) capture.texcoords = std::make_shared<const std::vector<TexturedFace>>(std::move(texcoords));
    const Vec3 up = fix.up.empty() ? source.up : withContext("--up", [&] { return axisFromName(fix.up); });

    const PhotographReader photographs(std::move(source), folder, options, progress);
    capture.notes.insert(capture.notes.end(), photographs.notes().begin(), photographs.notes().end());
    const size_t count = photographs.count();
    capture.views.resize(count);
    std::vector<std::vector<std::string>> notes(count);
    const auto readView = [&](size_t i) {
        capture.views[i] =
            options.images ? photographs.read(i, notes[i], progress) : photographs.readCamera(i, notes[i]);
    };
    if (photographs.merges()) {
        for (size_t i = 0; i < count; ++i) readView(i);
    } else {
        progress.begin(options.images ? "Reading photographs" : "Reading cameras", count);
        parallelFor(count, 1, readView, &progress);
    }
    orientCapture(capture, up, fix);
    applyRegistration(fix.registration, capture);
    capture.proxies = placedProxies(fix.proxies, capture.mesh, capture.origin);
    applyMend(fix.mend, capture.mesh);
    if (fix.smoothNormals > 0) capture.mesh.normals = smoothedNormals(capture.mesh, fix.smoothNormals);
    addProxies(capture.proxies, capture.mesh);
    for (const auto& sentences : notes) capture.notes.insert(capture.notes.end(), sentences.begin(), sentences.end());
    return capture;
}

}  // namespace relamp
