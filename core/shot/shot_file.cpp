#include "shot/shot_file.h"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstring>
#include <nlohmann/json.hpp>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/is_there.h"
#include "base/log.h"
#include "capture/load_capture.h"
#include "capture/photograph_reader.h"
#include "image/environment_map.h"
#include "image/image_io.h"
#include "scene/mesh_io.h"
#include "shot/background_file.h"
#include "shot/shot_document.h"
#include "shot/shot_leftovers.h"
#include "shot/shot_reflectance.h"
#include "shot/shot_texture.h"

namespace relamp {
namespace fs = std::filesystem;

double peakMib() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return double(usage.ru_maxrss) / 1024;
}

namespace {

/// Puts the new folder in the old one's place in one step; afterwards `fresh` is what was there before.
void exchange(const fs::path& fresh, const fs::path& target) {
    if (::renameat2(AT_FDCWD, fresh.c_str(), AT_FDCWD, target.c_str(), RENAME_EXCHANGE) == 0) return;
    const fs::path aside = fresh.string() + ".old";
    fs::rename(target, aside);
    std::error_code failed;
    fs::rename(fresh, target, failed);
    if (failed) {
        fs::rename(aside, target);
        throw fs::filesystem_error("rename", target, failed);
    }
    fs::rename(aside, fresh);
}

void writeColours(const fs::path& file, int width, int height, const std::vector<Rgb>& values) {
    std::vector<Channel> channels(3);
    const char* names[] = {"R", "G", "B"};
    for (int c = 0; c < 3; ++c) {
        channels[size_t(c)].name = names[c];
        channels[size_t(c)].half = false;  // a sun exceeds what half floats hold
        for (const Rgb& p : values) channels[size_t(c)].values.push_back(p[c]);
    }
    writeChannels(file, width, height, channels);
}

/// `stem`: of the file's name.
void writeEnvironment(const fs::path& folder, const std::string& stem, int side, const std::vector<Rgb>& cells,
                      const std::vector<Rgb>& sigma) {
    const DirectionGrid grid{side};
    const Image map = latLongFromCells(cells, grid, 1024);
    writeColours(folder / (stem + ".exr"), map.width, map.height, map.pixels);
    // The cells themselves, so that opening need not integrate the image again.
    fs::create_directories(folder / "cache");
    writeColours(folder / "cache" / (stem + "_cells.exr"), grid.side, grid.side, cells);
    if (sigma.empty()) return;
    const Image deviations = latLongFromCells(sigma, grid, 256);
    writeColours(folder / (stem + "_sigma.exr"), deviations.width, deviations.height, deviations.pixels);
}

void writeBackground(const fs::path& folder, const std::string& stem, const Panorama* background) {
    if (!background) return;
    writeBackgroundFile(folder / (stem + "_background.exr"), background->width(),
                        [&](int x, int y) { return background->at(x, y); });
}

void writeEnvironments(const Estimate& e, const fs::path& folder) {
    writeEnvironment(folder, environmentStem(0), e.environmentSide, e.environment, e.environmentSigma);
    writeBackground(folder, environmentStem(0), e.background.get());
    for (size_t k = 0; k < e.otherEnvironments.size(); ++k) {
        const std::string stem = environmentStem(int(k) + 1);
        const StateLight& other = e.otherEnvironments[k];
        writeEnvironment(folder, stem, e.environmentSide, other.environment, other.sigma);
        writeBackground(folder, stem, other.background.get());
    }
}

/// Keys of the old shot.json that relamp does not write.
void keepUnknownKeys(const fs::path& file, Json& document) {
    Json old;
    try {
        old = parseJson(readBytes(file));
    } catch (const Error&) { return; }
    if (!old.is_object()) return;
    upgradeShotDocument(old);
    for (const auto& [key, value] : old.items())
        if (!document.contains(key)) document[key] = value;
}

/// Moves what relamp did not write from the old shot to the new one. What cannot move is left there rather than lost.
void moveUnknownFiles(const fs::path& old, const fs::path& target) {
    bool left = false;
    std::error_code failed;
    for (fs::directory_iterator entry(old, failed), end; !failed && entry != end; entry.increment(failed)) {
        const std::string name = entry->path().filename().string();
        if (isPartOfShot(name)) continue;
        std::error_code kept;
        fs::rename(entry->path(), target / name, kept);
        left |= bool(kept);
    }
    if (left || failed) logWarning("{}: some files of the old shot are left in {}", target.string(), old.string());
    else fs::remove_all(old, failed);
}

}  // namespace

namespace {

/// Throws Error when a folder is there that saveShot may not replace.
void refuseForeign(const fs::path& target, const fs::path& named) {
    std::error_code failed;
    if (!fs::exists(target, failed)) return;
    if (!fs::is_directory(target, failed) ||
        (!fs::exists(target / "shot.json", failed) && !fs::is_empty(target, failed)))
        throw Error("{}: is not a shot, so it is not overwritten", named.string());
}

}  // namespace

void saveShot(const Shot& shot, const Mesh& mesh, const fs::path& folder, bool overwrite) {
    std::error_code failed;
    const fs::path target = folderPlace(folder);
    mendShot(target);
    const bool exists = fs::exists(target, failed);
    if (exists && !overwrite) throw Error("{}: exists already, add --overwrite to replace it", folder.string());
    refuseForeign(target, folder);
    const fs::path fresh = target.parent_path() / fmt::format(".{}.{}", target.filename().string(), ::getpid());
    fs::create_directories(fresh, failed);
    if (failed) throw Error("{}: cannot be made ({})", folder.string(), failed.message());
    const FolderHold holdFresh(fresh), holdOld(target);
    try {
        Json document = shotDocument(shot, target);
        if (exists && isThere(target / "shot.json")) keepUnknownKeys(target / "shot.json", document);
        writeEnvironments(shot.estimate, fresh);
        writeReflectance(shot, mesh, fresh);
        if (const auto& texture = shot.estimate.reflectance.texture) {
            writeTexture(*texture, fresh / "albedo.exr");
            if (!texture->confidence.empty()) writeTextureConfidence(*texture, fresh / "albedo_confidence.exr");
        }
        writeBytesAtomically(fresh / "shot.json", dumpJson(document, 1) + "\n");
        if (!exists) {
            fs::rename(fresh, target);
            flushFolder(target.parent_path());
            return;
        }
        exchange(fresh, target);
        flushFolder(target.parent_path());
    } catch (const fs::filesystem_error& error) {
        fs::remove_all(fresh, failed);
        throw Error("{}: cannot be written ({})", folder.string(), error.code().message());
    } catch (...) {
        fs::remove_all(fresh, failed);
        throw;
    }
    moveUnknownFiles(fresh, target);  // `fresh` is now the old shot
}

void checkShotCanBeWritten(const fs::path& folder, const InputFiles& inputs) {
    std::error_code failed;
    fs::path place = folderPlace(folder);
    refuseForeign(place, folder);
    for (const std::string& part : shotParts()) inputs.refuse(place / part);
    do place = place.parent_path();
    while (!fs::exists(place, failed) && place.has_relative_path());
    if (::access(place.c_str(), W_OK | X_OK) != 0)
        throw Error("{}: cannot be written ({}: {})", folder.string(), place.string(), std::strerror(errno));
}

namespace {

struct EnvironmentOfFile {
    std::vector<Rgb> cells;
    bool painted = false;  ///< the image says something else than the cells that were written with it
};

bool differ(const std::vector<Rgb>& cells, const std::vector<Rgb>& kept) {
    constexpr float tolerance = 0.05f;  // the image has texels of another shape
    DVec3 sum(0);
    for (const Rgb& c : kept) sum += DVec3(c);
    const float mean = maxChannel(Rgb(sum / double(kept.size())));
    double apart = 0;
    for (size_t c = 0; c < cells.size(); ++c) apart += double(maxChannel(glm::abs(cells[c] - kept[c])));
    return apart > double(tolerance * mean) * double(cells.size());
}

/// From the cache when it is whole and not older than the image, which an artist may have painted over.
EnvironmentOfFile readEnvironmentOf(const fs::path& folder, const std::string& stem, const DirectionGrid& grid) {
    const fs::path image = folder / (stem + ".exr"), cache = folder / "cache" / (stem + "_cells.exr");
    std::error_code failed, missing;
    const auto made = fs::last_write_time(cache, missing), painted = fs::last_write_time(image, failed);
    std::vector<Rgb> kept;
    if (!missing && !failed) try {
            Image cells = readImage(cache);
            if (cells.width == grid.side && cells.height == grid.side) kept = std::move(cells.pixels);
        } catch (const Error&) {
            // A damaged cache is no loss.
        }
    if (!kept.empty() && made >= painted) return {std::move(kept)};
    EnvironmentOfFile read{integrateOverCells(readEnvironment(image), grid)};
    read.painted = !kept.empty() && differ(read.cells, kept);
    return read;
}

/// Empty where none was kept.
std::vector<Rgb> deviationCells(const fs::path& folder, const std::string& stem, const DirectionGrid& grid) {
    const fs::path image = folder / (stem + "_sigma.exr");
    std::error_code unreadable;
    return fs::exists(image, unreadable) ? integrateOverCells(readEnvironment(image), grid) : std::vector<Rgb>{};
}

/// Null where none was kept, and beside an environment that was painted over and is newer.
std::shared_ptr<const Panorama> backgroundOf(const fs::path& folder, const std::string& stem, bool painted) {
    const fs::path image = folder / (stem + "_background.exr");
    if (!isThere(image)) return nullptr;
    std::error_code failed;
    if (painted && fs::last_write_time(folder / (stem + ".exr"), failed) > fs::last_write_time(image, failed))
        return nullptr;
    return std::make_shared<const Panorama>(readEnvironment(image));
}

/// Vertices of a fitted ball belong to the emitter that has its centre.
void nameBalls(const Capture& capture, const EmitterClusters& clusters, std::vector<float>& emitter) {
    const size_t first = capture.mesh.vertexCount() - capture.proxies.size() * proxyVertices;
    for (size_t i = 0; i < capture.proxies.size(); ++i) {
        const ProxyLight& ball = capture.proxies[i];
        if (!ball.observed()) continue;
        for (size_t e = 0; e < clusters.emitters.size(); ++e)
            if (glm::length(Vec3(ball.centre) - clusters.emitters[e].centroid) < 0.5f * ball.radius)
                std::fill_n(emitter.begin() + std::ptrdiff_t(first + i * proxyVertices), proxyVertices, float(e));
    }
}

/// Which vertices and triangles belong to which emitter.
void assignEmitters(const std::vector<float>& emitter, const Mesh& mesh, EmitterClusters& clusters) {
    clusters.emitterOfVertex.assign(emitter.size(), -1);
    for (size_t v = 0; v < emitter.size(); ++v) {
        const int i = int(std::clamp(emitter[v], -1.0f, 1e6f));
        if (i < 0 || size_t(i) >= clusters.emitters.size()) continue;
        clusters.emitterOfVertex[v] = i;
        clusters.emitters[size_t(i)].vertices.push_back(uint32_t(v));
    }
    clusters.emitterOfTriangle.assign(mesh.triangles.size(), -1);
    for (uint32_t t = 0; t < clusters.emitterOfTriangle.size(); ++t) {
        const Triangle& k = mesh.triangles[t];
        const int i = clusters.emitterOfVertex[k[0]];
        if (i < 0 || clusters.emitterOfVertex[k[1]] != i || clusters.emitterOfVertex[k[2]] != i) continue;
        clusters.emitterOfTriangle[t] = i;
        clusters.emitters[size_t(i)].triangles.push_back(t);
    }
}

/// The emitters that shine unevenly, by `level` of every vertex. Throws Error naming a value that cannot be.
void takeLevels(const std::vector<float>& level, const Mesh& mesh, EmitterClusters& clusters) {
    if (level.empty()) return;
    for (EmitterCluster& e : clusters.emitters) {
        for (const uint32_t v : e.vertices) {
            if (!(level[v] > 0) || level[v] > 1e6f)
                throw Error("reflectance.ply: emission_level of vertex {} is {}, expected more than 0 and at most 1e6",
                            v, level[v]);
            e.level.push_back(level[v]);
        }
        if (std::all_of(e.level.begin(), e.level.end(), [](float l) { return l == 1; })) e.level.clear();
        rebuildPattern(mesh, e);
    }
}

/// The mesh that a shot was made on, with nothing of the capture beside it.
Capture captureFromShot(const fs::path& folder, const fs::path& captureFolder, Progress& progress) {
    Capture capture;
    capture.folder = captureFolder;
    progress.begin("Reading the mesh", 1);
    capture.mesh = readShotMesh(folder, capture.meshReport);
    capture.origin = capture.meshReport.origin;
    return capture;
}

Shot readShot(const fs::path& folder, bool withImages, Progress& progress, const ShotPlaces& places) {
    Shot shot;
    shot.folder = folder;
    const fs::path file = folder / "shot.json";
    if (!isThere(file))
        throw Error("{}: {}", folder.string(),
                    isThere(folder) ? "is not a shot, there is no shot.json in it" : whyNoFile(folder));
    Json document = parseJson(readBytes(file, 256 << 20), file.string());
    if (!document.is_object()) throw Error("{}: is not valid JSON", file.string());
    Estimate& e = shot.estimate;
    std::vector<DVec3> centroids;
    withContext(file.string(), [&] {
        if (const int version = JsonFields(document).get<int>("version"); version < 1 || version > 3)
            throw Error("version: is {}, expected 1 to 3", version);
        upgradeShotDocument(document);
        placeShot(document, folder, places);
        readShotDocument(document, folder, shot, centroids);
    });
    LoadOptions load;
    load.images = withImages;
    load.fix = shot.fix;
    if (places.withoutCapture) shot.capture = captureFromShot(folder, shot.captureFolder, progress);
    else
        withContext(file.string() + ": capture",
                    [&] { shot.capture = loadCapture(shot.captureFolder, load, progress); });
    // What the document places counts from the capture's own origin.
    for (size_t i = 0; i < centroids.size(); ++i)
        e.emitters.emitters[i].centroid = Vec3(centroids[i] - shot.capture.origin);
    if (document.contains("look"))
        withContext(file.string(), [&] {
            withContext("look", [&] { shot.look = lookFromJson(document["look"], folder, shot.capture.origin); });
        });
    const ReflectanceFiles files(folder, shot.capture, shot.fix.mend.addedPositions.size());
    e.reflectance = files.reflectance(e.reflectance.basis);
    if (isThere(folder / "albedo.exr"))
        e.reflectance.texture = readTexture(folder / "albedo.exr", files.texturedFaces(), shot.capture.mesh.triangles,
                                            folder / "albedo_confidence.exr");
    e.nearFieldCorrection = files.nearFieldCorrection(e.emitters.emitters.size());
    const DirectionGrid grid{e.environmentSide};
    EnvironmentOfFile read = readEnvironmentOf(folder, environmentStem(0), grid);
    e.environment = std::move(read.cells);
    e.environmentSigma = deviationCells(folder, environmentStem(0), grid);
    e.background = backgroundOf(folder, environmentStem(0), read.painted);
    for (size_t k = 0; k < e.otherEnvironments.size(); ++k) {
        const std::string stem = environmentStem(int(k) + 1);
        read = readEnvironmentOf(folder, stem, grid);
        e.otherEnvironments[k] = {std::move(read.cells), deviationCells(folder, stem, grid),
                                  backgroundOf(folder, stem, read.painted)};
    }
    std::vector<float> emitter = files.column("emitter", -1);
    nameBalls(shot.capture, e.emitters, emitter);
    assignEmitters(emitter, shot.capture.mesh, e.emitters);
    takeLevels(files.emissionLevel(), shot.capture.mesh, e.emitters);
    return shot;
}

}  // namespace

InputFiles shotFiles(const Shot& shot, Progress& progress) {
    InputFiles files = captureFiles(shot.captureFolder, shot.fix, progress);
    for (const std::string& part : shotParts()) files.add(shot.folder / part);
    for (size_t k = 0; k < shot.estimate.otherEnvironments.size(); ++k)
        for (const char* end : environmentEnds) files.add(shot.folder / (environmentStem(int(k) + 1) + end));
    files.addFolder(shot.folder / "cache");
    for (const Lobe& lobe : shot.estimate.reflectance.basis.lobes)
        if (lobe.measured) files.add(lobe.measured->file);
    return files;
}

Shot openShot(const fs::path& folder, bool withImages, Progress& progress, const ShotPlaces& places) {
    mendShot(folder);
    // Another process may put a new shot in its place while this one reads: then once more, so that no file of one
    // meets those of another.
    struct stat before {
    }, after{};
    for (int attempt = 0;; ++attempt) {
        const bool there = ::stat(folder.c_str(), &before) == 0;
        const auto changed = [&] {
            return attempt < 5 && there && ::stat(folder.c_str(), &after) == 0 &&
                   (after.st_ino != before.st_ino || after.st_dev != before.st_dev);
        };
        try {
            Shot shot = readShot(folder, withImages, progress, places);
            if (!changed()) return shot;
        } catch (const Error&) {
            if (!changed()) throw;
        }
    }
}

}  // namespace relamp
