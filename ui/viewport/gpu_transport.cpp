#include "viewport/gpu_transport.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "base/error.h"
#include "viewport/gpu_context.h"

namespace relamp::ui {
namespace {

class GpuTransport : public TransportDevice {
public:
    explicit GpuTransport(std::shared_ptr<GpuContext> context) : context_(std::move(context)) {}
    std::string name() const override { return context_->renderer(); }

    void apply(const std::array<std::vector<float>, 3>& coefs, std::span<Rgb> out) override {
        if (out.size() != blocks_ * transportLanes)
            throw Error("{} places for the light of {} points", out.size(), blocks_ * transportLanes);
        if (!blocks_) return;
        context_->makeCurrent();
        interleaved_.resize(coefs[0].size() * 4);
        for (size_t i = 0; i < coefs[0].size(); ++i)
            for (size_t k = 0; k < 3; ++k) interleaved_[4 * i + k] = coefs[k][i];
        glUseProgram(program_);
        buffers_[coefsPlace].put(interleaved_.data(), interleaved_.size() * sizeof(float), GL_STREAM_DRAW);
        for (GLuint place = 0; place < places; ++place) buffers_[place].bind(place);
        glUniform1ui(blocksUniform_, GLuint(blocks_));
        glDispatchCompute(GLuint((blocks_ * transportLanes + groupSize - 1) / groupSize), 1, 1);
        glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
        static_assert(sizeof(Rgb) == 3 * sizeof(float));
        buffers_[lightPlace].read(out.data(), out.size_bytes());
        context_->check();
    }

protected:
    void take(const TransportStore& store) override {
        context_->makeCurrent();
        blocks_ = 0;
        if (!program_) {
            program_ = context_->build({"transport.comp"});
            blocksUniform_ = glGetUniformLocation(program_, "blocks");
        }
        GLint groups = 0;
        glGetIntegeri_v(GL_MAX_COMPUTE_WORK_GROUP_COUNT, 0, &groups);
        const size_t vertices = store.blocks() * transportLanes;
        context_->expectRoom(std::max(store.value().size_bytes(), vertices * sizeof(Rgb)));
        if (vertices / groupSize >= size_t(groups)) throw Error("{} vertices are too many for the driver", vertices);
        buffers_[indexPlace].put(store.index().data(), store.index().size_bytes(), GL_STATIC_DRAW);
        buffers_[valuePlace].put(store.value().data(), store.value().size_bytes(), GL_STATIC_DRAW);
        buffers_[startPlace].put(store.start().data(), store.start().size_bytes(), GL_STATIC_DRAW);
        buffers_[scalePlace].put(store.scale().data(), store.scale().size_bytes(), GL_STATIC_DRAW);
        buffers_[lightPlace].put(nullptr, vertices * sizeof(Rgb), GL_DYNAMIC_READ);
        context_->check();
        blocks_ = store.blocks();
    }

private:
    enum Place : GLuint {
        indexPlace,
        valuePlace,
        startPlace,
        scalePlace,
        coefsPlace,
        lightPlace,
        places
    };  // as bound in transport.comp
    static constexpr size_t groupSize = 64;
    std::shared_ptr<GpuContext> context_;
    GLuint program_ = 0;
    GLint blocksUniform_ = -1;
    GpuBuffer buffers_[places];
    size_t blocks_ = 0;
    std::vector<float> interleaved_;
};

}  // namespace

std::shared_ptr<TransportDevice> makeGpuTransport(std::shared_ptr<GpuContext> context) {
    return context ? std::make_shared<GpuTransport>(std::move(context)) : nullptr;
}

std::shared_ptr<TransportDevice> makeGpuTransport(bool force, std::string* why) {
    return makeGpuTransport(openGpuContext(force, why));
}

}  // namespace relamp::ui
