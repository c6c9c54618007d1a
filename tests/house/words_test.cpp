// One word, one meaning (core/README.md): the words that names and comments of core, ui, app and shaders do not
// use, and the field's word for each.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

namespace {
namespace fs = std::filesystem;

struct Word {
    std::regex banned;
    const char* instead;
    Word(const char* expression, const char* better) : banned(expression, std::regex::optimize), instead(better) {}
};
const std::vector<Word> words{
    {R"(\b(look-?up|sighting)s?\b)", "observation"},
    {R"(\blamps?\b)", "emitter"},
    {R"(\bsurroundings\b)", "environment"},
    {R"(\bpictures?\b)", "image, render, frame, photograph"},
    {R"(\b(coats?|glazes?|glazed)\b)", "dielectric coating"},
    {R"(\bforet(ell|ells|old)\b)", "predict"},
    {R"(\breckon(s|ed|ing)?\b)", "compute"},
    {R"(\bwork(s|ed|ing)? out\b)", "compute"},
    {R"(\bshares? of\b)", "fraction, contribution"},
    {R"(\bbiggest\b)", "max"},
    {R"(\bwish(es)?\b)", "request"},
    {R"(\b(hidden light|unseen)\b)", "unobserved"},
};
/// Parts of names: someLamp, lampAt, HiddenLight. (A name may hold "shared" and "share(d)_ptr".)
const std::vector<Word> nameParts{
    {R"((Lamp|\blamp)(s?[A-Z_]|s?\b))", "emitter"},
    {R"((Picture|\bpicture)(s?[A-Z_]|s?\b))", "image"},
    {R"((Wish|\bwish)([A-Z_]|\b))", "request"},
    {R"([a-z]Share(s?[A-Z_]|s?\b))", "fraction"},
    {R"(HiddenLight|hiddenLight|[Uu]nseen)", "unobserved"},
    {R"(Glaze|\bglaze)", "coating"},
    {R"(Surroundings|\bsurroundings)", "environment"},
};

/// The text of `line` from its comment on, or nothing; and its code without strings.
struct Parts {
    std::string code, comment;
};
Parts partsOf(const std::string& line) {
    Parts parts;
    bool inString = false;
    for (size_t i = 0; i < line.size(); ++i) {
        if (inString && line[i] == '\\') {
            ++i;
        } else if (line[i] == '"' && (i == 0 || line[i - 1] != '\'')) {
            inString = !inString;
        } else if (!inString && line.compare(i, 2, "//") == 0) {
            parts.comment = line.substr(i);
            break;
        } else if (!inString) {
            parts.code += line[i];
        }
    }
    return parts;
}

std::string found(const std::string& text, const std::vector<Word>& list) {
    if (text.empty()) return {};
    for (const Word& word : list)
        if (std::smatch match; std::regex_search(text, match, word.banned))
            return "\"" + match[0].str() + "\", better: " + word.instead;
    return {};
}

TEST(Words, NamesAndCommentsUseTheFieldsOwn) {
    size_t lines = 0;
    for (const char* folder : {"core", "ui", "app", "shaders"})
        for (const fs::directory_entry& entry :
             fs::recursive_directory_iterator(fs::path(RELAMP_SOURCE_DIR) / folder)) {
            const std::string extension = entry.path().extension().string();
            if (extension != ".h" && extension != ".cpp" && extension != ".frag" && extension != ".comp") continue;
            std::ifstream in(entry.path());
            bool raw = false;
            int number = 0;
            for (std::string line; std::getline(in, line); ++lines) {
                ++number;
                const bool opens = line.find("R\"(") != std::string::npos;
                const bool closes = line.find(")\"") != std::string::npos;
                if (raw || opens) {
                    raw = (raw || opens) && !closes;
                    continue;
                }
                const Parts parts = partsOf(line);
                const std::string place = entry.path().string() + ":" + std::to_string(number) + ": ";
                EXPECT_EQ(found(parts.comment, words), "") << place << line;
                EXPECT_EQ(found(parts.code, nameParts), "") << place << line;
            }
        }
    EXPECT_GT(lines, 20000u) << "is " << RELAMP_SOURCE_DIR << " the source tree?";
}

TEST(Words, BannedOnesAreFoundAndOthersAreNot) {
    EXPECT_NE(found("// what a lamp gives", words), "");
    EXPECT_NE(found("// three look-ups", words), "");
    EXPECT_EQ(found("// desklamps relamp", words), "");
    EXPECT_NE(found("int clippedShare = 0;", nameParts), "");
    EXPECT_NE(found("lampAt(3)", nameParts), "");
    EXPECT_EQ(found("std::shared_ptr<Emitter> clamp(relamp)", nameParts), "");
    EXPECT_EQ(partsOf("a = \"a lamp // here\";  // b").comment, "// b");
}

}  // namespace
