// The insides of Editor, shared by editor.cpp (look, image, polling), editor_jobs.cpp (background jobs), and
// editor_open.cpp, editor_save.cpp, editor_estimate.cpp and editor_export.cpp.
#pragma once
#include <atomic>
#include <chrono>
#include <mutex>
#include <utility>

#include "base/job.h"
#include "editor.h"
#include "plate_player.h"
#include "relight/look_track.h"
#include "relight_worker.h"
#include "relit_plate.h"
#include "shot/autosave.h"
#include "shot/shot_lock.h"

namespace relamp::ui {

/// What a background job leaves behind: a step that puts its result into the editor, on the window's thread.
using Finish = std::function<void()>;

/// A capture as it was read, with what was computed from it: Version::inputs.
struct CaptureInputs {
    CaptureFix fix;
    std::shared_ptr<const Capture> capture;
    std::shared_ptr<const Scene> scene;
    std::shared_ptr<const RadianceSamples> samples;
    std::shared_ptr<const CaptureCheck> check;
    static std::shared_ptr<const CaptureInputs> of(const Document& document);
};

struct Editor::Impl {
    using Clock = std::chrono::steady_clock;
    Impl(Editor& editor, EditorOptions editorOptions);

    Editor& self;
    EditorOptions options;
    History history;
    bool quit = false;

    // ---- jobs: one at a time, and one that saves beside it
    std::unique_ptr<Job<Finish>> job, saving;
    std::optional<JobStatus> status;
    std::function<void(bool cancelled)> onJobEnd;  ///< after a failed or cancelled job
    std::filesystem::path saveNext;                ///< asked for while another save was under way
    std::function<void()> whenSaved;               ///< continues what the unsaved-changes question held up

    /// Says so, and true, where a job runs.
    bool refusedWhileRunning();

    // ---- intermediate results of a running solve, from its thread
    std::mutex solveMutex;
    std::vector<TimelineEntry> newEntries;
    std::shared_ptr<const Estimate> newSnapshot;
    std::optional<SolvePlan> newPlan;
    std::shared_ptr<const Estimate> snapshot;     ///< shown while the solve runs
    double snapshotTaken = 0, snapshotShown = 0;  ///< seconds(), of that one: handed to the viewport, refined there
    bool solveIsNearField = true;
    std::optional<SolveRequest> solvedWith;
    double solveBudget = 0;              ///< seconds, of the solve that runs; 0: none
    std::string stageNow;                ///< the stage that runs
    double stageSince = 0;               ///< Progress::seconds() when it began
    bool shownOnce = false;              ///< the solve's first result was brought up
    double wholeAt = 0;                  ///< Progress::seconds() when JobStatus::whole was told
    std::atomic<double> jobWhole{-1};    ///< fraction of the running job that it tells by itself; < 0: it does not
    std::optional<double> planHeardAt;   ///< Progress::seconds() when state.plan was last heard of; none: not yet
    std::filesystem::path goOnWhenOpen;  ///< record of the interrupted estimate for which a document is being opened

    // ---- log lines from any thread
    std::mutex logMutex;
    std::vector<LogEntry> newLog;

    // ---- the image
    RelightWorker relight, relightDistant, relightBefore;
    Camera eye;
    bool orthographic = false;
    uint64_t pickSerial = 0;
    mutable std::vector<EmitterState> emitters;
    mutable uint64_t emittersRevision = 0;
    mutable int emittersFrame = 0;
    mutable std::shared_ptr<const Estimate> emittersOfEstimate;

    // ---- time
    /// Images of frames that were played.
    struct Playback {
        RelightRequest of;  ///< what they show, but for the look
        std::vector<std::string> solo;
        uint64_t revision = 0;
        std::map<int, std::shared_ptr<const LiveFrame>> kept;
        size_t bytes = 0;
        std::shared_ptr<const LiveFrame> shown;
        int shownFrame = -1;
        double since = 0;  ///< seconds() when it was first shown
    };
    Playback playback;
    mutable Look timed;  ///< the look at timedFrame
    mutable uint64_t timedRevision = 0;
    mutable int timedFrame = 0;
    /// Of a request for the present frame of the present history.
    int64_t timeTag() const;
    /// Takes the next frame when it is due. True: `request` needs no work, its image is kept.
    bool pollPlayback(const RelightRequest& request);

    // ---- the plate
    PlatePlayer plates;
    RelitPlates relitPlates;
    std::shared_ptr<const PlateImage> relitNow;                ///< of the present look and frame, once nothing moves
    std::vector<std::shared_ptr<const OpenPlate>> openPlates;  ///< the last ones, so that undo has them at once
    std::unique_ptr<Job<std::shared_ptr<const OpenPlate>>> plateOpening;
    /// Opens what the look names, and asks for the image of the present frame.
    void pollPlate();
    void keepPlate(std::shared_ptr<const OpenPlate> open);
    /// Relights the plate's present frame at rest, where that is wanted.
    void pollRelitPlate();
    /// Shows it: frames of the time line, its camera.
    void goToPlate(const OpenPlate& plate);
    /// The strip of frames has the plate's while there is one, and its own again after.
    struct FramesBeforePlate {
        int first, last, frame;
        std::filesystem::path plate;  ///< whose frames the strip has
    };
    std::optional<FramesBeforePlate> beforePlate;
    void takeFramesOf(const OpenPlate& plate);
    void leaveFramesOfPlate();

    // ---- autosave
    /// Changes that the history does not hold: snapshots, another place of the capture. How many there were, and how
    /// many the shot's folder holds.
    uint64_t changesBeside = 0, savedBeside = 0;
    Autosave autosave;
    uint64_t autosavedRevision = 0;
    double lastAutosave = -1e9, lastEstimateTry = -1e9;  ///< seconds()
    bool autosaveFailed = false;                         ///< and the user was told
    int estimateNumber = 0;
    std::shared_ptr<const Estimate> savedEstimate;      ///< the one in document.shotFolder
    std::shared_ptr<const Estimate> autosavedEstimate;  ///< the one in autosavedFolder
    std::shared_ptr<const Estimate> failedEstimate;     ///< could not be put away; tried again after a while
    std::filesystem::path autosavedFolder;
    std::vector<FoundWork> lost;
    std::optional<FoundWork> restored;  ///< on disk until our own autosave holds all of it

    // ---- what is opened once state.missing is answered
    std::optional<FoundWork> missingRecovered;
    ShotPlaces missingPlaces;
    int missingAs = 0;  ///< OpenAs

    // ---- the shot is ours alone
    std::shared_ptr<ShotLock> shotLock;  ///< of document.shotFolder; null: none
    enum class OpenAs { usual, readOnly, copy };

    void start(JobStatus::Kind kind, const std::string& title, std::function<Finish(Progress&)> work,
               std::function<void(bool)> onEnd = {});
    void openCapture(const std::filesystem::path& folder, std::optional<FoundWork> recovered = {});
    /// Reads the open capture anew; what comes of it is one entry of the history.
    void readAgain(const CaptureFix& fix, const std::string& label);
    /// The present entry's inputs become the document's, where they are others.
    void followHistory();
    /// To another entry of the history, unless that has other inputs while a job works on these.
    void goToEntry(size_t entry);
    /// Curves and plan of the present entry's estimates.
    void tellEstimates();
    /// Brings the check of the capture up where an estimate would be spoilt.
    void tellCheck();
    /// `saved` is what is on disk, with the estimate that the work was made on.
    void showRecovered(const FoundWork& found, Version saved);
    void openShotFolder(const std::filesystem::path& folder, std::optional<FoundWork> recovered = {},
                        OpenAs as = OpenAs::usual, const ShotPlaces& places = {});
    /// Asks for what `missing` says; false: nothing is missing.
    bool askForMissing(const MissingPlaces& missing, const std::filesystem::path& folder,
                       const std::optional<FoundWork>& recovered, OpenAs as, const ShotPlaces& places);
    std::shared_ptr<ShotLock> lockFor(const std::filesystem::path& shot) const;
    void setDocument(Document document, Version version, const std::string& label);
    /// Puts the viewport's camera where the first photograph was taken from.
    void frameScene();
    /// What a document that was just opened left unfinished; goes on with it if that is what it was opened for.
    void offerInterrupted(const std::optional<InterruptedEstimate>& found);
    void saveTo(const std::filesystem::path& folder);
    double seconds() const;
    /// Lights that an undo took away are selected and solo no more.
    void forgetLostLights();
    bool estimateIsOnDisk() const;
    void saveUnsavedEstimate();
    void writeAutosave();
    void offerLostWork();
    /// Takes what the solve's thread has told. A result that came before the viewport is free for it waits, or it is
    /// passed over for a later one; `ended`: the last one is taken at once.
    void takeSnapshots(bool ended = false);
    /// Showing results takes at most a quarter of the time: it takes the same processors as the solve.
    bool viewportIsFree();
    struct EstimateInputs;
    /// `goOn`: where an interrupted one of the same request stood.
    void solve(const SolveRequest& request, bool goOn);
    /// On the solving thread.
    std::shared_ptr<const Estimate> runEstimate(const EstimateInputs& inputs, Progress& progress);
    /// Puts an estimate into the history.
    void takeEstimate(const SolveRequest& request, std::shared_ptr<const Estimate> estimate, const std::string& label);
    /// Of the solve that runs, from its plan; nothing until that is made.
    std::optional<double> solveSecondsLeft() const;
    void tellWholeJob();
    void pollJob();
    void pollSaving();
    void pollImage();
    void pollAutosave();
    /// The present look without emitters the shown estimate does not have, with solo applied.
    Look shownLook(const Estimate& estimate) const;
    std::filesystem::path documentPath() const;
};

/// Absolute, without a slash at the end.
std::filesystem::path cleaned(const std::filesystem::path& path);
/// What to do about an error that kept something from being written.
std::string whereFull(const std::exception& error);
/// "emitter-1" as the window shows it: "Light 1".
std::string shownName(const std::string& id);
/// Gives those that the artist has not named the names they are shown by.
void nameForPeople(std::vector<EmitterState>& emitters, const Look& look);
/// Snapshots of the look as a shot's folder holds them: looks/A.json, each an edits document.
using Snapshots = std::array<std::optional<LookSnapshot>, 3>;
void writeSnapshots(const Snapshots& snapshots, const std::filesystem::path& shot, const DVec3& origin);
Snapshots readSnapshots(const std::filesystem::path& shot, const DVec3& origin);
/// Drops what names emitters or vertices that are not there.
Look lookThatFits(const Look& look, const Estimate& estimate, size_t vertices);

}  // namespace relamp::ui
