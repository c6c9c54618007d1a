// What the window shows and where the user is in it: plain data, no behaviour. Products of the core are shared and
// never change; only the look has undo and lives in the history.
#pragma once
#include <array>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "base/log.h"
#include "capture/check.h"
#include "display/scope.h"
#include "edit/light_brush.h"
#include "edit/value_key_edits.h"
#include "image/image_region.h"
#include "length_unit.h"
#include "pipeline/marked_reference.h"
#include "plate/relight_plate.h"
#include "radiance/samples.h"
#include "relight/live/live_scene.h"
#include "scene/scene.h"
#include "shot/export_frame.h"
#include "shot/shot_file.h"
#include "solve/solve.h"
#include "view_mode.h"
#include "viewport/orbit_camera.h"

namespace relamp::ui {

/// What is open. Empty capture: nothing.
struct Document {
    std::filesystem::path captureFolder;
    std::filesystem::path shotFolder;        ///< empty: never saved
    bool readOnly = false;                   ///< another process has the shot: saving asks for another place
    CaptureFix fix;                          ///< what the user says against the capture's files
    std::shared_ptr<const Capture> capture;  ///< with photographs
    std::shared_ptr<const Scene> scene;
    std::shared_ptr<const RadianceSamples> samples;
    std::shared_ptr<const CaptureCheck> check;
    std::string quality = "standard";
    uint64_t seed = 1;
    Resources resources;
    /// "room", for the title bar.
    std::string name() const;
};

struct PickedPoint {
    uint32_t triangle = 0;  ///< of the live frame's mesh
    Vec2 barycentric{0};
    Vec3 position{0}, normal{0};
    uint32_t vertex = 0;  ///< nearest corner
};

struct Selection {
    std::vector<std::string> emitters;  ///< ids; the last one is active
    int view = 0;                       ///< photograph
    std::optional<PickedPoint> point;
    bool has(const std::string& id) const;
    std::string active() const { return emitters.empty() ? std::string() : emitters.back(); }
};

enum class Tool { select, move, rotate, scale, paint };
/// The brush of Tool::paint.
struct LightBrushState {
    LightBrush brush;
    float radius = 36;         ///< points at scale 1
    bool environment = false;  ///< it may change too
};
/// What a click in the viewport means once: armed by a button of the inspector, Esc disarms.
enum class ClickTask { none, aim, reflect, illuminate, attach, leaveOut, lightOnly, newPart, takeColour, region };

struct ViewportState {
    ViewMode mode = ViewMode::relit;
    OrbitCamera camera;
    bool throughView = false;      ///< look through selection.view; its photograph lies behind
    bool throughPlate = false;     ///< look through the plate's camera of the present frame; the plate lies behind
    bool photographBehind = true;  ///< and the plate
    float plateOpacity = 1;
    bool plateRelit = false;   ///< at rest the plate is shown relit, as it is exported
    bool meshOverlay = false;  ///< wireframe over the photograph: how well cameras and mesh agree
    bool frusta = true, grid = true, directionDome = false;
    float exposureStops = 0;
    std::string displayView;  ///< empty: as it suits the scene (displayViewOf)
    bool falseColour = false;
    float wipeLeft = 1.0f / 3, wipeRight = 2.0f / 3;  ///< dividers of the wipe, fraction of the width
    float splitAt = 0.5f;                             ///< divider of the correction colours
    float compareAt = 0.5f;                           ///< divider between before and after
    int compareWith = -1;                             ///< before: as recovered, else the snapshot of this number
    bool overlays = true;                             ///< marks, grid, cameras, legend and axes over the image
    Tool tool = Tool::select;
    LightBrushState brush;
    bool localAxes = false;
    ClickTask clickTask = ClickTask::none;
    std::set<uint32_t> hiddenComponents;  ///< components of the mesh the user has hidden
    std::vector<std::string> solo;        ///< emitters that alone are lit on screen; empty: all
    std::optional<ImageRegion> region;  ///< of the image, which alone is rendered at rest and exported; none: all of it
    float aspect = 16.0f / 9;           ///< of the last drawn viewport
};

/// A background job as the panels see it.
struct JobStatus {
    enum class Kind { open, solve, search, save, exportFrames } kind = Kind::open;
    std::string title;  ///< "Estimating light"
    std::string stage;
    double fraction = 0;          ///< of the stage
    std::optional<double> whole;  ///< fraction of the whole job; nothing: not known
    double seconds = 0;
    std::optional<double> secondsLeft;  ///< of the whole job
    bool paused = false, stopping = false;
};

/// Something went wrong, or needs a word: a dialog that says what happened and what to do.
struct Notice {
    std::string title, text, advice;
    bool ofAnEdit = false;  ///< an edit cannot be shown: undo stays within reach
};

/// Asked before work would be lost.
struct UnsavedQuestion {
    enum class Then { open, quit, close } then = Then::quit;
    std::filesystem::path path;
    bool estimating = false;                   ///< an estimate runs, which would end
    bool edits = true;                         ///< there are edits that are not saved
    std::optional<JobStatus::Kind> running{};  ///< an export or a search runs, which would end
};

/// Asked when a shot names something that is not there: its capture, its environment, measured materials.
struct MissingQuestion {
    std::filesystem::path shot;
    enum class What { capture, environment, measured } what = What::capture;
    std::filesystem::path path;  ///< as the shot names it
};
enum class MissingAnswer { located, without, cancel };

/// Asked of a panorama that is opened beside a capture that is not estimated.
struct PanoramaQuestion {
    std::filesystem::path file;
};
enum class PanoramaUse { lightReference, environment, none };

/// A light reference that is being marked in a photograph.
struct ReferenceMarking {
    MarkedReference mark;
    std::optional<size_t> replaces = {};  ///< of SolveRequest::marks; none: it is a new one
    Vec2 middle{0};                       ///< pixel of the photograph in the middle of the dialog
    float zoom = 0;                       ///< 1: all of it is seen; 0: nothing was drawn yet
};

/// Work found after a crash.
struct RecoveryOffer {
    std::filesystem::path file;
    std::string project, time, stage;
};

struct SolveRequest {
    bool nearField = true;
    std::string quality = "standard";
    double budgetSeconds = 0;  ///< 0: none
    uint64_t seed = 1;
    GaugeChoice gauge;
    int palette = 0;                                  ///< materials of one colour; 0: nothing is said
    float lightSmoothness = 0, albedoSmoothness = 0;  ///< factors on the usual; 0: as the photographs say
    std::string basis = "built-in";                   ///< lobes that surfaces may have (brdf/basis.h, basisNamed)
    std::filesystem::path merl;                       ///< folder with measured materials that join them; empty: none
    SolveOptions::Bounce bounce = SolveOptions::Bounce::automatic;
    std::optional<size_t> meshTriangles = {};             ///< as PipelineOptions::meshTriangles
    std::optional<int> texture = {};                      ///< as PipelineOptions::texture
    std::vector<std::filesystem::path> lightProbes = {};  ///< panoramas of the set as it was photographed
    std::vector<MarkedReference> marks = {};              ///< mirror balls, greys and charts that photographs show
};

/// An estimate that did not come to its end and can go on where it stood (interrupted.h).
struct InterruptedEstimate {
    std::filesystem::path record;  ///< file that says what it is; its checkpoint lies beside it
    std::filesystem::path captureFolder;
    std::filesystem::path project;  ///< the shot it was made in, or the capture
    SolveRequest request;
    std::string time;    ///< local, of its start: "2026-11-21 14:03:11"
    double seconds = 0;  ///< of work that are kept
};

/// Asked when another process has the shot that is to be opened.
struct LockedQuestion {
    std::filesystem::path path;
    std::string owner;  ///< "anna on studio3, process 4711, since 14:03"
};
enum class LockedAnswer { readOnly, copy, cancel };

struct ExportRequest {
    enum class Views {
        present,
        capture,
        all,
        range,
        timeline,   ///< the viewport's eye over the frames of `range`
        turntable,  ///< once round what the views look at
        path,       ///< a smooth way through the views of `range`
        bookmarks,  ///< a smooth way through the look's bookmarks of `range`
        plate
    } views = Views::present;   ///< the viewport's eye, the selected view, ...
    int moveFrames = 48;        ///< of a turntable or a path
    std::string range = "1";    ///< "1-3,5" of the views or bookmarks, counted from 1; of the time line; of the plate
    Ratio ratio = Ratio::none;  ///< of views at their own size, and of the plate, where none means quotient
    LayerNaming naming = LayerNaming::blender;
    bool multipart = false;
    std::optional<DisplayView> view{};  ///< of PNG and JPEG; none: view transform and exposure of the viewport
    int width = 0, height = 0;          ///< 0: the view's own size, or the viewport's
    int samples = 8, plateSamples = defaultPlateSamples;  ///< a pixel; of a plate its own
    bool denoise = true;
    PlateUnsure unsure = PlateUnsure::model;  ///< of a plate
    ExrFormat exr{};
    bool regionOnly = true;         ///< where the viewport has one and its image is exported
    std::string layers = "groups";  ///< as render --layers; "" for beauty only
    std::filesystem::path file;     ///< #### is the frame's number
};

/// A plate that is open in the window: files, cameras, and what it lacks.
struct OpenPlate {
    PlateLook look;        ///< it was opened from
    PlateRequest request;  ///< the same for the relighting
    Plate plate;           ///< no frames: nothing of it could be used
    PlateGains gains;      ///< of the estimate; none: as it is
    std::string trouble;   ///< why nothing could be used; empty: something can
    std::shared_ptr<const Capture> capture;
    std::shared_ptr<const Estimate> estimate;  ///< that the gains are of; null: none
    /// The frame `number`, else the nearest before it, else the first; null without frames.
    const PlateFrame* at(int number) const;
};

/// A frame of the plate to be shown: without lens distortion, in the capture's scale, at most 1280 pixels wide or high.
struct PlateImage {
    int frame = 0, width = 0, height = 0;
    /// Four halves each: colour premultiplied by coverage, coverage; top row first; empty: it could not be read.
    std::vector<uint64_t> pixels;
    Vec4 at(size_t pixel) const;
    size_t bytes() const { return pixels.size() * sizeof(uint64_t); }
};

/// What the last search for an emitter that no photograph shows said, and of which capture.
struct UnobservedSearch {
    std::filesystem::path capture;
    std::string words;
};

/// One line of the error-against-run-time plot.
struct RunCurve {
    std::vector<TimelineEntry> entries;
    bool running = false;
};

/// Where the user is in time. The keys themselves belong to the look.
/// A key in the view of curves; of values with several numbers one of them.
struct CurveHandle {
    KeyPick key;
    int component = 0;
    bool operator==(const CurveHandle&) const = default;
};

struct TimeState {
    int frame = 1, first = 1, last = 48;
    double framesPerSecond = 24;
    int keptMiB = 2048;  ///< memory of frames that were played: half for images of the scene, half for the plate's
    size_t keptBytes() const { return size_t(keptMiB) << 19; }  ///< of either half
    bool playing = false, loop = true;
    bool scrubbing = false;            ///< the playhead is being dragged
    bool curves = false;               ///< the panel Frames shows values against frames
    std::vector<CurveHandle> handles;  ///< selected ones there
    bool takesDelete = false;          ///< the key Del is theirs
};

struct LogEntry {
    LogLevel level = LogLevel::info;
    std::string time, text;
};

/// A look that is kept beside the present one, to compare with and to go back to.
struct LookSnapshot {
    Look look;
    std::string time;  ///< local, "14:03"
};

/// Lights that were copied, as a shot of any capture can take them.
struct CopiedLights {
    std::vector<AddedEmitter> lights;
};

inline constexpr int scopeTab = 5, framesTab = 6;  ///< of the bottom panel

/// Which panels and dialogs are open.
struct PanelState {
    bool hidden = false;           ///< the viewport alone
    bool bottomFolded = true;      ///< of the bottom panel only the tabs are shown
    bool narrowInspector = false;  ///< where one column has room: the inspector instead of the scene
    std::string narrowSelection;   ///< what was selected when that was decided

    bool history = true, log = true, doctor = false, keys = false, palette = false, exportFrames = false, about = false;
    bool saveLookBrowser = false, loadLookBrowser = false;
    bool openBrowser = false, saveBrowser = false, environmentBrowser = false, solveSettings = false;
    bool renameLight = false;  ///< asks the inspector to put the cursor into the active light's name
    int bottomTab = 0;
    bool scopeShown() const { return bottomTab == scopeTab && !bottomFolded && !hidden; }
    float leftWidth = 300, rightWidth = 320, bottomHeight = 190;  ///< pixels at scale 1
};

struct EditorState {
    Document document;
    Selection selection;
    ViewportState viewport;
    PanelState panels;
    SolveRequest solve;
    TimeState time;
    ExportRequest exportFrames;
    std::vector<Notice> notices;  ///< shown one after the other
    std::optional<UnsavedQuestion> unsaved;
    std::optional<RecoveryOffer> recovery;
    std::optional<InterruptedEstimate> interrupted;  ///< offered: of the open capture, or, without one, the latest
    std::optional<LockedQuestion> locked;
    std::optional<MissingQuestion> missing;
    std::optional<PanoramaQuestion> panorama;
    std::optional<ReferenceMarking> marking;               ///< the dialog that marks one, and what is in it
    std::optional<PlateLook> plateImport;                  ///< the dialog that imports a plate, and what is in it
    std::filesystem::path environmentToCome;               ///< of the look, once there is a first estimate; empty: none
    std::array<std::optional<LookSnapshot>, 3> snapshots;  ///< A, B, C
    CopiedLights copied;
    std::string message;                 ///< what has just been done, shown for a while in the status bar
    uint64_t messages = 0;               ///< how many there were
    std::shared_ptr<const Scope> scope;  ///< of the image; kept up while it is shown
    std::optional<Rgb> probe;            ///< radiance under the pointer, where the present light is shown
    std::string keyHints;                ///< keys that mean something at this moment, for the status bar
    bool fullScreen = false;
    UnobservedSearch unobservedSearch;
    std::weak_ptr<const Estimate> bannerClosedFor;  ///< the estimate whose quality banner the user has closed
    std::array<RunCurve, 2> curves;                 ///< near-field, distant-only
    SolvePlan plan;                                 ///< of the estimate that runs or was made last; empty: none
    std::vector<LogEntry> log;
    std::vector<std::filesystem::path> recent;  ///< captures and shots, latest first
    std::vector<std::filesystem::path> recentEnvironments, recentLooks;
    std::optional<PointLight> pointLight;  ///< answer for selection.point, when it has come
    float uiScale = 1;
    LengthUnit lengthUnit = LengthUnit::metres;  ///< of what is shown and typed
    double framesPerSecond = 0,
           frameCpuMs = 0;  ///< of the last busy second; own work of a frame without the rasteriser's
    std::string gpu;        ///< "llvmpipe ...", for the status bar
};

}  // namespace relamp::ui
