// A scan as a capture folder, and its report.
#pragma once
#include <filesystem>
#include <nlohmann/json_fwd.hpp>

#include "base/input_files.h"
#include "scan/scan.h"

namespace relamp {

/// The axis of the calibration that is up: `name` (as axisFromName takes it), or, for an empty one, the axis nearest to
/// where the cameras' upper sides point, within 25 degrees, else that direction. Throws Error for another name.
Vec3 scanUp(const ScanCalibration& calibration, const std::string& name);

/// Every file that a scan reads.
InputFiles scanFiles(const std::filesystem::path& calibration, const std::vector<ScanPhotographs>& photographs);

/// Throws Error where the folder holds something (unless `overwrite`), or where a file to be written is one of
/// `inputs`. Writes nothing.
void refuseScanOutput(const std::filesystem::path& folder, const std::vector<ScanPhotographs>& photographs,
                      const ScanCalibration& calibration, bool overwrite, const InputFiles& inputs);

/// Writes transforms.json, mesh.ply (metres), images/NAME with the white photographs as they are, masks/ (what the mesh
/// does not hold is no background) and scan.json. Each file whole or not at all. Throws Error, OutOfResources,
/// Cancelled.
void writeScanCapture(const ScanResult& result, const ScanCalibration& calibration,
                      const std::vector<ScanPhotographs>& photographs, const std::filesystem::path& folder,
                      const Vec3& up, Progress& progress);

/// The report: for programs, and for people. Positions in relamp's world (metres, Z up) and in the calibration's axes.
nlohmann::json scanJson(const ScanResult& result, const Vec3& up);
std::string scanText(const ScanResult& result, const Vec3& up);

}  // namespace relamp
