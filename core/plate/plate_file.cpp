#include "plate/plate_file.h"

#include "base/atomic_file.h"

namespace relamp {

std::filesystem::path plateLightFile(std::filesystem::path frame) { return frame.replace_extension(".light.json"); }

void writePlateFrame(const std::filesystem::path& file, const PlateFrame& frame, const RelitPlate& relit,
                     FrameSources sources, const FrameOptions& options, const FrameFileOptions& fileOptions,
                     Progress& progress) {
    if (relit.matteLight)
        writeBytesAtomically(plateLightFile(file), matteLightJson(frame.number, *relit.matteLight, sources.origin));
    sources.finished = &relit.image;
    writeFrameFile(file, frame.camera, sources, options, fileOptions, progress);
}

}  // namespace relamp
