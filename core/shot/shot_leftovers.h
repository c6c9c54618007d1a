// What a process that was killed while it saved a shot leaves beside it, and how it is set right.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

namespace relamp {

/// A shot is saved into .NAME.PID and exchanged with the old one, which is then removed. Where a killed process left
/// such a folder, the files in it that relamp did not write move back into the shot, a shot that was only moved aside
/// returns, and the rest is removed, and so are checkpoints that were not put in place; a whole checkpoint stays for
/// `solve --resume`. Folders of processes that live are left alone, and so are those of other machines while they hold
/// them. Never throws: a folder that cannot be read or written stays as it is. Cost: one listing of the folder around
/// the shot.
void mendShot(const std::filesystem::path& shot);

/// Whether relamp wrote the entry of this name in a shot's folder.
bool isPartOfShot(const std::string& name);

/// The files that relamp writes into a shot's folder, beside `cache`.
const std::vector<std::string>& shotParts();

/// Keeps a folder from being taken for a leftover, while it lives.
class FolderHold {
public:
    explicit FolderHold(const std::filesystem::path& folder);
    ~FolderHold();
    FolderHold(const FolderHold&) = delete;
    FolderHold& operator=(const FolderHold&) = delete;

private:
    int handle_;
};

}  // namespace relamp
