// The formats that a capture's cameras are read from: one table, one row a format. Loading, checking and the window's
// file browser all read it.
#pragma once
#include <filesystem>
#include <optional>
#include <span>
#include <string>

#include "capture/capture_source.h"

namespace relamp {

struct CaptureFormat {
    const char* name;     ///< "COLMAP model"
    const char* marks;    ///< what a capture folder holds in this format, for hints: "a COLMAP model (sparse/0)"
    const char* reading;  ///< progress label
    /// What holds the cameras of the capture in `folder`: a file or a folder; none: no capture of this format. Cheap:
    /// names are looked at, nothing is opened but the heads of a few files.
    std::optional<std::filesystem::path> (*find)(const std::filesystem::path& folder);
    /// Whether a file of that name is one of the format's own.
    bool (*owns)(const std::string& fileName);
    /// Throws Error naming file and field.
    CaptureSource (*read)(const std::filesystem::path& folder, const std::filesystem::path& cameras,
                          const CaptureFix& fix, Progress& progress);
    /// Where the user names the place of the cameras; null: they cannot.
    std::string CaptureFix::*named = nullptr;
};

/// A folder that holds several formats is read as the first of them.
std::span<const CaptureFormat> captureFormats();

struct FoundCapture {
    const CaptureFormat* format = nullptr;
    std::filesystem::path cameras;
};
/// Of the capture in `folder`; none: it is no capture. Never throws for places that cannot be looked at.
std::optional<FoundCapture> findCapture(const std::filesystem::path& folder);

/// The capture folder that a format's own file belongs to (room/sparse/0/cameras.bin: room); other paths as they are.
std::filesystem::path captureFolderOf(const std::filesystem::path& path);

/// "transforms.json or a COLMAP model (sparse/0)"
std::string captureMarks();

// ---- the readers of the rows

CaptureSource sourceFromTransforms(const std::filesystem::path& folder, const std::filesystem::path& file,
                                   const CaptureFix& fix, Progress& progress);
CaptureSource sourceFromColmap(const std::filesystem::path& folder, const std::filesystem::path& model,
                               const CaptureFix& fix, Progress& progress);

}  // namespace relamp
