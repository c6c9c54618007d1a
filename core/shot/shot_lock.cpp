#include "shot/shot_lock.h"

#include <fcntl.h>
#include <pwd.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fmt/format.h>

#include <cerrno>
#include <ctime>
#include <utility>

#include "base/atomic_file.h"
#include "base/error.h"

namespace relamp {
namespace {
namespace fs = std::filesystem;

std::string thisProcess() {
    char host[256] = "";
    gethostname(host, sizeof host - 1);
    const passwd* user = getpwuid(geteuid());
    const std::time_t now = std::time(nullptr);
    std::tm parts{};
    localtime_r(&now, &parts);
    char time[32];
    std::strftime(time, sizeof time, "%Y-%m-%d %H:%M:%S", &parts);
    return fmt::format("{} on {}, process {}, since {}", user ? user->pw_name : std::to_string(geteuid()), host,
                       getpid(), time);
}

/// The first line; a lock file says no more, and what else may stand in it is not shown.
std::string ownerIn(int handle) {
    char text[512];
    const ssize_t size = pread(handle, text, sizeof text, 0);
    std::string owner(text, size_t(std::max<ssize_t>(size, 0)));
    owner.resize(std::min(owner.find('\n'), owner.size()));
    for (char& c : owner)
        if (static_cast<unsigned char>(c) < 32) c = ' ';
    return owner.empty() ? "another process" : owner;
}

bool isStillAt(int handle, const fs::path& file) {
    struct stat opened {
    }, named{};
    return fstat(handle, &opened) == 0 && stat(file.c_str(), &named) == 0 && opened.st_ino == named.st_ino &&
           opened.st_dev == named.st_dev;
}

}  // namespace

ShotLock& ShotLock::operator=(ShotLock&& other) noexcept {
    if (this == &other) return *this;
    release();
    shot_ = std::exchange(other.shot_, {});
    file_ = std::exchange(other.file_, {});
    owner_ = std::exchange(other.owner_, {});
    handle_ = std::exchange(other.handle_, -1);
    return *this;
}

ShotLock ShotLock::take(const fs::path& shot) {
    ShotLock lock;
    fs::path place;
    try {
        place = folderPlace(shot);  // by another way to the same folder it is the same lock
    } catch (const Error&) { return lock; }
    const fs::path file = place.parent_path() / ("." + place.filename().string() + ".lock");
    // The file may be removed by its last owner between our opening and locking it: then once more.
    for (int attempt = 0; attempt < 100; ++attempt) {
        const int handle = open(file.c_str(), O_RDWR | O_CREAT | O_NOFOLLOW | O_CLOEXEC, 0644);
        // Another user's lock can be read at least.
        const int reader = handle >= 0 ? handle : open(file.c_str(), O_RDONLY | O_NOFOLLOW | O_CLOEXEC);
        if (reader < 0) return lock;
        if (flock(reader, LOCK_EX | LOCK_NB) != 0) {
            if (errno == EWOULDBLOCK) lock.owner_ = ownerIn(reader);
            close(reader);
            return lock;
        }
        if (handle < 0) {
            close(reader);
            return lock;
        }
        if (!isStillAt(handle, file)) {
            close(handle);
            continue;
        }
        const std::string text = thisProcess() + "\n";
        // Without the text the lock holds all the same.
        if (ftruncate(handle, 0) != 0 || pwrite(handle, text.data(), text.size(), 0) < 0) errno = 0;
        lock.shot_ = place;
        lock.file_ = file;
        lock.handle_ = handle;
        return lock;
    }
    return lock;
}

void ShotLock::release() {
    if (handle_ < 0) return;
    unlink(file_.c_str());  // before the lock is free: afterwards it could be another's
    close(std::exchange(handle_, -1));
    shot_.clear();
}

}  // namespace relamp
