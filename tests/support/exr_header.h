// Reads the header of an OpenEXR file by hand, so that channel names and kinds are seen as they are on disk.
#pragma once
#include <cstring>
#include <filesystem>
#include <map>
#include <set>
#include <stdexcept>
#include <string>

#include "support/temporary_folder.h"

namespace relamp::test {

struct ExrHeader {
    std::map<std::string, std::string> channels;  ///< name -> "half", "float" or "uint"
    std::map<std::string, std::string> types;     ///< attribute -> its kind
    std::string compression;
    bool multipart = false;
    std::set<std::string> channelNames() const {
        std::set<std::string> names;
        for (const auto& [name, type] : channels) names.insert(name);
        return names;
    }
};

inline ExrHeader readExrHeader(const std::filesystem::path& file) {
    const std::string bytes = TemporaryFolder::read(file);
    size_t at = 0;
    const auto number = [&] {
        uint32_t value = 0;
        if (at + 4 > bytes.size()) throw std::runtime_error("the header ends early");
        std::memcpy(&value, bytes.data() + at, 4);
        at += 4;
        return value;
    };
    const auto text = [&] {
        const size_t end = bytes.find('\0', at);
        if (end == std::string::npos) throw std::runtime_error("the header ends early");
        const std::string word = bytes.substr(at, end - at);
        at = end + 1;
        return word;
    };
    if (number() != 20000630) throw std::runtime_error("no OpenEXR file");
    ExrHeader header;
    header.multipart = number() >> 12 & 1;
    while (bytes.at(at) != '\0') {
        const std::string name = text(), type = text();
        const size_t size = number(), end = at + size;
        header.types[name] = type;
        if (name == "compression") {
            const char* names[] = {"none", "rle", "zips", "zip", "piz", "pxr24", "b44", "b44a", "dwaa", "dwab"};
            header.compression = bytes.at(at) < 10 ? names[int(bytes.at(at))] : "other";
        }
        if (type == "chlist")
            while (bytes.at(at) != '\0') {
                const std::string channel = text();
                const char* kinds[] = {"uint", "half", "float"};
                header.channels[channel] = kinds[number()];
                at += 12;
            }
        at = end;
    }
    return header;
}

}  // namespace relamp::test
