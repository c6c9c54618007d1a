// What is shown while nothing is open: what was open last, with an image of each, and the example capture.
#include <atomic>
#include <nlohmann/json.hpp>
#include <thread>

#include "base/atomic_file.h"
#include "base/is_there.h"
#include "base/json_fields.h"
#include "browser/listing.h"
#include "image/image_io.h"
#include "item_map.h"
#include "panels/images.h"
#include "panels/panels.h"
#include "thumbnails.h"
#include "widgets.h"

namespace relamp::ui {
namespace {
namespace fs = std::filesystem;

/// Read by a thread of its own, which may outlive the window.
struct Preview {
    std::atomic<bool> done{false};
    Image display;
};

/// The capture of a document that is not open: itself, or what its shot names.
fs::path captureOf(const fs::path& document) {
    if (!isThere(document / "shot.json")) return document;
    const Json json = parseJson(readBytes(document / "shot.json", 256 << 20));
    if (!json.is_object() || !json.contains("capture") || !json["capture"].is_string()) return {};
    return (document / json["capture"].get<std::string>()).lexically_normal();
}

/// One photograph, the first by name.
fs::path firstImage(const fs::path& capture) {
    for (const fs::path& folder : {capture / "images", capture})
        for (const FileEntry& entry : listFolder(folder, false).entries)
            if (entry.kind == FileEntry::Kind::file &&
                hasExtension(entry.path, {".exr", ".hdr", ".png", ".jpg", ".jpeg", ".tif", ".tiff"}))
                return entry.path;
    return {};
}

/// Texture of a document's first photograph; 0 while it is read, and where there is none.
uint64_t previewOf(const fs::path& document) {
    static std::map<fs::path, std::shared_ptr<Preview>> all;
    static bool reading = false;
    auto& preview = all[document];
    if (!preview) {
        if (reading) {
            stayAwake();
            return 0;
        }
        reading = true;
        preview = std::make_shared<Preview>();
        std::thread([preview, document] {
            try {
                if (const fs::path file = firstImage(captureOf(document)); !file.empty())
                    preview->display = displayImage(readImage(file), 256);
            } catch (const std::exception&) {
                // Then there is none.
            }
            preview->done = true;
        }).detach();
    }
    if (!preview->done) {
        stayAwake();
        return 0;
    }
    reading = std::any_of(all.begin(), all.end(), [](const auto& one) { return one.second && !one.second->done; });
    return preview->display.width > 0 ? thumbnail("start:" + document.string(), [&] { return preview->display; }) : 0;
}

/// Looked for once: the page is drawn many times.
const std::vector<fs::path>& exampleCaptures() {
    static const std::vector<fs::path> found = [] {
        std::vector<fs::path> paths;
        if (const fs::path demos = demoCaptures(); !demos.empty())
            for (const FileEntry& entry : listFolder(demos, false).entries)
                if (entry.kind == FileEntry::Kind::folder && paths.size() < 4) paths.push_back(entry.path);
        return paths;
    }();
    return found;
}

struct Card {
    fs::path path;
    std::string name, below;
};

/// True when it was clicked.
bool drawCard(const Card& card, float width, float height) {
    ImGui::BeginGroup();
    const bool pressed = image("##card", previewOf(card.path), width, height, card.name);
    noteItem("start " + card.path.filename().string());
    tooltip(shown(card.path));
    text(elided(card.name, width));
    dimText(elided(card.below, width));
    ImGui::EndGroup();
    return pressed;
}

fs::path drawCards(const std::vector<Card>& cards, float room) {
    const float gap = em(1), least = em(12);
    const int columns = std::max(1, std::min(4, int((room + gap) / (least + gap))));
    const float width = std::floor(std::min(em(17), (room - gap * float(columns - 1)) / float(columns)));
    fs::path chosen;
    const float left = ImGui::GetCursorPosX();
    for (size_t i = 0; i < cards.size(); ++i) {
        if (i % size_t(columns)) ImGui::SameLine(0, gap);
        else ImGui::SetCursorPosX(left);
        ImGui::PushID(int(i));
        if (drawCard(cards[i], width, std::floor(width * 0.75f))) chosen = cards[i].path;
        ImGui::PopID();
        if ((i + 1) % size_t(columns) == 0) ImGui::Dummy({0, em(0.3f)});
    }
    return chosen;
}

}  // namespace

void drawStartPage(Editor& editor) {
    if (!beginChild("##start", {0, 0})) return ImGui::EndChild();
    const float room = ImGui::GetContentRegionAvail().x, margin = std::max(em(1), std::min(em(5), 0.08f * room));
    ImGui::Dummy({0, std::min(em(3), 0.06f * ImGui::GetContentRegionAvail().y)});
    ImGui::Indent(margin);
    const float width = room - 2 * margin;
    ImGui::PushTextWrapPos(ImGui::GetCursorPosX() + width);
    fs::path chosen;
    text("Light a photographed scene anew");
    dimText("Open a capture (photographs, cameras and a mesh), estimate its light, then move, dim or add lights.");
    ImGui::Spacing();
    if (primaryButton("Open...", "A capture's folder, or a saved shot (Ctrl+O). You can also drop it on the window.",
                      em(9)))
        editor.state.panels.openBrowser = true;
    std::vector<Card> recent, examples;
    for (const fs::path& path : editor.state.recent) {
        if (recent.size() == 8 || !isThere(path)) continue;
        const bool shot = path.extension() == ".relamp";
        recent.push_back({path, shown(shot ? path.stem() : path.filename()), shot ? "shot" : "capture"});
    }
    for (const fs::path& path : exampleCaptures())
        examples.push_back({path, shown(path.filename()), "example capture"});
    const auto block = [&](const char* title, const std::vector<Card>& cards) {
        if (cards.empty()) return;
        ImGui::Dummy({0, em(0.8f)});
        heading(title);
        ImGui::Spacing();
        if (const fs::path pressed = drawCards(cards, width); !pressed.empty()) chosen = pressed;
    };
    // Who starts for the first time begins with the example.
    block("Recent", recent);
    block(recent.empty() ? "Try it with an example" : "Examples", examples);
    ImGui::PopTextWrapPos();
    ImGui::Unindent(margin);
    ImGui::EndChild();
    if (!chosen.empty()) editor.open(chosen);
}

}  // namespace relamp::ui
