// Holds the sources to the sizes that a reader can take in, and their comments to documents that are in the repository.
// RELAMP_SOURCE_DIR is the root of the source tree.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <regex>
#include <set>
#include <string>
#include <vector>

namespace {
namespace fs = std::filesystem;

constexpr size_t mostLines = 500, mostColumns = 120, mostLinesOfAFunction = 120;

/// Files that are longer yet. The list only becomes shorter.
const std::set<std::string> longFiles{};

/// Functions that are longer yet, by file and the start of their first line.
const std::set<std::string> longFunctions{};

/// Documents that comments name by their file's name alone because they are not in the repository.
const std::set<std::string> documentsElsewhere{"MANIFEST.md"};  // of captures that are not shipped

struct SourceText {
    std::string name;  ///< from the root
    std::vector<std::string> lines;
};

SourceText readText(const fs::path& path) {
    SourceText text{fs::relative(path, RELAMP_SOURCE_DIR).generic_string(), {}};
    std::ifstream in(path);
    for (std::string line; std::getline(in, line);) text.lines.push_back(line);
    return text;
}

std::vector<SourceText> sourcesIn(const std::vector<const char*>& folders) {
    std::vector<SourceText> sources;
    for (const char* folder : folders)
        for (const fs::directory_entry& entry :
             fs::recursive_directory_iterator(fs::path(RELAMP_SOURCE_DIR) / folder)) {
            const std::string extension = entry.path().extension().string();
            if (extension == ".h" || extension == ".cpp") sources.push_back(readText(entry.path()));
        }
    return sources;
}

/// Letters of UTF-8.
size_t columnsOf(const std::string& line) {
    return size_t(std::count_if(line.begin(), line.end(), [](char c) { return (uint8_t(c) & 0xC0) != 0x80; }));
}

TEST(SizeRules, NoFileIsLongerThanItMayBe) {
    const std::vector<SourceText> sources = sourcesIn({"core", "ui", "app", "tests"});
    ASSERT_GT(sources.size(), 100u) << "is " << RELAMP_SOURCE_DIR << " the source tree?";
    for (const SourceText& source : sources) {
        const bool excepted = longFiles.contains(source.name);
        EXPECT_TRUE(excepted || source.lines.size() <= mostLines)
            << source.name << " has " << source.lines.size() << " lines";
        EXPECT_FALSE(excepted && source.lines.size() <= mostLines)
            << source.name << " is short enough: take it from the list of exceptions";
    }
}

TEST(SizeRules, NoLineIsWiderThanItMayBe) {
    for (const SourceText& source : sourcesIn({"core", "ui", "app", "tests"}))
        for (size_t i = 0; i < source.lines.size(); ++i) {
            const std::string& line = source.lines[i];
            EXPECT_TRUE(columnsOf(line) <= mostColumns || line.find("://") != std::string::npos)
                << source.name << ":" << i + 1 << " has " << columnsOf(line) << " columns";
        }
}

/// A function begins in the first column, or in a class's, and ends with a brace in the same one.
TEST(SizeRules, NoFunctionIsLongerThanItMayBe) {
    static const std::regex notAFunction(
        R"(\s*(namespace|struct|class|enum|union|if|for|while|switch|else|do|try|public|private|const auto)\b.*)");
    for (const SourceText& source : sourcesIn({"core", "ui", "app"}))
        for (const std::string indent : {"", "    "}) {
            size_t start = 0;
            for (size_t i = 0; i < source.lines.size(); ++i) {
                const std::string& line = source.lines[i];
                if (line == indent + "}") {
                    const std::string& first = source.lines[start];
                    std::string head;
                    for (size_t k = start; k < std::min(i, start + 4); ++k) head += source.lines[k];
                    const bool function = head.find('(') != std::string::npos && !std::regex_match(first, notAFunction);
                    const std::string name = source.name + ": " + first;
                    const bool excepted =
                        std::any_of(longFunctions.begin(), longFunctions.end(),
                                    [&](const std::string& known) { return name.starts_with(known); });
                    EXPECT_TRUE(!function || excepted || i - start + 1 <= mostLinesOfAFunction)
                        << source.name << ":" << start + 1 << " has " << i - start + 1 << " lines: " << first;
                } else if (line.size() > indent.size() && line.starts_with(indent) &&
                           std::string(" }#/:)").find(line[indent.size()]) == std::string::npos &&
                           (indent.empty() || (line.back() != ';' && line.back() != ','))) {
                    start = i;
                }
            }
        }
}

/// "docs/method.md 4.2" needs the file, and a heading that begins "4.2". A name without a folder may lie beside the
/// source or in any folder of the tree.
TEST(SizeRules, CommentsCiteDocumentsAndHeadingsThatExist) {
    static const std::regex citation(R"(([\w./-]*\w\.md)\b(?:\)?,? (\d+(?:\.\d+)*))?)");
    static const std::regex absent(R"(\b(METHOD|INTERFACE|ARCHITECTURE|DEPENDENCIES)( \d|\.md\b))");
    const fs::path root = RELAMP_SOURCE_DIR;
    std::set<std::string> names;
    for (const char* folder : {"core", "ui", "app", "docs", "tests", "assets"})
        for (const fs::directory_entry& entry : fs::recursive_directory_iterator(root / folder))
            if (entry.path().extension() == ".md") names.insert(entry.path().filename().string());
    for (const fs::directory_entry& entry : fs::directory_iterator(root))
        if (entry.path().extension() == ".md") names.insert(entry.path().filename().string());
    size_t cited = 0;
    for (const SourceText& source : sourcesIn({"core", "ui", "app", "tests"})) {
        if (source.name == "tests/house/size_rules_test.cpp") continue;
        for (size_t i = 0; i < source.lines.size(); ++i) {
            const std::string& line = source.lines[i];
            const std::string where = source.name + ":" + std::to_string(i + 1);
            EXPECT_FALSE(std::regex_search(line, absent)) << where << " cites a document that is not here: " << line;
            for (std::sregex_iterator m(line.begin(), line.end(), citation), end; m != end; ++m) {
                const std::string document = (*m)[1], heading = (*m)[2];
                ++cited;
                if (document.find('/') == std::string::npos) {
                    EXPECT_TRUE(names.contains(document) || documentsElsewhere.contains(document))
                        << where << " cites " << document;
                    continue;
                }
                if (!fs::exists(root / document)) {
                    ADD_FAILURE() << where << " cites " << document << ", which does not exist";
                    continue;
                }
                if (heading.empty()) continue;
                const std::regex wanted("#+ " + std::regex_replace(heading, std::regex("\\."), "\\.") + "\\b.*");
                const SourceText text = readText(root / document);
                EXPECT_TRUE(std::any_of(text.lines.begin(), text.lines.end(),
                                        [&](const std::string& l) { return std::regex_match(l, wanted); }))
                    << where << " cites " << document << " " << heading;
            }
        }
    }
    EXPECT_GT(cited, 10u);
}

/// "[Put15]" is explained in the lists of references.
TEST(SizeRules, EveryReferenceIsListed) {
    static const std::regex reference(R"(\[([A-Z][A-Za-z]{1,11}\d{2,4})\])");
    std::set<std::string> listed;
    for (const char* list : {"docs/method.md", "core/README.md"})
        for (const std::string& line : readText(fs::path(RELAMP_SOURCE_DIR) / list).lines)
            for (std::sregex_iterator m(line.begin(), line.end(), reference), end; m != end; ++m)
                listed.insert((*m)[1]);
    for (const SourceText& source : sourcesIn({"core", "ui", "app"}))
        for (const std::string& line : source.lines)
            for (std::sregex_iterator m(line.begin(), line.end(), reference), end; m != end; ++m)
                EXPECT_TRUE(listed.contains((*m)[1])) << source.name << ": " << (*m)[0];
}

}  // namespace
