// Draws one image of the scene into a texture: scene-linear layers with depth, then the display transform, then lines
// and outlines in display colours. Called only when something changed; at rest a few images with shifted pixels are
// averaged, which smooths edges.
#pragma once
#include <optional>
#include <vector>

#include "image/image_region.h"
#include "relight/environment_sides.h"
#include "viewport/display_transform.h"
#include "viewport/eye_view.h"
#include "viewport/gpu_mesh.h"

namespace relamp::ui {

/// The environment behind everything.
struct EnvironmentLayer {
    GLuint latLong = 0;                  ///< latitude-longitude texture; 0: none
    float yawDegrees = 0;                ///< it is turned about +Z, counter-clockwise from above
    Rgb gain{1};                         ///< factor on it
    EnvironmentSides sides = evenSides;  ///< factors on its sides
};

/// What fills a vertical strip of the image.
struct SceneLayer {
    float left = 0, right = 1;  ///< fraction of the image's width
    EnvironmentLayer environment;
    GLuint behind = 0;  ///< image behind the mesh: the photograph
    GpuMesh* mesh = nullptr;
    GlBuffer* colours = nullptr;
    bool display = false;      ///< the colours are display values
    bool shading = false;      ///< a soft light at the eye
    GlBuffer* some = nullptr;  ///< indices of the triangles to draw; nullptr: all
    size_t someTriangles = 0;
    GLuint texture = 0;                  ///< factor on the colours by the mesh's texture coordinates; 0: none
    bool inPlace = false;                ///< the texture stands in place of the colours
    GLuint instead = 0;                  ///< image shown in place of the mesh, which then gives depth only
    std::optional<ImageBox> insteadBox;  ///< of the image, where it is shown; none: everywhere
};

struct LineVertex {
    Vec3 position{0};
    Vec4 colour{1};
};

struct ImageJob {
    EyeView eye;
    std::vector<SceneLayer> layers;
    float stops = 0;
    bool falseColour = false;
    GlBuffer* lines = nullptr;
    size_t lineVertices = 0;
    GpuMesh* wires = nullptr;  ///< its edges, half transparent
    float wireStrength = 0.3f;
    GpuMesh* outlined = nullptr;  ///< with `outlineIndices`: the triangles of the selected emitters
    GlBuffer* outlineIndices = nullptr;
    size_t outlineCount = 0;
    Rgb outlineColour{1.0f, 0.62f, 0.16f};  ///< display values
    int outlineRadius = 2;                  ///< framebuffer pixels
    int outlineBox[4] = {0, 0, 0, 0};       ///< framebuffer pixels that may show a line: left, bottom, width, height
};

class Renderer {
public:
    Renderer();
    /// The view to show through. Throws Error with the driver's log when its shader does not compile.
    void setDisplay(const DisplayShader& shader);
    /// Image number `sample` of an average, 0 starts anew.
    void draw(const ImageJob& job, int sample);
    /// The finished image, bottom row first.
    GLuint texture() { return averaged_ ? average_.colour.id() : screen_.colour.id(); }
    /// Per triangle of `indices` 1 where draw() would show it in the first image of an average.
    std::vector<uint8_t> seenTriangles(const EyeView& eye, GpuMesh& mesh, GlBuffer& indices, size_t triangles);
    /// Reads the finished image back, top row first (tests, screenshots, scope); alpha is what of a pixel is covered.
    std::vector<uint8_t> readBack(int& width, int& height);
    static constexpr int samplesAtRest = 6;

private:
    GlProgram mesh_, texturedMesh_, image_, environment_, display_, lines_, flat_, outline_, averaging_, seen_;
    GlTarget scene_, screen_, average_, mask_, numbers_;
    GlTexture depth_;
    int depthWidth_ = 0, depthHeight_ = 0;
    GlVertexArray none_, lineArray_;
    std::vector<GlTexture> luts_;
    std::vector<DisplayLut> lutNames_;
    bool averaged_ = false;

    void resize(int width, int height);
    void drawLayer(const ImageJob& job, const SceneLayer& layer, const Mat4& clipFromWorld);
    /// A layer between two columns, or inside a box of them.
    void drawPart(const ImageJob& job, const SceneLayer& layer, const Mat4& clipFromWorld, const ImageBox& box);
    void drawDisplay(const ImageJob& job);
    void drawLines(const ImageJob& job, const Mat4& clipFromWorld);
    void drawWires(const ImageJob& job, const Mat4& clipFromWorld);
    void drawOutline(const ImageJob& job, const Mat4& clipFromWorld);
    void addToAverage(float fraction);
    void drawWhole();
};

}  // namespace relamp::ui
