// The editor behind the window: documents, background jobs, the look with its history, autosave. Knows neither ImGui
// nor GL, so that tests drive it as the window does. Everything here runs on the window's thread; poll() takes what the
// workers have finished.
#pragma once
#include <functional>
#include <memory>

#include "edit/emitter_edits.h"
#include "edit/history.h"
#include "editor_state.h"
#include "relight/frame.h"

namespace relamp::ui {

struct EditorOptions {
    std::filesystem::path configFolder;  ///< settings, recent files; created when needed
    std::filesystem::path stateFolder;   ///< autosaves
    std::filesystem::path
        cacheFolder;                  ///< baked transport, so that a scene is at once there the next time; empty: none
    std::function<void()> wake;       ///< called from workers when there is something to poll
    double autosaveSeconds = 15;      ///< of unsaved edits, at most
    double checkpointSeconds = 20;    ///< between two checkpoints of a running estimate, at least
    std::function<double()> seconds;  ///< the clock of autosaving; empty: the steady one
    enum class Gpu { automatic, on, off };
    Gpu gpu =
        Gpu::automatic;  ///< where light is summed: automatic on whichever is faster; on also in a software renderer
};

class Editor {
public:
    explicit Editor(EditorOptions options);
    ~Editor();
    EditorState state;

    // ---- documents; loading and saving run in the background
    /// A capture folder, a transforms.json, a shot folder, or an environment image (then the look's environment).
    /// Asks first when edits are unsaved, and what a panorama is for where nothing is estimated yet.
    void open(const std::filesystem::path& path);
    /// Reads the image in the background; it becomes the look's environment, one edit, once it has been read.
    void openEnvironment(const std::filesystem::path& file);
    /// Reads a panorama in the background; the next estimates take it as a light reference, once it has been read.
    void addLightProbe(const std::filesystem::path& file);
    /// Answer to state.panorama.
    void answerPanorama(PanoramaUse use);
    /// Runs `read` of this file in the background, then `done` here; what it throws is shown, and `done` does not run.
    void readInBackground(const std::filesystem::path& file, const std::function<void()>& read,
                          const std::function<void(Editor&)>& done);
    void openNow(const std::filesystem::path& path);
    /// Reads the open capture again with its axes set right, in the background. What was estimated before does not hold
    /// any more; undo gives it back, with the capture as it was. A reading that the history has needs no time.
    void fixCapture(const CaptureFix& fix, const std::string& label = "Read the capture otherwise");
    /// Saves to the shot's folder; asks for a place when it has none.
    void save();
    void saveAs(const std::filesystem::path& folder);
    /// Beside the shot under the next free number: NAME.relamp, NAME-002.relamp, ...
    void saveVersion();
    void requestQuit();
    bool quitting() const;
    /// Answers to state.unsaved, state.recovery, state.locked and state.missing.
    void answerUnsaved(bool saveFirst, bool proceed);
    void answerRecovery(bool restore);
    void answerLocked(LockedAnswer answer);
    /// `place`: where it is, when it was located.
    void answerMissing(MissingAnswer answer, const std::filesystem::path& place = {});
    bool unsavedChanges() const;

    // ---- the look
    /// Where it has keys, as it is at state.time.frame.
    const Look& look() const;
    /// What is shown: the present entry's, or while a solve runs its latest intermediate result. Null before the first.
    std::shared_ptr<const Estimate> estimate() const;
    std::shared_ptr<const Estimate> distantOnly() const { return history().present().distantOnly; }
    /// One edit, one entry. Ignored while nothing is estimated.
    void edit(const std::string& label, const std::function<void(Look&)>& change);
    /// A drag: previews start from the look at begin, and become one entry.
    void beginGesture(const std::string& label);
    void preview(const std::function<void(Look&)>& change);
    void commitGesture();
    void abandonGesture();
    bool inGesture() const { return history().inGesture(); }
    void undo();
    void redo();
    void goTo(size_t entry);
    const History& history() const;
    /// Keeps the present look as snapshot 0 to 2.
    void storeSnapshot(size_t which);
    /// Goes back to it: one edit. Nothing happens where there is none.
    void recallSnapshot(size_t which);
    /// Emitters as the look has them, with the names they are shown by; empty before a solve. Cached until the look
    /// changes.
    const std::vector<EmitterState>& emitters() const;
    const EmitterState* emitter(const std::string& id) const;
    /// What the artist calls it, else its id; of several: "3 lights".
    std::string namesOf(const std::vector<std::string>& ids) const;

    // ---- time: the look's keys. With keys every edit goes into the key at the present frame.
    /// The look as it stands becomes a key at the present frame.
    void setKey();
    void deleteKey(int frame);
    void moveKey(int from, int to);
    void easeKey(int frame, KeyEase ease);
    /// Shows another frame; no edit.
    void goToFrame(int frame);
    /// To the key before (-1) or after (+1) the present frame, of the look or of a single value.
    void goToKey(int direction);
    /// Keys of single values at the present frame; from then on edits of such a value set its keys. One edit each.
    void setValueKeys(const std::vector<KeyedOf>& values);
    /// `frame` < 0: all of them; the value stays as it is shown.
    void deleteValueKeys(const std::vector<KeyedOf>& values, int frame);
    void goToValueKey(const KeyedOf& value, int direction);
    /// What positions of lights count from.
    LookPivots pivots() const;
    /// Every frame is shown once, as fast as it can be made; frames that were shown are kept (up to a gibibyte), and
    /// come at their own speed from then on, until look or eye change.
    void play(bool on);
    /// It is kept: it can be shown at once.
    bool frameKept(int frame) const;

    // ---- the plate: a shot filmed in the captured set (Look::plate)
    /// Opens it in the background; it becomes the look's plate, one edit, once it has been opened. What it lacks is
    /// named; where nothing of it can be used, it is not taken.
    void importPlate(const PlateLook& plate);
    void removePlate();
    /// Of what was dropped at once: frames of a sequence with or without their camera are offered as a plate,
    /// everything else is opened.
    void openDropped(const std::vector<std::filesystem::path>& paths);
    /// The look's, once it has been opened; null before, and without one.
    std::shared_ptr<const OpenPlate> plate() const;
    /// Its camera in the present frame; null where the viewport does not look through it.
    const Camera* plateCamera() const;
    /// Its image in the present frame, relit where that is wanted and there, or the last one shown until that has been
    /// read; null: none.
    std::shared_ptr<const PlateImage> plateImage() const;
    /// The same relit as it is exported, where state.viewport.plateRelit wants that and it has been made; else null. It
    /// is made while nothing moves, and stays until the next one of its frame is there.
    std::shared_ptr<const PlateImage> relitPlateImage() const;
    /// The plate under the present look, for the view mode *Relit* at rest; null while anything moves, and until it has
    /// been made.
    std::shared_ptr<const PlateImage> relitAtRest() const;
    bool relightingPlate() const;

    // ---- background work
    void solve(const SolveRequest& request);
    /// Answer to state.interrupted: goes on with it, after opening its capture where that is not open, or throws it
    /// away.
    void answerInterrupted(bool goOn);
    /// Looks for an emitter that no photograph shows. Where there is one, the capture is read again with a small sphere
    /// in its place; state.unobservedSearch has the words.
    void findUnobservedLight();
    /// Takes one of document.fix.proxies away again.
    void removeProxy(size_t index);
    void exportFrames(const ExportRequest& request);
    void cancelJob();
    void pauseJob(bool paused);
    const std::optional<JobStatus>& job() const;

    // ---- the image
    /// Latest image of the look; null before the first.
    std::shared_ptr<const LiveFrame> liveFrame() const;
    /// The same for the distant-only estimate (modes correction and wipe); null when it was not solved.
    std::shared_ptr<const LiveFrame> distantOnlyFrame() const;
    /// The look that is compared with (mode before and after): as recovered, or a snapshot.
    std::shared_ptr<const LiveFrame> beforeFrame() const;
    /// A per-pixel image from the present eye, rendered at rest; null while something moves. Where the viewport has a
    /// region, of that alone.
    std::shared_ptr<const Frame> restFrame() const;
    /// The viewport tells where it is seen from, and how large it is; cheap when nothing changed.
    void setEye(const Camera& eye, bool orthographic);
    /// Asks where the light at a point comes from; the answer arrives in state.pointLight.
    void pick(const std::optional<PickedPoint>& point);
    bool refining() const;
    /// An image of the present look was asked for, and nothing of it has come yet.
    bool imageOwed() const;
    /// The estimate was made with other settings than state.solve now has.
    bool stale() const;

    const std::filesystem::path& configFolder() const;

    // ---- once a frame
    void poll();
    /// Asks for the image of what the state is now, without waiting for the next poll.
    void requestImage();
    /// Autosave at once, whatever the clock says; the window calls it before it goes away by force.
    void autosave();
    /// Something is going on that the window should show without waiting for input.
    bool busy() const;
    void log(LogLevel level, const std::string& text);
    /// A word about what was done, in the status bar and the log.
    void say(const std::string& text);
    void fail(const std::string& title, const std::string& text, const std::string& advice = {});

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace relamp::ui
