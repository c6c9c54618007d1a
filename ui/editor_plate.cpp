// The plate of the look: imported, shown, taken away, and what is dropped on the window.
#include "capture/capture_formats.h"
#include "edit/look_keys.h"
#include "editor_impl.h"
#include "image/image_io.h"

namespace relamp::ui {
namespace {
namespace fs = std::filesystem;

constexpr size_t mostPlates = 4;

std::string joined(const std::vector<std::string>& sentences) {
    std::string text;
    for (const std::string& one : sentences) text += (text.empty() ? "" : ". ") + one;
    return text;
}

std::string endingOf(const fs::path& path) {
    std::string ending = path.extension().string();
    for (char& c : ending) c = c >= 'A' && c <= 'Z' ? char(c - 'A' + 'a') : c;
    return ending;
}

bool isTrack(const fs::path& path) {
    const std::string ending = endingOf(path);
    return ending == ".chan" || ending == ".usda";
}

/// The view mode that shows the present look shows the plate under it, and not the model before a plate that is faded.
bool plateShownRelit(const ViewportState& viewport) {
    return viewport.mode == ViewMode::relit && viewport.photographBehind && viewport.plateOpacity >= 1;
}

bool isPlateImage(const fs::path& path) {
    static const std::set<std::string> endings{".exr", ".dpx", ".png", ".jpg", ".jpeg", ".tif", ".tiff", ".hdr"};
    return endings.contains(endingOf(path));
}

}  // namespace

void Editor::importPlate(const PlateLook& given) {
    if (!estimate()) {
        fail("There is nothing to relight a plate with yet", "A plate is relit with what was found about the light.",
             "Press Ctrl+Enter to estimate first.");
        return;
    }
    if (impl_->refusedWhileRunning()) return;
    PlateLook look = given;
    for (fs::path* file : {&look.files, &look.cameras, &look.lens, &look.matte})
        if (!file->empty()) *file = cleaned(*file);
    impl_->start(
        JobStatus::Kind::open, "Opening " + look.files.filename().string(),
        [impl = impl_.get(), look, capture = state.document.capture, scene = state.document.scene,
         solved = history().present().estimate](Progress& progress) -> Finish {
            const auto open = openPlateOf(look, capture, scene, solved, progress);
            if (!open->trouble.empty()) throw Error(open->trouble);
            return [impl, open] {
                impl->keepPlate(open);
                const char* what = impl->self.look().plate ? "Change the plate to " : "Import plate ";
                impl->self.edit(what + open->look.files.filename().string(),
                                [&](Look& changed) { changed.plate = open->look; });
                impl->goToPlate(*open);
                for (const std::string& note : open->plate.notes) impl->self.log(LogLevel::info, note);
                if (!open->plate.faults.empty())
                    impl->self.fail("Some frames of the plate cannot be used", joined(open->plate.faults) + ".",
                                    fmt::format("The other {} can.", open->plate.frames.size()));
            };
        },
        [this, given](bool) { state.plateImport = given; });
}

void Editor::removePlate() {
    edit("Remove the plate", [](Look& look) { look.plate.reset(); });
}

void Editor::openDropped(const std::vector<fs::path>& paths) {
    PlateLook plate;
    size_t images = 0, tracks = 0;
    std::vector<fs::path> others;
    for (const fs::path& path : paths) {
        if (isPlateImage(path)) {
            plate.files = platePattern(path);
            ++images;
        } else if (isTrack(path)) {
            plate.cameras = path;
            ++tracks;
        } else {
            others.push_back(path);
        }
    }
    // A folder of numbered images that is no capture.
    std::error_code failed;
    if (estimate() && paths.size() == 1 && others.size() == 1 && fs::is_directory(others[0], failed) &&
        !fs::exists(others[0] / "shot.json", failed) && !findCapture(others[0])) {
        for (fs::directory_iterator at(others[0], failed); !failed && at != fs::directory_iterator();
             at.increment(failed)) {
            if (isPlateImage(at->path())) plate.files = platePattern(at->path()), ++images;
            if (isTrack(at->path())) plate.cameras = at->path();
        }
        if (images > 1) others.clear();
    }
    if (estimate() && (images > 1 || tracks > 0) && others.empty()) {
        if (state.plateImport) {
            // The second half of what the dialog asks for.
            if (plate.files.empty()) plate.files = state.plateImport->files;
            if (plate.cameras.empty()) plate.cameras = state.plateImport->cameras;
        }
        state.plateImport = plate;
        return;
    }
    for (const fs::path& path : paths) open(captureFolderOf(path));
}

std::shared_ptr<const OpenPlate> Editor::plate() const {
    const std::optional<PlateLook>& wanted = history().present().look.plate;
    if (!wanted) return nullptr;
    for (auto at = impl_->openPlates.rbegin(); at != impl_->openPlates.rend(); ++at)
        if ((*at)->look == *wanted && (*at)->capture == state.document.capture) return *at;
    return nullptr;
}

const Camera* Editor::plateCamera() const {
    if (!state.viewport.throughPlate || state.viewport.throughView) return nullptr;
    const auto open = plate();
    const PlateFrame* frame = open ? open->at(state.time.frame) : nullptr;
    return frame ? &frame->camera : nullptr;
}

std::shared_ptr<const PlateImage> Editor::plateImage() const {
    if (!plateCamera()) return nullptr;
    const auto relit = relitPlateImage();
    return relit ? relit : impl_->plates.image();
}

std::shared_ptr<const PlateImage> Editor::relitPlateImage() const {
    const auto open = plate();
    const PlateFrame* frame = open && state.viewport.plateRelit ? open->at(state.time.frame) : nullptr;
    return frame ? impl_->relitPlates.image(open, frame->number) : nullptr;
}

std::shared_ptr<const PlateImage> Editor::relitAtRest() const {
    return plateShownRelit(state.viewport) && plateCamera() ? impl_->relitNow : nullptr;
}

bool Editor::relightingPlate() const { return impl_->relitPlates.working(); }

void Editor::Impl::pollRelitPlate() {
    const EditorState& state = self.state;
    std::optional<RelitPlateRequest> wanted;
    const std::shared_ptr<const Estimate>& solved = history.present().estimate;
    const bool steadied = state.viewport.plateRelit;
    if ((steadied || plateShownRelit(state.viewport)) && self.plateCamera() && solved && state.document.scene && !job &&
        !history.inGesture() && !state.time.playing && !state.time.scrubbing) {
        const ExportRequest& as = state.exportFrames;
        Look look = lookThatFits(history.present().look, *solved, state.document.scene->mesh.vertexCount());
        look.bookmarks.clear();
        wanted = RelitPlateRequest{self.plate(),    state.document.scene, solved,   std::move(look), state.time.frame,
                                   as.plateSamples, as.denoise,           as.ratio, as.unsure};
    }
    // The image of the model comes first: it takes less time.
    const bool now = wanted && (steadied || self.restFrame() || relitPlates.image(*wanted));
    const std::string trouble = relitPlates.want(now ? wanted : std::nullopt, steadied);
    relitNow = wanted ? relitPlates.image(*wanted) : nullptr;
    if (!trouble.empty()) self.fail("The plate could not be relit", trouble, "It is shown as it is.");
}

void Editor::Impl::keepPlate(std::shared_ptr<const OpenPlate> open) {
    openPlates.push_back(std::move(open));
    if (openPlates.size() > mostPlates) openPlates.erase(openPlates.begin());
}

void Editor::Impl::takeFramesOf(const OpenPlate& open) {
    if (open.plate.frames.empty()) return;
    TimeState& time = self.state.time;
    if (!beforePlate) beforePlate = {time.first, time.last, time.frame, {}};
    beforePlate->plate = open.look.files;
    time.first = open.plate.frames.front().number;
    time.last = std::max(open.plate.frames.back().number, time.first);
    self.goToFrame(std::clamp(time.frame, time.first, time.last));
}

void Editor::Impl::leaveFramesOfPlate() {
    TimeState& time = self.state.time;
    time.first = beforePlate->first, time.last = beforePlate->last;
    for (const int frame : keyFrames(history.present().look)) {
        time.first = std::min(time.first, frame);
        time.last = std::max(time.last, frame);
    }
    const int frame = time.frame >= time.first && time.frame <= time.last ? time.frame : beforePlate->frame;
    beforePlate.reset();
    self.goToFrame(frame);
}

void Editor::Impl::goToPlate(const OpenPlate& open) {
    if (open.plate.frames.empty()) return;
    takeFramesOf(open);
    ViewportState& viewport = self.state.viewport;
    viewport.throughView = false;
    viewport.throughPlate = true;
    self.state.panels.bottomTab = framesTab;
    self.state.panels.bottomFolded = false;
}

void Editor::Impl::pollPlate() {
    if (plateOpening && plateOpening->done()) {
        const auto finished = std::move(plateOpening);
        try {
            const std::shared_ptr<const OpenPlate> open = finished->take();
            const bool known = std::any_of(openPlates.begin(), openPlates.end(),
                                           [&](const auto& other) { return other->look == open->look; });
            keepPlate(open);
            if (!known && !open->trouble.empty())
                self.fail("The plate cannot be shown", open->trouble,
                          "Everything else is as it was. File, Import plate... says where it is now.");
            for (const std::string& fault : open->plate.faults)
                if (!known) self.log(LogLevel::warning, fault);
        } catch (const Cancelled&) {
            // It is opened again when it is wanted.
        } catch (const std::exception& error) {
            self.log(LogLevel::info, std::string("The plate was not opened: ") + error.what());
        }
    }
    const std::optional<PlateLook>& wanted = history.present().look.plate;
    const std::shared_ptr<const OpenPlate> open = self.plate();
    const std::shared_ptr<const Estimate>& solved = history.present().estimate;
    if (wanted && self.state.document.capture && !plateOpening && !history.inGesture() &&
        (!open || (solved && open->estimate != solved && open->trouble.empty())))
        plateOpening = std::make_unique<Job<std::shared_ptr<const OpenPlate>>>(
            [look = *wanted, capture = self.state.document.capture, scene = self.state.document.scene,
             solved](Progress& progress) { return openPlateOf(look, capture, scene, solved, progress); },
            options.wake);
    if (!history.inGesture()) {
        if (open && (!beforePlate || beforePlate->plate != open->look.files)) takeFramesOf(*open);
        else if (!wanted && beforePlate) leaveFramesOfPlate();
    }
    pollRelitPlate();
    if (!open) {
        plates.show(nullptr, 0, false, 0);
        return;
    }
    if (!self.plateCamera()) return;
    const std::string trouble =
        plates.show(open, self.state.time.frame, self.state.time.playing, self.state.time.keptBytes());
    if (!trouble.empty())
        self.fail("A frame of the plate could not be read", trouble, "The other frames are shown as they are.");
}

}  // namespace relamp::ui
