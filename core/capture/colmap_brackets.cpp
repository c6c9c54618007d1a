#include "capture/colmap_brackets.h"

#include <charconv>
#include <cmath>
#include <map>

#include "image/image_io.h"

namespace relamp {
namespace fs = std::filesystem;
namespace {

/// A name taken apart: FOLDER/STEM, stops, ending.
struct Named {
    std::string stem, ending;
    double stops = 0;
    bool says = false;  ///< it has an _evN
};

Named takeApart(const std::string& name) {
    const fs::path path(name);
    Named named{(path.parent_path() / path.stem()).string(), path.extension().string()};
    const size_t at = named.stem.rfind("_ev");
    if (at == std::string::npos || named.stem.find('/', at) != std::string::npos) return named;
    const char* first = named.stem.data() + at + 3;
    const char* last = named.stem.data() + named.stem.size();
    if (first < last && *first == '+') ++first;
    double stops = 0;
    const auto [end, error] = std::from_chars(first, last, stops, std::chars_format::fixed);
    if (error != std::errc() || end != last || !(std::abs(stops) <= 30)) return named;
    named.stops = stops;
    named.says = true;
    named.stem.resize(at);
    return named;
}

}  // namespace

std::vector<ColmapBracket> colmapBrackets(const fs::path& images, const std::vector<ColmapView>& views) {
    // Every folder that holds a view is listed once.
    std::map<std::string, std::map<std::string, std::vector<std::pair<double, fs::path>>>>
        folders;  // folder, stem + ending -> exposures
    const auto exposuresOf = [&](const Named& named) {
        const std::string folder = fs::path(named.stem).parent_path().string();
        const auto [at, fresh] = folders.try_emplace(folder);
        std::error_code failed;
        if (fresh)
            for (fs::directory_iterator entry(images / folder, failed), end; !failed && entry != end;
                 entry.increment(failed)) {
                const Named other = takeApart((fs::path(folder) / entry->path().filename()).string());
                at->second[other.stem + other.ending].emplace_back(other.stops, entry->path());
            }
        return at->second[named.stem + named.ending];
    };
    std::map<std::string, size_t> known;
    std::vector<ColmapBracket> result;
    for (const ColmapView& view : views) {
        const Named named = takeApart(view.name);
        const auto [at, fresh] = known.try_emplace(named.stem + named.ending, result.size());
        if (!fresh) {
            ColmapBracket& earlier = result[at->second];
            if (std::abs(named.stops) < std::abs(takeApart(earlier.view.name).stops)) earlier.view = view;
            continue;
        }
        ColmapBracket bracket{view, {}};
        std::vector<std::pair<double, fs::path>> files = exposuresOf(named);
        std::sort(files.begin(), files.end());
        if (files.size() >= 2) {
            bool timed = true;
            for (const auto& [stops, file] : files) timed = timed && readExposureTags(file).seconds > 0;
            for (const auto& [stops, file] : files)
                bracket.exposures.push_back({fs::absolute(file).string(), timed ? 0 : std::exp2(stops), 0, 0});
        }
        result.push_back(std::move(bracket));
    }
    return result;
}

}  // namespace relamp
