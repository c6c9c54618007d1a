// Turns the editor's state into the one texture that the viewport shows, and redraws it only when something it depends
// on has changed.
#pragma once
#include <array>
#include <memory>

#include "viewport/paint.h"
#include "viewport/photograph.h"
#include "viewport/renderer.h"
#include "viewport/seen_triangles.h"

namespace relamp::ui {

class ViewportImage {
public:
    /// Draws when needed. `pixelsPerPoint` scales the outline. In a drag a software renderer draws half as many pixels
    /// a side; the first image after it is whole again.
    void update(Editor& editor, const EyeView& whole, float pixelsPerPoint);
    uint64_t texture() { return renderer_.texture(); }
    /// Nothing is left to smooth: no further frame is needed.
    bool settled() const { return sample_ + 1 >= Renderer::samplesAtRest; }
    /// More light is about to come, and smoothing waits for it: drawing would take the processors that compute it.
    bool awaitsLight(const Editor& editor) const;
    /// Milliseconds that the last update spent in draw calls, which a software rasteriser runs on this thread.
    double drawMs() const { return drawMs_; }
    const std::vector<Strip>& strips() const { return key_.strips; }
    /// What is drawn and can be picked; null when there is nothing.
    const std::shared_ptr<const Mesh>& mesh() const { return meshes_[pickSlot_].geometry.mesh(); }
    const std::vector<uint8_t>& visible() const { return visible_; }
    Renderer& renderer() { return renderer_; }

private:
    /// Everything the image depends on.
    struct Key {
        Mat4 clipFromWorld{0};
        int width = 0, height = 0;
        std::vector<Strip> strips;
        std::vector<PaintKey> paints;
        float stops = 0, pixelsPerPoint = 1;
        std::string displayView;
        bool falseColour = false, wires = false, through = false, photographBehind = false, dome = false, grid = false,
             frusta = false, ownEnvironment = false, plateAlone = false;
        int view = -1;
        std::set<uint32_t> hidden;
        std::vector<std::string> selected;
        std::optional<ImageRegion> region;
        std::shared_ptr<const void> rest, distant, capture, live;
        std::shared_ptr<const PlateImage> plate;
        float plateOpacity = 1;
        bool operator==(const Key&) const = default;
    };
    /// A mesh with colours for one strip.
    struct Painted {
        PaintKey key;
        bool made = false;
        GpuMesh geometry;
        GlBuffer colours;
        bool display = false, shading = false, drawable = false;
        std::shared_ptr<const std::vector<uint32_t>> origin;
        std::shared_ptr<const AlbedoTexture> texture;  ///< whose coordinates the geometry has; null: shows none
    };

    Renderer renderer_;
    Key key_;
    int sample_ = -1;
    bool software_ = softwareRenderer();  ///< each pixel costs the processors that relight
    double drawMs_ = 0;
    ImageJob job_;
    SeenTriangles seen_;  ///< of the eye of a drag, where software draws
    std::array<Painted, 3> meshes_;
    size_t pickSlot_ = 0;  ///< strip whose mesh can be picked: the present look where it is shown
    PhotographTextures photographs_;
    std::vector<uint8_t> visible_;
    uint64_t visibleVersion_ = 0;
    std::set<uint32_t> hiddenShown_;
    GlTexture environment_, rest_, plate_;
    std::shared_ptr<const PlateImage> plateShown_;
    float plateOpacityShown_ = 1;
    /// Uploaded when it is first shown.
    struct DetailTexture {
        GlTexture texture;
        std::shared_ptr<const Estimate> shown;
    };
    DetailTexture factor_, confidence_, correction_;
    std::shared_ptr<const void> environmentShown_;  ///< a panorama, or the light it was drawn from
    std::shared_ptr<const Frame> restShown_;
    GlBuffer lines_, outline_;
    size_t lineVertices_ = 0, outlineCount_ = 0;
    struct LineKey {
        std::shared_ptr<const void> capture, scene;
        bool grid = false, frusta = false;
        int view = -1;
        std::vector<bool> cameras;  ///< whose frustum is shown
        bool operator==(const LineKey&) const = default;
    } lineKey_;
    std::string displayView_;

    Key keyOf(const Editor& editor, const EyeView& eye, float pixelsPerPoint) const;
    void compose(Editor& editor, const EyeView& eye);
    Painted& painted(const Editor& editor, size_t slot, const PaintKey& key);
    /// Gives the geometry its texture coordinates, where its paint shows a texture.
    void placeTexture(const Editor& editor, Painted& painted, const std::vector<uint8_t>& visible, bool otherTriangles);
    void makeLines(const Editor& editor, const EyeView& eye);
    void makeOutline(const Editor& editor, const EyeView& eye, float pixelsPerPoint);
    EnvironmentLayer environmentLayer(const std::shared_ptr<const DistantLight>& distant);
    /// The texture of the estimate that is edited, as a paint shows it; 0: it has none.
    GLuint detailTexture(const Editor& editor, Paint paint);
    /// Of the plate's present frame, as opaque as it is wanted; 0: there is none.
    GLuint plateTexture();
    GLuint restTexture(const std::shared_ptr<const Frame>& frame);
};

}  // namespace relamp::ui
