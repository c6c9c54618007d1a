#include "viewport/gpu_near.h"

#include <epoxy/gl.h>

#include <bit>
#include <cstring>

#include "base/error.h"
#include "base/random.h"
#include "viewport/gpu_scene.h"

namespace relamp::ui {
namespace {

constexpr size_t groupSize = 64;
/// Few enough that a run is over soon: drivers end long ones, and llvmpipe ends all loops of a lane together after
/// 65535 rounds.
constexpr int samplesOfRun = 16;

float bitsOf(uint32_t word) { return std::bit_cast<float>(word); }

class GpuNear : public NearDevice {
public:
    explicit GpuNear(std::shared_ptr<GpuScene> scene) : scene_(std::move(scene)), context_(scene_->context) {}
    std::string name() const override { return context_->renderer(); }

    void start(const NearQuery& q) override {
        context_->makeCurrent();
        if (!program_) program_ = context_->build({"boxes.glsl", "near.comp"});
        scene_->take(q.blockers, q.vertices);
        if (begun_ == flights_.size()) flights_.push_back(std::make_unique<Flight>());
        Flight& f = *flights_[begun_];
        takeWanted(f, q.wanted);
        takeEmitter(f, q.emitter);
        const size_t parts = takeParts(f, q);
        glUseProgram(program_);
        GpuBuffer* const places[] = {&scene_->nodes,   &scene_->triangles, &scene_->positions,
                                     &scene_->normals, &f.wanted,          &f.emitter,
                                     &f.parts,         &f.answers};  // as bound in the shaders
        for (GLuint place = 0; place < 8; ++place) places[place]->bind(place);
        setUniforms(q, parts);
        const int most = nearSamples(q.level) * (q.level < 3 ? 2 : 1);
        for (int from = 0; from < most; from += samplesOfRun) {
            glUniform1ui(glGetUniformLocation(program_, "from"), GLuint(from));
            glUniform1ui(glGetUniformLocation(program_, "to"), GLuint(from + samplesOfRun));
            glDispatchCompute(GLuint((q.wanted.size() + groupSize - 1) / groupSize), 1, 1);
            glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_BUFFER_UPDATE_BARRIER_BIT);
        }
        glFlush();
        context_->check();
        ++begun_;
    }

    void finish(std::span<NearAnswer> out) override {
        if (finished_ == begun_) throw Error("no form factors were asked for");
        Flight& f = *flights_[finished_];
        if (out.size() != f.held.size()) throw Error("{} places for {} form factors", out.size(), f.held.size());
        context_->makeCurrent();
        static_assert(sizeof(NearAnswer) == 2 * sizeof(float));
        f.answers.read(out.data(), out.size_bytes());
        context_->check();
        if (++finished_ == begun_) finished_ = begun_ = 0;
    }

    void forget() override { finished_ = begun_ = 0; }

    void clear() override {
        forget();
        context_->makeCurrent();
        scene_->clear();
        for (auto& f : flights_) {
            f->held.clear();
            for (GpuBuffer* b : {&f->wanted, &f->emitter, &f->parts, &f->answers}) b->put(nullptr, 0, GL_STATIC_DRAW);
        }
    }

private:
    /// One start() and its answers.
    struct Flight {
        GpuBuffer wanted, emitter, parts, answers;
        std::vector<uint32_t> held;  ///< what `wanted` holds
    };
    std::shared_ptr<GpuScene> scene_;
    std::shared_ptr<GpuContext> context_;
    GLuint program_ = 0;
    std::vector<std::unique_ptr<Flight>> flights_;
    size_t begun_ = 0, finished_ = 0;

    void takeWanted(Flight& f, std::span<const uint32_t> wanted) {
        GLint groups = 0;
        glGetIntegeri_v(GL_MAX_COMPUTE_WORK_GROUP_COUNT, 0, &groups);
        if (wanted.size() / groupSize >= size_t(groups))
            throw Error("{} vertices are too many for the driver", wanted.size());
        if (wanted.size() == f.held.size() &&
            (wanted.empty() || !std::memcmp(wanted.data(), f.held.data(), wanted.size_bytes())))
            return;
        f.held.assign(wanted.begin(), wanted.end());
        f.wanted.put(wanted.data(), wanted.size_bytes(), GL_DYNAMIC_DRAW);
        f.answers.put(nullptr, wanted.size() * sizeof(NearAnswer), GL_DYNAMIC_READ);
    }

    void takeEmitter(Flight& f, const NearEmitter& emitter) {
        const std::vector<LiveEmitterTree::Node>& nodes = emitter.tree.nodes();
        const EmitterSurface& surface = emitter.tree.surface();
        std::vector<Vec4> words(4 * nodes.size());
        for (size_t i = nodes.size(); i-- > 0;) {
            const LiveEmitterTree::Node& n = nodes[i];
            // The branch ends where that of its right child does.
            const float skip = n.right ? words[4 * n.right + 3].w : bitsOf(uint32_t(i + 1));
            words[4 * i] = Vec4(n.centre, n.radius);
            words[4 * i + 1] = Vec4(n.vectorArea, n.area);
            words[4 * i + 2] = Vec4(n.axis, n.coneCosine);
            words[4 * i + 3] = Vec4(n.coneSine, bitsOf(n.begin), bitsOf(n.end), skip);
        }
        for (size_t i = 0; i < emitter.tree.order().size(); ++i) {
            const uint32_t t = emitter.tree.order()[i];
            words.emplace_back(surface.corners[t][0], emitter.tree.cumulative()[i]);
            words.emplace_back(surface.corners[t][1], 0);
            words.emplace_back(surface.corners[t][2], 0);
            words.emplace_back(surface.normals[t], 0);
        }
        f.emitter.put(words.data(), words.size() * sizeof(Vec4), GL_STREAM_DRAW);
    }

    /// Returns their number: all but the ground.
    size_t takeParts(Flight& f, const NearQuery& q) {
        std::vector<Vec4> words;
        for (size_t b = 1; b < q.occluders.parts.size(); ++b) {
            const LivePart& p = q.occluders.parts[b];
            const Mat4 rows = glm::transpose(p.inverse);
            for (int k = 0; k < 3; ++k) words.push_back(rows[k]);
            words.emplace_back(p.centre, p.radius);
            words.emplace_back(bitsOf(scene_->places[b].begin), bitsOf(scene_->places[b].end), 0, 0);
        }
        f.parts.put(words.data(), words.size() * sizeof(Vec4), GL_STREAM_DRAW);
        return words.size() / 5;
    }

    void setUniforms(const NearQuery& q, size_t parts) {
        const auto place = [this](const char* name) { return glGetUniformLocation(program_, name); };
        const bool coarse = q.level == 1;
        const CutTolerance& cut = coarse ? coarseCut : fineCut;
        const NearEmitter& e = q.emitter;
        const uint64_t seed = mixBits(q.seed + e.part);
        glUniform1ui(place("count"), GLuint(q.wanted.size()));
        glUniform1ui(place("emitterNodes"), GLuint(e.tree.nodes().size()));
        glUniform1ui(place("partCount"), GLuint(parts));
        glUniform1ui(place("groundEnd"), scene_->places[0].end);
        glUniform1ui(place("samples"), GLuint(nearSamples(q.level)));
        glUniform1ui(place("splits"), GLuint(cut.splits));
        glUniform1ui(place("skipped"), e.part && e.tree.convex() ? GLuint(e.part - 1) : ~0u);
        glUniform2ui(place("seed"), GLuint(seed >> 32), GLuint(seed));
        glUniform4f(place("sphere"), e.centre.x, e.centre.y, e.centre.z, e.radius);
        glUniform3f(place("tolerance"), cut.far, cut.coneCosine, cut.above);
        glUniform1i(place("twoSided"), e.tree.surface().twoSided);
        glUniform1i(place("shadows"), e.shadows);
        glUniform1i(place("mayDouble"), q.level < 3);
        glUniform1f(place("offset"), q.occluders.offset);
    }
};

}  // namespace

std::shared_ptr<NearDevice> makeGpuNear(std::shared_ptr<GpuScene> scene) {
    return scene ? std::make_shared<GpuNear>(std::move(scene)) : nullptr;
}

std::shared_ptr<NearDevice> makeGpuNear(bool force, std::string* why) { return makeGpuNear(openGpuScene(force, why)); }

}  // namespace relamp::ui
