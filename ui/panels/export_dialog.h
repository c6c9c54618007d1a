// What is wrong with an export before it starts; apart from the dialog so that tests can ask.
#pragma once
#include <filesystem>
#include <string>

#include "editor.h"

namespace relamp::ui {

struct ExportProblems {
    std::string range, file, layers;  ///< empty: nothing wrong
    std::string firstFile;            ///< what the first frame will be called
    size_t frames = 0;
    bool ok() const { return range.empty() && file.empty() && layers.empty() && frames > 0; }
};
/// `plate`: the one that is open; null: none. `bookmarks`: how many the look has.
ExportProblems checkExport(const ExportRequest& request, size_t views, int selectedView,
                           const OpenPlate* plate = nullptr, size_t bookmarks = 0);

/// By its ending.
bool writesExr(const std::filesystem::path& file);

}  // namespace relamp::ui
