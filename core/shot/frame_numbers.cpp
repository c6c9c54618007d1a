#include "shot/frame_numbers.h"

namespace relamp {

std::optional<NumberPlace> numberPlace(const std::string& name, size_t from) {
    for (size_t at = from; at < name.size(); ++at) {
        if (name[at] == '#') {
            const size_t end = std::min(name.find_first_not_of('#', at), name.size());
            return NumberPlace{at, end, end - at};
        }
        if (name[at] != '%') continue;
        const size_t end = std::min(name.find_first_not_of("0123456789", at + 1), name.size());
        if (end == name.size() || name[end] != 'd') continue;
        const std::string width = name.substr(at + 1, end - at - 1);
        return NumberPlace{at, end + 1, width.empty() ? 1 : width.size() > 4 ? 9999 : size_t(std::stoi(width))};
    }
    return std::nullopt;
}

std::string numbered(const std::filesystem::path& path, int number) {
    constexpr size_t widest = 32;
    const std::string name = path.filename().string();
    const std::optional<NumberPlace> place = numberPlace(name);
    if (!place) return "";
    if (place->width > widest)
        throw BadOption("{}: a frame number of {} digits is too wide", path.string(), place->width);
    if (numberPlace(name, place->end))
        throw BadOption("{}: has two places for the frame's number, expected one", path.string());
    return (path.parent_path() /
            (name.substr(0, place->begin) + fmt::format("{:0{}}", number, place->width) + name.substr(place->end)))
        .string();
}

std::optional<int> numberInName(const std::filesystem::path& file) {
    const std::string stem = file.stem().string();
    const auto digit = [](char c) { return c >= '0' && c <= '9'; };
    size_t end = stem.size();
    while (end > 0 && !digit(stem[end - 1])) --end;
    size_t begin = end;
    while (begin > 0 && digit(stem[begin - 1])) --begin;
    if (begin == end || end - begin > 9) return std::nullopt;
    return std::stoi(stem.substr(begin, end - begin));
}

}  // namespace relamp
