#include "editor_state.h"

#include <algorithm>

namespace relamp::ui {

std::string Document::name() const {
    const std::filesystem::path& path = shotFolder.empty() ? captureFolder : shotFolder;
    std::filesystem::path last = path.filename();
    if (last.empty()) last = path.parent_path().filename();
    return last.string();
}

bool Selection::has(const std::string& id) const {
    return std::find(emitters.begin(), emitters.end(), id) != emitters.end();
}

}  // namespace relamp::ui
