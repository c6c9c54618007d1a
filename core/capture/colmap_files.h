// COLMAP's files word by word: binary ones, and lines of text. Not a door.
#pragma once
#include <bit>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>

#include "base/error.h"
#include "base/text_scanner.h"

namespace relamp {

static_assert(std::endian::native == std::endian::little,
              "COLMAP's binary files are little-endian and are read as they are");

/// A binary file that is never read past its end, nor into memory its size does not pay for.
class ColmapBinary {
public:
    explicit ColmapBinary(const std::filesystem::path& file) : in_(file, std::ios::binary) {
        std::error_code failed;
        size_ = std::filesystem::file_size(file, failed);
        if (!in_ || failed) throw Error("cannot be read");
    }
    uint64_t remaining() const { return size_ - at_; }
    template <class T>
    T take(const char* field) {
        T value;
        bytes(&value, sizeof value, field);
        return value;
    }
    void bytes(void* to, size_t count, const char* field) {
        if (count > remaining()) throw Error("{}: the file ends here, after {} bytes", field, size_);
        if (!in_.read(static_cast<char*>(to), std::streamsize(count))) throw Error("{}: cannot be read", field);
        at_ += count;
    }
    /// A count of things that take at least `leastBytes` each.
    uint64_t count(const char* field, uint64_t leastBytes, uint64_t most) {
        const auto value = take<uint64_t>(field);
        if (value > most) throw Error("{}: is {}, expected at most {}", field, value, most);
        if (value > remaining() / leastBytes)
            throw Error("{}: is {}, the file has room for {}", field, value, remaining() / leastBytes);
        return value;
    }
    std::string text(const char* field) {
        std::string result;
        for (;;) {
            const char c = take<char>(field);
            if (c == 0) return result;
            if (result.size() >= 4096) throw Error("{}: is longer than 4096 letters", field);
            result += c;
        }
    }
    void expectEnd() const {
        if (remaining()) throw Error("{} bytes are left over behind the last entry", remaining());
    }

private:
    std::ifstream in_;
    uint64_t size_ = 0, at_ = 0;
};

/// The words of one line of a text file.
class ColmapLine {
public:
    explicit ColmapLine(std::string_view text) : text_(text), scanner_(text) {}
    double number(const char* field) {
        const std::string_view word = scanner_.word();
        if (word.empty()) throw Error("{} is missing", field);
        const auto value = TextScanner::number(word);
        if (!value) throw Error("{} is \"{}\", expected a number", field, word.substr(0, 40));
        return *value;
    }
    /// A number from 0 to `most`.
    uint64_t whole(const char* field, uint64_t most) {
        const std::string_view word = scanner_.word();
        if (word.empty()) throw Error("{} is missing", field);
        const auto value = TextScanner::integer(word);
        if (!value || *value < 0 || uint64_t(*value) > most)
            throw Error("{} is \"{}\", expected a whole number from 0 to {}", field, word.substr(0, 40), most);
        return uint64_t(*value);
    }
    std::string_view word() { return scanner_.word(); }
    /// What is left, without spaces around it: names may hold spaces.
    std::string rest() {
        std::string_view left = text_.substr(text_.size() - scanner_.remaining());
        while (!left.empty() && TextScanner::isSpace(left.front())) left.remove_prefix(1);
        while (!left.empty() && TextScanner::isSpace(left.back())) left.remove_suffix(1);
        return std::string(left);
    }
    bool atEnd() const {
        return text_.substr(text_.size() - scanner_.remaining()).find_first_not_of(" \t\v\f\r\n") ==
               std::string_view::npos;
    }

private:
    std::string_view text_;
    TextScanner scanner_;
};

inline bool isCommentOrEmpty(std::string_view line) {
    const size_t first = line.find_first_not_of(" \t\v\f");
    return first == std::string_view::npos || line[first] == '#';
}

/// The next line that says something; none at the end.
inline std::optional<std::string_view> nextLine(TextScanner& scanner) {
    while (!scanner.atEnd()) {
        const std::string_view line = scanner.line();
        if (!isCommentOrEmpty(line)) return line;
    }
    return std::nullopt;
}

}  // namespace relamp
