#include "viewport/gpu_shadow.h"

#include <epoxy/gl.h>

#include <bit>
#include <cstring>

#include "base/error.h"
#include "viewport/gpu_scene.h"

namespace relamp::ui {
namespace {

constexpr size_t run = ShadowQuery::run, wordsOfChunk = run + 1;

float bitsOf(uint32_t word) { return std::bit_cast<float>(word); }

float angleBetween(const Vec3& a, const Vec3& b) { return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b)); }

/// Squares of 4 x 4 cells, then cells: circles that hold them, and the middles of their quarters.
std::vector<Vec4> tableOf(const LiveGrid& grid, size_t& parents) {
    const auto side = size_t(grid.grid().side);
    std::vector<Vec4> words;
    for (size_t y = 0; y < side; y += 4)
        for (size_t x = 0; x < side; x += 4) {
            const auto childAt = [&](size_t i) { return (y + i / 4) * side + x + i % 4; };
            Vec3 axis(0);
            for (size_t i = 0; i < 16; ++i) axis += grid.centre(childAt(i));
            axis = glm::normalize(axis);
            float radius = 0;
            for (size_t i = 0; i < 16; ++i)
                radius = std::max(radius, angleBetween(axis, grid.centre(childAt(i))) + grid.radius(childAt(i)));
            radius = std::min(1.001f * radius, 3.14f);
            words.emplace_back(axis, std::cos(radius));
            words.emplace_back(std::sin(radius), bitsOf(uint32_t(childAt(0))), 0, 0);
        }
    parents = words.size() / 2;
    for (size_t c = 0; c < grid.cells(); ++c) {
        const float radius = grid.radius(c);
        words.emplace_back(grid.centre(c), std::cos(radius));
        words.emplace_back(std::sin(radius), std::cos(0.75f * radius), std::sin(0.75f * radius), 0);
        for (int q = 0; q < 4; ++q) words.emplace_back(grid.quarter(c, q), 0);
    }
    return words;
}

class GpuShadow : public ShadowDevice {
public:
    explicit GpuShadow(std::shared_ptr<GpuScene> scene) : scene_(std::move(scene)), context_(scene_->context) {}
    std::string name() const override { return context_->renderer(); }

    void start(const ShadowQuery& q) override {
        context_->makeCurrent();
        if (!program_) program_ = context_->build({"boxes.glsl", "shadow.comp"});
        scene_->take(q.blockers, q.vertices);
        takeSlots(q);
        if (begun_ == flights_.size()) flights_.push_back(std::make_unique<Flight>());
        Flight& f = *flights_[begun_];
        const size_t header = 1 + chunks_ * wordsOfChunk;
        if (f.headerWords != header) {
            f.header.put(nullptr, header * sizeof(uint32_t), GL_DYNAMIC_READ);
            f.headerWords = header;
        }
        if (f.capacity < capacity_) {
            context_->expectRoom(capacity_ * sizeof(uint32_t));
            f.entries.put(nullptr, capacity_ * sizeof(uint32_t), GL_DYNAMIC_READ);
            f.capacity = capacity_;
        }
        const uint32_t zero = 0;
        f.header.change(0, &zero, sizeof zero);
        glUseProgram(program_);
        GpuBuffer* const places[] = {&scene_->nodes, &scene_->triangles, &scene_->positions, &slots_, &masks_,
                                     &grid_,         &f.header,          &f.entries};
        for (GLuint place = 0; place < 8; ++place) places[place]->bind(place);
        setUniforms(q, f);
        glDispatchCompute(GLuint(chunks_), 1, 1);
        glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
        glFlush();
        context_->check();
        ++begun_;
    }

    void finish(ShadowAnswers& out) override {
        if (finished_ == begun_) throw Error("no shadows were asked for");
        Flight& f = *flights_[finished_];
        context_->makeCurrent();
        header_.resize(f.headerWords);
        f.header.read(header_.data(), header_.size() * sizeof(uint32_t));
        context_->check();
        if (++finished_ == begun_) finished_ = begun_ = 0;
        const size_t chunks = f.headerWords / wordsOfChunk, used = header_[0];
        out.first.assign(chunks, ShadowAnswers::none);
        out.slot.resize(chunks * run);
        for (size_t c = 0; c < chunks; ++c)
            std::memcpy(&out.slot[c * run], &header_[2 + c * wordsOfChunk], run * sizeof(uint32_t));
        if (used > f.capacity) {  // which chunks found room is chance: none of them counts
            capacity_ = used + used / 4;
            return;
        }
        out.entries.resize(2 * used);
        if (used) f.entries.read(out.entries.data(), used * sizeof(uint32_t));
        context_->check();
        for (size_t c = 0; c < chunks; ++c)
            if (const uint32_t first = header_[1 + c * wordsOfChunk]; first != ShadowAnswers::none)
                out.first[c] = 2 * first;
    }

    void forget() override { finished_ = begun_ = 0; }

    void clear() override {
        forget();
        context_->makeCurrent();
        scene_->clear();
        for (GpuBuffer* b : {&slots_, &masks_, &grid_}) b->put(nullptr, 0, GL_STATIC_DRAW);
        for (auto& f : flights_) {
            f->header.put(nullptr, 0, GL_DYNAMIC_READ);
            f->entries.put(nullptr, 0, GL_DYNAMIC_READ);
            f->headerWords = f->capacity = 0;
        }
        version_ = 0;
    }

private:
    /// One start() and its answers.
    struct Flight {
        GpuBuffer header, entries;
        size_t headerWords = 0, capacity = 0;
    };
    std::shared_ptr<GpuScene> scene_;
    std::shared_ptr<GpuContext> context_;
    GLuint program_ = 0;
    GpuBuffer slots_, masks_, grid_;
    uint64_t version_ = 0;  ///< of the slots that the card holds
    size_t chunks_ = 0, parents_ = 0, capacity_ = 0;
    std::vector<std::unique_ptr<Flight>> flights_;
    size_t begun_ = 0, finished_ = 0;
    std::vector<uint32_t> header_;

    void takeSlots(const ShadowQuery& q) {
        if (version_ == q.version) return;
        version_ = 0;
        GLint groups = 0;
        glGetIntegeri_v(GL_MAX_COMPUTE_WORK_GROUP_COUNT, 0, &groups);
        const size_t slots = q.vertexOfSlot.size();
        chunks_ = (slots + run - 1) / run;
        if (chunks_ >= size_t(groups)) throw Error("{} vertices are too many for the driver", slots);
        std::vector<Vec4> words(slots);
        for (size_t s = 0; s < slots; ++s) words[s] = Vec4(q.normal[s], bitsOf(q.vertexOfSlot[s]));
        context_->expectRoom(std::max(words.size() * sizeof(Vec4), q.masks.size()));
        slots_.put(words.data(), words.size() * sizeof(Vec4), GL_STATIC_DRAW);
        masks_.put(q.masks.data(), q.masks.size(), GL_STATIC_DRAW);
        const std::vector<Vec4> table = tableOf(q.grid, parents_);
        grid_.put(table.data(), table.size() * sizeof(Vec4), GL_STATIC_DRAW);
        capacity_ = std::max<size_t>(capacity_, 8 * slots);
        context_->check();
        version_ = q.version;
    }

    void setUniforms(const ShadowQuery& q, const Flight& f) {
        const auto place = [this](const char* name) { return glGetUniformLocation(program_, name); };
        const LivePart& p = q.occluders.parts[q.part];
        const Mat4 rows = glm::transpose(p.inverse);
        glUniform1ui(place("slotCount"), GLuint(q.vertexOfSlot.size()));
        glUniform1ui(place("cells"), GLuint(q.grid.cells()));
        glUniform1ui(place("side"), GLuint(q.grid.grid().side));
        glUniform1ui(place("parents"), GLuint(parents_));
        glUniform1ui(place("capacity"), GLuint(f.capacity));
        glUniform1ui(place("treeBegin"), scene_->places[q.part].begin);
        glUniform1ui(place("treeEnd"), scene_->places[q.part].end);
        glUniform4f(place("sphere"), p.centre.x, p.centre.y, p.centre.z, p.radius);
        glUniform4fv(place("rowX"), 1, &rows[0][0]);
        glUniform4fv(place("rowY"), 1, &rows[1][0]);
        glUniform4fv(place("rowZ"), 1, &rows[2][0]);
        glUniform1f(place("offset"), q.occluders.offset);
    }
};

}  // namespace

std::shared_ptr<ShadowDevice> makeGpuShadow(std::shared_ptr<GpuScene> scene) {
    return scene ? std::make_shared<GpuShadow>(std::move(scene)) : nullptr;
}

std::shared_ptr<ShadowDevice> makeGpuShadow(bool force, std::string* why) {
    return makeGpuShadow(openGpuScene(force, why));
}

}  // namespace relamp::ui
