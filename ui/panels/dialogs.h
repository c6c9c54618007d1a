// The contents of each dialog; dialogs.cpp decides which one is shown and draws its frame.
#pragma once
#include <functional>

#include "browser/file_browser.h"
#include "editor.h"

namespace relamp::ui {

/// Each returns true when it is done and its window closes.
bool drawNotice(Editor& editor);
bool drawUnsavedQuestion(Editor& editor);
bool drawRecoveryOffer(Editor& editor);
bool drawLockedQuestion(Editor& editor);
bool drawMissingQuestion(Editor& editor);
bool drawPanoramaQuestion(Editor& editor);
bool drawReferenceDialog(Editor& editor);
bool drawPlateDialog(Editor& editor);
bool drawExportDialog(Editor& editor);
bool drawKeysDialog(Editor& editor);
bool drawAboutDialog(Editor& editor);
bool drawCommandPalette(Editor& editor);
/// A window of its own beside the viewport, not modal: its switches change what the viewport shows.
void drawImportDoctor(Editor& editor);
/// Its part where photographs get their lighting states.
void drawStatePatterns(Editor& editor);

/// Opens the file browser for a panel; `chosen` runs when something was chosen.
void browse(const BrowserRequest& request, std::function<void(Editor&, const std::filesystem::path&)> chosen);

/// Enter was pressed for the button in blue: not to end a field, not in a list that is open, and not before the dialog
/// could be read.
bool enterConfirms();

/// Where the file browser stands, or stood last; for tests.
const std::filesystem::path& browserFolder();

/// Name to begin with when a document is saved: "room.relamp", also for a shot of that name.
std::string nameToSave(const Document& document);

/// Score of `words` as a loose match of a label, the larger the better; negative: no match. The letters must occur in
/// order, each run of them at the start of a word, or as one run anywhere. A label that begins with them comes first,
/// then a word that does, then a run inside a word. Capitals do not matter.
int fuzzyScore(const std::string& label, const std::string& words);

}  // namespace relamp::ui
