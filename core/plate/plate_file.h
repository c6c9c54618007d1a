// A relit frame of a plate on disk, with what goes beside it.
#pragma once
#include "plate/relight_plate.h"
#include "shot/export_frame.h"

namespace relamp {

/// What the light at a frame's matte goes into, beside the frame: FRAME.light.json.
std::filesystem::path plateLightFile(std::filesystem::path frame);

/// Writes the relit frame with its layers by writeFrameFile, and first the light at its matte: a frame that is there
/// means that all of its files are. `sources`: look, captured and origin; `finished` is set here. Throws as
/// writeFrameFile does.
void writePlateFrame(const std::filesystem::path& file, const PlateFrame& frame, const RelitPlate& relit,
                     FrameSources sources, const FrameOptions& options, const FrameFileOptions& fileOptions,
                     Progress& progress);

}  // namespace relamp
