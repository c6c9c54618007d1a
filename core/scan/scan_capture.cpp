#include "scan/scan_capture.h"

#include <nlohmann/json.hpp>

#include "base/atomic_file.h"
#include "base/json_fields.h"
#include "base/printable.h"
#include "capture/orientation.h"
#include "capture/transforms_json.h"
#include "image/image_files.h"
#include "image/image_io.h"
#include "scene/mesh_io.h"

namespace relamp {
namespace {
namespace fs = std::filesystem;

std::string imageName(const ScanCamera& camera, const ScanPhotographs& photographs) {
    return camera.name + lowerExtension(photographs.files[0]);
}

Json jsonOf(const DVec3& v) { return Json::array({v.x, v.y, v.z}); }

/// A position of the calibration's axes in relamp's world.
DVec3 inWorld(const DVec3& position, const Vec3& up) { return glm::dmat3(rotationToZUp(up)) * position; }

/// As cameras.json has it, in metres.
Json calibrationJson(const Camera& c) {
    const glm::dmat3 axes(c.worldFromCamera);
    Json rotation = Json::array(), shift = Json::array();
    for (int r = 0; r < 3; ++r) {
        const DVec3 axis = r == 0 ? axes[r] : -axes[r];  // OpenGL's axes to OpenCV's
        rotation.push_back(jsonOf(axis));
        shift.push_back(-glm::dot(axis, c.position()));
    }
    return {{"width", c.width},
            {"height", c.height},
            {"K", {{c.focalX, 0, c.centreX - 0.5}, {0, c.focalY, c.centreY - 0.5}, {0, 0, 1}}},
            {"R", std::move(rotation)},
            {"t", std::move(shift)},
            {"distortion", c.distortion}};
}

const char* nameOf(ProjectorFrom from) {
    switch (from) {
        case ProjectorFrom::nowhere: return "none";
        case ProjectorFrom::calibration: return "calibration";
        case ProjectorFrom::resection: return "resection";
    }
    return "none";
}

Json cameraJson(const ScanResult& result, const ScanCameraFigures& camera) {
    Json absent = Json::array();
    for (size_t place : camera.lost.absent) absent.push_back(nameOfPlace(result.bits, place));
    return {{"name", camera.name},
            {"pixels", camera.pixels},
            {"lit", camera.lit},
            {"decoded", camera.decoded},
            {"coarse", camera.coarse},
            {"matched", camera.matched},
            {"points", camera.points},
            {"filled", camera.filled},
            {"coverage", double(camera.points) / double(std::max<size_t>(1, camera.lit))},
            {"median_gap", camera.medianGap},
            {"median_projector_gap", camera.projectorGap},
            {"noise", camera.noise},
            {"photograph_noise", camera.photographNoise},
            {"global_fraction", camera.global},
            {"codes_per_pixel", camera.slope},
            {"missing", std::move(absent)},
            {"code_exactness", camera.lost.exactness}};
}

Json projectorJson(const ScanResult& result, const Vec3& up) {
    Json projector{{"from", nameOf(result.projectorFrom)}, {"size", result.projectorSize}};
    if (!result.projector) return projector;
    const Camera& p = *result.projector;
    projector["position"] = jsonOf(inWorld(p.position(), up));
    projector["position_in_files"] = jsonOf(p.position());
    projector["calibration"] = calibrationJson(p);
    if (result.projectorFrom != ProjectorFrom::resection) return projector;
    const DVec3 sigma = inWorld(result.resection.positionSigma, up);
    projector["position_sigma"] = jsonOf(glm::abs(sigma));
    projector["median_error"] = result.resection.median;
    projector["rms_error"] = result.resection.rms;
    projector["points"] = result.resection.points;
    return projector;
}

}  // namespace

Vec3 scanUp(const ScanCalibration& calibration, const std::string& name) {
    if (!name.empty()) return withContext("--up", [&] { return axisFromName(name); });
    std::vector<Camera> cameras;
    for (const ScanCamera& camera : calibration.cameras) cameras.push_back(camera.camera);
    const Vec3 up(guessUp(cameras).value_or(DVec3(0, 0, 1)));
    for (int axis = 0; axis < 3; ++axis)
        if (std::abs(up[axis]) > 0.9f) {
            Vec3 whole(0);
            whole[axis] = up[axis] > 0 ? 1.0f : -1.0f;
            return whole;
        }
    return up;
}

InputFiles scanFiles(const fs::path& calibration, const std::vector<ScanPhotographs>& photographs) {
    InputFiles inputs;
    inputs.add(calibration);
    for (const ScanPhotographs& scan : photographs)
        for (const fs::path& file : scan.files) inputs.add(file);
    return inputs;
}

void refuseScanOutput(const fs::path& folder, const std::vector<ScanPhotographs>& photographs,
                      const ScanCalibration& calibration, bool overwrite, const InputFiles& inputs) {
    std::error_code failed;
    if (fs::exists(folder, failed) &&
        (!fs::is_directory(folder, failed) || (!overwrite && !fs::is_empty(folder, failed))))
        throw Error("{}: exists already, add --overwrite to write into it", folder.string());
    for (const char* name : {"transforms.json", "mesh.ply", "scan.json"}) inputs.refuse(folder / name);
    for (size_t c = 0; c < photographs.size(); ++c) {
        const std::string image = imageName(calibration.cameras[c], photographs[c]);
        inputs.refuse(folder / "images" / image);
        inputs.refuse(folder / "masks" / (image + ".png"));
    }
}

void writeScanCapture(const ScanResult& result, const ScanCalibration& calibration,
                      const std::vector<ScanPhotographs>& photographs, const fs::path& folder, const Vec3& up,
                      Progress& progress) {
    for (const char* part : {"images", "masks"}) {
        std::error_code failed;
        fs::create_directories(folder / part, failed);
        if (failed) throw Error("{}: cannot be made ({})", (folder / part).string(), failed.message());
    }
    Json frames = Json::array();
    for (size_t c = 0; c < photographs.size(); ++c) {
        const ScanCamera& camera = calibration.cameras[c];
        const std::string image = imageName(camera, photographs[c]);
        writeImage(folder / "masks" / (image + ".png"), coverageOf(result.mesh.mesh, camera.camera, progress));
        writeBytesAtomically(folder / "images" / image, readBytes(photographs[c].files[0]));
        frames.push_back(transformsFrame(camera.camera, "images/" + image));
    }
    writeVertexPly(folder / "mesh.ply", result.mesh.mesh, {});
    writeBytesAtomically(folder / "scan.json", dumpJson(scanJson(result, up), 1) + "\n");
    const Json document{{"up", nameFromAxis(up)}, {"mesh_path", "mesh.ply"}, {"frames", std::move(frames)}};
    writeBytesAtomically(folder / "transforms.json", dumpJson(document, 1) + "\n");
}

Json scanJson(const ScanResult& result, const Vec3& up) {
    Json cameras = Json::array();
    for (const ScanCameraFigures& camera : result.cameras) cameras.push_back(cameraJson(result, camera));
    return {{"bits", result.bits},
            {"cameras", std::move(cameras)},
            {"projector", projectorJson(result, up)},
            {"mesh",
             {{"vertices", result.mesh.mesh.vertexCount()},
              {"triangles", result.mesh.mesh.triangles.size()},
              {"pixel_step", result.mesh.step},
              {"dropped_pieces", result.mesh.droppedIslands}}},
            {"up", nameFromAxis(up)},
            {"notes", result.notes},
            {"seconds", result.seconds}};
}

std::string scanText(const ScanResult& result, const Vec3& up) {
    std::string text = fmt::format("{} and {} bits, projector of {} x {} pixels\n", result.bits[0], result.bits[1],
                                   result.projectorSize[0], result.projectorSize[1]);
    for (const ScanCameraFigures& c : result.cameras) {
        text += fmt::format("{}: {} pixels lit, {} with a code, {} with a place in space ({:.1f} % of the lit ones)\n",
                            c.name, c.lit, c.decoded, c.points, 100.0 * double(c.points) / double(c.lit));
        if (c.medianGap > 0)
            text += fmt::format("  {} matched in another camera, rays {:.3f} mm apart (median)\n", c.matched,
                                1000 * c.medianGap);
        if (c.projectorGap > 0)
            text += fmt::format("  rays of camera and projector {:.3f} mm apart (median)\n", 1000 * c.projectorGap);
        text += fmt::format("  distances known to {:.3f} mm before smoothing; indirect light {:.0f} % of white\n",
                            1000 * c.noise, 100 * double(c.global));
    }
    if (result.projector) {
        const DVec3 at = inWorld(result.projector->position(), up);
        text += fmt::format("projector at {:.4f}, {:.4f}, {:.4f} m (Z up)", at.x, at.y, at.z);
        if (result.projectorFrom == ProjectorFrom::resection) {
            const DVec3 sigma = glm::abs(inWorld(result.resection.positionSigma, up));
            text += fmt::format(
                " +- {:.1f}, {:.1f}, {:.1f} mm, from {} points that it hits to {:.2f} of its pixels "
                "(median)",
                1000 * sigma.x, 1000 * sigma.y, 1000 * sigma.z, result.resection.points, result.resection.median);
        }
        text += fmt::format("\n  as the light of a solve: --proxy-light {:.4f},{:.4f},{:.4f}\n", at.x, at.y, at.z);
    }
    text +=
        fmt::format("mesh: {} vertices, {} triangles, one vertex for {} x {} pixels\n", result.mesh.mesh.vertexCount(),
                    result.mesh.mesh.triangles.size(), result.mesh.step, result.mesh.step);
    for (const std::string& note : result.notes) text += "note: " + note + "\n";
    text += fmt::format("{:.1f} s\n", result.seconds);
    return text;
}

}  // namespace relamp
