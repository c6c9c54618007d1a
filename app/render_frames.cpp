#include "render_frames.h"

#include <optional>

#include "base/is_there.h"
#include "base/log.h"
#include "base/printable.h"
#include "plate/plate_sequence.h"

namespace relamp::cli {

Look lookOf(const RenderArguments& a, const Shot& shot) {
    return a.edits.empty() ? shot.look : readLook(a.edits, shot.capture.origin);
}

std::optional<size_t> stateOf(const std::string& name, const Shot& shot) {
    if (name.empty()) return {};
    std::string names;
    for (size_t s = 0; s < shot.estimate.states.size(); ++s) {
        if (shot.estimate.states[s].name == name) return s;
        names += (s ? ", " : "") + shot.estimate.states[s].name;
    }
    throw UsageError(names.empty() ? "--state: the photographs of this shot are of one lighting state"
                                   : fmt::format("--state {}: expected one of {}", printable(name), names));
}

LookTrack trackOf(const RenderArguments& a, const Look& look) {
    LookTrack track(look);
    track.apply([&](Look& one) {
        if (a.environment == "none") one.environment.source = EnvironmentLook::Source::none;
        else if (a.environment == "recovered") one.environment.source = EnvironmentLook::Source::recovered;
        else if (!a.environment.empty()) {
            one.environment.source = EnvironmentLook::Source::file;
            one.environment.file = a.environment;
        }
        one.environment.yawDegrees += a.yaw;
    });
    return track;
}

FrameFileOptions fileOptionsOf(const RenderArguments& a) {
    FrameFileOptions options;
    options.layers = a.layers;
    options.naming = layerNaming(a.naming);
    options.multipart = a.multipart;
    options.view = displayView(a.view);
    options.exr = exrFormat(a.exrCompression, a.exrDepth, a.layers);
    if (!a.ratio.empty()) options.ratio = a.ratio == "difference" ? Ratio::difference : Ratio::quotient;
    return options;
}

void refuseInputs(const RenderArguments& a, const Shot& shot, const LookTrack& track,
                  const std::vector<fs::path>& files, Progress& progress) {
    InputFiles inputs = shotFiles(shot, progress);
    for (const fs::path& one : {a.edits, fs::path(a.camera), a.plateCamera, a.plateLens}) inputs.add(one);
    for (const auto& [pattern, what] : {std::pair(a.plate, "--plate"), std::pair(a.matte, "--matte")})
        if (!pattern.empty())
            for (const auto& one : plateFiles(pattern, what)) inputs.add(one.second);
    LookTrack(track).apply([&](Look& look) {
        for (const auto& file : filesOf(look)) inputs.add(file);
    });
    for (const fs::path& file : files) inputs.refuse(file);
}

int writeFrames(const std::vector<fs::path>& files, bool skipExisting,
                const std::function<std::string(size_t index)>& write) {
    int failures = 0, written = 0, skipped = 0;
    std::optional<Error> first;
    for (size_t i = 0; i < files.size(); ++i) {
        const std::string file = files[i].string();
        if (skipExisting && isThere(files[i])) {
            logInfo("{}: exists, skipped", file);
            ++skipped;
            continue;
        }
        try {
            const std::string said = write(i);
            ++written;
            logInfo("{}: written ({} of {}), {}", file, written, files.size(), said);
        } catch (const OutOfResources& error) {
            if (!written) throw;
            // The others would not fit either; --skip-existing goes on from here.
            logWarning("{}; stopped after {} of {} frames", error.what(), written, files.size());
            ++failures;
            break;
        } catch (const Error& error) {
            if (files.size() == 1) throw;
            logWarning("{}", error.what());
            if (!first) first = error;
            ++failures;
        }
    }
    if (first && !written && !skipped) throw *first;
    return failures ? 5 : 0;
}

}  // namespace relamp::cli
