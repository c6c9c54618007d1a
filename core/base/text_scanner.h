// Words and numbers of text files (meshes, COLMAP models), without copies.
#pragma once
#include <charconv>
#include <cstdint>
#include <cstring>
#include <limits>
#include <optional>
#include <string_view>

namespace relamp {

/// Walks over text; every function stays inside it whatever the bytes are.
class TextScanner {
public:
    explicit TextScanner(std::string_view text) : text_(text) {}

    bool atEnd() const { return at_ >= text_.size(); }
    size_t remaining() const { return text_.size() - at_; }

    /// The next line without its end (LF, CRLF or CR), and a step beyond it.
    std::string_view line() {
        const size_t begin = at_;
        while (at_ < text_.size() && text_[at_] != '\n' && text_[at_] != '\r') ++at_;
        const std::string_view found = text_.substr(begin, at_ - begin);
        if (at_ < text_.size() && text_[at_] == '\r') ++at_;
        if (at_ < text_.size() && text_[at_] == '\n' &&
            (at_ == 0 || at_ == begin + found.size() || text_[at_ - 1] == '\r'))
            ++at_;
        return found;
    }
    /// The next word on any line; empty at the end. `comment` starts a comment up to the end of the line (0: none).
    std::string_view word(char comment = 0) {
        for (;;) {
            while (at_ < text_.size() && isSpace(text_[at_])) ++at_;
            if (comment && at_ < text_.size() && text_[at_] == comment) {
                while (at_ < text_.size() && text_[at_] != '\n' && text_[at_] != '\r') ++at_;
                continue;
            }
            break;
        }
        const size_t begin = at_;
        while (at_ < text_.size() && !isSpace(text_[at_])) ++at_;
        return text_.substr(begin, at_ - begin);
    }

    static bool isSpace(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r' || c == '\v' || c == '\f'; }

    /// A number as printf writes it ("nan" and "inf" too); none when the word is something else.
    static std::optional<double> number(std::string_view word) {
        if (!word.empty() && word[0] == '+') word.remove_prefix(1);
        double value = 0;
        const auto [end, failed] = std::from_chars(word.data(), word.data() + word.size(), value);
        if (failed == std::errc::result_out_of_range) return std::numeric_limits<double>::infinity();
        if (failed != std::errc() || end == word.data()) return std::nullopt;
        return value;
    }
    static std::optional<int64_t> integer(std::string_view word) {
        if (!word.empty() && word[0] == '+') word.remove_prefix(1);
        int64_t value = 0;
        const auto [end, failed] = std::from_chars(word.data(), word.data() + word.size(), value);
        if (failed == std::errc::result_out_of_range)
            return word[0] == '-' ? std::numeric_limits<int64_t>::min() : std::numeric_limits<int64_t>::max();
        if (failed != std::errc() || end == word.data()) return std::nullopt;
        return value;
    }

private:
    std::string_view text_;
    size_t at_ = 0;
};

}  // namespace relamp
