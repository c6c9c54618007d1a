#include "viewport/gpu_near.h"

#include <epoxy/gl.h>

#include <bit>
#include <cstring>

#include "base/error.h"
#include "base/parallel.h"
#include "base/random.h"
#include "viewport/gpu_context.h"
#include "viewport/gpu_transport.h"

namespace relamp::ui {
namespace {

constexpr size_t groupSize = 64;
/// Few enough that a run is over soon: drivers end long ones, and llvmpipe ends all loops of a lane together after
/// 65535 rounds.
constexpr int samplesOfRun = 16;

float bitsOf(uint32_t word) { return std::bit_cast<float>(word); }

/// Copies a list of a mesh; of one that it follows only the runs that differ.
void bring(GpuBuffer& buffer, const std::vector<Vec3>& now, const std::vector<Vec3>* before) {
    constexpr size_t run = 8192;
    if (!before || before->size() != now.size()) {
        buffer.put(now.data(), now.size() * sizeof(Vec3), GL_DYNAMIC_DRAW);
        return;
    }
    std::vector<uint8_t> differs((now.size() + run - 1) / run);
    const auto lengthOf = [&](size_t r) { return std::min(run, now.size() - r * run); };
    parallelFor(differs.size(), 1, [&](size_t r) {
        differs[r] = std::memcmp(&now[r * run], &(*before)[r * run], lengthOf(r) * sizeof(Vec3)) != 0;
    });
    for (size_t r = 0; r < differs.size(); ++r)
        if (differs[r]) buffer.change(r * run * sizeof(Vec3), &now[r * run], lengthOf(r) * sizeof(Vec3));
}

class GpuNear : public NearDevice {
public:
    explicit GpuNear(std::shared_ptr<GpuContext> context) : context_(std::move(context)) {}
    std::string name() const override { return context_->renderer(); }

    void start(const NearQuery& q) override {
        context_->makeCurrent();
        if (!program_) program_ = context_->build({"boxes.glsl", "near.comp"});
        takeTrees(q.blockers);
        takeVertices(q.vertices);
        if (begun_ == flights_.size()) flights_.push_back(std::make_unique<Flight>());
        Flight& f = *flights_[begun_];
        takeWanted(f, q.wanted);
        takeEmitter(f, q.emitter);
        const size_t parts = takeParts(f, q);
        glUseProgram(program_);
        GpuBuffer* const places[] = {&nodes_,   &triangles_, &positions_, &normals_,
                                     &f.wanted, &f.emitter,  &f.parts,    &f.answers};  // as bound in the shaders
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
        for (GpuBuffer* b : {&nodes_, &triangles_, &positions_, &normals_}) b->put(nullptr, 0, GL_STATIC_DRAW);
        for (auto& f : flights_) {
            f->held.clear();
            for (GpuBuffer* b : {&f->wanted, &f->emitter, &f->parts, &f->answers}) b->put(nullptr, 0, GL_STATIC_DRAW);
        }
        trees_.clear();
        mesh_.reset();
    }

private:
    /// One start() and its answers.
    struct Flight {
        GpuBuffer wanted, emitter, parts, answers;
        std::vector<uint32_t> held;  ///< what `wanted` holds
    };
    struct Place {
        uint32_t begin = 0, end = 0;  ///< nodes
    };
    std::shared_ptr<GpuContext> context_;
    GLuint program_ = 0;
    GpuBuffer nodes_, triangles_, positions_, normals_;
    std::vector<std::shared_ptr<const BoxTree>> trees_;  ///< that the card holds, one behind the other
    std::vector<Place> places_;                          ///< of them
    std::shared_ptr<const Mesh> mesh_;                   ///< whose vertices it holds
    std::vector<std::unique_ptr<Flight>> flights_;
    size_t begun_ = 0, finished_ = 0;

    void takeTrees(const NearBlockers& blockers) {
        std::vector<std::shared_ptr<const BoxTree>> now;
        for (const auto& b : blockers.blockers) now.push_back(b.tree);
        if (now == trees_) return;
        trees_.clear();
        places_.assign(now.size(), {});
        std::vector<BoxTree::Node> nodes;
        std::vector<Vec4> triangles;
        for (size_t b = 0; b < now.size(); ++b) {
            if (!now[b]) continue;
            const auto first = uint32_t(nodes.size()), corner = uint32_t(triangles.size() / 3);
            for (BoxTree::Node n : now[b]->nodes) {
                n.skip += first;
                if (n.leaf) n.leaf += corner << 3;
                nodes.push_back(n);
            }
            triangles.insert(triangles.end(), now[b]->triangles.begin(), now[b]->triangles.end());
            places_[b] = {first, uint32_t(nodes.size())};
        }
        context_->expectRoom(std::max(nodes.size() * sizeof(BoxTree::Node), triangles.size() * sizeof(Vec4)));
        nodes_.put(nodes.data(), nodes.size() * sizeof(BoxTree::Node), GL_STATIC_DRAW);
        triangles_.put(triangles.data(), triangles.size() * sizeof(Vec4), GL_STATIC_DRAW);
        context_->check();
        trees_ = std::move(now);
    }

    void takeVertices(const LiveVertices& vertices) {
        if (mesh_ == vertices.mesh) return;
        const std::shared_ptr<const Mesh> before = std::move(mesh_);
        mesh_.reset();
        context_->expectRoom(vertices.count() * sizeof(Vec3));
        bring(positions_, vertices.mesh->positions, before ? &before->positions : nullptr);
        bring(normals_, vertices.mesh->normals, before ? &before->normals : nullptr);
        context_->check();
        mesh_ = vertices.mesh;
    }

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
            words.emplace_back(bitsOf(places_[b].begin), bitsOf(places_[b].end), 0, 0);
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
        glUniform1ui(place("groundEnd"), places_[0].end);
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

std::shared_ptr<NearDevice> makeGpuNear(std::shared_ptr<GpuContext> context) {
    return context ? std::make_shared<GpuNear>(std::move(context)) : nullptr;
}

std::shared_ptr<NearDevice> makeGpuNear(bool force, std::string* why) {
    return makeGpuNear(openGpuContext(force, why));
}

LiveDevices makeGpuDevices(bool force, std::string* why) {
    const std::shared_ptr<GpuContext> context = openGpuContext(force, why);
    return {makeGpuTransport(context), makeGpuNear(context)};
}

}  // namespace relamp::ui
