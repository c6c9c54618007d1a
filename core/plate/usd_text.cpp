#include "plate/usd_text.h"

#include <optional>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/text_scanner.h"

namespace relamp {
namespace {

constexpr size_t maxUsdBytes = size_t(1) << 30, maxNumbers = 64'000'000;
constexpr int maxDepth = 64;

bool isWordEnd(char c) { return TextScanner::isSpace(c) || std::string_view("=(){}[],;\"'#").find(c) < 13; }

/// Walks over the text by what matters: words, brackets, strings.
class UsdReader {
public:
    explicit UsdReader(std::string_view text) : text_(text) {}

    UsdStage stage() {
        UsdStage stage;
        if (!text_.starts_with("#usda"))
            fail("is no USD text (expected #usda 1.0); usdcat converts binary files, with -o FILE.usda");
        skipSpace();
        if (peek() == '(') layerMetadata(balanced(), stage);
        for (skipSpace(); at_ < text_.size(); skipSpace()) {
            const std::string_view word = nextWord();
            if (isSpecifier(word)) prim(stage, -1, 0);
            else if (word.empty()) ++at_;
        }
        return stage;
    }

private:
    std::string_view text_;
    size_t at_ = 0, numbers_ = 0;

    [[noreturn]] void fail(const std::string& what) const {
        const size_t line = 1 + size_t(std::count(text_.begin(), text_.begin() + std::ptrdiff_t(at_), '\n'));
        throw Error("line {}: {}", line, what);
    }
    char peek() const { return at_ < text_.size() ? text_[at_] : '\0'; }
    static bool isSpecifier(std::string_view w) { return w == "def" || w == "over" || w == "class"; }

    /// Over blanks, line ends and comments.
    void skipSpace(bool lines = true) {
        for (; at_ < text_.size(); ++at_) {
            if (text_[at_] == '#') {
                while (at_ < text_.size() && text_[at_] != '\n') ++at_;
                if (at_ >= text_.size()) return;
            }
            if (!TextScanner::isSpace(text_[at_]) || (!lines && text_[at_] == '\n')) return;
        }
    }
    std::string_view nextWord() {
        const size_t begin = at_;
        while (at_ < text_.size() && !isWordEnd(text_[at_])) ++at_;
        return text_.substr(begin, at_ - begin);
    }
    /// The text between quotes; stands behind them afterwards.
    std::string_view quoted() {
        const char quote = text_[at_];
        const bool longOne = text_.substr(at_, 3) == std::string(3, quote);
        const size_t marks = longOne ? 3 : 1, begin = at_ + marks;
        for (at_ = begin; at_ < text_.size(); ++at_) {
            if (text_[at_] == '\\') ++at_;
            else if (text_.substr(at_, marks) == std::string(marks, quote)) {
                const std::string_view found = text_.substr(begin, at_ - begin);
                at_ += marks;
                return found;
            }
        }
        at_ = text_.size();
        fail("a text has no end");
    }
    /// From a bracket to the one that closes it, both included.
    std::string_view balanced() {
        const size_t begin = at_;
        int depth = 0;
        while (at_ < text_.size()) {
            const char c = text_[at_];
            if (c == '"' || c == '\'') {
                quoted();
                continue;
            }
            if (c == '#') {
                skipSpace();
                continue;
            }
            ++at_;
            if (c == '(' || c == '[' || c == '{') ++depth;
            if ((c == ')' || c == ']' || c == '}') && --depth == 0) return text_.substr(begin, at_ - begin);
        }
        fail("a bracket is not closed");
    }

    /// "(" key = value ... ")"
    static void layerMetadata(std::string_view text, UsdStage& stage) {
        UsdReader inside(text.substr(1, text.size() - 2));
        for (inside.skipSpace(); inside.at_ < inside.text_.size(); inside.skipSpace()) {
            if (inside.peek() == '"' || inside.peek() == '\'') inside.quoted();
            const std::string_view key = inside.nextWord();
            inside.skipSpace();
            if (inside.peek() != '=') {
                if (key.empty() && inside.at_ < inside.text_.size()) ++inside.at_;
                continue;
            }
            ++inside.at_;
            inside.skipSpace();
            const std::string_view value = inside.valueText();
            if (key == "upAxis") stage.upAxis = std::string(value);
            const auto number = TextScanner::number(value);
            if (key == "metersPerUnit" && number && std::isfinite(*number) && *number > 0)
                stage.metresPerUnit = *number;
        }
    }
    /// A bracket with what it holds, the inside of a text, or a word.
    std::string_view valueText() {
        const char c = peek();
        if (c == '(' || c == '[' || c == '{') return balanced();
        return c == '"' || c == '\'' ? quoted() : nextWord();
    }

    /// Behind its specifier.
    void prim(UsdStage& stage, int parent, int depth) {
        if (depth > maxDepth) fail(fmt::format("prims lie more than {} deep", maxDepth));
        UsdPrim made;
        made.parent = parent;
        skipSpace();
        if (peek() != '"' && peek() != '\'') {
            made.type = std::string(nextWord());
            skipSpace();
        }
        if (peek() != '"' && peek() != '\'') fail("a prim has no name");
        made.name = std::string(quoted());
        made.path = (parent < 0 ? std::string() : stage.prims[size_t(parent)].path) + "/" + made.name;
        skipSpace();
        if (peek() == '(') balanced();
        skipSpace();
        if (peek() != '{') fail("prim " + made.name + " has no body");
        ++at_;
        if (stage.prims.size() >= 1'000'000) fail("has more than a million prims");
        const int index = int(stage.prims.size());
        stage.prims.push_back(std::move(made));
        for (;;) {
            skipSpace();
            if (at_ >= text_.size()) fail("prim " + stage.prims[size_t(index)].name + " does not end");
            if (peek() == '}') {
                ++at_;
                return;
            }
            const size_t begin = at_;
            if (isSpecifier(nextWord())) prim(stage, index, depth + 1);
            else {
                at_ = begin;
                property(stage.prims[size_t(index)]);
                if (at_ == begin) ++at_;  // a lone separator
            }
        }
    }

    /// One line "[words] name [= value] [(metadata)]"; brackets may span lines.
    void property(UsdPrim& prim) {
        std::string_view name;
        for (;;) {
            skipSpace(false);
            const char c = peek();
            if (at_ >= text_.size() || c == '\n' || c == ';' || c == '}') return;
            if (c == '=') break;
            if (c == '"' || c == '\'') quoted();  // variantSet "name" = { ... }
            else if (c == '(' || c == '{' || c == '[') balanced();
            else if (const std::string_view word = nextWord(); !word.empty()) name = word;
            else ++at_;
        }
        ++at_;
        skipSpace();
        take(prim, std::string(name));
        for (skipSpace(false); peek() == '('; skipSpace(false)) balanced();
    }

    void take(UsdPrim& prim, const std::string& name) {
        const bool samples = name.ends_with(".timeSamples");
        const std::string base = samples ? name.substr(0, name.size() - 12) : name;
        const std::string_view value = valueText();
        if (base == "xformOpOrder") {
            UsdReader inside(value);
            while (inside.at_ < value.size())
                if (inside.peek() == '"' || inside.peek() == '\'') prim.order.emplace_back(inside.quoted());
                else ++inside.at_;
        } else if (base.starts_with("xformOp:") || base == "focalLength" ||
                   base.find("Aperture") != std::string::npos) {
            UsdValue& into = prim.values[base];
            if (!samples) {
                if (!into.sampled) into.at[0] = numbersIn(value);
                return;
            }
            if (!value.starts_with('{')) fail(base + ": time samples are no list");
            into = {};
            into.sampled = true;
            UsdReader inside(value.substr(1, value.size() - 2));
            for (inside.skipSpace(); inside.at_ < inside.text_.size(); inside.skipSpace()) {
                std::string_view time = inside.nextWord();
                const size_t colon = time.find(':');
                if (colon != std::string_view::npos) {
                    inside.at_ -= time.size() - colon - 1;
                    time = time.substr(0, colon);
                } else {
                    inside.skipSpace();
                    if (inside.peek() == ':') ++inside.at_;
                }
                const auto when = TextScanner::number(time);
                if (!when || !std::isfinite(*when)) fail(base + ": a time sample has no time");
                inside.skipSpace();
                into.at[*when] = numbersIn(inside.valueText());
                inside.skipSpace();
                if (inside.peek() == ',') ++inside.at_;
            }
        }
    }

    std::vector<double> numbersIn(std::string_view text) {
        std::vector<double> found;
        for (size_t at = 0; at < text.size();) {
            if (std::string_view("(){}[],").find(text[at]) < 7 || TextScanner::isSpace(text[at])) {
                ++at;
                continue;
            }
            const size_t begin = at;
            while (at < text.size() && std::string_view("(){}[],").find(text[at]) >= 7 &&
                   !TextScanner::isSpace(text[at]))
                ++at;
            const auto number = TextScanner::number(text.substr(begin, at - begin));
            if (!number) return {};
            if (!std::isfinite(*number) || std::abs(*number) > 1e30) fail("a number is not finite");
            found.push_back(*number);
            if (found.size() > 16) return {};
        }
        if (numbers_ += found.size(); numbers_ > maxNumbers) fail("has too many time samples");
        return found;
    }
};

}  // namespace

std::vector<double> UsdValue::value(double time) const {
    if (at.empty()) return {};
    const auto above = at.lower_bound(time);
    if (above == at.end()) return at.rbegin()->second;
    if (above == at.begin() || above->first == time) return above->second;
    const auto below = std::prev(above);
    if (below->second.size() != above->second.size()) return below->second;
    const double t = (time - below->first) / (above->first - below->first);
    std::vector<double> between(below->second);
    for (size_t i = 0; i < between.size(); ++i) between[i] += t * (above->second[i] - between[i]);
    return between;
}

UsdStage readUsdText(const std::filesystem::path& file) {
    const std::string text = readBytes(file, maxUsdBytes);
    return withContext(file.filename().string(), [&] { return UsdReader(text).stage(); });
}

}  // namespace relamp
