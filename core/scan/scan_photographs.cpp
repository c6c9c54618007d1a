#include "scan/scan_photographs.h"

#include <algorithm>
#include <charconv>
#include <map>
#include <optional>

#include "base/error.h"
#include "image/image_files.h"

namespace relamp {
namespace {
namespace fs = std::filesystem;

bool isPhotographName(const fs::path& file) {
    static const char* const endings[] = {".jpg", ".jpeg", ".png", ".tif", ".tiff", ".exr", ".hdr", ".dpx"};
    const std::string ending = lowerExtension(file);
    return file.filename().string()[0] != '.' &&
           std::any_of(std::begin(endings), std::end(endings), [&](const char* known) { return ending == known; });
}

/// The number that a name ends in.
std::optional<size_t> numberAtEnd(const fs::path& file) {
    const std::string stem = file.stem().string();
    size_t begin = stem.size();
    while (begin > 0 && stem[begin - 1] >= '0' && stem[begin - 1] <= '9') --begin;
    size_t number = 0;
    const auto read = std::from_chars(stem.data() + begin, stem.data() + stem.size(), number);
    if (begin == stem.size() || read.ec != std::errc()) return std::nullopt;
    return number;
}

std::vector<fs::path> photographsIn(const fs::path& folder) {
    std::vector<fs::path> files;
    std::error_code failed;
    for (fs::directory_iterator at(folder, failed); !failed && at != fs::directory_iterator(); at.increment(failed)) {
        std::error_code ignored;
        if (at->is_regular_file(ignored) && isPhotographName(at->path())) files.push_back(at->path());
        if (files.size() > 4096) throw Error("{}: holds more than 4096 photographs", folder.string());
    }
    if (failed) throw Error("{}: cannot be read as a folder ({})", folder.string(), failed.message());
    if (files.empty()) throw Error("{}: holds no photographs", folder.string());
    std::sort(files.begin(), files.end());
    return files;
}

/// By number, where every file has one of its own.
std::optional<std::map<size_t, fs::path>> byNumber(const std::vector<fs::path>& files) {
    std::map<size_t, fs::path> numbered;
    for (const fs::path& file : files) {
        const auto number = numberAtEnd(file);
        if (!number || !numbered.emplace(*number, file).second) return std::nullopt;
    }
    return numbered;
}

void takeBits(ScanBits& bits, size_t count, const std::string& where) {
    if (bits[0] > 0 && bits[1] > 0) return;
    // The very last inverse may be missing everywhere.
    const size_t even = count % 4 == 1 ? count + 1 : count;
    if (even < 6 || even % 4 != 2)
        throw Error(
            "{}: {} photographs, expected white, black and four for every bit along both axes (6, 10, ... 42); "
            "--bits says how many bits there are along each",
            where, count);
    const size_t each = (even - 2) / 4;
    if (each > size_t(mostScanBits))
        throw Error("{}: {} photographs would be {} bits along each axis, expected at most {}", where, count, each,
                    mostScanBits);
    bits = {int(each), int(each)};
}

}  // namespace

std::vector<ScanPhotographs> findScanPhotographs(const std::vector<fs::path>& folders, ScanBits& bits) {
    std::vector<std::vector<fs::path>> files;
    std::vector<std::optional<std::map<size_t, fs::path>>> numbered;
    size_t first = ~size_t(0), count = 0;
    bool allNumbered = true;
    for (const fs::path& folder : folders) {
        files.push_back(photographsIn(folder));
        numbered.push_back(byNumber(files.back()));
        allNumbered = allNumbered && numbered.back();
        if (numbered.back()) first = std::min(first, numbered.back()->begin()->first);
    }
    for (size_t i = 0; i < folders.size(); ++i)
        count = std::max(count, allNumbered ? numbered[i]->rbegin()->first - first + 1 : files[i].size());
    const std::string where = folders.size() == 1 ? folders[0].string() : folders[0].parent_path().string();
    takeBits(bits, count, where);
    const size_t places = 2 + 2 * size_t(bits[0] + bits[1]);
    if (count > places)
        throw Error("{}: photograph {} of a camera is beyond the {} that {} and {} bits have", where, count, places,
                    bits[0], bits[1]);
    std::vector<ScanPhotographs> found;
    for (size_t i = 0; i < folders.size(); ++i) {
        ScanPhotographs scan{folders[i], std::vector<fs::path>(places)};
        if (allNumbered)
            for (const auto& [number, file] : *numbered[i]) scan.files[number - first] = file;
        else std::copy(files[i].begin(), files[i].end(), scan.files.begin());
        for (size_t place : {0, 1})
            if (scan.files[place].empty())
                throw Error("{}: the {} photograph is missing (the {})", folders[i].string(),
                            place == 0 ? "white" : "black", place == 0 ? "first" : "second");
        found.push_back(std::move(scan));
    }
    return found;
}

std::string nameOfPlace(const ScanBits& bits, size_t place) {
    if (place < 2) return place == 0 ? "white" : "black";
    const bool second = place >= patternPlace(bits, 1, 0);
    const size_t within = place - patternPlace(bits, second ? 1 : 0, 0);
    return fmt::format("{} axis, bit {} of {}, {}", second ? "second" : "first", within / 2 + 1, bits[second ? 1 : 0],
                       within % 2 ? "inverse" : "pattern");
}

}  // namespace relamp
