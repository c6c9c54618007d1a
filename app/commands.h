// The verbs of the command line: each takes its parsed options and returns an exit code.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/progress.h"
#include "capture/orientation.h"
#include "pipeline/pipeline.h"

namespace relamp::cli {

namespace fs = std::filesystem;

/// Wrong options: exit code 2.
class UsageError : public Error {
public:
    using Error::Error;
};

struct SolveArguments {
    fs::path capture, output;
    CaptureFix fix;
    fs::path merl;
    std::vector<fs::path> probes;                        ///< light probes
    std::vector<std::string> mirrorBalls, grey, charts;  ///< as on the command line
    std::string mode = "near-field", quality = "standard", gauge = "auto", bounce = "auto", basis = "built-in",
                smoothLight = "auto", smoothSurfaces = "auto";
    double timeBudget = 0;
    std::string photometric = "auto";
    std::string registration = "auto";
    long meshTriangles = -1;  ///< below 0: not given
    std::string texture = "auto";
    int gridSide = 0, threads = 0, palette = 0;
    uint64_t seed = 1;
    bool overwrite = false, acceptPoor = false, everything = false, resume = false, findLight = false;
    fs::path list;              ///< in place of `capture`; `output` is then the folder of the shots
    std::string items;          ///< of the list, as numbers of frames are given; empty: all
    bool skipExisting = false;  ///< of the list
};

struct RenderArguments {
    fs::path shot, output, edits;
    /// `camera` empty: not given, view 0 or the plate of the look.
    std::string environment, state, camera, frames, size, layers, naming = "blender", ratio, view = "standard",
                                                                  denoise = "auto";
    float yaw = 0;
    int samples = 0, threads = 0;
    uint64_t seed = 1;
    bool skipExisting = false, multipart = false;
    fs::path plate, plateCamera, plateLens, matte;
    std::string plateCurve = "auto", plateMatch = "auto", plateRotation = "ZXY", matteLight = "keep";
    std::string plateUnsure = "model", exrCompression = "zip", exrDepth = "half";
    int plateOffset = 0, plateSteady = 3;
};

struct ExportArguments {
    fs::path shot, output, edits;
    std::string state;
    int threads = 0;
    bool overwrite = false;
};

struct PaintArguments {
    fs::path shot, target, mask, output, edits;
    std::string camera = "0";
    std::vector<std::string> lights;  ///< ids or names; empty: all that shine
    bool environment = false, keepColours = false;
    float keep = 1e-3f;
    int threads = 0;
    uint64_t seed = 1;
};

struct CompareArguments {
    fs::path capture, output;
    CaptureFix fix;
    std::string quality = "standard";
    int threads = 0;
    uint64_t seed = 1;
};

struct MergeArguments {
    std::vector<fs::path> images;
    fs::path output, response, useResponse, ghosts;
    std::string times;
    bool keepGhosts = false, noAlign = false;
    double smoothness = 1;
    int threads = 0;
};

/// "X,Y,Z" or "X,Y,Z,RADIUS". Throws UsageError.
ProxyLight proxyLightOf(const std::string& text);
/// Those of the command line, which are read. Throws UsageError, and Error for a bad file.
void takeReferences(const SolveArguments& arguments, PipelineOptions& options);
/// The files that light references are read from.
std::vector<fs::path> referenceFiles(const SolveArguments& arguments);
/// "1,2.5,3" as `count` numbers. Throws UsageError that names the option.
std::vector<double> numbersOf(const std::string& text, const std::string& option, size_t count);
/// Becomes relamp-editor, which lies beside this program or on the PATH. Throws Error when it is not installed.
int edit(const std::string& path);
int check(const fs::path& capture, const CaptureFix& fix, bool json, Progress& progress);
/// Throws UsageError for a wrong option.
PipelineOptions pipelineOptions(const SolveArguments& arguments);
int solve(const SolveArguments& arguments, Progress& progress);
int solveList(const SolveArguments& arguments, Progress& progress);
int render(const RenderArguments& arguments, Progress& progress);
/// The same of a plate; called by render().
int renderPlate(const RenderArguments& arguments, Progress& progress);
int exportShot(const ExportArguments& arguments, Progress& progress);
int paint(const PaintArguments& arguments, Progress& progress);
int compare(const CompareArguments& arguments, Progress& progress);
int info(const fs::path& path, const CaptureFix& fix, bool json, Progress& progress);
int mergeHdr(const MergeArguments& arguments, Progress& progress);

}  // namespace relamp::cli
