#include "pipeline/mend_mesh.h"

#include "base/log.h"
#include "clusters/emitter_mend.h"
#include "pipeline/light_obstacles.h"
#include "radiance/free_space.h"

namespace relamp {
namespace {

class MeshMender {
public:
    MeshMender(const PipelineOptions& options, Capture& capture, Prepared& prepared, StageMeter& meter,
               Progress& progress)
        : options_(options),
          capture_(capture),
          prepared_(prepared),
          meter_(meter),
          progress_(progress),
          file_(capture.mesh),
          proxies_(capture.proxies) {}

    void takeSkirtsOff() {
        std::vector<uint8_t> isLight(prepared_.scene->mesh.vertexCount(), 0);
        for (const std::vector<EmitterCluster>* list : {&prepared_.clusters.emitters, &prepared_.clusters.candidates})
            for (const EmitterCluster& e : *list)
                for (const uint32_t v : e.vertices) isLight[v] = 1;
        mend_.removed = freeSpaceTriangles(*prepared_.scene, capture_, *prepared_.samples, isLight, progress_);
        if (mend_.removed.empty()) return;
        apply({});
        say(fmt::format("{} triangles stand where photographs show the background past them: left out",
                        mend_.removed.size()));
    }

    void shapeEmitters() {
        meter_.begin(Stage::emitters);
        EmitterMend found = mendEmitters(*prepared_.scene, capture_, *prepared_.samples, prepared_.clusters);
        if (!found.needed()) return;
        add(found.mesh.removed, mend_.removed);
        mend_.moved = found.mesh.moved;
        apply(found.balls);
        if (!mend_.moved.empty() &&
            leastOverlap(*prepared_.scene, capture_, *prepared_.samples, prepared_.clusters) < found.overlap) {
            logInfo("moving the surfaces of lights does not bring them nearer to the photographs: taken back");
            mend_.moved.clear();
            found.movedWords.clear();
            apply(found.balls);
        }
        // Skins over the openings of shades.
        const std::vector<uint32_t> obstacles =
            falseObstacles(*prepared_.scene, *prepared_.samples, prepared_.clusters, options_.solve, progress_);
        if (!obstacles.empty()) {
            add(obstacles, mend_.shadowless);
            found.words.push_back(
                fmt::format("{} triangles beside a light hide it though photographs are explained better without their "
                            "shadow: light passes them",
                            obstacles.size()));
            apply(found.balls);
        }
        for (const std::vector<std::string>* list : {&found.words, &found.movedWords})
            for (const std::string& words : *list) say(words);
    }

    MeshMend result() && { return std::move(mend_); }

private:
    /// Triangles of the mesh as it is, by their numbers in the file.
    void add(const std::vector<uint32_t>& present, std::vector<uint32_t>& list) const {
        const std::vector<uint32_t> numbers = trianglesLeft(mend_, file_.triangles.size());
        for (const uint32_t t : present)
            if (t < numbers.size()) list.push_back(numbers[t]);  // not those of a ball
        std::sort(list.begin(), list.end());
    }
    void apply(const std::vector<ProxyLight>& balls) {
        capture_.mesh = file_;
        capture_.proxies = proxies_;
        applyMend(mend_, capture_.mesh);
        addProxies(balls, capture_.mesh);
        capture_.proxies.insert(capture_.proxies.end(), balls.begin(), balls.end());
        prepared_ = prepare(capture_, options_, meter_, progress_);
    }
    void say(const std::string& words) {
        capture_.notes.push_back(words);
        logInfo("{}", words);
    }

    const PipelineOptions& options_;
    Capture& capture_;
    Prepared& prepared_;
    StageMeter& meter_;
    Progress& progress_;
    const Mesh file_;
    const std::vector<ProxyLight> proxies_;
    MeshMend mend_;
};

}  // namespace

MeshMend mendMesh(const PipelineOptions& options, Capture& capture, Prepared& prepared, StageMeter& meter,
                  Progress& progress) {
    MeshMender mender(options, capture, prepared, meter, progress);
    mender.takeSkirtsOff();
    mender.shapeEmitters();
    return std::move(mender).result();
}

}  // namespace relamp
