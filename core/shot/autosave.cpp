#include "shot/autosave.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <ctime>
#include <nlohmann/json.hpp>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/log.h"

namespace relamp {
namespace {
namespace fs = std::filesystem;
using Json = nlohmann::json;

constexpr const char* suffix = ".autosave.json";

/// Opens and locks; -1 when another process holds it.
int lockFile(const fs::path& file) {
    const int handle = open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
    if (handle < 0) return -1;
    if (flock(handle, LOCK_EX | LOCK_NB) == 0) return handle;
    close(handle);
    return -1;
}

std::string localTime() {
    const std::time_t now = std::time(nullptr);
    std::tm parts{};
    localtime_r(&now, &parts);
    char text[32];
    std::strftime(text, sizeof text, "%Y-%m-%d %H:%M:%S", &parts);
    return text;
}

fs::path with(fs::path stem, const char* ending) {
    stem += ending;
    return stem;
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

fs::path Autosave::estimateFolder() const { return with(stem_, ".relamp"); }

void Autosave::write(const AutosavedWork& work) {
    if (!working()) return;
    const Json document{{"version", 1},
                        {"capture", work.captureFolder.string()},
                        {"shot", work.shotFolder.string()},
                        {"estimate", work.estimateShot.string()},
                        {"look", lookToJson(work.look)},
                        {"stage", work.stage},
                        {"time", localTime()}};
    writeBytesAtomically(with(stem_, suffix), document.dump(1, ' ', false, Json::error_handler_t::replace));
}

void Autosave::clear() {
    if (!working()) return;
    std::error_code error;
    fs::remove(with(stem_, suffix), error);
    fs::remove_all(estimateFolder(), error);
}

std::vector<FoundWork> Autosave::findLost() const {
    std::vector<std::pair<fs::file_time_type, FoundWork>> found;
    std::error_code error;
    for (fs::directory_iterator entry(folder_, error), end; !error && entry != end; entry.increment(error)) {
        const std::string name = entry->path().filename().string();
        const fs::path stem = folder_ / name.substr(0, name.find('.'));
        if (!name.ends_with(suffix) || stem == stem_) continue;
        const int lock = lockFile(with(stem, ".lock"));
        if (lock < 0) continue;  // its process lives
        close(lock);
        try {
            const Json document = Json::parse(readBytes(entry->path(), 64 << 20), nullptr, false);
            FoundWork one;
            one.file = entry->path();
            one.work.captureFolder = document.at("capture").get<std::string>();
            one.work.shotFolder = document.at("shot").get<std::string>();
            one.work.estimateShot = document.at("estimate").get<std::string>();
            one.work.look = lookFromJson(document.at("look"), {});
            one.work.stage = document.at("stage").get<std::string>();
            one.work.time = document.at("time").get<std::string>();
            std::error_code ignored;
            found.emplace_back(fs::last_write_time(entry->path(), ignored), std::move(one));
        } catch (const std::exception& damage) {
            logWarning("{}: is damaged and cannot be recovered ({})", entry->path().string(), damage.what());
        }
    }
    std::sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
    std::vector<FoundWork> works;
    for (auto& [time, work] : found) works.push_back(std::move(work));
    return works;
}

void Autosave::discard(const FoundWork& found) {
    std::error_code error;
    const std::string file = found.file.string();
    const std::string stem = file.substr(0, file.size() - std::string(suffix).size());
    fs::remove(found.file, error);
    fs::remove(stem + ".lock", error);
    fs::remove_all(stem + ".relamp", error);
}

}  // namespace relamp
