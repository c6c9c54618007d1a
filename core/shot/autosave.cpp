#include "shot/autosave.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <ctime>
#include <nlohmann/json.hpp>
#include <set>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/json_fields.h"
#include "base/local_time.h"
#include "base/log.h"

namespace relamp {
namespace {
namespace fs = std::filesystem;

constexpr const char* suffix = ".autosave.json";

/// Opens and locks; -1 when another process holds it.
int lockFile(const fs::path& file) {
    const int handle = open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
    if (handle < 0) return -1;
    // Without a name it is a file that its last owner has just removed.
    struct stat opened {};
    if (flock(handle, LOCK_EX | LOCK_NB) == 0 && fstat(handle, &opened) == 0 && opened.st_nlink > 0) return handle;
    close(handle);
    return -1;
}

fs::path with(fs::path stem, const std::string& ending) {
    stem += ending;
    return stem;
}

/// "work-4711-0" of "work-4711-0.estimate-2.relamp".
std::string stemOf(const fs::path& file) {
    const std::string name = file.filename().string();
    return name.substr(0, name.find('.'));
}

/// Removes the estimates of a work but `kept`; of a process that is gone also what a killed write left.
void removeEstimates(const fs::path& stem, const fs::path& kept, bool processIsGone) {
    std::error_code error;
    std::vector<fs::path> gone;
    const std::string name = stem.filename().string();
    for (fs::directory_iterator entry(stem.parent_path(), error), end; !error && entry != end; entry.increment(error)) {
        const std::string one = entry->path().filename().string();
        const bool unfinished = processIsGone && one.starts_with("." + name + ".");
        if ((one.starts_with(name + ".estimate-") || unfinished) && entry->path() != kept)
            gone.push_back(entry->path());
    }
    for (const fs::path& one : gone) fs::remove_all(one, error);
}

}  // namespace

Autosave::Autosave(fs::path folder) : folder_(std::move(folder)) {
    std::error_code error;
    fs::create_directories(folder_, error);
    for (int n = 0; n < 100 && lock_ < 0; ++n) {
        stem_ = folder_ / fmt::format("work-{}-{}", getpid(), n);
        // Process numbers come again: a lost work of the same number is not to be taken for one's own.
        if (!fs::exists(with(stem_, suffix), error)) lock_ = lockFile(with(stem_, ".lock"));
    }
    if (lock_ < 0) logWarning("{}: cannot be written, so edits are not saved by themselves", folder_.string());
}

Autosave::~Autosave() {
    if (lock_ < 0) return;
    close(lock_);
    std::error_code error;
    // A work that is still there is left for recovery; its lock is free now.
    if (!fs::exists(with(stem_, suffix), error)) fs::remove(with(stem_, ".lock"), error);
}

fs::path Autosave::estimateFolder(int number) const { return with(stem_, fmt::format(".estimate-{}.relamp", number)); }

void Autosave::keepEstimate(const fs::path& folder) {
    if (working()) removeEstimates(stem_, folder, false);
}

void Autosave::write(const AutosavedWork& work) {
    if (!working()) return;
    Json steps = Json::array();
    for (const AutosavedStep& step : work.steps)
        steps.push_back({{"label", step.label}, {"look", lookToJson(step.look)}});
    const Json document{{"version", 1},
                        {"capture", work.captureFolder.string()},
                        {"shot", work.shotFolder.string()},
                        {"estimate", work.estimateShot.string()},
                        {"look", lookToJson(work.look)},
                        {"steps", steps},
                        {"stage", work.stage},
                        {"time", localTime()}};
    writeBytesAtomically(with(stem_, suffix), dumpJson(document, 1, BadText::replace));
}

void Autosave::clear() {
    if (!working()) return;
    std::error_code error;
    fs::remove(with(stem_, suffix), error);
    removeEstimates(stem_, {}, false);
}

std::vector<FoundWork> Autosave::findLost() const {
    std::vector<std::pair<fs::file_time_type, FoundWork>> found;
    std::error_code error;
    std::set<std::string> stems;
    for (fs::directory_iterator entry(folder_, error), end; !error && entry != end; entry.increment(error))
        if (const std::string stem = stemOf(entry->path()); stem.starts_with("work-") && folder_ / stem != stem_)
            stems.insert(stem);
    for (const std::string& name : stems) {
        const fs::path stem = folder_ / name, file = with(stem, suffix);
        const int lock = lockFile(with(stem, ".lock"));
        if (lock < 0) continue;  // its process lives
        const std::shared_ptr<void> hold(nullptr, [lock](void*) { close(lock); });
        if (!fs::exists(file, error)) {
            // Killed with nothing unsaved, or before the work that was to name its estimate was written.
            fs::remove(with(stem, ".lock"), error);
            removeEstimates(stem, {}, true);
            continue;
        }
        try {
            const Json document = parseJson(readBytes(file, 64 << 20));
            FoundWork one;
            one.file = file;
            one.hold = hold;
            one.work.captureFolder = document.at("capture").get<std::string>();
            one.work.shotFolder = document.at("shot").get<std::string>();
            one.work.estimateShot = document.at("estimate").get<std::string>();
            one.work.look = lookFromJson(document.at("look"), {});
            if (document.contains("steps"))
                for (const Json& step : document["steps"])
                    one.work.steps.push_back({step.at("label").get<std::string>(), lookFromJson(step.at("look"), {})});
            one.work.stage = document.at("stage").get<std::string>();
            one.work.time = document.at("time").get<std::string>();
            std::error_code ignored;
            found.emplace_back(fs::last_write_time(file, ignored), std::move(one));
        } catch (const std::exception& damage) {
            logWarning("{}: is damaged and cannot be recovered ({})", file.string(), damage.what());
        }
    }
    std::sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
    std::vector<FoundWork> works;
    works.reserve(found.size());
    for (auto& [time, work] : found) works.push_back(std::move(work));
    return works;
}

void Autosave::discard(const FoundWork& found) {
    std::error_code error;
    const std::string file = found.file.string();
    const std::string stem = file.substr(0, file.size() - std::string(suffix).size());
    fs::remove(found.file, error);
    removeEstimates(stem, {}, true);
    fs::remove(stem + ".lock", error);
}

}  // namespace relamp
