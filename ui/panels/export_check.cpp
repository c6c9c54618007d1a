// What is wrong with an export before it starts.
#include <unistd.h>

#include <algorithm>

#include "base/error.h"
#include "panels/export_dialog.h"
#include "shot/export_frame.h"
#include "shot/frame_numbers.h"
#include "widgets.h"

namespace relamp::ui {
namespace {
namespace fs = std::filesystem;

std::string lowered(std::string s) {
    for (char& c : s) c = c >= 'A' && c <= 'Z' ? char(c - 'A' + 'a') : c;
    return s;
}

/// An error of the command line in the words of the dialog: without the option's name.
std::string withoutOption(std::string words) {
    if (words.starts_with("--"))
        if (const size_t colon = words.find(": "); colon != std::string::npos) words = words.substr(colon + 2);
    return words;
}

}  // namespace

ExportProblems checkExport(const ExportRequest& request, size_t views, int selectedView, const OpenPlate* plate,
                           size_t bookmarks) {
    using Views = ExportRequest::Views;
    ExportProblems problems;
    int first = 1;
    if (request.views == Views::present) problems.frames = 1;
    else if (request.views == Views::plate) {
        try {
            if (!plate || plate->plate.frames.empty()) throw Error("The plate is not open");
            std::vector<int> numbers;
            if (!request.range.empty()) numbers = parseFrameRange(request.range);
            else
                for (const PlateFrame& frame : plate->plate.frames) numbers.push_back(frame.number);
            std::erase_if(numbers, [&](int n) { return plate->at(n)->number != n; });
            problems.frames = numbers.size();
            if (numbers.empty())
                problems.range = fmt::format("The plate has none of these frames; it has {} to {}.",
                                             plate->plate.frames.front().number, plate->plate.frames.back().number);
            else first = numbers.front();
        } catch (const Error& error) {
            problems.range = withoutOption(error.what()) + ". Write numbers like 1-24 or 1-48:2.";
        }
    } else if (request.views == Views::timeline) {
        try {
            const std::vector<int> numbers = parseFrameRange(request.range);
            problems.frames = numbers.size();
            first = numbers.front();
        } catch (const Error& error) {
            problems.range = withoutOption(error.what()) + ". Write numbers like 1-24 or 1-48:2.";
        }
    } else if (request.views == Views::turntable) {
        problems.frames = size_t(std::max(request.moveFrames, 0));
    } else if (request.views == Views::path || request.views == Views::bookmarks) {
        const bool kept = request.views == Views::bookmarks;
        const size_t places = kept ? bookmarks : views;
        problems.frames = size_t(std::max(request.moveFrames, 0));
        try {
            const std::vector<int> numbers = parseFrameRange(request.range);
            if (std::any_of(numbers.begin(), numbers.end(), [&](int n) { return n < 1 || size_t(n) > places; }))
                problems.range = fmt::format("One of these {} does not exist; there are 1 to {}.",
                                             kept ? "bookmarks" : "views", places);
            else if (numbers.size() < 2)
                problems.range = fmt::format("A way goes through two {} at least.", kept ? "bookmarks" : "views");
        } catch (const Error& error) { problems.range = withoutOption(error.what()) + ". Write numbers like 1-3,5."; }
    } else if (request.views == Views::capture) {
        problems.frames = selectedView >= 0 && size_t(selectedView) < views;
        first = selectedView + 1;
    } else if (request.views == Views::all) {
        problems.frames = views;
    } else {
        try {
            std::vector<int> numbers = parseFrameRange(request.range);
            std::erase_if(numbers, [&](int n) { return n < 1 || size_t(n) > views; });
            problems.frames = numbers.size();
            if (numbers.empty()) problems.range = fmt::format("None of these views exists; there are 1 to {}.", views);
            else first = numbers.front();
        } catch (const Error& error) {
            problems.range = withoutOption(error.what()) + ". Write numbers like 1-3,5 or 1-20:2.";
        }
    }
    const std::string name = request.file.filename().string(), extension = lowered(request.file.extension().string());
    const std::optional<NumberPlace> number = numberPlace(name);
    std::error_code failed;
    const fs::path parent = request.file.parent_path();
    if (name.empty()) problems.file = "Choose where the frames go.";
    else if (extension != ".exr" && extension != ".png" && extension != ".jpg" && extension != ".jpeg")
        problems.file = "The name must end in .exr (for compositing), .png or .jpg (to look at).";
    else if (problems.frames > 1 && !number)
        problems.file =
            "Several frames need a place for the number: name.####.exr becomes name.0001.exr, name.0002.exr and so on.";
    else if (!parent.empty() && !fs::is_directory(parent, failed))
        problems.file = fmt::format("The folder {} does not exist.", shown(parent));
    else if (::access(parent.empty() ? "." : parent.c_str(), W_OK) != 0)
        problems.file = fmt::format("You may not write into {}.", shown(parent));
    if (extension != ".exr" && !extension.empty() && !request.layers.empty() && problems.file.empty())
        problems.layers = "PNG and JPEG hold the image only; layers need .exr.";
    if (extension == ".exr" && problems.layers.empty() && !isLossless(request.exr) &&
        ("," + request.layers + ",").find(",cryptomatte,") != std::string::npos)
        problems.layers = fmt::format("{} would change the numbers of the Cryptomatte.", request.exr.compression);
    const bool photographs =
        request.views == Views::capture || request.views == Views::all || request.views == Views::range;
    const bool ownSize = request.width == 0 && request.height == 0;
    const bool residual = ("," + request.layers + ",").find(",residual,") != std::string::npos;
    if (residual && !(photographs && ownSize) && problems.layers.empty())
        problems.layers = "The residual is photograph minus model: it needs views at their own size.";
    if (request.ratio != Ratio::none && request.views != Views::plate && !(photographs && ownSize))
        problems.layers = "Relighting the photograph itself needs views at their own size.";
    std::string firstName = name;
    if (number && number->width <= 32 && request.views != Views::present && request.views != Views::capture)
        firstName =
            name.substr(0, number->begin) + fmt::format("{:0{}}", first, number->width) + name.substr(number->end);
    problems.firstFile = firstName;
    return problems;
}

bool writesExr(const fs::path& file) { return lowered(file.extension().string()) == ".exr"; }

}  // namespace relamp::ui
