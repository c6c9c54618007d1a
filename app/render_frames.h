// What `relamp render` of cameras and of plates share.
#pragma once
#include <functional>
#include <optional>

#include "commands.h"
#include "relight/look_track.h"
#include "shot/export_frame.h"
#include "shot/shot_file.h"

namespace relamp::cli {

/// The looks that the options ask for.
Look lookOf(const RenderArguments& arguments, const Shot& shot);
LookTrack trackOf(const RenderArguments& arguments, const Look& look);
/// The lighting state that --state names; none where it is not given. Throws UsageError for another name.
std::optional<size_t> stateOf(const std::string& name, const Shot& shot);
/// Frames of the plate that the arguments name, or else the look.
int relightPlate(const RenderArguments& arguments, const Shot& shot, const Look& look, Progress& progress);

/// Throws BadOption.
FrameFileOptions fileOptionsOf(const RenderArguments& arguments);

/// Throws Error where one of `files` would replace a file that this command reads.
void refuseInputs(const RenderArguments& arguments, const Shot& shot, const LookTrack& track,
                  const std::vector<fs::path>& files, Progress& progress);

/// Calls write(index) for each file; it returns what the log says of it. A frame that fails is named and the others go
/// on, but for a full disk. Returns the exit code: 5 where frames failed. Throws the first error when none was written.
int writeFrames(const std::vector<fs::path>& files, bool skipExisting,
                const std::function<std::string(size_t index)>& write);

}  // namespace relamp::cli
