#include "scan_command.h"

#include <nlohmann/json.hpp>

#include <charconv>

#include "base/json_fields.h"
#include "base/log.h"
#include "base/parallel.h"
#include "print_result.h"
#include "scan/scan_capture.h"

namespace relamp::cli {
namespace {

/// "10,9" or "1024x768". Throws UsageError.
std::array<int, 2> wholeNumbersOf(const std::string& text, char between, int most, const char* wrong) {
    std::array<int, 2> values{};
    const char* at = text.data();
    const char* const end = at + text.size();
    for (size_t i = 0; i < 2; ++i) {
        const auto read = std::from_chars(at, end, values[i]);
        const bool goesOn = i == 0 ? read.ptr != end && *read.ptr == between : read.ptr == end;
        if (read.ec != std::errc() || !goesOn || values[i] < 1 || values[i] > most) throw UsageError(wrong);
        at = read.ptr + 1;
    }
    return values;
}

}  // namespace

int scan(const ScanArguments& a, Progress& progress) {
    ScanOptions options;
    if (!a.bits.empty())
        options.bits = wholeNumbersOf(a.bits, ',', mostScanBits, "--bits: expected two numbers from 1 to 14, as 10,9");
    if (!a.projector.empty())
        options.projectorSize =
            wholeNumbersOf(a.projector, 'x', 1 << mostScanBits, "--projector-size: expected WIDTHxHEIGHT, as 1024x768");
    options.mostGap = a.mostGap / 1000;
    options.mesh.triangles = a.triangles;
    const ThreadLimit limit(a.threads);
    const fs::path file = a.cameras.empty() ? a.folder / "cameras.json" : a.cameras;
    ScanCalibration calibration = readScanCalibration(file);
    // Photographs lie in the scan's folder, wherever the calibration does.
    if (!a.cameras.empty())
        for (ScanCamera& camera : calibration.cameras)
            camera.folder = a.folder / camera.folder.lexically_relative(file.parent_path());
    const Vec3 up = scanUp(calibration, a.up);
    std::vector<ScanPhotographs> photographs;
    const ScanInput input = openScan(calibration, options, photographs);
    refuseScanOutput(a.output, photographs, calibration, a.overwrite, scanFiles(file, photographs));
    const ScanResult result = scanSurface(calibration, input, options, progress);
    for (const std::string& note : result.notes) logWarning("{}", note);
    writeScanCapture(result, calibration, photographs, a.output, up, progress);
    printResult(a.json ? dumpJson(scanJson(result, up), 1) : scanText(result, up));
    return 0;
}

}  // namespace relamp::cli
