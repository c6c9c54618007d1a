#include "viewport/paint.h"

#include <algorithm>

#include "display/vertex_images.h"
#include "viewport/navigation.h"

namespace relamp::ui {
namespace {

const std::string needsEstimate = "Needs an estimate: press Ctrl+Enter";
const std::string needsDistant = "Needs the distant-only estimate: menu Light, Estimate with distant light only";
const Rgb plainGrey(0.42f), foreignGrey(0.30f);

/// The capture's mesh as its own shared pointer.
std::shared_ptr<const Mesh> captureMesh(const Document& document) {
    return document.scene ? std::shared_ptr<const Mesh>(document.scene, &document.scene->mesh) : nullptr;
}

/// Colours of the capture's vertices, taken over to the live frame's vertices. Shapes that were added get `foreign`.
std::vector<Rgb> mapped(std::vector<Rgb> colours, const PaintedMesh& painted, const Rgb& foreign) {
    const size_t count = painted.mesh->vertexCount();
    if (!painted.origin) {
        colours.resize(count, foreign);
        return colours;
    }
    std::vector<Rgb> out(count, foreign);
    for (size_t v = 0; v < count && v < painted.origin->size(); ++v)
        if ((*painted.origin)[v] < colours.size()) out[v] = colours[(*painted.origin)[v]];
    return out;
}

bool usable(const std::shared_ptr<const LiveFrame>& live) {
    return live && live->mesh && live->radiance.size() == live->mesh->vertexCount();
}

/// Id of the emitter that is shown alone; empty: none.
std::string shownEmitter(const Editor& editor) {
    const auto live = editor.liveFrame();
    const int i = live ? irradianceEmitter(editor, *live) : -1;
    return i < 0 ? std::string() : live->emitterIds[size_t(i)];
}

/// What to do about what a strip needs; empty: it is there.
std::string missingFor(const Editor& editor, Needs needs) {
    std::string estimateMissing = editor.estimate() ? "" : needsEstimate;
    switch (needs) {
        case Needs::nothing: break;
        case Needs::photographs:
            return editor.state.document.samples || looksThrough(editor) ? "" : "The photographs are being read";
        case Needs::estimate: return estimateMissing;
        case Needs::distantEstimate: return editor.distantOnly() ? "" : needsDistant;
        case Needs::emitter: {
            const auto live = editor.liveFrame();
            const bool none = editor.estimate() && live && irradianceEmitter(editor, *live) < 0;
            return none ? "No light was found or added here" : estimateMissing;
        }
    }
    return {};
}

}  // namespace

int irradianceEmitter(const Editor& editor, const LiveFrame& live) {
    const size_t count = std::min(live.emitterIds.size(), live.formFactor.size());
    const std::string active = editor.state.selection.active();
    for (size_t i = 0; i < count; ++i)
        if (live.emitterIds[i] == active) return int(i);
    return count ? 0 : -1;
}

std::vector<Strip> stripsOf(const Editor& editor) {
    const ViewportState& viewport = editor.state.viewport;
    const ViewModeInfo& mode = infoOf(viewport.mode);
    std::vector<Strip> strips;
    float left = 0;
    for (size_t i = 0; i < mode.strips.size(); ++i) {
        const StripInfo& info = mode.strips[i];
        const float right = i < mode.dividers.size() ? std::clamp(viewport.*mode.dividers[i], left, 1.0f) : 1.0f;
        std::string caption = info.caption;
        if (info.paint == Paint::before)
            caption = viewport.compareWith < 0 ? "As recovered"
                                               : fmt::format("Snapshot {}", char('A' + viewport.compareWith));
        strips.push_back({left, right, info.paint, std::move(caption), missingFor(editor, info.needs)});
        left = right;
    }
    return strips;
}

namespace {

/// What painters read; null where it is missing or does not fit the capture's mesh.
struct PaintSource {
    const Editor& editor;
    std::shared_ptr<const LiveFrame> live;
    std::shared_ptr<const Estimate> estimate;
    std::shared_ptr<const RadianceSamples> samples;
    size_t captured = 0;  ///< vertices of the capture
};

/// Scene-linear colours of the capture's vertices.
bool linear(PaintedMesh& painted, std::vector<Rgb> colours, const Rgb& foreign) {
    painted.colours = mapped(std::move(colours), painted, foreign);
    return true;
}

/// Colours for the screen.
bool display(PaintedMesh& painted, std::vector<Rgb> colours) {
    painted.colours = mapped(std::move(colours), painted, foreignGrey);
    painted.display = painted.shading = true;
    return true;
}

bool paintPhotographs(const PaintSource& from, PaintedMesh& painted) {
    if (!from.samples) return false;
    const std::shared_ptr<const CaptureCheck>& check = from.editor.state.document.check;
    const MeshColours* own = check ? check->meshColours.get() : nullptr;
    return linear(painted, photographColours(*from.samples, -1, own), Rgb(0.05f));
}

bool paintLive(const PaintSource& from, PaintedMesh& painted) {
    if (!from.live) return false;
    painted.mesh = from.live->mesh, painted.origin = from.live->origin;
    painted.colours = from.live->radiance;
    return true;
}

bool paintModel(const PaintSource& from, PaintedMesh& painted) {
    return paintLive(from, painted) || (from.samples && linear(painted, photographColours(*from.samples), Rgb(0.18f)));
}

bool paintDifference(const PaintSource& from, PaintedMesh& painted) {
    if (!from.samples || !from.live) return false;
    const std::vector<Rgb>& radiance = from.live->radiance;
    std::vector<Rgb> model(radiance.begin(), radiance.begin() + ptrdiff_t(std::min(from.captured, radiance.size())));
    model.resize(from.captured, Rgb(0));
    const EditorState& state = from.editor.state;
    return display(painted,
                   differenceColours(model, *from.samples, state.viewport.throughView ? state.selection.view : -1));
}

bool paintClusters(const PaintSource& from, PaintedMesh& painted) {
    return from.estimate && display(painted, clusterColours(*from.estimate));
}

bool paintCorrection(const PaintSource& from, PaintedMesh& painted) {
    if (!from.estimate) return false;
    painted.shading = true;
    return linear(painted, correctionColours(*from.estimate), Rgb(0.18f));
}

bool paintAlbedo(const PaintSource& from, PaintedMesh& painted) {
    return from.estimate && linear(painted, albedoColours(*from.estimate), Rgb(0.18f));
}

bool paintConfidence(const PaintSource& from, PaintedMesh& painted) {
    return from.estimate && display(painted, confidenceColours(*from.estimate));
}

bool paintIrradiance(const PaintSource& from, PaintedMesh& painted) {
    const auto& live = from.live;
    const int i = live ? irradianceEmitter(from.editor, *live) : -1;
    if (i < 0 || live->formFactor[size_t(i)].size() != live->mesh->vertexCount() ||
        size_t(i) >= live->emitterRadiance.size())
        return false;
    painted.mesh = live->mesh, painted.origin = live->origin;
    painted.colours = irradianceColours(live->formFactor[size_t(i)], live->emitterRadiance[size_t(i)]);
    // The emitter itself shows its radiance.
    if (live->emitterOfTriangle && live->emitterOfTriangle->size() == live->mesh->triangles.size())
        for (size_t t = 0; t < live->mesh->triangles.size(); ++t)
            if ((*live->emitterOfTriangle)[t] == i)
                for (uint32_t v : live->mesh->triangles[t]) painted.colours[v] = live->emitterRadiance[size_t(i)];
    return true;
}

/// One row a paint: how it is painted, and what its colours depend on.
struct PaintInfo {
    Paint paint;
    bool (*painter)(const PaintSource&, PaintedMesh&);  ///< false: something is missing, the mesh is shown in grey
    bool followsLight = false;  ///< with every image of the light; else the mesh is all it takes from it
    bool ofSamples = false;     ///< what the photographs say of the vertices
    bool ofView = false;        ///< through a view it compares with that one photograph
    bool ofEmitter = false;     ///< the active emitter
    bool distantFrame = false, distantEstimate = false;  ///< from the distant-only estimate instead
    bool beforeFrame = false;                            ///< of the look that is compared with
};

/// The light that a paint shows.
std::shared_ptr<const LiveFrame> frameOf(const Editor& editor, const PaintInfo& info) {
    return info.distantFrame ? editor.distantOnlyFrame() : info.beforeFrame ? editor.beforeFrame() : editor.liveFrame();
}

const PaintInfo paints[] = {
    {.paint = Paint::photographs, .painter = paintPhotographs, .ofSamples = true},
    {.paint = Paint::model, .painter = paintModel, .followsLight = true, .ofSamples = true},
    {.paint = Paint::distantModel, .painter = paintLive, .followsLight = true, .distantFrame = true},
    {.paint = Paint::difference, .painter = paintDifference, .followsLight = true, .ofSamples = true, .ofView = true},
    {.paint = Paint::clusters, .painter = paintClusters},
    {.paint = Paint::correction, .painter = paintCorrection},
    {.paint = Paint::distantCorrection, .painter = paintCorrection, .distantEstimate = true},
    {.paint = Paint::albedo, .painter = paintAlbedo},
    {.paint = Paint::confidence, .painter = paintConfidence},
    {.paint = Paint::irradiance, .painter = paintIrradiance, .followsLight = true, .ofEmitter = true},
    {.paint = Paint::before, .painter = paintLive, .followsLight = true, .beforeFrame = true},
};

const PaintInfo& infoOf(Paint paint) {
    return *std::find_if(std::begin(paints), std::end(paints), [&](const PaintInfo& p) { return p.paint == paint; });
}

}  // namespace

PaintKey paintKey(const Editor& editor, Paint paint) {
    const PaintInfo& info = infoOf(paint);
    const Document& document = editor.state.document;
    PaintKey key;
    key.paint = paint;
    key.scene = document.scene;
    key.live = frameOf(editor, info);
    key.estimate = info.distantEstimate ? editor.distantOnly() : editor.estimate();
    if (info.ofEmitter) key.emitter = shownEmitter(editor);
    if (info.ofSamples) key.samples = document.samples;
    if (info.ofView && editor.state.viewport.throughView) key.view = editor.state.selection.view;
    if (!info.followsLight) {
        const auto live = editor.liveFrame();
        key.live = live ? std::shared_ptr<const void>(live->mesh) : nullptr;
    }
    return key;
}

PaintedMesh paintMesh(const Editor& editor, Paint paint) {
    const PaintInfo& info = infoOf(paint);
    const Document& document = editor.state.document;
    PaintedMesh painted;
    painted.mesh = captureMesh(document);
    if (!painted.mesh) return painted;
    PaintSource from{editor, frameOf(editor, info), info.distantEstimate ? editor.distantOnly() : editor.estimate(),
                     document.samples, document.scene->mesh.vertexCount()};
    if (!usable(from.live)) from.live = nullptr;
    if (from.live && (from.live->origin || from.live->mesh->vertexCount() == painted.mesh->vertexCount()))
        painted.mesh = from.live->mesh, painted.origin = from.live->origin;
    if (from.samples && from.samples->start.size() != from.captured + 1) from.samples = nullptr;
    if (from.estimate &&
        (from.estimate->reflectance.lobes() == 0 || from.estimate->reflectance.vertexCount() != from.captured))
        from.estimate = nullptr;
    if (!info.painter(from, painted)) {
        painted.colours.assign(painted.mesh->vertexCount(), plainGrey);
        painted.display = painted.shading = true;
    }
    painted.colours.resize(painted.mesh->vertexCount(), foreignGrey);
    return painted;
}

}  // namespace relamp::ui
