#include "base/input_files.h"

#include <sys/stat.h>

#include "base/atomic_file.h"
#include "base/error.h"

namespace relamp {
namespace fs = std::filesystem;

void InputFiles::add(const fs::path& file) {
    if (file.empty()) return;
    struct stat found {};
    if (::stat(file.c_str(), &found) == 0) files_.try_emplace({found.st_dev, found.st_ino}, file);
    else places_.insert(folderPlace(file));
}

void InputFiles::addFolder(const fs::path& folder) {
    std::error_code failed;
    constexpr auto options = fs::directory_options::skip_permission_denied;
    for (fs::recursive_directory_iterator at(folder, options, failed), end; !failed && at != end;
         at.increment(failed)) {
        std::error_code unknown;
        if (at->is_regular_file(unknown)) add(at->path());
    }
}

void InputFiles::refuse(const fs::path& target) const {
    if (target.empty()) return;
    struct stat found {};
    if (::stat(target.c_str(), &found) == 0) {
        if (!S_ISREG(found.st_mode))
            throw Error("{}: is {}, it cannot be written over", target.string(),
                        S_ISDIR(found.st_mode) ? "a folder" : "no regular file");
        const auto same = files_.find({found.st_dev, found.st_ino});
        if (same == files_.end()) return;
        if (same->second == target)
            throw Error("{}: belongs to what this command reads, so it is not written over; choose another name",
                        target.string());
        throw Error(
            "{}: is the same file as {}, which this command reads, so it is not written over; choose another name",
            target.string(), same->second.string());
    }
    if (places_.contains(folderPlace(target)))
        throw Error("{}: is the name of another file of this command; choose another one", target.string());
}

void InputFiles::claim(const fs::path& target) {
    refuse(target);
    add(target);
}

}  // namespace relamp
