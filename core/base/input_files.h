// The files that a command reads. Nothing that it writes may replace one of them.
#pragma once
#include <sys/types.h>

#include <filesystem>
#include <map>
#include <set>
#include <utility>

namespace relamp {

/// Files by device and number, so that every name of a file counts: relative ones, links, hard links. Files that are
/// not there count by their place.
class InputFiles {
public:
    /// An empty name is nothing.
    void add(const std::filesystem::path& file);
    /// Every file in a folder and below it; what cannot be looked at is left out.
    void addFolder(const std::filesystem::path& folder);
    /// Throws Error naming both when `target` is one of them, and where something stands there that is no file.
    void refuse(const std::filesystem::path& target) const;
    /// refuse(), then add(): for a command that writes several files, which must not be one.
    void claim(const std::filesystem::path& target);

private:
    std::map<std::pair<dev_t, ino_t>, std::filesystem::path> files_;
    std::set<std::filesystem::path> places_;
};

}  // namespace relamp
