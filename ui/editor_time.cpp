// Keys of the look, the frame that is shown, and playing.
#include "edit/look_keys.h"
#include "editor_impl.h"

namespace relamp::ui {
namespace {

size_t bytesOf(const LiveFrame& frame) {
    size_t bytes = (frame.radiance.size() + frame.distantMatte.size()) * sizeof(Rgb);
    for (const auto& factors : frame.formFactor) bytes += factors.size() * sizeof(float);
    return bytes;
}

/// Of sorted frames; the present one where there is none on that side.
int nextOf(const std::vector<int>& frames, int frame, int direction) {
    if (direction > 0) {
        const auto after = std::upper_bound(frames.begin(), frames.end(), frame);
        return after == frames.end() ? frame : *after;
    }
    const auto at = std::lower_bound(frames.begin(), frames.end(), frame);
    return at == frames.begin() ? frame : *std::prev(at);
}

}  // namespace

LookPivots Editor::pivots() const {
    LookPivots pivots;
    pivots.emitter = [estimate = estimate()](const std::string& id) {
        if (estimate)
            for (const EmitterCluster& e : estimate->emitters.emitters)
                if (e.id == id) return e.centroid;
        return Vec3(0);
    };
    pivots.vertex = [scene = state.document.scene](uint32_t v) {
        return scene && v < scene->mesh.vertexCount() ? scene->mesh.positions[v] : Vec3(0);
    };
    return pivots;
}

const Look& Editor::look() const {
    const Look& now = history().present().look;
    if ((now.keys.empty() && now.curves.empty()) || inGesture()) return now;
    if (impl_->timedRevision != history().revision() || impl_->timedFrame != state.time.frame) {
        impl_->timed = LookTrack(now).at(state.time.frame, pivots());
        impl_->timed.keys = now.keys;
        impl_->timed.curves = now.curves;
        impl_->timed.plate = now.plate;
        impl_->timed.bookmarks = now.bookmarks;
        impl_->timedRevision = history().revision();
        impl_->timedFrame = state.time.frame;
    }
    return impl_->timed;
}

void Editor::setKey() {
    edit(fmt::format("Set key at frame {}", state.time.frame),
         [&](Look& look) { relamp::setKey(look, state.time.frame); });
}
void Editor::deleteKey(int frame) {
    if (keyAt(look(), frame) < 0) return;
    Look left = look();
    relamp::deleteKey(left, frame);
    // The last key leaves the look behind as it is shown.
    impl_->history.pushLook(fmt::format("Delete key at frame {}", frame), std::move(left));
}
void Editor::moveKey(int from, int to) {
    if (keyAt(look(), from) < 0 || from == to) return;
    Look moved = look();
    relamp::moveKey(moved, from, to);
    impl_->history.pushLook(fmt::format("Move key from frame {} to {}", from, to), std::move(moved));
}
void Editor::easeKey(int frame, KeyEase ease) {
    Look eased = look();
    relamp::easeKey(eased, frame, ease);
    constexpr const char* names[] = {"Linear", "Smooth", "Hold"};
    impl_->history.pushLook(fmt::format("{} from frame {}", names[int(ease)], frame), std::move(eased));
}

void Editor::goToFrame(int frame) {
    if (inGesture()) return;
    state.time.frame = std::clamp(frame, 0, 100'000'000);
}

void Editor::goToKey(int direction) { goToFrame(nextOf(keyFrames(look()), state.time.frame, direction)); }

void Editor::setValueKeys(const std::vector<KeyedOf>& values) {
    edit(fmt::format("Set key of {} at frame {}", values.empty() ? "" : infoOf(values.front().value).label,
                     state.time.frame),
         [&](Look& look) {
             for (const KeyedOf& value : values) setValueKey(look, value, state.time.frame, pivots());
         });
}

void Editor::deleteValueKeys(const std::vector<KeyedOf>& values, int frame) {
    edit(frame < 0 ? "Delete keys" : fmt::format("Delete key at frame {}", frame), [&](Look& look) {
        for (const KeyedOf& value : values)
            if (frame >= 0) deleteValueKey(look, value, frame);
            else std::erase_if(look.curves, [&](const ValueCurve& curve) { return curve.what == value; });
    });
}

void Editor::goToValueKey(const KeyedOf& value, int direction) {
    const ValueCurve* curve = curveOf(look(), value);
    if (!curve) return;
    std::vector<int> frames;
    for (const ValueKey& key : curve->keys) frames.push_back(key.frame);
    goToFrame(nextOf(frames, state.time.frame, direction));
}

void Editor::play(bool on) {
    if (on == state.time.playing || (on && (inGesture() || !estimate()))) return;
    TimeState& time = state.time;
    if (on && (time.frame < time.first || time.frame >= time.last)) time.frame = time.first;
    time.playing = on;
    impl_->playback.shown = nullptr;
    impl_->playback.since = 0;
}

bool Editor::frameKept(int frame) const {
    return impl_->playback.revision == history().revision() && impl_->playback.kept.count(frame) > 0;
}

int64_t Editor::Impl::timeTag() const { return int64_t(history.revision()) << 27 | self.state.time.frame; }

bool Editor::Impl::pollPlayback(const RelightRequest& request) {
    TimeState& time = self.state.time;
    if (!time.playing) return false;
    if (history.inGesture() || !request.estimate) {
        self.play(false);
        return false;
    }
    Playback& p = playback;
    RelightRequest of = request;
    of.look = {};
    // A plate's camera is where it is in each frame.
    const bool throughPlate = self.plateCamera() != nullptr;
    if (throughPlate) of.eye.worldFromCamera = DMat4(1);
    if (p.revision != history.revision() || p.solo != self.state.viewport.solo || !sameImage(p.of, of)) {
        p = {};
        p.revision = history.revision();
        p.solo = self.state.viewport.solo;
        p.of = of;
    }
    const auto show = [&](const std::shared_ptr<const LiveFrame>& image) {
        p.shown = image;
        p.shownFrame = time.frame;
        p.since = seconds();
    };
    if (p.shownFrame != time.frame) {
        if (throughPlate && !plates.ready()) return false;
        const RelitImage made = relight.frame();
        if (const auto kept = p.kept.find(time.frame); kept != p.kept.end()) {
            show(kept->second);
        } else if (made.image && made.time == timeTag()) {
            show(made.image);
            if (const size_t bytes = bytesOf(*made.image); p.bytes + bytes <= time.keptBytes()) {
                p.kept[time.frame] = made.image;
                p.bytes += bytes;
            }
        } else {
            return false;
        }
    }
    if (seconds() - p.since < 1 / std::max(1.0, time.framesPerSecond)) return true;
    if (time.frame < time.last) ++time.frame;
    else if (time.loop) time.frame = time.first;
    else self.play(false);
    return true;  // the next poll asks for it
}

}  // namespace relamp::ui
