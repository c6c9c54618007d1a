#include "viewport/viewport.h"

#include <chrono>

#include "item_map.h"
#include "viewport/interaction.h"
#include "viewport/navigation.h"
#include "viewport/thumbnail_textures.h"
#include "viewport/toolbar.h"
#include "viewport/viewport_image.h"
#include "widgets.h"

namespace relamp::ui {

struct Viewport::Impl {
    // Before everything else: the parts make GL objects.
    struct Context {
        Context() { requireOpenGl43(); }
    } context;
    ViewportImage image;
    Interaction interaction;
    ThumbnailTextures thumbnails;
    std::weak_ptr<const Scene> framedScene;
    const bool software = softwareRenderer();
    bool broken = false;  ///< the driver refused something: said once
    double cpuMs = 0;

    EyeView eyeFor(const Editor& editor, const Vec2& corner, const Vec2& size, const Vec2& density) const;
    void draw(Editor& editor);
};

EyeView Viewport::Impl::eyeFor(const Editor& editor, const Vec2& corner, const Vec2& size, const Vec2& density) const {
    const SceneExtent& extent = sceneExtent(editor);
    const auto& capture = editor.state.document.capture;
    const int view = editor.state.selection.view;
    // Depths enclose the cameras' drawings and lights that were moved outside.
    const float reach = 3.2f * extent.wholeRadius;
    if (const Camera* plate = editor.plateCamera())
        return eyeOf(*plate, corner, size, density, extent.wholeCentre, reach);
    if (editor.state.viewport.throughView && capture && view >= 0 && view < int(capture->views.size()) &&
        capture->views[size_t(view)].camera.width > 0)
        return eyeOf(capture->views[size_t(view)].camera, corner, size, density, extent.wholeCentre, reach);
    return eyeOf(editor.state.viewport.camera, corner, size, density, extent.wholeCentre, reach);
}

void Viewport::Impl::draw(Editor& editor) {
    const auto start = std::chrono::steady_clock::now();
    if (!editor.state.panels.hidden) drawViewportToolbar(editor);
    ImVec2 at = ImGui::GetCursorScreenPos(), area = ImGui::GetContentRegionAvail();
    at = {std::floor(at.x), std::floor(at.y)};
    area = {std::floor(std::max(area.x, 16.0f)), std::floor(std::max(area.y, 16.0f))};
    editor.state.viewport.aspect = area.x / area.y;
    if (const auto& scene = editor.state.document.scene; scene && framedScene.lock() != scene) {
        framedScene = scene;
        frameAll(editor);
    }
    ImGui::InvisibleButton(
        "image", area,
        ImGuiButtonFlags_MouseButtonLeft | ImGuiButtonFlags_MouseButtonRight | ImGuiButtonFlags_MouseButtonMiddle);
    noteItem("viewport");
    const bool hovered = ImGui::IsItemHovered(), active = ImGui::IsItemActive();
    const ImVec2 density = ImGui::GetIO().DisplayFramebufferScale;
    const Vec2 pixelsPerPoint(density.x > 0 ? density.x : 1, density.y > 0 ? density.y : 1);

    Canvas canvas;
    canvas.list = ImGui::GetWindowDrawList();
    canvas.editor = &editor;
    canvas.corner = {at.x, at.y}, canvas.size = {area.x, area.y};
    canvas.scale = editor.state.uiScale > 0 ? editor.state.uiScale : 1;
    EyeView eye = eyeFor(editor, canvas.corner, canvas.size, pixelsPerPoint);
    canvas.eye = &eye;
    interaction.moveCamera(editor, canvas, hovered, active);
    eye = eyeFor(editor, canvas.corner, canvas.size, pixelsPerPoint);
    interaction.act(editor, canvas, {image.strips(), image.mesh(), image.visible()}, hovered, active);
    // A click may have changed where the eye is.
    eye = eyeFor(editor, canvas.corner, canvas.size, pixelsPerPoint);

    double drawMs = 0;
    if (editor.state.document.scene) {
        editor.setEye(eye.camera, eye.orthographic);
        editor.requestImage();  // work on what the hand has just changed goes on while this frame is drawn
        image.update(editor, eye, canvas.scale * pixelsPerPoint.y);
        drawMs = image.drawMs();
        if (editor.state.panels.scopeShown() && (drawMs > 0 || !editor.state.scope)) {
            int width = 0, height = 0;
            const std::vector<uint8_t> pixels = image.renderer().readBack(width, height);
            editor.state.scope = std::make_shared<const Scope>(scopeOf(pixels, width, height));
        }
        // Not while something moves: the next change starts anew.
        if (!image.settled() && !editor.inGesture() && !image.awaitsLight(editor)) stayAwake();
        if (eye.corner != canvas.corner || eye.size != canvas.size)
            canvas.list->AddRectFilled(at, {at.x + area.x, at.y + area.y}, IM_COL32(24, 24, 24, 255));
        canvas.list->AddImage(textureId(image.texture()), toIm(eye.corner), toIm(eye.corner + eye.size), {0, 1},
                              {1, 0});
    } else {
        canvas.list->AddRectFilledMultiColor(at, {at.x + area.x, at.y + area.y}, IM_COL32(47, 47, 47, 255),
                                             IM_COL32(47, 47, 47, 255), IM_COL32(32, 32, 32, 255),
                                             IM_COL32(32, 32, 32, 255));
    }
    canvas.list->PushClipRect(at, {at.x + area.x, at.y + area.y}, true);
    interaction.draw(canvas, {image.strips(), image.mesh(), image.visible()});
    canvas.list->PopClipRect();
    if (interaction.gestureRunning() && !software) stayAwake();
    cpuMs = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count() - drawMs;
}

Viewport::Viewport() : impl_(std::make_unique<Impl>()) {}
Viewport::~Viewport() = default;

void Viewport::draw(Editor& editor) {
    try {
        impl_->draw(editor);
    } catch (const Error& error) {
        if (!std::exchange(impl_->broken, true))
            editor.fail("The image could not be drawn", error.what(),
                        "Another view transform or a newer graphics driver may help.");
    }
}

uint64_t Viewport::texture() const { return impl_->image.renderer().texture(); }
bool Viewport::software() const { return impl_->software; }
bool Viewport::takesEscape() const { return impl_->interaction.takesEscape(); }
double Viewport::cpuMs() const { return impl_->cpuMs; }
uint64_t Viewport::thumbnail(const std::string& key, const std::function<Image()>& make) {
    return impl_->thumbnails.texture(key, make);
}
void Viewport::dropThumbnails(const std::string& prefix) { impl_->thumbnails.drop(prefix); }

}  // namespace relamp::ui
