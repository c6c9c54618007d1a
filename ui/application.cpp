#include "application.h"

#include <chrono>
#include <cstdio>
#include <deque>
#include <memory>
#include <utility>

#include "actions.h"
#include "base/log.h"
#include "capture/capture_formats.h"
#include "editor.h"
#include "gui.h"
#include "item_map.h"
#include "keys.h"
#include "layout.h"
#include "panels/panels.h"
#include "thumbnails.h"
#include "viewport/viewport.h"
#include "widgets.h"
#include "window.h"

namespace relamp::ui {
namespace {
namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

double secondsSince(Clock::time_point time) { return std::chrono::duration<double>(Clock::now() - time).count(); }

/// $VARIABLE/relamp, or ~/FALLBACK/relamp.
fs::path userFolder(const char* variable, const char* fallback) {
    if (const char* set = std::getenv(variable); set && *set == '/') return fs::path(set) / "relamp";
    if (const char* home = std::getenv("HOME"); home && *home) return fs::path(home) / fallback / "relamp";
    return fs::temp_directory_path() / "relamp";
}

/// Keys wait here: one a frame, so that quick typing arrives in order.
class KeyQueue {
public:
    /// Keys that came while a text field had the keyboard are its own.
    void add(std::vector<KeyPress> keys, const Gui& gui) {
        if (gui.typing()) return;
        for (KeyPress& key : keys) queue_.push_back(std::move(key));
    }
    bool waiting() const { return !queue_.empty(); }
    /// Hands the next key to a command or to the viewport.
    void deliver(Editor& editor, const Gui& gui, const Viewport* viewport) {
        input().pressed = 0;
        input().typed.clear();
        if (queue_.empty()) return;
        const KeyPress key = queue_.front();
        queue_.pop_front();
        if (key.key == keyEscape && gui.escapeUsed()) return;
        // As they were when the key went down: by now they may be up again.
        input().control = key.control, input().shift = key.shift, input().alt = key.alt;
        const bool ofADrag = viewport && viewport->takesEscape() && key.key == keyEscape;
        if (!gui.popupOpen() && !dialogOpen(editor) && !editor.inGesture() && key.key && !ofADrag &&
            runKey(editor, {key.key, key.control, key.shift, key.alt}))
            return;
        input().pressed = key.key;
        input().typed = key.text;
    }

private:
    std::deque<KeyPress> queue_;
};

/// What is still to be drawn.
struct Pending {
    int extraFrames = 3;    ///< the interface settles over some frames
    bool heldBack = false;  ///< the last frame waits for the light of its step
};

/// A drag where drawing takes the processors that the light of its next step needs.
bool sparingDrag(const Editor& editor, const Viewport* viewport) {
    return viewport && viewport->software() && editor.inGesture();
}

/// Light that is refined at rest wakes the window whenever there is more of it to show; until then no frame is drawn,
/// which would take the processors from it where OpenGL is software.
bool refiningAlone(const Editor& editor) { return editor.refining() && !editor.job() && !editor.state.time.playing; }

/// How long the loop may sleep: as long as it can while nothing happens.
double patience(const Editor& editor, const Window& window, const Gui& gui, const KeyQueue& keys,
                const Pending& pending, bool sparing) {
    if (pending.extraFrames > 0 || keys.waiting() || window.keysWaiting() || window.buttonsWaiting()) return 0;
    if (pending.heldBack || panelsBusy() || (editor.inGesture() && !sparing)) return 1.0 / 60;
    if (editor.busy()) return 0.1;          // stages and times; images wake the window themselves
    if (gui.typing()) return 0.5;           // the caret blinks
    if (editor.unsavedChanges()) return 5;  // autosave
    return -1;
}

/// What the screen shows, and since when a newer frame waits for its light.
struct Drawn {
    std::shared_ptr<const LiveFrame> light;
    std::optional<Clock::time_point> waitingSince;
};

/// In a drag a frame without the light of the present step would only hold that light up, where drawing takes the same
/// processors. A tenth of a second at most.
bool waitForLight(const Editor& editor, const Viewport* viewport, Drawn& drawn) {
    if (!sparingDrag(editor, viewport) || !editor.imageOwed() || editor.liveFrame() != drawn.light) return false;
    if (!drawn.waitingSince) drawn.waitingSince = Clock::now();
    return secondsSince(*drawn.waitingSince) < 0.1;
}

std::string titleOf(const Editor& editor) {
    const std::string name = editor.state.document.name();
    if (name.empty()) return "relamp";
    return (editor.unsavedChanges() ? "* " : "") + name + (editor.state.document.readOnly ? " (read-only)" : "") +
           " - relamp";
}

/// One window from its opening to its end. False: the graphics context was lost and a new window is needed.
bool runWindow(Editor& editor, const ApplicationOptions& options, fs::path& openWhenAsked, bool& solveWhenOpen) {
    Window window("relamp", options.width, options.height);
    Gui gui(window);
    std::unique_ptr<Viewport> viewport;
    std::string reason;
    try {
        viewport = std::make_unique<Viewport>();
    } catch (const Error& error) {
        reason = error.what();
        editor.fail("The 3D view cannot be shown", reason,
                    "Update the graphics driver. Estimating and exporting work without it.");
    }
    if (viewport)
        setThumbnailMaker(
            [&](const std::string& key, const std::function<Image()>& make) { return viewport->thumbnail(key, make); });
    if (viewport) setThumbnailDropper([&](const std::string& prefix) { viewport->dropThumbnails(prefix); });
    editor.state.gpu = window.renderer();
    if (!(editor.state.uiScale > 0)) editor.state.uiScale = options.scale > 0 ? options.scale : window.contentScale();
    KeyQueue keys;
    Pending pending;
    std::string title, quality = options.quality;
    Clock::time_point second = Clock::now();
    int frames = 0;
    Drawn drawn;
    bool lost = false, shownBusy = false;  // shownBusy: the last frame showed work that was going on
    while (!editor.quitting()) {
        const bool sparing = sparingDrag(editor, viewport.get());
        const bool event =
            window.wait(shownBusy && !editor.busy() ? 0 : patience(editor, window, gui, keys, pending, sparing));
        if (event) pending.extraFrames = sparing ? 0 : 3;
        else if (pending.extraFrames > 0) --pending.extraFrames;
        if (const std::vector<fs::path> dropped = window.takeDropped(); !dropped.empty()) editor.openDropped(dropped);
        if (window.closeRequested()) editor.requestQuit();
        editor.poll();
        if (shownBusy && !editor.busy()) pending.extraFrames = 3;  // what has just ended is still to be shown
        if (!openWhenAsked.empty() && !editor.state.recovery && !editor.job()) {
            if (!editor.state.document.capture) editor.openNow(openWhenAsked);
            openWhenAsked.clear();
        }
        if (!quality.empty() && editor.state.document.capture) editor.state.solve.quality = std::exchange(quality, {});
        if (solveWhenOpen && editor.state.document.capture && !editor.job()) {
            solveWhenOpen = false;
            if (!editor.estimate()) editor.solve(editor.state.solve);
        }
        if (const std::string wanted = titleOf(editor); wanted != title) {
            window.setTitle(wanted);
            title = wanted;
        }
        window.setFullScreen(editor.state.fullScreen);
        if (window.minimised()) continue;
        if (!event && pending.extraFrames == 0 && !pending.heldBack &&
            (sparing || !editor.busy() || refiningAlone(editor)) && (sparing || !editor.inGesture()) && !panelsBusy() &&
            !keys.waiting() && !window.buttonsWaiting() && !gui.typing())
            continue;

        const Vec2 size = window.size(), pixels = window.framebufferSize();
        if (!(size.x > 0 && size.y > 0)) continue;
        const Clock::time_point start = Clock::now();
        gui.setScale(editor.state.uiScale, pixels.x / size.x);
        gui.beginFrame(!editor.state.panels.palette);
        window.readModifiers();
        keys.add(window.takeKeys(), gui);
        keys.deliver(editor, gui, viewport.get());
        shownBusy = editor.busy();
        drawLayout(editor, viewport.get(), reason);
        pending.heldBack = waitForLight(editor, viewport.get(), drawn);
        if (pending.heldBack) {
            gui.skipFrame();
            continue;
        }
        if (sparing && !editor.inGesture()) pending.extraFrames = 3;  // the drag has just ended
        drawn = {editor.liveFrame(), {}};
        const double cpu = secondsSince(start);
        gui.endFrame(int(pixels.x), int(pixels.y), sparingDrag(editor, viewport.get()) ? viewport->texture() : 0);
        window.swap();
        writeItemMap(editor);
        ++frames;
        editor.state.frameCpuMs = viewport ? viewport->cpuMs() : cpu * 1000;
        if (const double passed = secondsSince(second); passed > 1) {
            editor.state.framesPerSecond = frames / passed;
            frames = 0;
            second = Clock::now();
        }
        if (window.contextLost()) {
            editor.abandonGesture();
            editor.autosave();
            lost = true;
            break;
        }
    }
    setThumbnailMaker({});
    setThumbnailDropper({});
    return !lost;
}

}  // namespace

int runApplication(const ApplicationOptions& options) {
    EditorOptions editorOptions;
    editorOptions.configFolder = userFolder("XDG_CONFIG_HOME", ".config");
    editorOptions.cacheFolder = userFolder("XDG_CACHE_HOME", ".cache");
    editorOptions.stateFolder = userFolder("XDG_STATE_HOME", ".local/state");
    editorOptions.wake = [] { Window::wake(); };
    editorOptions.gpu = options.gpu == "on"    ? EditorOptions::Gpu::on
                        : options.gpu == "off" ? EditorOptions::Gpu::off
                                               : EditorOptions::Gpu::automatic;
    Editor editor(editorOptions);
    if (options.scale > 0) editor.state.uiScale = options.scale;
    fs::path openWhenAsked = options.open;  // after the question about lost work
    bool solveWhenOpen = options.solve;
    for (int attempt = 0; !runWindow(editor, options, openWhenAsked, solveWhenOpen); ++attempt) {
        if (attempt == 3)
            throw Error(
                "the graphics driver loses its state again and again; the edits are kept and will be offered when "
                "relamp-editor starts again");
        editor.fail("The graphics driver was reset", "Everything on the graphics card was lost and has been made anew.",
                    "Your edits are as they were. If this comes back, update the driver.");
    }
    return 0;
}

}  // namespace relamp::ui
