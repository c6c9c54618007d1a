// The real program against what a careless script, a broken disk or a hostile file gives it: one sentence, the right
// exit code, and nothing that was there is lost.
#include <gtest/gtest.h>

#include <sys/stat.h>
#include <nlohmann/json.hpp>

#include <chrono>

#include "support/known_world.h"
#include "support/run_program.h"
#include "whole/relamp_program.h"

namespace relamp {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using Words = std::vector<std::string>;
using test::relamp;

/// What a shell makes of `command`, in which relamp stands for the program.
test::ProgramResult shell(std::string command) {
    const std::string word = "relamp ";
    for (size_t at = command.find(word); at != std::string::npos; at = command.find(word, at + 1))
        if (at == 0 || command[at - 1] == ' ') command.replace(at, word.size(), std::string(RELAMP_BINARY) + " ");
    return test::runProgram({"/bin/sh", "-c", command});
}

std::string joined(const Words& words) {
    std::string line;
    for (const std::string& word : words) line += word + " ";
    return line;
}

void expectEnd(const test::ProgramResult& r, int code, const Words& said, const std::string& what) {
    EXPECT_EQ(r.exitCode, code) << what << "\n" << r.error;
    for (const std::string& words : said)
        EXPECT_NE(r.error.find(words), std::string::npos) << what << ": expected " << words << " in: " << r.error;
}

/// A small capture and its shot, made once for all tests, which get copies.
class HostileInput : public testing::Test {
protected:
    static void SetUpTestSuite() {
        made = new test::TemporaryFolder;
        test::paintSmallWorld(*made / "capture", 6, 8);
        solved = relamp({"solve", *made / "capture", "-o", *made / "x.relamp", "--quality", "draft", "--accept-poor"});
    }
    static void TearDownTestSuite() { delete made; }
    void SetUp() override {
        ASSERT_EQ(solved.exitCode, 0) << solved.error;
        for (const char* name : {"capture", "x.relamp"})
            fs::copy(*made / name, folder / name, fs::copy_options::recursive);
    }
    test::ProgramResult render(const Words& options) const {
        Words all{"render", shot, "--samples", "1", "--size", "8x6"};
        all.insert(all.end(), options.begin(), options.end());
        return relamp(all);
    }
    test::ProgramResult solve(const Words& options) const {
        Words all{"solve", capture, "--quality", "draft", "--accept-poor"};
        all.insert(all.end(), options.begin(), options.end());
        return relamp(all);
    }
    /// Bytes of every file, by name.
    std::map<std::string, std::string> contents() const {
        std::map<std::string, std::string> found;
        for (const auto& entry : fs::recursive_directory_iterator(folder.path()))
            if (entry.is_regular_file()) found[entry.path().string()] = test::TemporaryFolder::read(entry.path());
        return found;
    }
    json transforms() const { return json::parse(test::TemporaryFolder::read(folder / "capture/transforms.json")); }

    static inline test::TemporaryFolder* made = nullptr;
    static inline test::ProgramResult solved;
    const test::TemporaryFolder folder;
    const std::string capture = folder / "capture", shot = folder / "x.relamp";
};

TEST_F(HostileInput, NoCommandWritesOverWhatItReads) {
    fs::create_symlink("capture/images/02.exr", folder / "link.exr");
    fs::create_hard_link(folder / "capture/images/02.exr", folder / "second-name.exr");
    fs::copy_file(folder / "x.relamp/environment.exr", folder / "sky.exr");
    for (const char* name : {"a.png", "b.png"}) writeImage(folder / name, Image(40, 30, Rgb(0.4f)));
    const std::string a = folder / "a.png", b = folder / "b.png", out = folder / "out.exr";
    const auto before = contents();
    const Words merge{"merge-hdr", a, b, "--times", "1,2"};
    const auto with = [](Words words, const Words& more) {
        words.insert(words.end(), more.begin(), more.end());
        return words;
    };
    const Words frame{"render", shot, "--samples", "1", "--size", "8x6"};
    for (const Words& arguments : std::vector<Words>{
             with(frame, {"-o", folder / "x.relamp/environment.exr"}),
             with(frame, {"-o", folder / "x.relamp/cache/environment_cells.exr"}),
             with(frame, {"-o", folder / "capture/images/00.exr"}),
             with(frame, {"-o", folder / "x.relamp/../capture/images/00.exr"}),
             with(frame, {"-o", folder / "link.exr"}),
             with(frame, {"-o", folder / "second-name.exr"}),
             with(frame, {"-o", folder / "capture/images/##.exr", "--camera", "all"}),
             with(frame, {"-o", folder / "sky.exr", "--env", folder / "sky.exr"}),
             with(merge, {"-o", out, "--response", a}),
             with(merge, {"-o", out, "--ghosts", b}),
             with(merge, {"-o", out, "--ghosts", out}),
             {"export", shot, "-o", shot, "--overwrite"},
             {"export", shot, "-o", capture, "--overwrite"},
             {"solve", capture, "-o", capture, "--overwrite"},
             {"solve", capture, "-o", shot, "--overwrite", "--mesh", folder / "x.relamp/reflectance.ply"}}) {
        expectEnd(relamp(arguments), 3, {}, joined(arguments));
        EXPECT_TRUE(contents() == before) << joined(arguments);
    }
    // What only lies beside the inputs may be written over.
    EXPECT_EQ(render({"-o", folder / "out.exr"}).exitCode, 0);
    EXPECT_EQ(render({"-o", folder / "out.exr"}).exitCode, 0);
}

TEST_F(HostileInput, AShotBehindALinkIsReadAndReplacedWhereItLies) {
    fs::create_directories(folder / "elsewhere/deep");
    const fs::path link = folder / "elsewhere/deep/link.relamp";
    fs::create_symlink("../../x.relamp", link);
    const auto written = fs::last_write_time(folder / "x.relamp/shot.json");
    const test::ProgramResult r = solve({"-o", link.string(), "--overwrite"});
    EXPECT_EQ(r.exitCode, 0) << r.error;
    EXPECT_TRUE(fs::is_symlink(link));
    EXPECT_NE(fs::last_write_time(folder / "x.relamp/shot.json"), written);
    const test::ProgramResult frame =
        relamp({"render", link.string(), "-o", folder / "f.exr", "--samples", "1", "--size", "8x6"});
    EXPECT_EQ(frame.exitCode, 0) << frame.error;
    // A frame behind a link, too.
    fs::create_symlink("f.exr", folder / "g.exr");
    fs::create_symlink("circle.exr", folder / "circle.exr");
    EXPECT_EQ(render({"-o", folder / "g.exr"}).exitCode, 0);
    EXPECT_TRUE(fs::is_symlink(folder / "g.exr"));
    expectEnd(render({"-o", folder / "circle.exr"}), 3, {"circle of links"}, "circle");
    expectEnd(render({"-o", folder.path() / "elsewhere.exr" / ""}), 3, {}, "a folder's name");
}

TEST_F(HostileInput, AFolderThatIsNoShotIsRefusedBeforeTheSolve) {
    folder.write("mine/notes.txt", "keep");
    expectEnd(solve({"-o", folder / "mine", "--overwrite"}), 3, {"is not a shot"}, "mine");
    EXPECT_EQ(solve({"-o", folder / "mine", "--overwrite"}).error.find("vertices are seen"), std::string::npos);
}

TEST_F(HostileInput, EmptyAndSenselessValuesAreWrongUsage) {
    for (const Words& wrong : std::vector<Words>{{"-o", ""},
                                                 {"-o", folder / "f.exr", "--edits", ""},
                                                 {"-o", folder / "f.exr", "--env", ""},
                                                 {"-o", folder / "f.exr", "--layers", ""},
                                                 {"-o", folder / "f##.exr", "--camera", "all", "--frames", ""},
                                                 {"-o", folder / "f##.exr", "--camera", "all", "--frames", "99"},
                                                 {"-o", folder / "f_%02d_%03d.exr", "--camera", "all"},
                                                 {"-o", folder / "f_##_%03d.exr", "--camera", "all"},
                                                 {"-o", folder / "f.exr", "--seed", "-1"}})
        expectEnd(render(wrong), 2, {}, joined(wrong));
    expectEnd(relamp({"render", shot, "-o", folder / "f.exr", "--size", ""}), 2, {"--size", "empty"}, "--size");
    expectEnd(solve({"-o", ""}), 2, {"empty"}, "solve -o");
    expectEnd(solve({"-o", folder / "n.relamp", "--seed", "-3"}), 2, {"--seed"}, "solve --seed");
    expectEnd(relamp({"check", ""}), 2, {"empty"}, "check");
    EXPECT_EQ(render({"-o", folder / "f.exr", "--threads", "1000000000"}).exitCode, 0) << "more threads than memory";
    for (const Words& wrong : std::vector<Words>{{"--time-budget", "nan"},
                                                 {"--seed", "99999999999999999999"},
                                                 {"--gauge", "albedo=5"},
                                                 {"--gauge", "emitter=emitter-1:0,0,0"},
                                                 {"--gauge", "white-patch=1e30,1,1"}}) {
        Words all{"-o", folder / "n.relamp"};
        all.insert(all.end(), wrong.begin(), wrong.end());
        expectEnd(solve(all), 2, {}, joined(wrong));
    }
    expectEnd(render({"-o", folder / "f.exr", "--env-yaw", "nan"}), 2, {"--env-yaw"}, "yaw");
    expectEnd(relamp({"render", shot, "-o", folder / "f.exr", "--size", "99999999x2"}), 2, {"--size"}, "a wide strip");
}

TEST_F(HostileInput, AShotOrAnAutosaveIsNoEditsDocument) {
    folder.write("work.autosave.json", R"({"capture": "/nowhere", "look": {"emitters": []}, "steps": []})");
    for (const std::string& file : {(folder / "x.relamp/shot.json").string(), (folder / "work.autosave.json").string()})
        expectEnd(render({"-o", folder / "frame.exr", "--edits", file}), 3, {file, "is a shot or an autosave"}, file);
    EXPECT_FALSE(fs::exists(folder / "frame.exr"));
}

TEST_F(HostileInput, ALocaleWithADecimalCommaChangesNothing) {
    // Where the sources of locales are installed there is one; elsewhere the name alone must do no harm.
    const std::string locales = folder / "locales";
    fs::create_directories(locales);
    shell("localedef -i de_DE -f UTF-8 '" + locales + "/de_DE.UTF-8'");
    const std::string comma = "LOCPATH='" + locales + "' LC_ALL=de_DE.UTF-8 ";
    const auto said = [&](const std::string& where, const std::string& command) {
        const test::ProgramResult r = shell(where + "relamp " + command);
        EXPECT_EQ(r.exitCode, 0) << command << ": " << r.error;
        return r.out;
    };
    for (const std::string& command : {"info '" + shot + "' --json", "check '" + capture + "' --json --scale 1.5"})
        EXPECT_EQ(said(comma, command), said("", command));
    folder.write("look.json", R"({"environment": {"exposure_stops": 0.5, "yaw_degrees": 12.25}})");
    for (const std::string name : {"plain", "comma"})
        said(name == "comma" ? comma : "", "render '" + shot + "' -o '" + (folder / (name + ".exr")).string() +
                                               "' --samples 1 --size 8x6 --env-yaw 12.5 --edits '" +
                                               (folder / "look.json").string() + "'");
    EXPECT_EQ(test::TemporaryFolder::read(folder / "plain.exr"), test::TemporaryFolder::read(folder / "comma.exr"));
    EXPECT_EQ(
        shell(comma + "relamp render '" + shot + "' -o '" + (folder / "c.exr").string() + "' --env-yaw 12,5").exitCode,
        2)
        << "a comma is no decimal point anywhere";
}

TEST_F(HostileInput, AResultThatCannotBePrintedIsAnError) {
    for (const std::string& line : {"info " + shot + " --json", "info " + shot, "info " + capture,
                                    "check " + capture + " --json", std::string("--help"), std::string("--version")})
        expectEnd(shell("relamp " + line + " > /dev/full"), 6, {"standard output"}, line);
}

TEST_F(HostileInput, CamerasThatSeeNothingAreNamed) {
    const json good = transforms();
    const auto check = [&](const json& file, const Words& said) {
        folder.write("capture/transforms.json", file.dump());
        expectEnd(relamp({"check", capture}), 3, said, said.back());
        folder.write("capture/transforms.json", good.dump());
    };
    for (const char* key : {"fl_x", "cx"}) {
        json file = good;
        file[key] = key == std::string("fl_x") ? 1e-310 : 1e8;
        check(file, {"transforms.json", key});
    }
    json file = good;
    file["frames"][1]["transform_matrix"][0][3] = 1e30;
    check(file, {"frame 1", "too large"});
    json camera{{"w", 8}, {"h", 6}, {"fl_x", 1e-310}, {"transform_matrix", good["frames"][0]["transform_matrix"]}};
    folder.write("camera.json", camera.dump());
    expectEnd(relamp({"render", shot, "-o", folder / "f.exr", "--camera", folder / "camera.json"}), 3, {"fl_x"},
              "camera");
    expectEnd(solve({"-o", folder / "n.relamp", "--proxy-light", "0,0,1,1e-20"}), 3, {"proxy light", "1e-20"}, "proxy");
    // Lengths that leave the range of single precision.
    for (const char* edits :
         {R"({"emitters": [{"id": "emitter-1", "matrix": [[1,0,0,1e30],[0,1,0,0],[0,0,1,0],[0,0,0,1]]}]})",
          R"({"added_emitters": [{"id": "a", "shape": "sphere", "size": [1e30, 1e30]}]})"})
        expectEnd(render({"-o", folder / "f.exr", "--edits", folder.write("e.json", edits)}), 3, {"too large"}, edits);
    // Coefficients of a lens that leave no direction for most pixels end in a frame or a sentence.
    camera["fl_x"] = 8;
    for (const char* key : {"k1", "p1", "k6"}) {
        json wild = camera;
        wild[key] = -1e300;
        folder.write("camera.json", wild.dump());
        const int code = relamp({"render", shot, "-o", folder / "f.exr", "--camera", folder / "camera.json"}).exitCode;
        EXPECT_TRUE(code == 0 || code == 3) << key << ": " << code;
    }
}

TEST_F(HostileInput, PhotographsWithoutAPixelThatCountsSayWhy) {
    const auto fill = [&](const Rgb& value) {
        for (int i = 0; i < 6; ++i)
            writeImage(folder / fmt::format("capture/images/{:02}.exr", i), Image(64, 48, value));
    };
    fs::create_directories(folder / "capture/masks");
    for (int i = 0; i < 6; ++i)
        writeImage(folder / fmt::format("capture/masks/{:02}.exr.png", i), Image(64, 48, Rgb(0)));
    expectEnd(solve({"-o", folder / "n.relamp"}), 3, {"100 % are black in a mask"}, "masks");
    fs::remove_all(folder / "capture/masks");
    fill(Rgb(std::numeric_limits<float>::quiet_NaN()));
    expectEnd(solve({"-o", folder / "n.relamp"}), 3, {"100 % are not a number"}, "NaN");
    fill(Rgb(-1));
    expectEnd(solve({"-o", folder / "n.relamp"}), 3, {"100 % are negative"}, "negative");
    fs::create_directories(folder / "capture/masks/00.exr.png");
    expectEnd(solve({"-o", folder / "n.relamp"}), 3, {"00.exr.png: is a folder"}, "a mask that is a folder");
}

TEST_F(HostileInput, WhatIsNoRegularFileIsNeitherReadNorReplaced) {
    const fs::path pipe = folder / "pipe.exr";
    ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
    for (const char* option : {"--edits", "--env", "--camera"})
        expectEnd(render({"-o", folder / "f.exr", option, pipe}), 3, {"pipe.exr: is no regular file"}, option);
    expectEnd(render({"-o", pipe.string()}), 3, {"is no regular file"}, "-o");
    EXPECT_TRUE(fs::is_fifo(pipe));
    fs::remove(folder / "capture/mesh.ply");
    ASSERT_EQ(::mkfifo((folder / "capture/mesh.ply").c_str(), 0600), 0);
    expectEnd(relamp({"check", capture}), 3, {"is no regular file"}, "mesh");
}

TEST_F(HostileInput, BrokenDocumentsSayWhere) {
    expectEnd(render({"-o", folder / "f.exr", "--edits", folder.write("e.json", "{\n \"emitters\": [1,]\n}")}), 3,
              {"e.json: is not valid JSON", "line 2, column 17"}, "edits");
    folder.write("x.relamp/shot.json", "{\n\n \"version\" 2}");
    for (const char* verb : {"info", "report"})
        expectEnd(verb == std::string("info") ? relamp({verb, shot}) : relamp({verb, shot, "-o", folder / "r.html"}), 3,
                  {"shot.json: is not valid JSON", "line 3, column 12"}, verb);
    folder.write("x.relamp/shot.json", "{\"version\": 2, \"emitters\": [], \"mode\": \"x\", \"deep\": " +
                                           std::string(200'000, '[') + std::string(200'000, ']') + "}");
    expectEnd(relamp({"info", shot, "--json"}), 3, {"nested deeper"}, "nested");
}

TEST_F(HostileInput, ControlCharactersAreShownAsNumbers) {
    const std::string name = "a\033[31m\nb\x7f";
    for (const Words& arguments : std::vector<Words>{{"check", name}, {"render", shot, "-o", "f.exr", "--" + name}}) {
        const test::ProgramResult r = relamp(arguments);
        EXPECT_NE(r.exitCode, 0);
        EXPECT_NE(r.error.find("a\\x1b[31m"), std::string::npos) << r.error;
        EXPECT_EQ(r.error.find('\033'), std::string::npos);
        EXPECT_EQ(r.error.find('\x7f'), std::string::npos);
    }
}

TEST_F(HostileInput, AStopIsNoticedInsideAPixelOfVeryManySamples) {
    const auto begin = std::chrono::steady_clock::now();
    const test::ProgramResult r = relamp(
        {"render", shot, "-o", folder / "f.exr", "--samples", "1000000000", "--size", "64x48", "--progress", "json"},
        "f.exr", SIGTERM);
    EXPECT_EQ(r.exitCode, 143) << r.error;
    EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(15));
    EXPECT_FALSE(fs::exists(folder / "f.exr"));
}

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
TEST_F(HostileInput, TooLittleMemoryIsExitCodeSixWhereverItEnds) {
    const auto limited = [&](int mib, const std::string& line) {
        return shell(fmt::format("ulimit -v {}; relamp {}", mib * 1024, line)).exitCode;
    };
    // The loader of libraries ends with 127 as long as not even they fit.
    int least = 100;
    for (int step = 2560; step >= 10; step /= 2)
        if (limited(least + step, "--version") == 127) least += step;
    least += 10;
    size_t refused = 0;
    const std::string lines[] = {"check " + capture,
                                 "render " + shot + " -o " + (folder / "f.exr").string() + " --samples 1"};
    // In turn: what they ask of memory before their own work is the same.
    for (int i = 0; i < 16; ++i) {
        const int mib = least + 10 * i;
        const std::string& line = lines[i % 2];
        const int code = limited(mib, line + " > /dev/null");
        EXPECT_TRUE(code == 0 || code == 6) << mib << " MiB: " << line << ": " << code;
        refused += code == 6;
    }
    EXPECT_GT(refused, 0u);
}
#endif

}  // namespace
}  // namespace relamp
