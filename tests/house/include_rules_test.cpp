// Holds every #include of core, ui and app against the table of rooms: which room may know which, and which file may
// name a library. RELAMP_SOURCE_DIR is the root of the source tree.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <optional>
#include <regex>
#include <set>
#include <string>
#include <vector>

namespace {
namespace fs = std::filesystem;
using Names = std::set<std::string>;

/// The conductor, the back rooms that look at everything, and the program may know every room of the core.
const Names coreRooms{"base",     "image",     "wavelet",  "brdf",    "capture", "scene", "radiance",
                      "clusters", "transport", "solve",    "texture", "relight", "edit",  "shot",
                      "plate",    "report",    "pipeline", "display", "scan"};

/// Ground floor and the rooms of the walk before `room`: what a room on the walk may include.
Names upTo(const std::string& room) {
    Names allowed{"base", "image", "wavelet", "brdf"};
    for (const char* earlier :
         {"capture", "scene", "radiance", "clusters", "transport", "solve", "texture", "relight"}) {
        if (room == earlier) break;
        allowed.insert(earlier);
    }
    return allowed;
}

Names programRooms() {
    Names rooms = coreRooms;
    rooms.insert("ui");
    return rooms;
}

Names windowRooms() {
    Names rooms = coreRooms;
    rooms.insert({"viewport", "panels", "browser", "actions", "backends"});
    return rooms;
}

/// A room, and the rooms and single headers it may include beside its own.
const std::map<std::string, Names>& table() {
    static const std::map<std::string, Names> rooms{
        {"base", {}},
        {"image", {"base"}},
        {"wavelet", {"base", "image"}},
        {"brdf", {"base", "image", "wavelet"}},
        {"capture", {"base", "image", "scene/mesh.h", "scene/mesh_io.h", "scene/smooth_normals.h"}},
        {"scene", {"base"}},
        {"scan", {"base", "image", "capture", "scene"}},
        {"radiance", upTo("radiance")},
        {"clusters", upTo("clusters")},
        {"transport", upTo("transport")},
        {"solve", upTo("solve")},
        {"texture", upTo("texture")},
        {"relight", upTo("relight")},
        {"edit", {"base", "relight", "scene", "solve/estimate.h"}},
        {"shot", coreRooms},
        {"plate", coreRooms},
        {"display", {"base", "image", "capture", "radiance", "scene", "solve"}},
        {"report", coreRooms},
        {"pipeline", coreRooms},
        {"ui", windowRooms()},
        {"app", programRooms()},
    };
    return rooms;
}

/// A library by the start of its headers, and the files (or folders, with a slash at the end) that may include it.
struct Library {
    const char* headers;
    std::vector<std::string> homes;  ///< empty: nowhere
};
const std::vector<Library> libraries{
    {"OpenImageIO/", {"image/image_reader.cpp", "image/image_writer.cpp"}},
    {"OpenMesh/", {"scene/mesh_io.cpp"}},
    {"embree", {"scene/ray_tracer.cpp"}},
    {"Eigen/", {"base/dense.h", "base/dense.cpp", "solve/", "scan/resection.cpp"}},
    {"unsupported/Eigen/", {"solve/"}},
    {"tbb/", {"base/parallel.cpp"}},
    {"oneapi/tbb", {"base/parallel.cpp"}},
    {"GL/", {}},
    {"GLES", {}},
    {"glad/", {}},
    {"GLFW/", {"ui/window.cpp"}},
    {"epoxy/", {"ui/window.cpp", "ui/gui.cpp", "ui/viewport/"}},
    {"OpenColorIO/", {"ui/viewport/display_transform.cpp"}},
    {"imgui", {"ui/"}},
    {"stb/", {"texture/atlas.cpp"}},
    {"pugixml", {"capture/formats/metashape.cpp"}},
    {"pybind11", {"app/python/"}},
};

struct Include {
    std::string name;
    bool angled = false;
};

/// What is wrong with `include` in `file` (relative to core; app files as "app/..."), if anything.
std::optional<std::string> violation(const std::string& file, const Include& include) {
    for (const Library& library : libraries) {
        if (!include.name.starts_with(library.headers)) continue;
        for (const std::string& home : library.homes)
            if (home.ends_with('/') ? file.starts_with(home) : file == home) return {};
        return library.homes.empty() ? "nothing may include this library"
                                     : "only " + library.homes.front() + " may include this library";
    }
    if (include.angled) return {};
    const std::string room = file.substr(0, file.find('/'));
    if (include.name.find('/') == std::string::npos)
        return room == "app" || room == "ui" ? std::nullopt
                                             : std::optional<std::string>("expected the form \"room/header.h\"");
    const std::string other = include.name.substr(0, include.name.find('/'));
    const auto row = table().find(room);
    if (row == table().end()) return "the room " + room + " is not in the table";
    if (other == room || row->second.contains(other) || row->second.contains(include.name)) return {};
    return "the room " + room + " may not include " + other;
}

struct Source {
    std::string name;               ///< relative to core, or app/...
    std::vector<Include> includes;  ///< in the order of the file
    bool pragmaOnce = false;
};

Source readSource(const std::string& name, const fs::path& path) {
    static const std::regex includeLine(R"re(^\s*#\s*include\s*(["<])([^">]+)[">].*)re");
    static const std::regex pragmaLine(R"(^\s*#\s*pragma\s+once\b.*)");
    Source source{name, {}, false};
    std::ifstream in(path);
    std::smatch match;
    for (std::string line; std::getline(in, line);) {
        if (line.find('#') == std::string::npos) continue;
        if (std::regex_match(line, match, includeLine)) source.includes.push_back({match[2], match[1] == "<"});
        else if (std::regex_match(line, pragmaLine)) source.pragmaOnce = true;
    }
    return source;
}

std::vector<Source> sourcesIn(const std::string& folder, const std::string& prefix) {
    std::vector<Source> sources;
    const fs::path root = fs::path(RELAMP_SOURCE_DIR) / folder;
    if (!fs::exists(root)) return sources;
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(root)) {
        const std::string extension = entry.path().extension().string();
        if (extension == ".h" || extension == ".cpp")
            sources.push_back(readSource(prefix + fs::relative(entry.path(), root).generic_string(), entry.path()));
    }
    return sources;
}

TEST(IncludeRules, EveryIncludeOfCoreAndAppKeepsToTheTableOfRooms) {
    std::vector<Source> sources = sourcesIn("core", "");
    ASSERT_GT(sources.size(), 20u) << "is " << RELAMP_SOURCE_DIR << " the source tree?";
    for (Source& source : sourcesIn("app", "app/")) sources.push_back(std::move(source));
    for (Source& source : sourcesIn("ui", "ui/")) sources.push_back(std::move(source));
    for (const Source& source : sources)
        for (const Include& include : source.includes) {
            const auto wrong = violation(source.name, include);
            EXPECT_FALSE(wrong) << source.name << ": " << include.name << ": " << wrong.value_or("");
        }
}

TEST(IncludeRules, EveryHeaderThatIsIncludedByRoomExists) {
    const fs::path root = RELAMP_SOURCE_DIR;
    for (const Source& source : sourcesIn("core", ""))
        for (const Include& include : source.includes)
            EXPECT_TRUE(include.angled || fs::exists(root / "core" / include.name))
                << source.name << ": " << include.name;
}

TEST(IncludeRules, EveryHeaderHasPragmaOnce) {
    for (const char* folder : {"core", "ui", "app"})
        for (const Source& source : sourcesIn(folder, ""))
            EXPECT_TRUE(source.pragmaOnce || !source.name.ends_with(".h")) << source.name;
}

TEST(IncludeRules, EverySourceWithAHeaderIncludesItFirstSoThatTheHeaderCompilesAlone) {
    for (const char* folder : {"core", "ui"})
        for (const Source& source : sourcesIn(folder, "")) {
            if (!source.name.ends_with(".cpp")) continue;
            const std::string header = source.name.substr(0, source.name.size() - 4) + ".h";
            if (!fs::exists(fs::path(RELAMP_SOURCE_DIR) / folder / header)) continue;
            ASSERT_FALSE(source.includes.empty()) << source.name;
            EXPECT_EQ(source.includes.front().name, header) << source.name;
        }
}

/// Parsing and writing are what takes long to compile in the JSON library.
TEST(IncludeRules, JsonIsParsedAndWrittenInOneFile) {
    static const std::regex call(R"(\b[jJ]son::parse\(|\.dump\()");
    for (const char* folder : {"core", "ui", "app"})
        for (const fs::directory_entry& entry :
             fs::recursive_directory_iterator(fs::path(RELAMP_SOURCE_DIR) / folder)) {
            if (entry.path().filename() == "json_fields.cpp") continue;
            std::ifstream in(entry.path());
            for (std::string line; std::getline(in, line);)
                EXPECT_FALSE(line.find('(') != std::string::npos && std::regex_search(line, call))
                    << entry.path() << ": use parseJson or dumpJson: " << line;
        }
}

/// Two types of one name in one namespace compile and link, and then crash: the linker keeps one destructor for both.
TEST(IncludeRules, EveryTypeHasANameOfItsOwn) {
    static const std::regex definition(R"(^(?:struct|class|enum class|union)\s+(\w+)\b(?!::)[^;]*\{.*)");
    for (const char* folder : {"core", "ui"}) {
        std::map<std::string, std::string> home;
        for (const fs::directory_entry& entry :
             fs::recursive_directory_iterator(fs::path(RELAMP_SOURCE_DIR) / folder)) {
            if (entry.path().extension() != ".h") continue;
            std::ifstream in(entry.path());
            std::smatch match;
            for (std::string line; std::getline(in, line);) {
                if (!std::regex_match(line, match, definition)) continue;
                const auto [other, isNew] = home.emplace(match[1], entry.path().string());
                EXPECT_TRUE(isNew) << match[1] << " stands in " << other->second << " and in " << entry.path();
            }
        }
        EXPECT_GT(home.size(), 20u);
    }
}

TEST(IncludeRules, TableRefusesWhatItShould) {
    EXPECT_TRUE(violation("base/error.h", {"image/image.h"}));
    EXPECT_TRUE(violation("scene/scene.cpp", {"capture/capture.h"}));
    EXPECT_TRUE(violation("capture/capture.h", {"scene/scene.h"}));
    EXPECT_TRUE(violation("radiance/gather.cpp", {"clusters/emitter_clusters.h"}));
    EXPECT_TRUE(violation("transport/incident.cpp", {"solve/solve.h"}));
    EXPECT_TRUE(violation("relight/frame.cpp", {"shot/shot_file.h"}));
    EXPECT_TRUE(violation("solve/solve.cpp", {"relight/frame.h"}));
    EXPECT_TRUE(violation("app/cli_main.cpp", {"attic/old.h"}));
    EXPECT_TRUE(violation("attic/old.cpp", {"base/error.h"}));
    EXPECT_TRUE(violation("solve/solve.cpp", {"qp.h"}));
    EXPECT_TRUE(violation("image/image.h", {"OpenImageIO/imageio.h", true}));
    EXPECT_TRUE(violation("scan/scan.cpp", {"Eigen/Dense", true}));
    EXPECT_TRUE(violation("scene/scene.cpp", {"embree4/rtcore.h", true}));
    EXPECT_TRUE(violation("relight/shade.cpp", {"Eigen/Dense", true}));
    EXPECT_TRUE(violation("relight/shade.cpp", {"GL/gl.h", true}));
    EXPECT_TRUE(violation("relight/shade.cpp", {"imgui.h"}));
    EXPECT_TRUE(violation("relight/shade.cpp", {"ui/editor.h"}));
    EXPECT_TRUE(violation("ui/panels/log_panel.cpp", {"epoxy/gl.h", true}));
    EXPECT_TRUE(violation("ui/editor.cpp", {"GLFW/glfw3.h", true}));
    EXPECT_TRUE(violation("ui/viewport/renderer.cpp", {"OpenColorIO/OpenColorIO.h", true}));
}

TEST(IncludeRules, TableAllowsWhatItShould) {
    EXPECT_FALSE(violation("base/parallel.cpp", {"tbb/parallel_for.h", true}));
    EXPECT_FALSE(violation("capture/load_capture.h", {"scene/mesh_io.h"}));
    EXPECT_FALSE(violation("relight/shade.cpp", {"solve/solve.h"}));
    EXPECT_FALSE(violation("solve/qp.cpp", {"Eigen/Dense", true}));
    EXPECT_FALSE(violation("scan/resection.cpp", {"Eigen/Dense", true}));
    EXPECT_FALSE(violation("solve/qp.cpp", {"vector", true}));
    EXPECT_FALSE(violation("report/plan.cpp", {"pipeline/pipeline.h"}));
    EXPECT_FALSE(violation("app/cli_main.cpp", {"arguments.h"}));
    EXPECT_FALSE(violation("ui/editor.cpp", {"editor_state.h"}));
    EXPECT_FALSE(violation("ui/viewport/renderer.cpp", {"epoxy/gl.h", true}));
    EXPECT_FALSE(violation("ui/gui.cpp", {"backends/imgui_impl_glfw.h"}));
    EXPECT_FALSE(violation("app/commands.cpp", {"solve/solve.h"}));
}

/// There is one way from a capture to an estimate: core/pipeline. Comments may name the function.
TEST(OnePipeline, NobodySolvesAroundIt) {
    static const std::regex call(R"(\bsolveScene\s*\()");
    size_t calls = 0;
    for (const char* folder : {"core", "ui", "app"})
        for (const fs::directory_entry& entry :
             fs::recursive_directory_iterator(fs::path(RELAMP_SOURCE_DIR) / folder)) {
            const std::string extension = entry.path().extension().string();
            if (extension != ".h" && extension != ".cpp") continue;
            const std::string name = fs::relative(entry.path(), RELAMP_SOURCE_DIR).generic_string();
            if (name.starts_with("core/solve/")) continue;
            std::ifstream in(entry.path());
            for (std::string line; std::getline(in, line);) {
                if (line.find("solveScene") == std::string::npos ||
                    !std::regex_search(line.substr(0, line.find("//")), call))
                    continue;
                ++calls;
                EXPECT_EQ(name, "core/pipeline/pipeline.cpp") << line;
            }
        }
    EXPECT_EQ(calls, 1u);
}

/// And one place where a shot is filled from an estimate.
TEST(OnePipeline, ShotsAreFilledInOnePlace) {
    static const std::regex filled(R"(\bshot\.(?:estimate|captureFolder)\s*=[^=])");
    for (const char* folder : {"core", "ui", "app"})
        for (const fs::directory_entry& entry :
             fs::recursive_directory_iterator(fs::path(RELAMP_SOURCE_DIR) / folder)) {
            const std::string name = fs::relative(entry.path(), RELAMP_SOURCE_DIR).generic_string();
            // Reading a shot fills one, too.
            if (!name.ends_with(".cpp") || name.starts_with("core/shot/") || name == "core/pipeline/shot_of.cpp")
                continue;
            std::ifstream in(entry.path());
            for (std::string line; std::getline(in, line);)
                EXPECT_FALSE(line.find("shot.") != std::string::npos && std::regex_search(line, filled))
                    << name << ": " << line;
        }
}

}  // namespace
