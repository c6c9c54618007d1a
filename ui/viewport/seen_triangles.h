// The triangles that one eye sees: while a light is dragged, software OpenGL draws these and what moves, and the same
// image comes of a third of the triangles.
#pragma once
#include <memory>
#include <vector>

#include "viewport/renderer.h"

namespace relamp::ui {

class SeenTriangles {
public:
    /// To be called in each frame of a drag: true when `indices` give the whole image. The first frame of an eye does
    /// not, it only tells where everything stands; who leaves that place later is always drawn. `shown`: per triangle 0
    /// leaves it out; empty: all are shown. `version` tells another `shown`.
    bool follow(Renderer& renderer, const EyeView& eye, GpuMesh& mesh, const std::vector<uint8_t>& shown,
                uint64_t version);
    GlBuffer& indices() { return indices_; }
    size_t count() const { return count_; }
    void forget() { base_.reset(); }

private:
    Mat4 clipFromWorld_{0};
    int width_ = 0, height_ = 0;
    uint64_t version_ = 0;
    std::shared_ptr<const Mesh> base_;  ///< what stands where
    std::vector<uint8_t> left_;         ///< per vertex 1: it has left that place
    bool known_ = false;
    GlBuffer indices_;
    size_t count_ = 0;

    void look(Renderer& renderer, const EyeView& eye, GpuMesh& mesh, const std::vector<uint8_t>& shown);
};

}  // namespace relamp::ui
