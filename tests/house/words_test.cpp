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
    std::vector<std::string> stems;  ///< one of them is in all that is banned: most lines need no expression; or empty
    Word(const char* expression, const char* better, std::vector<std::string> in = {})
        : banned(expression, std::regex::optimize), instead(better), stems(std::move(in)) {}
    bool mayBeIn(const std::string& text) const {
        bool may = stems.empty();
        for (const std::string& stem : stems) may = may || text.find(stem) != std::string::npos;
        return may;
    }
};
const std::vector<Word> words{
    {R"(\b(look-?up|sighting)s?\b)", "observation", {"look", "sighting"}},
    {R"(\blamps?\b)", "emitter", {"lamp"}},
    {R"(\bsurroundings\b)", "environment", {"surroundings"}},
    {R"(\bpictures?\b)", "image, render, frame, photograph", {"picture"}},
    {R"(\b(coats?|glazes?|glazed)\b)", "dielectric coating", {"coat", "glaze"}},
    {R"(\bforet(ell|ells|old)\b)", "predict", {"foret"}},
    {R"(\breckon(s|ed|ing)?\b)", "compute", {"reckon"}},
    {R"(\bwork(s|ed|ing)? out\b)", "compute", {"work"}},
    {R"(\bshares? of\b)", "fraction, contribution", {"share"}},
    {R"(\bbiggest\b)", "max", {"biggest"}},
    {R"(\bwish(es)?\b)", "request", {"wish"}},
    {R"(\b(hidden light|unseen)\b)", "unobserved", {"hidden", "unseen"}},
};
/// Parts of names: someLamp, lampAt, HiddenLight. (A name may hold "shared" and "share(d)_ptr".)
const std::vector<Word> nameParts{
    {R"((Lamp|\blamp)(s?[A-Z_]|s?\b))", "emitter", {"Lamp", "lamp"}},
    {R"((Picture|\bpicture)(s?[A-Z_]|s?\b))", "image", {"icture"}},
    {R"((Wish|\bwish)([A-Z_]|\b))", "request", {"Wish", "wish"}},
    {R"([a-z]Share(s?[A-Z_]|s?\b))", "fraction", {"Share"}},
    {R"(HiddenLight|hiddenLight|[Uu]nseen)", "unobserved", {"iddenLight", "nseen"}},
    {R"(Glaze|\bglaze)", "coating", {"laze"}},
    {R"(Surroundings|\bsurroundings)", "environment", {"urroundings"}},
};

/// What the window says; case counts. A whole text is one between ^ and $.
const std::vector<Word> windowWords{
    {R"(\b([Ll]amp|[Pp]icture|[Pp]iece)s?\b)", "light; image, photograph; object"},
    {R"(\b([Ss]urroundings|[Uu]nseen|[Rr]eckon(s|ed)?)\b)", "environment; off-camera; compute"},
    {R"(\b([Aa]ttach|[Dd]etach|[Pp]ut|[Mm]ove)\w* (a |an |the )?parts?\b)", "object"},
    {R"(\bCorrection\b)", "albedo chroma, baked light"},
    {R"(\b(What this rests on|Without perspective|Photograph behind|Environment picture|Glaze)\b)",
     "Evidence, Orthographic, Background photo, HDRI, Gloss"},
    {R"(\b(Go on in the background|Takes what is selected|Own size)\b|\d a pixel\b)",
     "Run in background, Open selected, Source size, samples per pixel"},
    {R"(^(Timeline|Plan|Turn|Stops|Brightness|Place|S|Col|own)$)",
     "Progress, Solve details, Rotate, Exposure, Position, Solo, Colour, Auto"},
    {R"(\b(emitter|copy)-\d)", "Light 1, Light 1 copy"},
    {R"(\(s\))", "the number decides: 1 light, 2 lights"},
};

/// The strings of a line of code without ids, which nobody sees: light.add, and what follows ##.
std::vector<std::string> stringsOf(const std::string& line) {
    std::vector<std::string> strings;
    if (line.starts_with("#")) return strings;
    static const std::regex id(R"([a-z]+\.\w+)"), literal(R"re("((?:[^"\\]|\\.)*)")re");
    for (std::sregex_iterator at(line.begin(), line.end(), literal), end; at != end; ++at)
        if (const std::string text = (*at)[1].str(); !std::regex_match(text, id))
            strings.push_back(text.substr(0, text.find("##")));
    return strings;
}

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
        if (std::smatch match; word.mayBeIn(text) && std::regex_search(text, match, word.banned))
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
                if (std::string(folder) != "ui") continue;
                for (const std::string& text : stringsOf(line.substr(0, line.size() - parts.comment.size())))
                    EXPECT_EQ(found(text, windowWords), "") << place << line;
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
    EXPECT_EQ(stringsOf(R"(row("Stops##stops", "3 \"Lamps\"");)"),
              (std::vector<std::string>{"Stops", R"(3 \"Lamps\")"}));
    EXPECT_NE(found("Stops", windowWords), "");
    EXPECT_EQ(found("Stops this job", windowWords), "");
    EXPECT_NE(found("Detach a part from ", windowWords), "");
    EXPECT_EQ(found("The part of each light", windowWords), "");
    EXPECT_EQ(partsOf("a = \"a lamp // here\";  // b").comment, "// b");
}

}  // namespace
