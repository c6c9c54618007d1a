// What one shot's solve did: error over run time by stage, how well each photograph is explained, how well posed the
// equations were, what was left out. One self-contained page, with its figures as CSV and its plots as SVG beside it.
#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "image/image.h"
#include "report/truth_figures.h"
#include "shot/shot_file.h"

namespace relamp {

struct ReportOptions {
    /// Against a distant-only solve of the same capture: when that is likely to take less than `mostSeconds`, always,
    /// never.
    enum class Distant { automatic, on, off } againstDistant = Distant::automatic;
    double mostSeconds = 60;
    std::filesystem::path truth;  ///< folder of known truth; empty: none
};

struct ReportedView {
    std::string name;
    double psnr = 0;         ///< dB, display values on the surfaces
    double distantPsnr = 0;  ///< of the distant-only solve, when there is one
};

struct ReportedWorst {
    std::string name;
    Image photograph, model, difference;  ///< exposed
};

/// The same capture explained by distant light alone.
struct ReportedDistant {
    Estimate estimate;
    double seconds = 0;  ///< from the photographs to the answer
};

/// How a solve of the same capture stood against the truth while it ran.
struct TruthMoment {
    double seconds = 0;  ///< since the photographs were opened
    double psnr = 0;     ///< mean over the relit images in which something changes, dB
};

struct SolveReport {
    std::string shot, capture;  ///< names of the folders
    Estimate estimate;
    DVec3 origin{0};  ///< Capture::origin
    Resources resources;
    std::string quality;
    std::vector<ReportedView> views;
    std::optional<ReportedWorst> worst;  ///< the view explained least well
    std::optional<ReportedDistant> distant;
    std::string noDistantBecause;  ///< when there is none
    std::string noViewsBecause;    ///< when the photographs cannot be reached
    std::optional<TruthFigures> truth;
    std::vector<TruthMoment> truthOverTime;  ///< by a solve made for the report; empty without truth or photographs
};

/// Writes `page` and beside it STEM-timeline.csv, STEM-views.csv, STEM-error.svg, STEM-spectrum.svg, with truth also
/// STEM-truth.csv and STEM-truth.svg: the capture is then solved once more and looked at after each large step. Cost: a
/// frame of at most 400 x 400 pixels for up to 24 views, twice and a whole solve with distant-only. A capture that
/// cannot be reached costs its sections, no more. Throws Error when the shot or the truth cannot be read,
/// OutOfResources, Cancelled.
void writeReport(const std::filesystem::path& shot, const std::filesystem::path& page, const ReportOptions& options,
                 Progress& progress);

/// The page. Pure: the same report gives the same bytes.
std::string reportPage(const SolveReport& report);
/// Error over run time by stage, and the falling eigenvalues of the lighting equations; empty where there is nothing to
/// draw.
std::string errorPlot(const SolveReport& report);
std::string spectrumPlot(const SolveReport& report);
/// Error of relit images over run time; empty without truth.
std::string truthPlot(const SolveReport& report);
/// seconds,psnr_db
std::string truthCsv(const SolveReport& report);
/// mode,seconds,stage,iteration,objective,error
std::string timelineCsv(const SolveReport& report);
/// view,psnr_db,distant_only_psnr_db
std::string viewsCsv(const SolveReport& report);

}  // namespace relamp
