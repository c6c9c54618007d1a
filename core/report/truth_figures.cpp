#include "report/truth_figures.h"

#include <map>
#include <nlohmann/json.hpp>

#include "base/atomic_file.h"
#include "base/json_fields.h"
#include "base/statistics.h"
#include "capture/load_capture.h"
#include "display/display_image.h"
#include "image/environment_map.h"
#include "relight/frame.h"
#include "scene/mesh_io.h"
#include "shot/export_frame.h"

namespace relamp {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using Columns = std::map<std::string, std::vector<float>>;

Columns readColumns(const fs::path& file) {
    Columns columns;
    for (VertexProperty& p : readVertexPly(file)) columns[p.name] = std::move(p.values);
    return columns;
}

std::vector<Rgb> colours(const Columns& columns, const std::string& stem) {
    std::vector<Rgb> result;
    const auto r = columns.find(stem + "_r"), g = columns.find(stem + "_g"), b = columns.find(stem + "_b");
    if (r == columns.end() || g == columns.end() || b == columns.end()) return result;
    for (size_t v = 0; v < r->second.size(); ++v) result.emplace_back(r->second[v], g->second[v], b->second[v]);
    return result;
}

/// The emitters found for the emitters there are: true number -> id. Fills the figures of both.
std::map<int, std::string> matchEmitters(const Columns& truth, const std::vector<Rgb>& emission, const Shot& shot,
                                         const Scene& scene, TruthFigures& out) {
    std::map<int, std::string> matched;
    const auto ids = truth.find("emitter_id");
    if (ids == truth.end() || emission.empty()) return matched;
    std::map<int, std::vector<uint32_t>> vertices;
    size_t both = 0, either = 0;
    for (uint32_t v = 0; v < emission.size(); ++v) {
        const bool shines = ids->second[v] >= 0 && maxChannel(emission[v]) > 0,
                   mine = shot.estimate.emitters.emitterOfVertex[v] >= 0;
        if (shines) vertices[int(ids->second[v])].push_back(v);
        both += shines && mine;
        either += shines || mine;
    }
    std::vector<double> errors;
    for (const auto& [id, members] : vertices) {
        Vec3 centre(0);
        Rgb radiance(0);
        for (uint32_t v : members)
            centre += scene.mesh.positions[v] / float(members.size()), radiance += emission[v] / float(members.size());
        float nearest = 1e-3f;
        for (uint32_t v : members) nearest = std::max(nearest, glm::length(scene.mesh.positions[v] - centre));
        int match = -1;
        for (size_t e = 0; e < shot.estimate.emitters.emitters.size(); ++e)
            if (const float d = glm::length(shot.estimate.emitters.emitters[e].centroid - centre); d <= nearest)
                nearest = d, match = int(e);
        if (match < 0) continue;
        matched[id] = shot.estimate.emitters.emitters[size_t(match)].id;
        for (int c = 0; c < 3; ++c)
            if (radiance[c] > 0.02f * maxChannel(radiance))
                errors.push_back(
                    std::abs(double(shot.estimate.lighting.emitterRadiance[size_t(match)][c]) / radiance[c] - 1));
    }
    out.figures.push_back({"Lights",
                           fmt::format("{} of {} found, {} in all", matched.size(), vertices.size(),
                                       shot.estimate.emitters.emitters.size()),
                           "Matched by where they are."});
    if (either)
        out.figures.push_back({"Lights' outline", fmt::format("{:.3f}", double(both) / double(either)),
                               "Vertices taken for a light over those that are or were taken for one; 1 is exact."});
    if (!errors.empty())
        out.figures.push_back({"Lights' radiance", fmt::format("{:.2f} % off", 100 * medianOf(errors)),
                               "Median over lights and channels."});
    return matched;
}

void albedoFigures(const Columns& truth, const std::vector<Rgb>& emission, const Shot& shot, TruthFigures& out) {
    const std::vector<Rgb> albedo = colours(truth, "albedo");
    if (albedo.empty()) return;
    double ab = 0, aa = 0, squares = 0, angle = 0, count = 0;
    for (size_t v = 0; v < albedo.size(); ++v) {
        const DVec3 t(albedo[v]), found(shot.estimate.reflectance.at(v).albedo());
        if (std::min(t.x, std::min(t.y, t.z)) <= 0.02 || !shot.estimate.reflectance.observed[v] ||
            (!emission.empty() && maxChannel(emission[v]) > 0))
            continue;
        ab += glm::dot(t, found);
        aa += glm::dot(found, found);
        squares += glm::dot(t - found, t - found) / 3;
        angle += std::acos(
                     std::clamp(glm::dot(t, found) / std::max(glm::length(t) * glm::length(found), 1e-12), -1.0, 1.0)) *
                 180 / piD;
        ++count;
    }
    if (!(count > 0)) return;
    out.figures.push_back({"Surfaces' own colour",
                           fmt::format("{:.1f} dB", -10 * std::log10(std::max(squares / count, 1e-10))),
                           "PSNR of the albedo per vertex, raw."});
    out.figures.push_back({"Scale of the albedo", fmt::format("{:.3f}", ab / std::max(aa, 1e-20)),
                           "What it would have to be multiplied with; 1 is exact."});
    out.figures.push_back(
        {"Tint", fmt::format("{:.1f}\u00b0", angle / count), "Mean angle between the colour found and the true one."});
}

void environmentFigure(const fs::path& file, const Shot& shot, TruthFigures& out) {
    if (!fs::exists(file)) return;
    const DirectionGrid coarse{32};
    const std::vector<Rgb> truth = integrateOverCells(readEnvironment(file), coarse);
    const int step = shot.estimate.environmentSide / coarse.side;
    std::vector<DVec3> found(truth.size(), DVec3(0));
    for (int c = 0; c < shot.estimate.environmentSide * shot.estimate.environmentSide; ++c)
        found[size_t(c / shot.estimate.environmentSide / step * coarse.side +
                     c % shot.estimate.environmentSide / step)] +=
            DVec3(shot.estimate.environment[size_t(c)]) / double(step * step);
    double difference = 0, norm = 0;
    for (size_t c = 0; c < truth.size(); ++c)
        difference += glm::dot(found[c] - DVec3(truth[c]), found[c] - DVec3(truth[c])),
            norm += glm::dot(DVec3(truth[c]), DVec3(truth[c]));
    if (norm > 0)
        out.figures.push_back({"Environment", fmt::format("{:.2f}", std::sqrt(difference / norm)),
                               "Relative error over 32 x 32 directions, raw; a few bright spots rule it."});
}

Look lookOf(const json& entry, const std::map<int, std::string>& emitters, const fs::path& folder) {
    json document{{"version", 1}, {"emitters", json::array()}};
    const std::string environment = entry.value("env", "unchanged");
    if (environment == "none") document["environment"] = {{"source", "none"}};
    else if (environment != "unchanged")
        document["environment"] = {
            {"source", "file"},
            {"file",
             (fs::exists(folder / environment) ? folder / environment : folder.parent_path() / environment).string()}};
    for (const json& edit : entry.value("edits", json::array())) {
        const auto id = emitters.find(edit.at("emitter_id").get<int>());
        if (id == emitters.end()) continue;
        json e{{"id", id->second}};
        for (const char* key : {"matrix", "power_scale"})
            if (edit.contains(key)) e[key] = edit[key];
        document["emitters"].push_back(e);
    }
    return lookFromJson(document, folder);
}

/// The entry's camera: a view's number, or an object as `render --camera FILE` takes it.
Camera cameraOf(const json& entry, const Shot& shot) {
    const json& camera = entry.at("camera");
    if (camera.is_number_integer() && camera.get<int>() >= 0 && camera.get<size_t>() < shot.capture.views.size())
        return shot.capture.views[camera.get<size_t>()].camera;
    if (!camera.is_object()) throw Error("camera: {} is no view", dumpJson(camera));
    const fs::path file =
        fs::temp_directory_path() / fmt::format("relamp-camera-{}.json", std::hash<std::string>{}(dumpJson(camera)));
    writeBytesAtomically(file, dumpJson(camera));
    Camera read = readCameraFile(file);
    read.worldFromCamera[3] -= glm::dvec4(shot.capture.origin, 0);
    fs::remove(file);
    return read;
}

void editFigures(const fs::path& folder, const Shot& shot, const Scene& scene,
                 const std::map<int, std::string>& emitters, TruthFigures& out, Progress& progress) {
    const fs::path file = folder / "relight.json";
    if (!fs::exists(file)) return;
    json entries = parseJson(readBytes(file), file.string());
    if (entries.is_object()) entries = entries.at("entries");
    double sum = 0;
    size_t counted = 0;
    for (const json& entry : entries) {
        const std::string name = entry.value("name", ""), image = entry.at("image").get<std::string>();
        Image truth = readImage(fs::exists(folder / image) ? folder / image : folder.parent_path() / image);
        const fs::path maskFile = folder / "masks" / (fs::path(image).stem().string() + ".png");
        std::vector<uint8_t> mask(truth.pixels.size(), 1);
        if (fs::exists(maskFile)) {
            const Image m = readImage(maskFile, nullptr, true);
            for (size_t i = 0; i < std::min(mask.size(), m.pixels.size()); ++i) mask[i] = m.pixels[i].x > 0.5f;
        }
        FrameOptions options;
        options.samplesPerPixel = 4;
        options.denoise = true;
        Camera camera = smallerCamera(cameraOf(entry, shot), std::max(truth.width, truth.height));
        if (camera.width != truth.width || camera.height != truth.height) continue;
        const Frame frame = renderFrame(applyLook(scene, shot.estimate, lookOf(entry, emitters, folder), progress),
                                        camera, options, progress);
        Image relit(frame.width, frame.height);
        relit.pixels = frame.beauty;
        truth.usable = mask;
        const double psnr = displayError(relit, truth, mask, exposureFor(truth, 99.5f)).psnr();
        out.edits.push_back({name, entry.value("about", ""), psnr});
        const bool changes =
            !entry.value("edits", json::array()).empty() || entry.value("env", "unchanged") != "unchanged";
        if (changes) sum += psnr, ++counted;
    }
    if (counted) out.meanPsnr = sum / double(counted);
}

}  // namespace

TruthFigures truthFigures(const fs::path& folder, const Shot& shot, const Scene& scene, Progress& progress) {
    TruthFigures out;
    const fs::path vertices = folder / "vertices.ply";
    if (!fs::exists(vertices) && !fs::exists(folder / "relight.json") && !fs::exists(folder / "env.exr"))
        throw Error("{}: holds no truth, expected vertices.ply, env.exr or relight.json", folder.string());
    try {
        std::map<int, std::string> emitters;
        if (fs::exists(vertices)) {
            const Columns truth = readColumns(vertices);
            const std::vector<Rgb> emission = colours(truth, "emission");
            const auto x = truth.find("x");
            if (x == truth.end() || x->second.size() != scene.mesh.vertexCount())
                throw Error("{}: has {} vertices, expected the capture's {}", vertices.string(),
                            x == truth.end() ? 0 : x->second.size(), scene.mesh.vertexCount());
            emitters = matchEmitters(truth, emission, shot, scene, out);
            albedoFigures(truth, emission, shot, out);
        }
        environmentFigure(folder / "env.exr", shot, out);
        editFigures(folder, shot, scene, emitters, out, progress);
    } catch (const json::exception& error) {
        throw Error("{}: a field is missing or has the wrong kind ({})", (folder / "relight.json").string(),
                    error.what());
    }
    return out;
}

}  // namespace relamp
