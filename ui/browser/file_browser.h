// The file browser inside the window: the same on every desktop, knows captures, shots and numbered sequences, and
// never runs in the way of the window: a folder is read once, in the background.
#pragma once
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace relamp::ui {

struct BrowserRequest {
    enum class Mode { open, save, folder } mode = Mode::open;
    std::string title = "Open", confirm = "Open";
    std::filesystem::path start;          ///< folder to begin in; empty: the last one, or home
    std::string name;                     ///< save: the name to begin with
    std::vector<std::string> extensions;  ///< ".exr", ...: others are shown only on demand; empty: all. save: the first
                                          ///< is added when the name has none
    bool captures = false;                ///< open: folders that hold a capture or a shot can be chosen
    bool replacesShots = false;  ///< save: the result is a shot folder, which may replace a shot and nothing else
    std::string note;            ///< a sentence under the title
};

class FileBrowser {
public:
    FileBrowser();
    ~FileBrowser();
    void begin(const BrowserRequest& request);
    enum class Answer { none, chosen, cancelled };
    /// Draws into the present popup or window.
    Answer draw(const std::vector<std::filesystem::path>& recent);
    const std::filesystem::path& chosen() const;
    const BrowserRequest& request() const;
    /// What the list shows now (after sequences and filter); for tests.
    std::vector<std::string> names() const;
    const std::filesystem::path& folder() const;
    bool reading() const;

private:
    struct State;
    class Drawing;
    std::unique_ptr<State> state_;
};

}  // namespace relamp::ui
