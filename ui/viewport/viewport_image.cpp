#include "viewport/viewport_image.h"

#include <chrono>

#include "base/parallel.h"
#include "edit/state_edits.h"
#include "image/environment_map.h"
#include "relight/backdrop.h"
#include "viewport/navigation.h"
#include "viewport/picking.h"
#include "viewport/space_lines.h"
#include "viewport/surface_texture.h"

namespace relamp::ui {
namespace {

bool throughPhotograph(const Editor& editor) {
    const auto& capture = editor.state.document.capture;
    return !editor.plateCamera() && editor.state.viewport.throughView && capture && editor.state.selection.view >= 0 &&
           editor.state.selection.view < int(capture->views.size());
}

/// Its texture stands in place of the vertices' colours.
bool isInPlace(Paint paint) { return paint == Paint::confidence || paint == Paint::correction; }

/// The frame covers this part of the eye's image.
bool covers(const Frame& frame, const EyeView& eye, const std::optional<ImageRegion>& region) {
    const ImageBox box = boxOf(region.value_or(ImageRegion{}), std::max(eye.width, 1), std::max(eye.height, 1));
    if (region && (frame.width != box.width || frame.height != box.height)) return false;
    const float a = float(frame.width) / float(std::max(frame.height, 1)), b = float(box.width) / float(box.height);
    return frame.width > 0 && std::abs(a / b - 1) < 0.02f &&
           frame.beauty.size() == size_t(frame.width) * size_t(frame.height) &&
           frame.alpha.size() == frame.beauty.size();
}

/// Edges that lie close together on screen are drawn fainter, so that the photograph stays visible under a dense mesh.
float wireStrength(const Scene& scene, const EyeView& eye) {
    double sum = 0;
    size_t count = 0;
    for (size_t v = 0; v < scene.vertexSpacing.size(); v += 1 + scene.vertexSpacing.size() / 4096) {
        const Vec3& p = scene.mesh.positions[v];
        if (!scene.referenced[v] || glm::dot(p - eye.position, eye.forward) <= 0) continue;
        sum += scene.vertexSpacing[v] / eye.metresPerPoint(p);
        ++count;
    }
    const float points = count ? float(sum / double(count)) : 10.0f;
    return std::clamp(0.03f * points, 0.07f, 0.38f);
}

}  // namespace

ViewportImage::Key ViewportImage::keyOf(const Editor& editor, const EyeView& eye, float pixelsPerPoint) const {
    const ViewportState& viewport = editor.state.viewport;
    Key key;
    key.clipFromWorld = eye.clipFromWorld;
    key.width = eye.width, key.height = eye.height;
    key.strips = stripsOf(editor);
    for (const Strip& strip : key.strips) key.paints.push_back(paintKey(editor, strip.paint));
    key.stops = viewport.exposureStops;
    key.pixelsPerPoint = pixelsPerPoint;
    key.displayView = displayViewOf(editor);
    key.falseColour = viewport.falseColour;
    key.through = throughPhotograph(editor) || editor.plateCamera();
    key.plate = editor.relitAtRest();
    key.plateAlone = key.plate != nullptr;
    if (!key.plate) key.plate = editor.plateImage();
    key.plateOpacity = viewport.plateOpacity;
    key.wires = viewport.meshOverlay;
    key.photographBehind = viewport.photographBehind, key.dome = viewport.directionDome;
    key.grid = viewport.grid && viewport.overlays && !key.through;
    key.frusta = viewport.frusta && viewport.overlays && !key.through;
    key.view = editor.state.selection.view;
    key.hidden = viewport.hiddenComponents;
    key.selected = editor.state.selection.emitters;
    key.capture = editor.state.document.capture;
    key.ownEnvironment = editor.look().environment.source == EnvironmentLook::Source::recovered;
    // A photograph of another lighting state may show another environment.
    const auto capture = editor.state.document.capture;
    const auto estimate = editor.estimate();
    if (estimate && capture && key.view >= 0 && size_t(key.view) < capture->views.size())
        if (const size_t state = capture->views[size_t(key.view)].state; state < estimate->states.size())
            key.ownEnvironment = key.ownEnvironment && showsEnvironment(editor.look().environment, *estimate, state);
    const auto live = editor.liveFrame();
    if (live) {
        key.live = live->mesh;
        if (key.dome || (key.through && !key.ownEnvironment)) key.distant = live->distant;
    }
    bool model = false;
    for (const Strip& strip : key.strips) model = model || strip.paint == Paint::model;
    if (const auto rest = editor.restFrame();
        rest && model && live && key.hidden.empty() && !editor.inGesture() && covers(*rest, eye, viewport.region))
        key.rest = rest, key.region = viewport.region;
    return key;
}

bool ViewportImage::awaitsLight(const Editor& editor) const {
    const auto live = editor.liveFrame();
    return software_ && live && !live->refined &&
           std::any_of(key_.strips.begin(), key_.strips.end(), [](const Strip& s) { return s.paint == Paint::model; });
}

void ViewportImage::update(Editor& editor, const EyeView& whole, float pixelsPerPoint) {
    drawMs_ = 0;
    EyeView eye = whole;
    if (software_ && editor.inGesture()) {
        eye.width = (eye.width + 1) / 2, eye.height = (eye.height + 1) / 2;
        pixelsPerPoint *= 0.5f;
    }
    Key key = keyOf(editor, eye, pixelsPerPoint);
    if (sample_ >= 0 && key == key_) {
        // Smoothing waits for the end of a drag: the next step would wait for it.
        if (settled() || editor.inGesture() || awaitsLight(editor)) return;
        ++sample_;
    } else {
        key_ = std::move(key);
        sample_ = 0;
        compose(editor, eye);
    }
    const auto start = std::chrono::steady_clock::now();
    renderer_.draw(job_, sample_);
    drawMs_ = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

void ViewportImage::compose(Editor& editor, const EyeView& eye) {
    if (displayView_ != key_.displayView) {
        renderer_.setDisplay(displayTransform().shader(key_.displayView));
        displayView_ = key_.displayView;
    }
    if (hiddenShown_ != key_.hidden || meshes_[0].geometry.mesh() == nullptr)
        hiddenShown_ = key_.hidden, ++visibleVersion_;
    job_.eye = eye;
    job_.layers.clear();
    job_.stops = key_.stops;
    job_.falseColour = key_.falseColour;
    const bool plate = editor.plateCamera() != nullptr;
    const GLuint photograph = plate          ? plateTexture()
                              : key_.through ? photographs_.texture(editor.state.document.capture, key_.view)
                                             : 0;
    const auto live = editor.liveFrame();
    const auto present =
        std::find_if(key_.strips.begin(), key_.strips.end(), [](const Strip& s) { return s.paint == Paint::model; });
    pickSlot_ = present == key_.strips.end() ? 0 : size_t(present - key_.strips.begin());
    for (size_t i = 0; i < key_.strips.size() && i < meshes_.size(); ++i) {
        const Strip& strip = key_.strips[i];
        Painted& mesh = painted(editor, i, key_.paints[i]);
        if (!strip.missing.empty()) continue;
        SceneLayer layer;
        layer.left = strip.left, layer.right = strip.right;
        const bool model =
            strip.paint == Paint::model || strip.paint == Paint::distantModel || strip.paint == Paint::before;
        if ((strip.paint == Paint::photographs || key_.plateAlone) && photograph) {
            layer.behind = photograph;
        } else {
            const bool photographShows = photograph && key_.photographBehind && model && key_.ownEnvironment;
            if (photographShows) {
                const auto& samples = editor.state.document.samples;
                const GLuint backdrop =
                    live && samples && !plate
                        ? photographs_.backdrop(editor.state.document.capture, key_.view, *samples, live->distant)
                        : 0;
                layer.behind = backdrop ? backdrop : photograph;
            } else if (key_.distant && model) layer.environment = environmentLayer(live ? live->distant : nullptr);
            if (mesh.drawable) {
                layer.mesh = &mesh.geometry;
                layer.colours = &mesh.colours;
                layer.display = mesh.display, layer.shading = mesh.shading;
                if (mesh.texture) layer.texture = detailTexture(editor, strip.paint);
                layer.inPlace = isInPlace(strip.paint);
                if (strip.paint == Paint::model && key_.rest) layer.instead = restTexture(editor.restFrame());
                if (layer.instead && key_.region) layer.insteadBox = boxOf(*key_.region, eye.width, eye.height);
            }
        }
        job_.layers.push_back(layer);
    }
    // In a drag the eye stands still: what it does not see need not be drawn in every step.
    if (!software_ || !editor.inGesture()) seen_.forget();
    else if (job_.layers.size() == 1 && job_.layers[0].colours && !job_.layers[0].texture && !job_.layers[0].instead &&
             seen_.follow(renderer_, eye, *job_.layers[0].mesh, visible_, visibleVersion_))
        job_.layers[0].some = &seen_.indices(), job_.layers[0].someTriangles = seen_.count();
    job_.wires = key_.wires && meshes_[0].drawable ? &meshes_[0].geometry : nullptr;
    if (job_.wires) job_.wireStrength = wireStrength(*editor.state.document.scene, eye);
    makeLines(editor, eye);
    job_.lines = &lines_;
    job_.lineVertices = lineVertices_;
    makeOutline(editor, eye, key_.pixelsPerPoint);
}

ViewportImage::Painted& ViewportImage::painted(const Editor& editor, size_t slot, const PaintKey& key) {
    Painted& p = meshes_[slot];
    if (!p.made || p.key != key) {
        PaintedMesh fresh = paintMesh(editor, key.paint);
        p.key = key;
        p.made = true;
        p.drawable = fresh.mesh != nullptr;
        if (!p.drawable) return p;
        p.display = fresh.display, p.shading = fresh.shading;
        p.origin = fresh.origin;
        const auto& scene = editor.state.document.scene;
        const std::vector<uint8_t> visible =
            hiddenShown_.empty() || !scene ? std::vector<uint8_t>{}
                                           : visibleTriangles(*fresh.mesh, fresh.origin.get(), *scene, hiddenShown_);
        const bool otherTriangles = p.geometry.upload(fresh.mesh, visible, visibleVersion_);
        placeTexture(editor, p, visible, otherTriangles);
        p.colours.upload(GL_ARRAY_BUFFER, fresh.colours, GL_STREAM_DRAW);
        if (slot == pickSlot_) visible_ = visible;
    } else if (p.drawable) {
        // Only what is hidden can have changed.
        const auto& scene = editor.state.document.scene;
        const auto mesh = p.geometry.mesh();
        const std::vector<uint8_t> visible = hiddenShown_.empty() || !scene
                                                 ? std::vector<uint8_t>{}
                                                 : visibleTriangles(*mesh, p.origin.get(), *scene, hiddenShown_);
        const bool otherTriangles = p.geometry.upload(mesh, visible, visibleVersion_);
        placeTexture(editor, p, visible, otherTriangles);
        if (slot == pickSlot_) visible_ = visible;
    }
    return p;
}

void ViewportImage::placeTexture(const Editor& editor, Painted& p, const std::vector<uint8_t>& visible,
                                 bool otherTriangles) {
    const auto estimate = editor.estimate();
    const auto& scene = editor.state.document.scene;
    const Paint paint = p.key.paint;
    const bool wanted = paint == Paint::model || paint == Paint::before || paint == Paint::albedo || isInPlace(paint);
    auto texture = wanted && estimate && scene ? estimate->reflectance.texture : nullptr;
    if (texture && paint == Paint::confidence && texture->confidence.empty()) texture = nullptr;
    if (texture && (otherTriangles || p.texture != texture))
        p.geometry.uploadTexcoords(texcoordsDrawn(*texture, *p.geometry.mesh(), scene->mesh, p.origin.get(), visible));
    p.texture = texture;
}

GLuint ViewportImage::detailTexture(const Editor& editor, Paint paint) {
    const auto estimate = editor.estimate();
    const Mesh& captured = editor.state.document.scene->mesh;
    DetailTexture& kept = paint == Paint::confidence ? confidence_ : paint == Paint::correction ? correction_ : factor_;
    if (estimate != kept.shown) {
        const SurfaceDetail detail = paint == Paint::confidence   ? confidenceDetail(*estimate)
                                     : paint == Paint::correction ? correctionDetail(*estimate, captured)
                                                                  : detailOf(*estimate, captured);
        uploadHalf(kept.texture, detail.width, detail.height, &detail.factor[0].x, false);
        kept.shown = estimate;
    }
    return kept.texture.id();
}

void ViewportImage::makeLines(const Editor& editor, const EyeView& eye) {
    const SceneExtent& extent = sceneExtent(editor);
    const float depth = frustumDepth(extent.radius);
    LineKey wanted{editor.state.document.capture, editor.state.document.scene, key_.grid, key_.frusta, key_.view, {}};
    if (wanted.frusta && editor.state.document.capture)
        for (const View& view : editor.state.document.capture->views)
            wanted.cameras.push_back(frustumShown(view.camera, eye.position, depth));
    if (wanted == lineKey_) return;
    lineKey_ = wanted;
    std::vector<LineVertex> lines;
    if (wanted.grid && editor.state.document.scene) addGrid(lines, extent);
    for (size_t i = 0; i < wanted.cameras.size(); ++i)
        if (wanted.cameras[i])
            addFrustum(lines, editor.state.document.capture->views[i].camera, depth, int(i) == wanted.view);
    lineVertices_ = lines.size();
    if (lineVertices_) lines_.upload(GL_ARRAY_BUFFER, lines);
}

void ViewportImage::makeOutline(const Editor& editor, const EyeView& eye, float pixelsPerPoint) {
    outlineCount_ = 0;
    job_.outlined = nullptr;
    const auto live = editor.liveFrame();
    if (key_.selected.empty() || !live || !live->emitterOfTriangle || !meshes_[pickSlot_].drawable ||
        meshes_[pickSlot_].geometry.mesh() != live->mesh)
        return;
    std::vector<uint8_t> wanted(live->emitterIds.size(), 0);
    for (size_t i = 0; i < wanted.size(); ++i) wanted[i] = editor.state.selection.has(live->emitterIds[i]);
    std::vector<Triangle> triangles;
    Vec2 low(1e9f), high(-1e9f);
    bool whole = false;
    for (size_t t = 0; t < live->mesh->triangles.size() && t < live->emitterOfTriangle->size(); ++t) {
        const int emitter = (*live->emitterOfTriangle)[t];
        if (emitter < 0 || size_t(emitter) >= wanted.size() || !wanted[size_t(emitter)]) continue;
        if (t < visible_.size() && !visible_[t]) continue;
        triangles.push_back(live->mesh->triangles[t]);
        for (uint32_t v : live->mesh->triangles[t]) {
            const auto at = eye.toScreen(live->mesh->positions[v]);
            if (at) low = glm::min(low, *at), high = glm::max(high, *at);
            else whole = true;
        }
    }
    if (triangles.empty()) return;
    outline_.upload(GL_ARRAY_BUFFER, triangles);
    outlineCount_ = 3 * triangles.size();
    job_.outlined = &meshes_[pickSlot_].geometry;
    job_.outlineIndices = &outline_;
    job_.outlineCount = outlineCount_;
    // In the light's own colour, also where it is off; a black one has none.
    job_.outlineColour = ImageJob().outlineColour;
    if (const EmitterState* active = editor.emitter(editor.state.selection.active()))
        if (const float most = maxChannel(active->radiance); most > 0)
            job_.outlineColour = glm::pow(glm::max(active->radiance / most, Rgb(0.02f)), Rgb(1 / 2.2f));
    job_.outlineRadius = std::clamp(int(std::lround(1.6f * pixelsPerPoint)), 1, 5);
    const Vec2 scale = Vec2(eye.width, eye.height) / eye.size;
    const Vec2 pad(float(job_.outlineRadius + 2));
    Vec2 from = (low - eye.corner) * scale - pad, to = (high - eye.corner) * scale + pad;
    if (whole) from = Vec2(0), to = Vec2(eye.width, eye.height);
    from = glm::clamp(from, Vec2(0), Vec2(eye.width, eye.height)),
    to = glm::clamp(to, Vec2(0), Vec2(eye.width, eye.height));
    job_.outlineBox[0] = int(from.x), job_.outlineBox[1] = std::max(0, eye.height - int(std::ceil(to.y)));
    job_.outlineBox[2] = int(std::ceil(to.x)) - int(from.x), job_.outlineBox[3] = int(std::ceil(to.y)) - int(from.y);
}

EnvironmentLayer ViewportImage::environmentLayer(const std::shared_ptr<const DistantLight>& distant) {
    if (!distant) return {};
    const Backdrop* backdrop = distant->backdrop().get();
    if (backdrop && backdrop->layers.size() == 1) {
        // Turns and colours are the shader's: a panorama goes to the card once.
        const auto& [panorama, weight] = backdrop->layers[0];
        if (panorama != environmentShown_)
            uploadHalf(environment_, panorama->width(), panorama->height(), panorama->halves().data());
        environmentShown_ = panorama;
        return {environment_.id(), backdrop->yawDegrees, weight * panorama->scale() * backdrop->gain, backdrop->sides};
    }
    if (distant != environmentShown_) {
        const int height = backdrop ? 512 : 256, width = 2 * height;  // a mix is drawn anew in every step
        std::vector<Vec4> texels(size_t(width) * size_t(height));
        parallelFor(size_t(height), 8, [&](size_t y) {
            for (int x = 0; x < width; ++x) {
                const Vec2 place((float(x) + 0.5f) / float(width), (float(y) + 0.5f) / float(height));
                const Rgb seen = distant->background(directionFromLatLong(place));
                texels[y * size_t(width) + size_t(x)] = Vec4(glm::clamp(seen, Rgb(0), Rgb(60000)), 1);
            }
        });
        uploadHalf(environment_, width, height, &texels[0].x, true);
        environmentShown_ = distant;
    }
    return {environment_.id()};
}

GLuint ViewportImage::plateTexture() {
    if (!key_.plate || key_.plate->pixels.empty()) return 0;
    if (plateShown_ != key_.plate || plateOpacityShown_ != key_.plateOpacity) {
        const PlateImage& plate = *key_.plate;
        if (key_.plateOpacity < 1) {
            std::vector<Vec4> faded(plate.pixels.size());
            for (size_t p = 0; p < faded.size(); ++p) faded[p] = key_.plateOpacity * plate.at(p);
            uploadHalf(plate_, plate.width, plate.height, &faded[0].x, false);
        } else {
            uploadHalf(plate_, plate.width, plate.height, plate.pixels.data());
        }
        plateShown_ = key_.plate;
        plateOpacityShown_ = key_.plateOpacity;
    }
    return plate_.id();
}

GLuint ViewportImage::restTexture(const std::shared_ptr<const Frame>& frame) {
    if (!frame) return 0;
    if (frame != restShown_) {
        std::vector<Vec4> texels(frame->beauty.size());
        parallelFor(texels.size(), 1 << 14, [&](size_t i) {
            texels[i] = Vec4(glm::clamp(frame->beauty[i], Rgb(0), Rgb(60000)), std::clamp(frame->alpha[i], 0.0f, 1.0f));
        });
        uploadHalf(rest_, frame->width, frame->height, &texels[0].x, false);
        restShown_ = frame;
    }
    return rest_.id();
}

}  // namespace relamp::ui
