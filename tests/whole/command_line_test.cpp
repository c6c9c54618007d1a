// The real program, run as a user or a farm runs it.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "capture/capture_formats.h"
#include "support/colmap_copy.h"
#include "support/exr_header.h"
#include "support/known_world.h"
#include "support/run_program.h"
#include "whole/relamp_program.h"

namespace relamp {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using test::expectBadInput;
using test::linesOf;
using test::relamp;

TEST(CommandLine, WrongUsageIsExitCodeTwoWithNothingOnStdout) {
    const std::vector<std::vector<std::string>> wrong{
        {},
        {"dance"},
        {"solve"},
        {"solve", "capture"},
        {"check"},
        {"solve", "capture", "-o", "x.relamp", "--quality", "best"},
        {"solve", "capture", "-o", "x.relamp", "--mode", "both"},
        {"solve", "capture", "-o", "x.relamp", "--threads", "-2"},
        {"solve", "capture", "-o", "x.relamp", "--time-budget", "soon"},
        {"solve", "capture", "-o", "x.relamp", "--grid-side", "33"},
        {"solve", "capture", "-o", "x.relamp", "--gauge", "sunny"},
        {"solve", "capture", "-o", "x.relamp", "--gauge", "albedo=0"},
        {"solve", "capture", "-o", "x.relamp", "--proxy-light", "1,2"},
        {"check", "capture", "--proxy-light", "1,2,up"},
        {"check", "capture", "--proxy-light", "1,2,3,-1"},
        {"solve", "capture", "-o", "x.relamp", "--gauge", "white-patch=1,2"},
        {"solve", "capture", "-o", "x.relamp", "--nonsense"},
        {"render", "shot", "-o", "f.exr", "--samples", "0"},
        {"info", "x", "--progress", "loud"}};
    for (const auto& arguments : wrong) {
        const test::ProgramResult r = relamp(arguments);
        std::string line;
        for (const std::string& a : arguments) line += a + " ";
        EXPECT_EQ(r.exitCode, 2) << line << "\n" << r.error;
        EXPECT_EQ(r.out, "") << line;
        EXPECT_NE(r.error, "") << line;
    }
}

TEST(CommandLine, AnUnknownCommandIsNamed) {
    EXPECT_NE(relamp({"solv", "capture"}).error.find("There is no command solv."), std::string::npos);
    EXPECT_NE(relamp({"--quiet"}).error.find("required"), std::string::npos);
}

TEST(CommandLine, HelpAndVersionAreResults) {
    EXPECT_EQ(relamp({"--version"}).exitCode, 0);
    EXPECT_EQ(relamp({"--version"}).out.substr(0, 7), "relamp ");
    const test::ProgramResult help = relamp({"--help"});
    EXPECT_EQ(help.exitCode, 0);
    for (const char* verb : {"check", "solve", "render", "export", "compare", "info"})
        EXPECT_NE(help.out.find(verb), std::string::npos) << verb;
    EXPECT_EQ(help.error, "");
}

/// Whoever has a folder of another program asks the import doctor whether it is read.
TEST(CommandLine, HelpOfVerbsForCapturesListsTheirFormats) {
    for (const char* verb : {"check", "plan", "solve", "compare", "info"}) {
        const test::ProgramResult help = relamp({verb, "--help"});
        EXPECT_EQ(help.exitCode, 0) << verb;
        size_t at = help.out.find("Capture formats");
        ASSERT_NE(at, std::string::npos) << verb;
        for (const CaptureFormat& format : captureFormats()) {  // in their order, a line each
            const size_t line = help.out.find(fmt::format("\n  {} ", format.name), at);
            ASSERT_NE(line, std::string::npos) << verb << " does not list " << format.name;
            at = line + 1;
            EXPECT_NE(help.out.substr(at, help.out.find('\n', at) - at).find(format.marks), std::string::npos)
                << verb << ": " << format.name;
        }
    }
    EXPECT_EQ(relamp({"render", "--help"}).out.find("Capture formats"), std::string::npos);
}

TEST(CommandLine, WhatIsNotThereIsBadInput) {
    const test::TemporaryFolder folder;
    for (const char* verb : {"check", "info"})
        expectBadInput(relamp({verb, folder / "absent"}), {(folder / "absent").string() + ": does not exist"});
    // A name longer than any may be.
    for (const char* verb : {"check", "info", "stress"})
        expectBadInput(relamp({verb, folder / std::string(300, 'x')}), {"xxx"});
    expectBadInput(relamp({"solve", folder / "absent", "-o", folder / "x.relamp"}), {"absent"});
    expectBadInput(relamp({"check", folder.path()}), {"transforms.json"});
    expectBadInput(relamp({"render", folder / "absent.relamp", "-o", folder / "f.exr"}),
                   {"absent.relamp: does not exist"});
    EXPECT_EQ(folder.entries(), 0u);
}

/// From a capture to frames, in one test because the shot is made once.
/// What a look does to the light is found from its frame alone; wrong requests are refused.
void expectPaints(const std::string& shot, const test::TemporaryFolder& folder) {
    folder.write("dim.json", R"({"emitters": [{"id": "emitter-1", "power_scale": [0.4, 0.2, 0.1]}]})");
    const std::string target = folder / "dim.exr";
    ASSERT_EQ(relamp({"render", shot, "-o", target, "--edits", folder / "dim.json"}).exitCode, 0);
    const test::ProgramResult painted = relamp({"paint", shot, "--target", target, "--keep", "1e-5"});
    ASSERT_EQ(painted.exitCode, 0) << painted.error;
    const json look = json::parse(painted.out, nullptr, false);
    ASSERT_TRUE(look.is_object()) << painted.out;
    ASSERT_EQ(look["emitters"].size(), 1u);
    const double expected[] = {0.4, 0.2, 0.1};
    for (size_t c = 0; c < 3; ++c)
        EXPECT_NEAR(look["emitters"][0]["power_scale"][c].get<double>(), expected[c], 0.01 * expected[c]) << c;
    EXPECT_EQ(relamp({"paint", shot, "--target", target, "--lights", "nobody"}).exitCode, 2);
    EXPECT_EQ(relamp({"paint", shot, "--target", target, "--camera", "all"}).exitCode, 2);
    expectBadInput(relamp({"paint", shot, "--target", folder / "absent.exr"}), {"absent.exr"});
    expectBadInput(relamp({"paint", shot, "--target", target, "-o", target}), {"dim.exr"});
    expectBadInput(relamp({"paint", shot, "--target", target, "-o", folder / "nowhere/look.json"}), {"nowhere"});
}

/// A group that is off is its lights off, to the bit; one that is dimmed is its lights dimmed. `paint` refuses the
/// lights of one that is off, and takes them again once it is on.
void expectGroups(const std::string& shot, const test::TemporaryFolder& folder) {
    const std::string lamp = R"({"id": "added-1", "shape": "rectangle", "size": [0.3, 0.3], "radiance": [4, 4, 4],
        "matrix": [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 1.5], [0, 0, 0, 1]]})";
    const auto rendered = [&](const std::string& name, const std::string& look) {
        folder.write(name + ".json", look);
        const test::ProgramResult r = relamp({"render", shot, "-o", folder / (name + ".exr"), "--edits",
                                              folder / (name + ".json"), "--samples", "1", "--size", "24x18"});
        EXPECT_EQ(r.exitCode, 0) << r.error;
        return readImage(folder / (name + ".exr")).pixels;
    };
    const auto grouped = [&](const std::string& group) {
        return R"({"groups": [{"name": "Both", "members": ["emitter-1", "added-1"], )" + group +
               R"(}], "added_emitters": [)" + lamp + "]}";
    };
    const auto single = [&](const std::string& edit, const std::string& added) {
        json look{{"emitters", {json::parse(edit)}}, {"added_emitters", {json::parse(lamp)}}};
        look["added_emitters"][0].update(json::parse(added));
        return look.dump();
    };
    const auto off = rendered("group-off", grouped(R"("enabled": false)"));
    EXPECT_EQ(off, rendered("lights-off", single(R"({"id": "emitter-1", "enabled": false})", R"({"enabled": false})")));
    const auto dimmed = rendered("group-dim", grouped(R"("power_scale": [0.5, 0.5, 0.5])"));
    EXPECT_EQ(dimmed, rendered("lights-dim", single(R"({"id": "emitter-1", "power_scale": [0.5, 0.5, 0.5]})",
                                                    R"({"radiance": [2, 2, 2]})")));
    const auto on = rendered("group-on", grouped(R"("enabled": true)"));
    EXPECT_NE(on, off);
    EXPECT_NE(on, dimmed);
    for (const char* light : {"emitter-1", "added-1"}) {
        const std::string target = folder / "group-on.exr";
        const test::ProgramResult refused =
            relamp({"paint", shot, "--target", target, "--lights", light, "--edits", folder / "group-off.json"});
        EXPECT_EQ(refused.exitCode, 2) << refused.error;
        EXPECT_EQ(refused.out, "");
        EXPECT_NE(refused.error.find("is in a group that is off"), std::string::npos) << refused.error;
    }
    EXPECT_EQ(relamp({"paint", shot, "--target", folder / "group-off.exr", "--lights", "added-1", "--edits",
                      folder / "group-on.json"})
                  .exitCode,
              0);
}

TEST(CommandLine, SolvesRendersAndTellsWhatIsInAShot) {
    const test::TemporaryFolder folder;
    test::paintSmallWorld(folder / "capture", 6, 14);
    const std::string capture = folder / "capture", shot = folder / "x.relamp";

    const test::ProgramResult check = relamp({"check", capture, "--json"});
    EXPECT_EQ(check.exitCode, 0) << check.error;
    EXPECT_TRUE(json::parse(check.out, nullptr, false).is_object()) << check.out;

    const test::ProgramResult solve = relamp({"solve", capture, "-o", shot, "--quality", "draft", "--threads", "2"});
    ASSERT_EQ(solve.exitCode, 0) << solve.error;
    EXPECT_EQ(solve.out, "") << "stdout carries results only";
    EXPECT_EQ(solve.error.find('\033'), std::string::npos) << "no escapes when stderr is no terminal";
    EXPECT_EQ(solve.error.find('\r'), std::string::npos);
    expectBadInput(relamp({"solve", capture, "-o", shot, "--quality", "draft"}), {"--overwrite", shot});

    const test::ProgramResult progress =
        relamp({"solve", capture, "-o", shot, "--overwrite", "--quality", "draft", "--quiet", "--progress", "json"});
    EXPECT_EQ(progress.exitCode, 0);
    size_t lines = 0;
    std::istringstream stream(progress.error);
    for (std::string line; std::getline(stream, line); ++lines) {
        const json step = json::parse(line, nullptr, false);
        EXPECT_TRUE(step.is_object() && step.contains("stage") && step.contains("fraction")) << line;
    }
    EXPECT_GT(lines, 5u);

    const test::ProgramResult info = relamp({"info", shot, "--json"});
    EXPECT_EQ(info.exitCode, 0);
    const json found = json::parse(info.out, nullptr, false);
    ASSERT_TRUE(found.is_object()) << info.out;
    EXPECT_EQ(found["emitters"].size(), 1u);
    EXPECT_EQ(found["emitters"][0]["power"], found["emitters"][0]["radiance"]) << "scripts read the name of version 1";
    EXPECT_EQ(found["environment"]["kept_coefficients"], found["environment"]["leaves"]);
    for (const char* key : {"environment", "gauge", "basis", "left_out", "timeline", "stability", "resources"})
        EXPECT_TRUE(found.contains(key)) << key;
    EXPECT_EQ(relamp({"info", shot}).exitCode, 0);
    EXPECT_EQ(json::parse(relamp({"info", capture, "--json"}).out)["views"], 6);

    // Frames.
    const std::string frames = folder / "frames.##.exr";
    EXPECT_EQ(relamp({"render", shot, "-o", frames, "--camera", "all", "--frames", "2-3,9", "--samples", "1", "--size",
                      "24x18"})
                  .exitCode,
              0);
    EXPECT_TRUE(fs::exists(folder / "frames.02.exr") && fs::exists(folder / "frames.03.exr"));
    EXPECT_FALSE(fs::exists(folder / "frames.09.exr") || fs::exists(folder / "frames.01.exr"));
    EXPECT_EQ(readImageSize(folder / "frames.02.exr"), std::pair(24, 18));
    // --skip-existing leaves what is there and fills in what is missing.
    folder.write("frames.02.exr", "mine");
    fs::remove(folder / "frames.03.exr");
    EXPECT_EQ(relamp({"render", shot, "-o", frames, "--camera", "all", "--frames", "2-3", "--samples", "1", "--size",
                      "24x18", "--skip-existing"})
                  .exitCode,
              0);
    EXPECT_EQ(test::TemporaryFolder::read(folder / "frames.02.exr"), "mine");
    EXPECT_TRUE(fs::exists(folder / "frames.03.exr"));
    // Cameras and looks that move; the photograph itself relit; the scene for other programs.
    folder.write("keys.json",
                 R"({"keys": [{"frame": 1, "look": {}},
            {"frame": 3, "look": {"emitters": [{"id": "emitter-1", "enabled": false}]}}]})");
    const std::string moving = folder / "turn.#.exr", keys = folder / "keys.json";
    EXPECT_EQ(relamp({"render", shot, "-o", moving, "--camera", "turntable:3", "--frames", "2-5", "--edits", keys,
                      "--samples", "1", "--size", "24x18"})
                  .exitCode,
              0);
    EXPECT_TRUE(fs::exists(folder / "turn.2.exr") && fs::exists(folder / "turn.3.exr"));
    EXPECT_FALSE(fs::exists(folder / "turn.1.exr") || fs::exists(folder / "turn.4.exr"));
    // One camera and a look that moves; a plate with its own camera.
    EXPECT_EQ(relamp({"render", shot, "-o", folder / "still.#.exr", "--frames", "1-3:2", "--edits", keys, "--samples",
                      "1", "--size", "24x18"})
                  .exitCode,
              0);
    EXPECT_NE(readImage(folder / "still.1.exr").pixels, readImage(folder / "still.3.exr").pixels);
    const std::vector<std::string> still{
        "render", shot, "-o", folder / "still.exr", "--frames", "99", "--samples", "1", "--size", "24x18"};
    const test::ProgramResult unkeyed = relamp(still);
    EXPECT_EQ(unkeyed.exitCode, 0);
    EXPECT_NE(unkeyed.error.find("--frames 99: "), std::string::npos) << unkeyed.error;
    std::vector<std::string> keyed = still;
    keyed.insert(keyed.end(), {"--edits", keys});
    EXPECT_EQ(relamp(keyed).error.find("--frames 99: "), std::string::npos);
    fs::copy(folder / "capture/images/00.exr", folder / "plate.0001.exr");
    fs::copy(folder / "capture/images/01.exr", folder / "plate.0003.exr");
    // One that is damaged is named, the others are written.
    const std::string bytes = test::TemporaryFolder::read(folder / "plate.0001.exr");
    folder.write("plate.0002.exr", bytes.substr(0, bytes.size() / 2));
    const test::ProgramResult plate =
        relamp({"render", shot, "-o", folder / "relit.##.exr", "--plate", folder / "plate.####.exr", "--plate-camera",
                folder / "capture/transforms.json", "--edits", keys, "--samples", "2"});
    EXPECT_EQ(plate.exitCode, 5) << "frame 2 is damaged: " << plate.error;
    EXPECT_NE(plate.error.find("plate.0002.exr"), std::string::npos) << plate.error;
    EXPECT_EQ(relamp({"render", shot, "-o", folder / "part.##.exr", "--plate", folder / "plate.####.exr",
                      "--plate-camera", folder / "capture/transforms.json", "--frames", "1"})
                  .exitCode,
              0)
        << "frame 2 is another part's";
    EXPECT_EQ(readImage(folder / "relit.01.exr").pixels, readImage(folder / "plate.0001.exr").pixels)
        << "nothing is edited in frame 1";
    // The same plate as the look's own, with the light keyed alone; options win.
    folder.write("own.json",
                 R"({"plate": {"files": "plate.####.exr", "camera": "capture/transforms.json"}, "value_keys": [
            {"light": "emitter-1", "value": "enabled",
             "keys": [{"frame": 1, "value": true}, {"frame": 3, "value": false}]}]})");
    const test::ProgramResult own =
        relamp({"render", shot, "-o", folder / "own.##.exr", "--edits", folder / "own.json", "--samples", "2"});
    EXPECT_EQ(own.exitCode, 5) << own.error;
    fs::remove(folder / "plate.0002.exr");
    // Parts that go beyond the end are the last of a farm.
    for (const auto& [range, written] : {std::pair("3-5", true), {"7-9", false}}) {
        const test::ProgramResult part =
            relamp({"render", shot, "-o", folder / (std::string("end.##.") + range + ".exr"), "--frames", range,
                    "--edits", folder / "own.json", "--samples", "1", "--exr-compression", "piz"});
        EXPECT_EQ(part.exitCode, 0) << part.error;
        EXPECT_NE(part.error.find("outside the plate's 1 to 3, skipped"), std::string::npos) << part.error;
        EXPECT_NE(part.error.find("frames 2 are missing"), std::string::npos) << part.error;
        EXPECT_EQ(fs::exists(folder / (std::string("end.03.") + range + ".exr")), written);
    }
    EXPECT_EQ(test::readExrHeader(folder / "end.03.3-5.exr").compression, "piz");
    const test::ProgramResult early =
        relamp({"render", shot, "-o", folder / "end.exr", "--frames", "0", "--edits", folder / "own.json"});
    EXPECT_EQ(early.exitCode, 2) << early.error;
    for (const char* number : {"01", "03"})
        EXPECT_EQ(readImage(folder / (std::string("own.") + number + ".exr")).pixels,
                  readImage(folder / (std::string("relit.") + number + ".exr")).pixels)
            << number;
    EXPECT_EQ(relamp({"render", shot, "-o", folder / "view.exr", "--edits", folder / "own.json", "--camera", "0",
                      "--samples", "1"})
                  .exitCode,
              0);
    expectBadInput(relamp({"render", shot, "-o", folder / "plate.####.exr", "--edits", folder / "own.json"}),
                   {"plate.0001.exr"});
    EXPECT_NE(readImage(folder / "relit.03.exr").pixels, readImage(folder / "plate.0003.exr").pixels);
    const test::ProgramResult ratio = relamp({"render", shot, "-o", folder / "ratio.exr", "--ratio", "--edits", keys,
                                              "--camera", "0", "--samples", "1", "--layers", "all", "--multipart"});
    EXPECT_EQ(ratio.exitCode, 0) << ratio.error;
    EXPECT_EQ(relamp({"render", shot, "-o", folder / "same.exr", "--ratio", "--samples", "1"}).exitCode, 0);
    const Image photograph = readImage(folder / "capture/images/00.exr"), same = readImage(folder / "same.exr");
    for (size_t p = 0; p < same.pixels.size(); ++p)
        ASSERT_NEAR(same.pixels[p].x, photograph.pixels[p].x, 1e-3 * photograph.pixels[p].x + 1e-6);
    // Other cameras take the detail from the photographs.
    for (const char* camera : {"--camera=turntable:1", "--size=24x18"}) {
        const test::ProgramResult other =
            relamp({"render", shot, "-o", folder / "other.exr", "--ratio", "--edits", keys, camera, "--samples", "1"});
        EXPECT_EQ(other.exitCode, 0) << camera << other.error;
    }
    EXPECT_EQ(relamp({"export", shot, "-o", folder / "scene"}).exitCode, 0);
    EXPECT_EQ(json::parse(test::TemporaryFolder::read(folder / "scene/lights.json"))["lights"][0]["id"], "emitter-1");
    EXPECT_EQ(relamp({"check", folder / "scene"}).exitCode, 0) << "what is exported is a capture again";
    expectBadInput(relamp({"export", shot, "-o", folder / "scene"}), {"scene", "--overwrite"});
    // As if it had been photographed with its light at a quarter too.
    const fs::path states = folder / "states.relamp";
    fs::copy(shot, states, fs::copy_options::recursive);
    json document = json::parse(test::TemporaryFolder::read(states / "shot.json"));
    for (const auto& [name, level] : {std::pair{"on", 1.0}, {"dim", 0.25}})
        document["states"].push_back(
            {{"name", name}, {"views", {"a"}}, {"emitters", {{{"id", "emitter-1"}, {"level", level}}}}});
    folder.write("states.relamp/shot.json", document.dump());
    EXPECT_EQ(relamp({"export", states, "-o", folder / "dim", "--state", "dim"}).exitCode, 0);
    const auto exported = [&](const char* scene) {
        return json::parse(test::TemporaryFolder::read(folder / scene / "lights.json"))["lights"][0]["radiance"][0]
            .get<double>();
    };
    EXPECT_NEAR(exported("dim"), 0.25 * exported("scene"), 1e-4 * exported("scene"));
    EXPECT_EQ(relamp({"export", states, "-o", folder / "none", "--state", "off"}).exitCode, 2);
    // Options that cannot be meant.
    for (const std::vector<std::string>& extra :
         std::vector<std::vector<std::string>>{{"--camera", "all", "--frames", "1-3"},
                                               {"--camera", "all", "--frames", "3-1"},
                                               {"--camera", "99"},
                                               {"--size", "12"},
                                               {"--layers", "beauty"},
                                               {"--frames", "1-2"},
                                               {"--plate", "p.exr"},
                                               {"--matte", "m.exr"},
                                               {"--ratio=cubed", "--samples=1"},
                                               {"--layers=residual", "--size=24x18"},
                                               {"--camera", "turntable:0"},
                                               {"--camera", "path:0,77:4"},
                                               {"--naming", "nuke"},
                                               {"--view", "film"}}) {
        std::vector<std::string> arguments{"render", shot, "-o", folder / "one.exr", "--samples", "1"};
        arguments.insert(arguments.end(), extra.begin(), extra.end());
        const test::ProgramResult r = relamp(arguments);
        EXPECT_EQ(r.exitCode, 2) << extra[0] << " " << extra[1] << ": " << r.error;
        EXPECT_FALSE(fs::exists(folder / "one.exr"));
    }
    for (const auto& [option, words] : {std::pair("--seed=-1", "--seed: -1: expected 0 or more\n"),
                                        std::pair("--samples=0", "--samples: 0: expected a number above 0\n")}) {
        const test::ProgramResult r = relamp({"render", shot, "-o", folder / "one.exr", option});
        EXPECT_EQ(r.exitCode, 2) << option;
        EXPECT_NE(r.error.find(words), std::string::npos) << r.error;
    }
    expectPaints(shot, folder);
    expectGroups(shot, folder);
    // Bad files name themselves.
    folder.write("edits.json", R"({"emitters": [{"id": "emitter-9"}]})");
    expectBadInput(relamp({"render", shot, "-o", folder / "one.exr", "--edits", folder / "edits.json"}), {"emitter-9"});
    folder.write("edits.json", R"({"environment": {"tint": [1]}})");
    expectBadInput(relamp({"render", shot, "-o", folder / "one.exr", "--edits", folder / "edits.json"}),
                   {"edits.json", "environment.tint"});
    expectBadInput(relamp({"render", shot, "-o", folder / "one.exr", "--env", folder / "absent.hdr"}), {"absent.hdr"});
    expectBadInput(relamp({"render", shot, "-o", folder / "one.exr", "--camera", folder / "absent.json"}),
                   {"absent.json"});
    expectBadInput(relamp({"render", shot, "-o", folder / "nowhere/one.exr", "--samples", "1", "--size", "8x6"}),
                   {"nowhere"});
    json broken = json::parse(test::TemporaryFolder::read(folder / "x.relamp/shot.json"));
    broken["emitters"][0]["radiance"] = "bright";
    folder.write("x.relamp/shot.json", broken.dump());
    expectBadInput(relamp({"render", shot, "-o", folder / "one.exr"}), {"shot.json", "emitters[0].radiance"});
    broken.erase("gauge");
    folder.write("x.relamp/shot.json", broken.dump());
    expectBadInput(relamp({"info", shot}), {"shot.json"});
    EXPECT_FALSE(fs::exists(folder / "one.exr"));
}

/// The same world as a COLMAP model in folders of other names, turned so that nothing is up by itself.
TEST(CommandLine, AColmapCaptureIsSolvedAndItsShotOpensByItself) {
    const test::TemporaryFolder folder;
    test::paintSmallWorld(folder / "room", 6, 8);
    test::makeColmap(folder / "room", "recon");
    fs::rename(folder / "room/mesh.ply", folder / "room/scan.ply");
    const std::string capture = folder / "room", shot = folder / "x.relamp";
    expectBadInput(relamp({"solve", capture, "-o", shot}), {"transforms.json", "does not exist"});
    const std::vector<std::string> places{"--colmap", "recon", "--images", ".", "--mesh", "scan.ply", "--up", "z"};
    const auto with = [&](std::vector<std::string> arguments) {
        arguments.insert(arguments.end(), places.begin(), places.end());
        return relamp(arguments);
    };
    const test::ProgramResult check = with({"check", capture, "--json"});
    ASSERT_EQ(check.exitCode, 0) << check.error;
    const json found = json::parse(check.out);
    EXPECT_GT(found["views"][0]["mesh_fraction"].get<double>(), 0.2);
    EXPECT_TRUE(found.contains("reconstruction"));
    ASSERT_EQ(with({"solve", capture, "-o", shot, "--quality", "draft"}).exitCode, 0);
    EXPECT_EQ(json::parse(relamp({"info", shot, "--json"}).out)["emitters"].size(), 1u);
    const test::ProgramResult frame = relamp({"render", shot, "-o", (folder / "f.exr").string(), "--samples", "1"});
    EXPECT_EQ(frame.exitCode, 0) << frame.error;
}

TEST(CommandLine, AnInterruptEndsASolveWithItsOwnCodeAndLeavesNothingBehind) {
    const test::TemporaryFolder folder;
    test::paintKnownWorld(folder / "capture", true, 4, 60);
    for (const auto& [number, code] : {std::pair{SIGINT, 130}, std::pair{SIGTERM, 143}}) {
        const test::ProgramResult r =
            relamp({"solve", folder / "capture", "-o", folder / "x.relamp", "--quality", "fine", "--progress", "json"},
                   "Visibility", number);
        EXPECT_EQ(r.exitCode, code) << r.error;
        EXPECT_EQ(r.out, "");
        EXPECT_EQ(folder.entries(), 1u) << "the capture alone";
    }
}

}  // namespace
}  // namespace relamp
