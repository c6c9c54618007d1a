#include "shot/shot_leftovers.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <optional>
#include <vector>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/log.h"
#include "capture/lighting_states.h"
#include "shot/shot_document.h"

namespace relamp {
namespace {
namespace fs = std::filesystem;

struct Leftover {
    fs::path folder;
    bool aside = false;  ///< the old shot of a file system that cannot exchange folders
};

/// Whether `number` names a process that is gone.
bool deadProcess(const std::string& number) {
    if (number.empty() || number.size() > 9 ||
        !std::all_of(number.begin(), number.end(), [](char c) { return c >= '0' && c <= '9'; }))
        return false;
    const int process = std::stoi(number);
    return process > 0 && kill(process, 0) != 0 && errno != EPERM;
}

/// A checkpoint that its solve did not get to put in place, "..NAME.relamp.4711.checkpoint".
bool unfinishedCheckpoint(const std::string& name, const std::string& shotName) {
    const std::string prefix = ".." + shotName + ".", suffix = ".checkpoint";
    return name.size() > prefix.size() + suffix.size() && name.starts_with(prefix) && name.ends_with(suffix) &&
           deadProcess(name.substr(prefix.size(), name.size() - prefix.size() - suffix.size()));
}

std::optional<Leftover> leftoverOf(const fs::path& entry, const std::string& shotName) {
    std::string name = entry.filename().string();
    const std::string prefix = "." + shotName + ".";
    if (!name.starts_with(prefix)) return {};
    name.erase(0, prefix.size());
    const bool aside = name.ends_with(".old");
    if (aside) name.resize(name.size() - 4);
    if (!deadProcess(name)) return {};
    const int handle = open(entry.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC | O_NOFOLLOW);
    if (handle < 0) return {};
    const bool free = flock(handle, LOCK_EX | LOCK_NB) == 0;
    close(handle);
    if (!free) return {};
    return Leftover{entry, aside};
}

/// Temporary files of the writers, ".environment.4711.exr".
bool isTemporary(const std::string& name) {
    for (const char* stem : {".shot.", ".environment.", ".environment_", ".environment-", ".reflectance."})
        if (name.starts_with(stem)) return true;
    return false;
}

/// "environment-2.exr" or "environment-2_sigma.exr", of a lighting state.
bool isStateEnvironment(const std::string& name) {
    for (int k = 1; k < int(mostStates); ++k)
        for (const char* end : environmentEnds)
            if (name == environmentStem(k) + end) return true;
    return false;
}

/// Moves what relamp did not write into the shot; true when nothing had to stay.
bool takeBack(const fs::path& from, const fs::path& shot) {
    bool all = true;
    std::error_code failed;
    std::vector<fs::path> entries;
    for (fs::directory_iterator entry(from, failed), end; !failed && entry != end; entry.increment(failed))
        entries.push_back(entry->path());
    if (failed) return false;
    for (const fs::path& entry : entries) {
        const std::string name = entry.filename().string();
        if (isPartOfShot(name) || isTemporary(name)) continue;
        std::error_code kept;
        if (fs::exists(fs::symlink_status(shot / name, kept))) all = false;
        else fs::rename(entry, shot / name, kept);
        all &= !kept;
    }
    return all;
}

}  // namespace

bool isPartOfShot(const std::string& name) {
    return name == "cache" || isStateEnvironment(name) ||
           std::find(shotParts().begin(), shotParts().end(), name) != shotParts().end();
}

const std::vector<std::string>& shotParts() {
    static const std::vector<std::string> parts{
        "shot.json", "environment.exr", "environment_sigma.exr", "environment_background.exr", "reflectance.ply",
        "added.ply", "albedo.exr",      "albedo_confidence.exr"};
    return parts;
}

void mendShot(const fs::path& given) {
    std::error_code failed;
    fs::path shot;
    try {
        shot = folderPlace(given);
    } catch (const Error&) { return; }
    std::vector<Leftover> leftovers;
    std::vector<fs::path> unfinished;
    for (fs::directory_iterator entry(shot.parent_path(), failed), end; !failed && entry != end;
         entry.increment(failed)) {
        if (auto one = leftoverOf(entry->path(), shot.filename().string())) leftovers.push_back(*one);
        else if (unfinishedCheckpoint(entry->path().filename().string(), shot.filename().string()))
            unfinished.push_back(entry->path());
    }
    for (const fs::path& file : unfinished) fs::remove(file, failed);
    if (leftovers.empty()) return;
    // Killed between moving the old one aside and putting the new one there: shot.json is written last, so what has it
    // is whole.
    if (!fs::exists(fs::symlink_status(shot, failed))) {
        std::stable_sort(leftovers.begin(), leftovers.end(),
                         [](const Leftover& a, const Leftover& b) { return a.aside < b.aside; });
        for (size_t i = 0; i < leftovers.size(); ++i) {
            if (!fs::exists(leftovers[i].folder / "shot.json", failed)) continue;
            fs::rename(leftovers[i].folder, shot, failed);
            if (failed) return;
            logInfo("{}: put back, where an interrupted save had left it", shot.string());
            leftovers.erase(leftovers.begin() + std::ptrdiff_t(i));
            break;
        }
        if (!fs::exists(shot, failed)) return;
    }
    for (const Leftover& one : leftovers) {
        if (takeBack(one.folder, shot)) fs::remove_all(one.folder, failed);
        else logWarning("{}: some files of an interrupted save are left in {}", shot.string(), one.folder.string());
    }
}

FolderHold::FolderHold(const fs::path& folder) : handle_(open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)) {
    if (handle_ >= 0 && flock(handle_, LOCK_EX | LOCK_NB) != 0)
        errno = 0;  // a file system without locks: the process number has to do
}

FolderHold::~FolderHold() {
    if (handle_ >= 0) close(handle_);
}

}  // namespace relamp
