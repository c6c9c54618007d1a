// Who has a shot open: a file beside it (.NAME.relamp.lock), locked while its process lives, so that two editors, or an
// editor and a solve, cannot overwrite each other's work. A killed process frees its lock; the file it leaves is taken
// over by the next.
#pragma once
#include <filesystem>
#include <string>

namespace relamp {

class ShotLock {
public:
    ShotLock() = default;
    ~ShotLock() { release(); }
    ShotLock(ShotLock&& other) noexcept { *this = std::move(other); }
    ShotLock& operator=(ShotLock&& other) noexcept;

    /// Tries to take the lock of a shot folder, which need not exist yet. Never waits and never throws: held() and
    /// owner() say how it went. Not held and nobody's: the folder around the shot cannot be written, or is not there.
    static ShotLock take(const std::filesystem::path& shot);

    bool held() const { return handle_ >= 0; }
    /// Who holds it instead: "anna on studio3, process 4711, since 2026-11-21 14:03:11"; empty when nobody else does.
    const std::string& owner() const { return owner_; }
    /// The shot, absolute; empty when not held.
    const std::filesystem::path& shot() const { return shot_; }
    void release();

private:
    std::filesystem::path shot_, file_;
    std::string owner_;
    int handle_ = -1;
};

}  // namespace relamp
