#include "browser/listing.h"

#include <chrono>
#include <cstdlib>
#include <ctime>
#include <map>
#include <unordered_map>

#include "capture/capture_formats.h"
#include "widgets.h"

namespace relamp::ui {
namespace fs = std::filesystem;
namespace {

bool isDigit(char c) { return c >= '0' && c <= '9'; }
char lower(char c) { return c >= 'A' && c <= 'Z' ? char(c - 'A' + 'a') : c; }

std::string lowered(std::string s) {
    for (char& c : s) c = lower(c);
    return s;
}

/// The last number before the extension.
struct Numbered {
    std::string before, after;
    std::string digits;
};
bool findNumber(const std::string& name, Numbered& out) {
    const size_t dot = name.rfind('.');
    size_t end = dot == std::string::npos || dot == 0 ? name.size() : dot;
    while (end > 0 && !isDigit(name[end - 1])) --end;
    size_t begin = end;
    while (begin > 0 && isDigit(name[begin - 1])) --begin;
    if (begin == end || end - begin > 9) return false;
    out = {name.substr(0, begin), name.substr(end), name.substr(begin, end - begin)};
    return true;
}

}  // namespace

bool naturalLess(const std::string& a, const std::string& b) {
    size_t i = 0, j = 0;
    while (i < a.size() && j < b.size()) {
        if (isDigit(a[i]) && isDigit(b[j])) {
            while (i < a.size() && a[i] == '0') ++i;
            while (j < b.size() && b[j] == '0') ++j;
            size_t ie = i, je = j;
            while (ie < a.size() && isDigit(a[ie])) ++ie;
            while (je < b.size() && isDigit(b[je])) ++je;
            if (ie - i != je - j) return ie - i < je - j;
            if (const int order = a.compare(i, ie - i, b, j, je - j)) return order < 0;
            i = ie, j = je;
            continue;
        }
        const unsigned char x = static_cast<unsigned char>(lower(a[i])), y = static_cast<unsigned char>(lower(b[j]));
        if (x != y) return x < y;
        ++i, ++j;
    }
    if (a.size() - i != b.size() - j) return a.size() - i < b.size() - j;
    return a < b;
}

std::vector<FileEntry> collapseSequences(std::vector<FileEntry> entries) {
    struct Group {
        std::vector<size_t> members;
        bool padded = false;
    };
    // Groups by what stands around the number; padded ones are told apart by their width in a second pass.
    std::unordered_map<std::string, Group> groups;
    std::vector<Numbered> numbers(entries.size());
    for (size_t i = 0; i < entries.size(); ++i) {
        if (entries[i].kind != FileEntry::Kind::file || !findNumber(entries[i].path.filename().string(), numbers[i]))
            continue;
        Group& group = groups[numbers[i].before + '/' + numbers[i].after];
        group.members.push_back(i);
        group.padded |= numbers[i].digits.size() > 1 && numbers[i].digits[0] == '0';
    }
    std::vector<uint8_t> gone(entries.size(), 0);
    std::vector<FileEntry> out;
    for (auto& [around, group] : groups) {
        std::map<size_t, std::vector<size_t>> byWidth;
        for (const size_t i : group.members) byWidth[group.padded ? numbers[i].digits.size() : 0].push_back(i);
        for (auto& [width, members] : byWidth) {
            if (members.size() < 3) continue;
            const auto value = [&](size_t i) { return std::stol(numbers[i].digits); };
            const auto [low, high] = std::minmax_element(members.begin(), members.end(),
                                                         [&](size_t a, size_t b) { return value(a) < value(b); });
            FileEntry run{
                FileEntry::Kind::sequence,
                entries[*low].path,
                shown(numbers[*low].before + numbers[*low].digits + "-" + numbers[*high].digits + numbers[*low].after),
                value(*low),
                value(*high),
                members.size()};
            for (const size_t i : members) gone[i] = 1;
            out.push_back(std::move(run));
        }
    }
    for (size_t i = 0; i < entries.size(); ++i)
        if (!gone[i]) out.push_back(std::move(entries[i]));
    std::sort(out.begin(), out.end(), [](const FileEntry& a, const FileEntry& b) {
        const bool af = a.kind == FileEntry::Kind::folder, bf = b.kind == FileEntry::Kind::folder;
        return af != bf ? af : naturalLess(a.name, b.name);
    });
    return out;
}

FolderListing listFolder(const fs::path& folder, bool hidden) {
    FolderListing listing{folder, {}, {}};
    std::error_code failed;
    fs::directory_iterator at(folder, failed);
    if (failed) {
        listing.error = failed == std::errc::permission_denied
                            ? "You may not read this folder. Ask its owner for permission, or choose another."
                        : failed == std::errc::no_such_file_or_directory ? "This folder does not exist."
                        : failed == std::errc::not_a_directory           ? "This is a file, not a folder."
                                                               : "This folder cannot be read: " + failed.message();
        return listing;
    }
    for (; at != fs::directory_iterator(); at.increment(failed)) {
        const std::string name = at->path().filename().string();
        if (!hidden && !name.empty() && name[0] == '.') continue;
        std::error_code ignored;
        const bool directory = at->is_directory(ignored);
        listing.entries.push_back(
            {directory ? FileEntry::Kind::folder : FileEntry::Kind::file, at->path(), shown(name), 0, 0, 1});
        if (failed) break;
    }
    if (failed) listing.error = "Only a part of this folder could be read: " + failed.message();
    std::sort(listing.entries.begin(), listing.entries.end(), [](const FileEntry& a, const FileEntry& b) {
        const bool af = a.kind == FileEntry::Kind::folder, bf = b.kind == FileEntry::Kind::folder;
        return af != bf ? af : naturalLess(a.name, b.name);
    });
    return listing;
}

bool isShotFolder(const fs::path& folder) {
    std::error_code ignored;
    return fs::exists(folder / "shot.json", ignored);
}

fs::path demoCaptures() {
    std::error_code failed;
    const fs::path program = fs::read_symlink("/proc/self/exe", failed);
    return failed ? fs::path() : demoCaptures(program);
}

fs::path demoCaptures(const fs::path& program) {
    fs::path at = program.parent_path();
    for (int up = 0; up < 4 && !at.empty(); ++up, at = at.parent_path())
        for (const char* place : {"share/relamp/captures", "assets/captures"})
            if (std::error_code ignored; fs::is_directory(at / place, ignored)) return at / place;
    return {};
}

FileDetail detailOf(const FileEntry& entry) {
    FileDetail detail;
    std::error_code failed;
    if (entry.kind == FileEntry::Kind::folder) {
        if (const auto found = findCapture(entry.path)) detail.capture = found->format->name;
        detail.shot = isShotFolder(entry.path);
    } else if (const auto bytes = fs::file_size(entry.path, failed); !failed) {
        const double b = double(bytes);
        detail.size = b < 1024         ? fmt::format("{} B", bytes)
                      : b < 1048576    ? fmt::format("{:.0f} KiB", b / 1024)
                      : b < 1073741824 ? fmt::format("{:.1f} MiB", b / 1048576)
                                       : fmt::format("{:.2f} GiB", b / 1073741824);
    }
    if (const auto written = fs::last_write_time(entry.path, failed); !failed) {
        const auto since = std::chrono::duration_cast<std::chrono::seconds>(written - fs::file_time_type::clock::now());
        const std::time_t when = std::time(nullptr) + std::time_t(since.count());
        std::tm local{};
        char words[32] = "";
        if (localtime_r(&when, &local)) std::strftime(words, sizeof words, "%Y-%m-%d %H:%M", &local);
        detail.time = words;
    }
    return detail;
}

bool hasExtension(const fs::path& path, const std::vector<std::string>& extensions) {
    if (extensions.empty()) return true;
    const std::string own = lowered(path.extension().string());
    return std::find(extensions.begin(), extensions.end(), own) != extensions.end();
}

bool containsFolded(const std::string& name, const std::string& part) {
    return lowered(name).find(lowered(part)) != std::string::npos;
}

fs::path homeFolder() {
    const char* home = std::getenv("HOME");
    return home && *home ? fs::path(home) : fs::path("/");
}

}  // namespace relamp::ui
