#include "viewport/paint.h"

#include "display/vertex_images.h"

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

std::string nameOfPaint(const Editor& editor, Paint paint) {
    if (paint != Paint::irradiance) return {};
    const auto live = editor.liveFrame();
    const int i = live ? irradianceEmitter(editor, *live) : -1;
    return i < 0 ? std::string() : live->emitterIds[size_t(i)];
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
    const std::string estimateMissing = editor.estimate() ? "" : needsEstimate;
    const std::string photographsMissing =
        editor.state.document.samples || viewport.throughView ? "" : "The photographs are being read";
    const std::string distantMissing = editor.distantOnly() ? "" : needsDistant;
    const auto one = [&](Paint paint, const std::string& missing) {
        return std::vector<Strip>{{0, 1, paint, "", missing}};
    };
    switch (viewport.mode) {
        case ViewMode::photograph: return one(Paint::photographs, photographsMissing);
        case ViewMode::relit: return one(Paint::model, "");  // photographs or grey stand in until there is an estimate
        case ViewMode::difference: return one(Paint::difference, estimateMissing);
        case ViewMode::clusters: return one(Paint::clusters, estimateMissing);
        case ViewMode::albedo: return one(Paint::albedo, estimateMissing);
        case ViewMode::confidence: return one(Paint::confidence, estimateMissing);
        case ViewMode::irradiance: {
            const auto live = editor.liveFrame();
            const bool none = editor.estimate() && live && irradianceEmitter(editor, *live) < 0;
            return one(Paint::irradiance, none ? "No light was found or added here" : estimateMissing);
        }
        case ViewMode::correction: {
            const float at = std::clamp(viewport.splitAt, 0.0f, 1.0f);
            return {{0, at, Paint::correction, "Correction, near-field", estimateMissing},
                    {at, 1, Paint::distantCorrection, "Correction, distant-only", distantMissing}};
        }
        case ViewMode::wipe: break;
    }
    const float left = std::clamp(viewport.wipeLeft, 0.0f, 1.0f), right = std::clamp(viewport.wipeRight, left, 1.0f);
    return {{0, left, Paint::photographs, "Photograph", photographsMissing},
            {left, right, Paint::model, "Model, near-field", estimateMissing},
            {right, 1, Paint::distantModel, "Model, distant-only", distantMissing}};
}

PaintKey paintKey(const Editor& editor, Paint paint) {
    const Document& document = editor.state.document;
    PaintKey key;
    key.paint = paint;
    key.scene = document.scene;
    key.live = paint == Paint::distantModel ? editor.distantOnlyFrame() : editor.liveFrame();
    key.estimate = paint == Paint::distantCorrection ? editor.distantOnly() : editor.estimate();
    key.emitter = nameOfPaint(editor, paint);
    if (paint == Paint::photographs || paint == Paint::difference || paint == Paint::model)
        key.samples = document.samples;
    // Through a view the comparison is with that one photograph.
    if (paint == Paint::difference && editor.state.viewport.throughView) key.view = editor.state.selection.view;
    // Colours that do not follow the light need not be made again with every image of it: the mesh is all they take
    // from it.
    const bool followsLight = paint == Paint::model || paint == Paint::distantModel || paint == Paint::difference ||
                              paint == Paint::irradiance;
    if (!followsLight) {
        const auto live = editor.liveFrame();
        key.live = live ? std::shared_ptr<const void>(live->mesh) : nullptr;
    }
    return key;
}

PaintedMesh paintMesh(const Editor& editor, Paint paint) {
    const Document& document = editor.state.document;
    PaintedMesh painted;
    painted.mesh = captureMesh(document);
    if (!painted.mesh) return painted;
    auto live = paint == Paint::distantModel ? editor.distantOnlyFrame() : editor.liveFrame();
    if (!usable(live)) live = nullptr;
    if (live && (live->origin || live->mesh->vertexCount() == painted.mesh->vertexCount()))
        painted.mesh = live->mesh, painted.origin = live->origin;
    const auto estimate = paint == Paint::distantCorrection ? editor.distantOnly() : editor.estimate();
    const auto& samples = document.samples;
    const size_t captured = document.scene->mesh.vertexCount();
    const bool haveSamples = samples && samples->start.size() == captured + 1;
    const bool haveEstimate =
        estimate && !estimate->reflectance.weight.empty() && estimate->reflectance.weight.front().size() == captured;

    const auto linear = [&](std::vector<Rgb> colours, const Rgb& foreign) {
        painted.colours = mapped(std::move(colours), painted, foreign);
    };
    const auto display = [&](std::vector<Rgb> colours) {
        painted.colours = mapped(std::move(colours), painted, foreignGrey);
        painted.display = painted.shading = true;
    };
    const auto plain = [&] {
        painted.colours.assign(painted.mesh->vertexCount(), plainGrey);
        painted.display = painted.shading = true;
    };

    switch (paint) {
        case Paint::model:
        case Paint::distantModel:
            if (live) {
                painted.mesh = live->mesh, painted.origin = live->origin;
                painted.colours = live->radiance;
            } else if (paint == Paint::model && haveSamples) {
                linear(photographColours(*samples), Rgb(0.18f));
            } else {
                plain();
            }
            break;
        case Paint::photographs: haveSamples ? linear(photographColours(*samples), Rgb(0.05f)) : plain(); break;
        case Paint::difference:
            if (haveSamples && live) {
                std::vector<Rgb> model(live->radiance.begin(),
                                       live->radiance.begin() + ptrdiff_t(std::min(captured, live->radiance.size())));
                model.resize(captured, Rgb(0));
                display(differenceColours(model, *samples,
                                          editor.state.viewport.throughView ? editor.state.selection.view : -1));
            } else {
                plain();
            }
            break;
        case Paint::clusters: haveEstimate ? display(clusterColours(*estimate)) : plain(); break;
        case Paint::correction:
        case Paint::distantCorrection:
            if (haveEstimate) {
                linear(correctionColours(*estimate), Rgb(0.18f));
                painted.shading = true;
            } else {
                plain();
            }
            break;
        case Paint::albedo: haveEstimate ? linear(albedoColours(*estimate), Rgb(0.18f)) : plain(); break;
        case Paint::confidence: haveEstimate ? display(confidenceColours(*estimate)) : plain(); break;
        case Paint::irradiance: {
            const int i = live ? irradianceEmitter(editor, *live) : -1;
            if (i >= 0 && live->formFactor[size_t(i)].size() == live->mesh->vertexCount() &&
                size_t(i) < live->emitterRadiance.size()) {
                painted.mesh = live->mesh, painted.origin = live->origin;
                painted.colours = irradianceColours(live->formFactor[size_t(i)], live->emitterRadiance[size_t(i)]);
                // The emitter itself shows what it sends.
                if (live->emitterOfTriangle && live->emitterOfTriangle->size() == live->mesh->triangles.size())
                    for (size_t t = 0; t < live->mesh->triangles.size(); ++t)
                        if ((*live->emitterOfTriangle)[t] == i)
                            for (uint32_t v : live->mesh->triangles[t])
                                painted.colours[v] = live->emitterRadiance[size_t(i)];
            } else {
                plain();
            }
            break;
        }
    }
    painted.colours.resize(painted.mesh->vertexCount(), foreignGrey);
    return painted;
}

}  // namespace relamp::ui
