#include "editor.h"

#include <algorithm>
#include <ctime>
#include <map>
#include <utility>

#include "base/is_there.h"
#include "base/local_time.h"
#include "base/log.h"
#include "edit/link_edits.h"
#include "edit/look_keys.h"
#include "editor_impl.h"
#include "interrupted.h"
#include "settings.h"
#include "viewport/gpu_devices.h"

namespace relamp::ui {
namespace fs = std::filesystem;

Look lookThatFits(const Look& look, const Estimate& estimate, size_t vertices) {
    const auto known = [&](const std::string& id) {
        return std::any_of(estimate.emitters.emitters.begin(), estimate.emitters.emitters.end(),
                           [&](const EmitterCluster& c) { return c.id == id; });
    };
    Look out = look;
    eachLook(out, [&](Look& one) {
        std::erase_if(one.emitters, [&](const EmitterLook& e) { return !known(e.id); });
        std::erase_if(one.added, [&](const AddedEmitter& e) {
            const auto geometry = infoOf(e.shape).geometry;
            return (geometry == EmitterShapeInfo::Geometry::emitter && !known(e.source)) ||
                   (geometry == EmitterShapeInfo::Geometry::component && e.seedVertex >= vertices);
        });
        std::erase_if(one.parts, [&](const PartLook& p) { return p.seedVertex >= vertices; });
        for (EmitterLook& e : one.emitters) e.link = linkThatFits(e.link, vertices);
        for (AddedEmitter& e : one.added) e.link = linkThatFits(e.link, vertices);
        dropMembers(one.groups, [&](const std::string& id) {
            return !known(id) &&
                   std::none_of(one.added.begin(), one.added.end(), [&](const AddedEmitter& e) { return e.id == id; });
        });
    });
    std::erase_if(out.curves, [&](const ValueCurve& curve) {
        bool there = !infoOf(curve.what.value).ofLight() || known(curve.what.of);
        eachLook(out, [&](const Look& one) {
            there = there || std::any_of(one.added.begin(), one.added.end(),
                                         [&](const AddedEmitter& e) { return e.id == curve.what.of; });
        });
        return !there;
    });
    return out;
}

namespace {

/// Run by a relighting thread, which keeps what it gets.
std::function<LiveDevices()> devicesFor(EditorOptions::Gpu gpu) {
    if (gpu == EditorOptions::Gpu::off) return {};
    return [force = gpu == EditorOptions::Gpu::on] {
        std::string why;
        LiveDevices devices = makeGpuDevices(force, &why);
        if (!devices.near && force) logWarning("Light stays on the processor: no graphics card can do it: {}", why);
        return devices;
    };
}

}  // namespace

Editor::Impl::Impl(Editor& editor, EditorOptions editorOptions)
    : self(editor),
      options(std::move(editorOptions)),
      relight(options.wake, devicesFor(options.gpu), options.gpu == EditorOptions::Gpu::on),
      relightDistant(options.wake, devicesFor(options.gpu), options.gpu == EditorOptions::Gpu::on),
      relightBefore(options.wake),
      plates(options.wake),
      relitPlates(options.wake),
      autosave(options.stateFolder) {}

Editor::Editor(EditorOptions options) : impl_(std::make_unique<Impl>(*this, std::move(options))) {
    loadSettings(impl_->options.configFolder, state);
    setLogSink([impl = impl_.get()](LogLevel level, const std::string& line) {
        const std::time_t now = std::time(nullptr);
        std::tm parts{};
        localtime_r(&now, &parts);
        char time[16];
        std::strftime(time, sizeof time, "%H:%M:%S", &parts);
        std::lock_guard lock(impl->logMutex);
        impl->newLog.push_back({level, time, line});
    });
    impl_->lost = impl_->autosave.findLost();
    impl_->offerLostWork();
    if (const auto found = findInterrupted(impl_->options.stateFolder); !found.empty())
        state.interrupted = found.front();
}

Editor::~Editor() {
    if (impl_->job) impl_->job->progress().requestStop();
    impl_->job.reset();
    if (impl_->saving && !impl_->quit) {
        // Not closed by the user: what was being put away is to be found again.
        try {
            impl_->saving->take()();
        } catch (const std::exception&) {
            // Then what is on disk already has to do.
        }
    }
    impl_->saving.reset();
    if (impl_->quit) {
        impl_->autosave.clear();
        if (impl_->restored) Autosave::discard(*impl_->restored);
    }
    saveSettings(impl_->options.configFolder, state);
    setLogSink({});
}

// ---- the look

const History& Editor::history() const { return impl_->history; }
std::shared_ptr<const Estimate> Editor::estimate() const {
    return impl_->snapshot ? impl_->snapshot : history().present().estimate;
}

void Editor::edit(const std::string& label, const std::function<void(Look&)>& change) {
    if (!estimate()) return;
    const Look& before = this->look();
    Look look = before;
    change(look);
    if (look == before) return;
    keyEdit(before, look, state.time.frame, pivots());
    impl_->history.pushLook(label, std::move(look));
}

void Editor::beginGesture(const std::string& label) {
    if (!estimate()) return;
    const Look from = look();
    impl_->history.begin(label, &from);
}
void Editor::preview(const std::function<void(Look&)>& change) {
    if (!inGesture()) return;
    Look look = history().gestureStart();
    change(look);
    keyEdit(history().gestureStart(), look, state.time.frame, pivots());
    impl_->history.preview(std::move(look));
}
void Editor::commitGesture() { impl_->history.commit(); }
void Editor::abandonGesture() { impl_->history.abandon(); }
void Editor::undo() {
    if (inGesture()) impl_->history.undo();
    else if (history().canUndo()) return goTo(history().index() - 1);
    impl_->forgetLostLights();
}
void Editor::redo() {
    if (!inGesture() && history().canRedo()) goTo(history().index() + 1);
}
void Editor::goTo(size_t entry) { impl_->goToEntry(entry); }

void Editor::Impl::forgetLostLights() {
    const auto gone = [this](const std::string& id) { return !self.emitter(id); };
    std::erase_if(self.state.selection.emitters, gone);
    std::erase_if(self.state.viewport.solo, gone);
}

const std::vector<EmitterState>& Editor::emitters() const {
    const std::shared_ptr<const Estimate> shown = estimate();
    if (impl_->emittersRevision != history().revision() || impl_->emittersFrame != state.time.frame ||
        impl_->emittersOfEstimate != shown) {
        impl_->emitters = shown && state.document.scene ? emittersOf(*state.document.scene, *shown, look())
                                                        : std::vector<EmitterState>{};
        nameForPeople(impl_->emitters, look());
        impl_->emittersRevision = history().revision();
        impl_->emittersFrame = state.time.frame;
        impl_->emittersOfEstimate = shown;
    }
    return impl_->emitters;
}

const EmitterState* Editor::emitter(const std::string& id) const {
    for (const EmitterState& e : emitters())
        if (e.id == id) return &e;
    return nullptr;
}

std::string shownName(const std::string& id) {
    const size_t dash = id.rfind('-');
    if (dash == std::string::npos || dash == 0) return id;
    const std::string stem = id.substr(0, dash), number = id.substr(dash + 1);
    if (number.empty() || number.find_first_not_of("0123456789") != std::string::npos) return id;
    if (stem == "emitter") return "Light " + number;
    std::string name = stem == "part" ? "Object light" : stem;
    if (name[0] >= 'a' && name[0] <= 'z') name[0] = char(name[0] - 'a' + 'A');
    return name + " " + number;
}

void nameForPeople(std::vector<EmitterState>& emitters, const Look& look) {
    const auto fresh = [](EmitterState& e) { return e.name == e.id; };
    for (EmitterState& e : emitters)
        if (fresh(e)) e.name = shownName(e.id);
    // Copies are called after what they were made from.
    std::map<std::string, int> copies;
    for (EmitterState& e : emitters) {
        if (e.recovered || size_t(e.index) >= look.added.size()) continue;
        const AddedEmitter& added = look.added[size_t(e.index)];
        if (!added.name.empty() || added.source.empty()) continue;
        const auto source = std::find_if(emitters.begin(), emitters.end(),
                                         [&](const EmitterState& other) { return other.id == added.source; });
        if (source == emitters.end()) continue;
        const int n = ++copies[added.source];
        e.name = source->name + " copy" + (n > 1 ? fmt::format(" {}", n) : std::string());
    }
}

std::string Editor::namesOf(const std::vector<std::string>& ids) const {
    if (ids.size() != 1) return fmt::format("{} lights", ids.size());
    const EmitterState* known = emitter(ids[0]);
    return known ? known->name : ids[0];
}

// ---- the image

// ---- snapshots of the look

void Editor::storeSnapshot(size_t which) {
    if (!estimate() || which >= state.snapshots.size()) return;
    state.snapshots[which] = LookSnapshot{look(), localTime().substr(11, 5)};
    state.snapshots[which]->look.plate.reset();
    state.snapshots[which]->look.bookmarks.clear();
    ++impl_->changesBeside;
    say(fmt::format("The present look is snapshot {}", char('A' + which)));
}

void Editor::recallSnapshot(size_t which) {
    if (!estimate() || which >= state.snapshots.size() || !state.snapshots[which]) return;
    const size_t before = history().index();
    edit(fmt::format("Snapshot {}", char('A' + which)), [&](Look& look) {
        Look recalled = state.snapshots[which]->look;
        recalled.plate = look.plate;
        recalled.bookmarks = look.bookmarks;
        look = std::move(recalled);
    });
    if (history().index() == before) say(fmt::format("The present look is snapshot {} already", char('A' + which)));
    std::erase_if(state.selection.emitters, [&](const std::string& id) { return !emitter(id); });
}

std::shared_ptr<const LiveFrame> Editor::liveFrame() const {
    return state.time.playing && impl_->playback.shown ? impl_->playback.shown : impl_->relight.frame().image;
}
std::shared_ptr<const LiveFrame> Editor::distantOnlyFrame() const { return impl_->relightDistant.frame().image; }
std::shared_ptr<const LiveFrame> Editor::beforeFrame() const { return impl_->relightBefore.frame().image; }
std::shared_ptr<const Frame> Editor::restFrame() const { return impl_->relight.restFrame(); }
bool Editor::refining() const {
    return impl_->relight.working() || impl_->relightDistant.working() || impl_->relightBefore.working();
}

bool Editor::imageOwed() const { return impl_->relight.imageOwed(); }

void Editor::setEye(const Camera& eye, bool orthographic) {
    impl_->eye = eye;
    impl_->orthographic = orthographic;
}

void Editor::pick(const std::optional<PickedPoint>& point) {
    state.selection.point = point;
    state.pointLight.reset();
    if (point) ++impl_->pickSerial;
}

Look Editor::Impl::shownLook(const Estimate& estimate) const {
    Look look = lookThatFits(self.look(), estimate,
                             self.state.document.scene ? self.state.document.scene->mesh.vertexCount() : 0);
    look.keys.clear();
    look.curves.clear();
    look.plate.reset();
    look.bookmarks.clear();
    const std::vector<std::string>& solo = self.state.viewport.solo;
    if (!solo.empty()) {
        const auto alone = [&](const std::string& id) { return std::find(solo.begin(), solo.end(), id) != solo.end(); };
        for (const EmitterCluster& c : estimate.emitters.emitters)
            if (!alone(c.id)) setEnabled(look, c.id, false);
        for (AddedEmitter& added : look.added)
            if (!alone(added.id)) added.enabled = false;
    }
    return look;
}

void Editor::Impl::pollImage() {
    const std::shared_ptr<const Estimate> estimate = self.estimate();
    RelightRequest request;
    if (estimate && self.state.document.scene) {
        request.scene = self.state.document.scene;
        request.estimate = estimate;
        request.look = shownLook(*estimate);
        request.eye = eye;
        // The eye follows the frame at once, before the viewport is drawn anew.
        if (const Camera* camera = self.plateCamera()) request.eye.worldFromCamera = camera->worldFromCamera;
        request.orthographic = orthographic;
        request.cacheFolder = options.cacheFolder;
        request.restImage = eye.width > 0 && eye.height > 0 && infoOf(self.state.viewport.mode).restImage &&
                            !history.inGesture() && !job && !self.state.time.playing && !self.state.time.scrubbing;
        request.region = self.state.viewport.region;
        request.dragging = history.inGesture() || self.state.time.playing || self.state.time.scrubbing;
        request.time = timeTag();
        if (self.state.selection.point) {
            request.pickSerial = pickSerial;
            request.pickTriangle = self.state.selection.point->triangle;
            request.pickBarycentric = self.state.selection.point->barycentric;
        }
    }
    if (!pollPlayback(request)) relight.request(std::move(request));
    RelightRequest distant;
    const std::shared_ptr<const Estimate> distantOnly = self.distantOnly();
    if (distantOnly && self.state.document.scene && infoOf(self.state.viewport.mode).shows(Paint::distantModel)) {
        distant.scene = self.state.document.scene;
        distant.estimate = distantOnly;
        distant.look.environment = self.look().environment;
        distant.eye = eye;
        distant.orthographic = orthographic;
        relightDistant.request(std::move(distant));
    } else if (!distantOnly) {
        relightDistant.clear();
    }
    RelightRequest before;
    if (estimate && self.state.document.scene && infoOf(self.state.viewport.mode).shows(Paint::before)) {
        before.scene = self.state.document.scene;
        before.estimate = estimate;
        const int with = self.state.viewport.compareWith;
        if (with >= 0 && size_t(with) < self.state.snapshots.size() && self.state.snapshots[size_t(with)])
            before.look = lookThatFits(self.state.snapshots[size_t(with)]->look, *estimate,
                                       self.state.document.scene->mesh.vertexCount());
        before.eye = eye;
        before.orthographic = orthographic;
        before.cacheFolder = options.cacheFolder;
        relightBefore.request(std::move(before));
    } else if (!estimate) {
        relightBefore.clear();
    }
    if (self.state.selection.point)
        if (std::optional<PointLight> light = relight.takePointLight(pickSerial))
            self.state.pointLight = std::move(light);
    for (const std::string& error : {relight.takeError(), relightDistant.takeError(), relightBefore.takeError()})
        if (!error.empty()) {
            self.fail("The edit could not be shown", error, "The edit stays; undo it with Ctrl+Z or change it.");
            if (!self.state.notices.empty()) self.state.notices.back().ofAnEdit = true;
        }
}

// ---- once a frame

bool Editor::busy() const {
    return impl_->job || impl_->saving || state.time.playing || refining() || impl_->plateOpening ||
           (plateCamera() && impl_->plates.working()) || impl_->relitPlates.working();
}

const std::filesystem::path& Editor::configFolder() const { return impl_->options.configFolder; }

void Editor::requestImage() { impl_->pollImage(); }

void Editor::poll() {
    {
        std::lock_guard lock(impl_->logMutex);
        for (LogEntry& entry : impl_->newLog) state.log.push_back(std::move(entry));
        impl_->newLog.clear();
        if (state.log.size() > 2000) state.log.erase(state.log.begin(), state.log.end() - 1500);
    }
    impl_->takeSnapshots();
    impl_->pollJob();
    impl_->pollSaving();
    impl_->pollPlate();
    impl_->pollImage();
    impl_->pollAutosave();
}

void Editor::log(LogLevel level, const std::string& text) { logLine(level, text); }

void Editor::say(const std::string& text) {
    state.message = text;
    ++state.messages;
    logLine(LogLevel::info, text);
}

void Editor::fail(const std::string& title, const std::string& text, const std::string& advice) {
    logLine(LogLevel::warning, title + ": " + text);
    // The same trouble again needs no second dialog.
    for (const Notice& notice : state.notices)
        if (notice.text == text) return;
    state.notices.push_back({title, text, advice});
}

}  // namespace relamp::ui
