#include "shot/shot_file.h"

#include <gtest/gtest.h>

#include <signal.h>
#include <sys/resource.h>
#include <nlohmann/json.hpp>

#include "capture/load_capture.h"
#include "image/environment_map.h"
#include "image/image_io.h"
#include "scene/mesh_io.h"
#include "support/estimates.h"
#include "support/measured.h"
#include "support/one_view_capture.h"
#include "support/temporary_folder.h"

namespace relamp {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

/// A capture of one view and a shot of it with an emitter.
class ShotFile : public testing::Test {
protected:
    void SetUp() override {
        Mesh mesh = test::sheet({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, 4, 4);
        const std::vector<uint32_t> emitter = test::append(mesh, test::squareAbove(0.5f, 0, 0, 1, 2));
        test::writeOneViewCapture(folder, mesh);
        scene = test::sceneOf(mesh);
        shot.captureFolder = folder / "capture";
        shot.estimate = test::matteEstimate(scene, Rgb(0.5f, 0.25f, 0.125f), Rgb(0),
                                            test::emittersOf(scene, {emitter}, {Rgb(12, 11, 10)}));
        Estimate& e = shot.estimate;
        e.reflectance.basis.lobes.push_back({Lobe::Kind::ggxDielectric, 0.1024f, "ggx dielectric roughness 0.32"});
        e.reflectance.weight.push_back(std::vector<Rgb>(mesh.vertexCount(), Rgb(0.75f, 0.5f, 0.25f)));
        e.environmentSide = 256;
        e.environment.assign(256 * 256, Rgb(0.1f, 0.2f, 0.4f));
        for (int y = 100; y < 104; ++y)
            for (int x = 30; x < 34; ++x) e.environment[size_t(y) * 256 + size_t(x)] = Rgb(90000, 70000, 50000);
        e.timeline.push_back({1.5, "light", 3, 0.25, 0.125});
        e.leftOut.push_back({Omission::interreflection, "direct light only"});
        e.stability = {1e-6, 1234, 17, 20, "none"};
        shot.look.emitters.push_back({"emitter-1", true, test::translation({0, 0, 0.5f}), Rgb(2)});
        shot.quality = "draft";
        shot.seed = 77;
        shot.fix.meshUp = "z";
        shot.resources = {12.5, 345, 2};
        target = folder / "out.relamp";
    }
    void save(bool overwrite = false) { saveShot(shot, scene.mesh, target, overwrite); }
    Shot open(bool images = false) {
        Progress progress;
        return openShot(target, images, progress);
    }
    std::string openError() {
        try {
            open();
        } catch (const Error& error) { return error.what(); } catch (const std::exception& error) {
            return std::string("not an Error: ") + error.what();
        }
        return "";
    }
    json document() { return json::parse(test::TemporaryFolder::read(target / "shot.json")); }
    void putDocument(const json& j) { folder.write("out.relamp/shot.json", j.dump()); }

    test::TemporaryFolder folder;
    Scene scene;
    Shot shot;
    fs::path target;
};

Rgb energy(const std::vector<Rgb>& cells) {
    DVec3 sum(0);
    for (const Rgb& c : cells) sum += DVec3(c);
    return Rgb(sum / double(cells.size()));
}

TEST_F(ShotFile, SurvivesARoundTrip) {
    save();
    const Shot back = open(true);
    ASSERT_EQ(back.capture.views.size(), 1u);
    EXPECT_EQ(back.capture.views[0].image.at(3, 3), Rgb(0.5f));
    const Estimate &a = shot.estimate, &b = back.estimate;
    EXPECT_EQ(b.mode, a.mode);
    EXPECT_EQ(back.quality, "draft");
    EXPECT_EQ(std::pair(back.seed, back.fix.meshUp), std::pair(shot.seed, shot.fix.meshUp));
    EXPECT_EQ(back.resources.seconds, 12.5);
    ASSERT_EQ(b.emitters.emitters.size(), 1u);
    EXPECT_EQ(b.emitters.emitters[0].id, "emitter-1");
    EXPECT_EQ(b.emitters.emitters[0].vertices, a.emitters.emitters[0].vertices);
    EXPECT_EQ(b.emitters.emitters[0].triangles, a.emitters.emitters[0].triangles);
    EXPECT_EQ(b.emitters.emitterOfVertex, a.emitters.emitterOfVertex);
    EXPECT_EQ(b.emitters.emitterOfTriangle, a.emitters.emitterOfTriangle);
    EXPECT_EQ(b.emitters.emitters[0].centroid, a.emitters.emitters[0].centroid);
    EXPECT_EQ(b.emitters.emitters[0].area, a.emitters.emitters[0].area);
    EXPECT_EQ(b.lighting.emitterRadiance, a.lighting.emitterRadiance);
    EXPECT_EQ(b.emitterSigma, a.emitterSigma);
    EXPECT_EQ(b.identifiability, a.identifiability);
    EXPECT_EQ(b.reflectance.weight, a.reflectance.weight) << "to the last bit";
    EXPECT_EQ(b.reflectance.observed, a.reflectance.observed);
    EXPECT_EQ(b.reflectance.confidence, a.reflectance.confidence);
    ASSERT_EQ(b.reflectance.basis.lobes.size(), 2u);
    EXPECT_EQ(b.reflectance.basis.lobes[1].kind, Lobe::Kind::ggxDielectric);
    EXPECT_EQ(b.reflectance.basis.lobes[1].alpha, 0.1024f);
    ASSERT_EQ(b.timeline.size(), 1u);
    EXPECT_EQ(b.timeline[0].stage, "light");
    EXPECT_EQ(b.timeline[0].rmse, 0.125);
    ASSERT_EQ(b.leftOut.size(), 1u);
    EXPECT_EQ(b.leftOut[0].why, "direct light only");
    EXPECT_EQ(b.gauge.kind, "emitter");
    EXPECT_EQ(b.stability.effectiveRank, 17);
    EXPECT_EQ(lookToJson(back.look), lookToJson(shot.look));
}

TEST_F(ShotFile, KeepsHowCamerasAndMeshWereBroughtTogether) {
    const PoseFix pose{"images/0.exr", DVec3(0.001, -0.002, 0.0005), DVec3(0.01, 0, -0.003)};
    const RegistrationFix fix =
        shot.fix.registration = {{pose}, 0.0001f, std::vector<int>(25, -80), 0.0002f, std::vector<int>(25, 9)};
    Progress progress;
    Capture moved = loadCapture(shot.captureFolder, {}, progress);
    applyRegistration(fix, moved);
    save();
    const Shot back = open();
    EXPECT_TRUE(back.fix.registration == fix);
    EXPECT_EQ(back.capture.mesh.positions, moved.mesh.positions) << "to the last bit";
    EXPECT_EQ(back.capture.views[0].camera.worldFromCamera, moved.views[0].camera.worldFromCamera);
}

TEST_F(ShotFile, NamesTheMeasuredReflectanceItNeeds) {
    const auto coated = [](const Vec3& light, const Vec3& eye) {
        return Rgb(0.1f) + Rgb(0.3f) * ggx(light, eye, 0.1f);
    };
    folder.write("merl/paint.binary", test::merlBytes(coated));
    Reflectance& r = shot.estimate.reflectance;
    r.basis.lobes[1] = readMeasuredLobes(folder / "merl").at(0);
    r.basis.lobes.push_back({Lobe::Kind::ward, 0.2f, "ward"});
    r.weight.push_back(r.weight[1]);
    save();
    const auto same = [&](const Shot& opened) {
        const std::vector<Lobe>& lobes = opened.estimate.reflectance.basis.lobes;
        ASSERT_EQ(lobes.size(), 3u);
        EXPECT_EQ(lobes[1].kind, Lobe::Kind::measured);
        EXPECT_EQ(lobes[1].name, "paint");
        EXPECT_EQ(lobes[2].kind, Lobe::Kind::ward);
        const Vec3 light = glm::normalize(Vec3(0.3f, 0.1f, 1)), eye(0, 0, 1);
        EXPECT_EQ(evaluateLobe(lobes[1], light, eye), evaluateLobe(r.basis.lobes[1], light, eye));
    };
    same(open());
    // Away from its folder it says what it lacks; a copy in the shot's own folder does as well, and stays when the shot
    // is saved again.
    std::filesystem::create_directories(target / "merl");
    std::filesystem::rename(folder / "merl/paint.binary", folder / "paint");
    EXPECT_NE(openError().find("basis[1].file: "), std::string::npos);
    EXPECT_NE(openError().find("paint.binary is not there"), std::string::npos);
    std::filesystem::rename(folder / "paint", target / "merl/paint.binary");
    same(open());
    save(true);
    same(open());
}

TEST_F(ShotFile, KeepsTheEnergyOfTheEnvironmentSunIncluded) {
    // Width of the sun in cells of 0.8 degrees, and what may be lost of it.
    for (const auto& [width, bound] : {std::pair{0, 1e-3}, {1, 1e-3}, {4, 1e-3}}) {
        shot.estimate.environment.assign(256 * 256, Rgb(0.1f, 0.2f, 0.4f));
        for (int y = 100; y < 100 + width; ++y)
            for (int x = 30; x < 30 + width; ++x)
                shot.estimate.environment[size_t(y) * 256 + size_t(x)] = Rgb(90000, 70000, 50000);
        save(true);
        const Rgb before = energy(shot.estimate.environment),
                  after = (fs::remove_all(target / "cache"), energy(open().estimate.environment));
        for (int c = 0; c < 3; ++c) EXPECT_NEAR(after[c] / before[c], 1, bound) << "sun of " << width << " cells";
    }
}

TEST_F(ShotFile, IsThreeFilesInOpenFormatsAndACache) {
    save();
    size_t entries = 0;
    for ([[maybe_unused]] const auto& entry : fs::directory_iterator(target)) ++entries;
    EXPECT_EQ(entries, 4u);
    EXPECT_TRUE(fs::is_directory(target / "cache"));
    EXPECT_EQ(document()["version"], 2);
    EXPECT_EQ(document()["capture"], "../capture") << "relative, so that both can be moved";
    EXPECT_EQ(readImageSize(target / "environment.exr"), std::pair(1024, 512));
    std::set<std::string> names;
    for (const VertexProperty& p : readVertexPly(target / "reflectance.ply")) names.insert(p.name);
    for (const char* name :
         {"albedo_r", "albedo_g", "albedo_b", "weight_0_r", "weight_1_b", "observed", "emitter", "confidence"})
        EXPECT_TRUE(names.contains(name)) << name;
    EXPECT_EQ(readMesh(target / "reflectance.ply").positions, scene.mesh.positions)
        << "the capture's vertices in order";
}

TEST_F(ShotFile, InfoHasWhatIsPromised) {
    const json info = shotInfo(shot);
    for (const char* key :
         {"emitters", "environment", "gauge", "basis", "left_out", "timeline", "stability", "resources"})
        EXPECT_TRUE(info.contains(key)) << key;
    for (const char* key : {"id", "name", "centroid", "normal", "area_m2", "triangles", "radiance", "radiance_stddev",
                            "identifiability", "views_seen", "clipped_fraction"})
        EXPECT_TRUE(info["emitters"][0].contains(key)) << key;
    EXPECT_EQ(info["emitters"][0]["radiance"], (json{12, 11, 10}));
    EXPECT_EQ(info["environment"]["grid_side"], 256);
    EXPECT_TRUE(info["environment"].contains("leaves"));
}

/// A document of version 2 with the names that version 1 had.
json asVersion1(json document) {
    const auto rename = [](json& object, const char* now, const char* before) {
        if (!object.contains(now)) return;
        object[before] = object[now];
        object.erase(now);
    };
    for (json& e : document["emitters"]) {
        rename(e, "radiance", "power");
        rename(e, "radiance_stddev", "power_stddev");
        rename(e, "clipped_fraction", "clipped_share");
        rename(e, "unobserved", "unseen");
    }
    for (json& c : document["palette"]) rename(c, "fraction", "share");
    rename(document["environment"], "leaves", "kept_coefficients");
    rename(document["interreflection"], "fraction", "share");
    document["version"] = 1;
    return document;
}

TEST_F(ShotFile, OpensVersion1WithTheSameValues) {
    Estimate& e = shot.estimate;
    e.emitters.emitters[0].unobserved = true;
    e.emitters.emitters[0].evidence.clippedFraction = 0.25f;
    e.palette = {{Rgb(0.5f), 0.75f}};
    e.interreflection = true;
    e.bouncedFraction = 0.125f;
    save();
    const Shot now = open();
    putDocument(asVersion1(document()));
    EXPECT_EQ(document()["emitters"][0]["power"], (json{12, 11, 10}));
    const Shot before = open();
    for (const Shot* s : {&now, &before}) {
        const EmitterCluster& c = s->estimate.emitters.emitters.at(0);
        EXPECT_EQ(s->estimate.lighting.emitterRadiance.at(0), Rgb(12, 11, 10));
        EXPECT_EQ(s->estimate.emitterSigma, e.emitterSigma);
        EXPECT_TRUE(c.unobserved);
        EXPECT_EQ(c.evidence.clippedFraction, 0.25f);
        EXPECT_EQ(s->estimate.palette.at(0).fraction, 0.75f);
        EXPECT_EQ(s->estimate.bouncedFraction, 0.125f);
    }
    EXPECT_EQ(shotInfo(before), shotInfo(now));
    // Saved again, it is a document of version 2 with nothing of version 1 in it.
    save(true);
    EXPECT_EQ(document()["version"], 2);
    EXPECT_FALSE(document()["emitters"][0].contains("power"));
    EXPECT_FALSE(document()["environment"].contains("kept_coefficients"));
}

TEST_F(ShotFile, OpensVersion1AsItWasWritten) {
    save();
    putDocument(json::parse(R"({"version": 1, "capture": "../capture", "mode": "near-field", "quality": "draft",
        "emitters": [{"id": "emitter-1", "centroid": [0, 0, 1], "normal": [0, 0, -1], "area_m2": 0.25,
                      "power": [12, 11, 10], "power_stddev": [1, 2, 3], "views_seen": 4, "clipped_share": 0.5,
                      "unseen": true, "identifiability": 0.75}],
        "environment": {"kept_coefficients": 64, "grid_side": 256}, "interreflection": {"kept": true, "share": 0.25},
        "palette": [{"albedo": [0.5, 0.25, 0.125], "share": 0.5}],
        "basis": [{"kind": "lambert", "alpha": 1, "name": "lambert"}], "studio": {"job": 42}})"));
    const Shot old = open();
    const EmitterCluster& c = old.estimate.emitters.emitters.at(0);
    EXPECT_EQ(c.radiance, Rgb(12, 11, 10));
    EXPECT_EQ(old.estimate.emitterSigma.at(0), Rgb(1, 2, 3));
    EXPECT_EQ(c.evidence.viewsSeen, 4);
    EXPECT_EQ(c.evidence.clippedFraction, 0.5f);
    EXPECT_TRUE(c.unobserved);
    EXPECT_EQ(old.estimate.identifiability.at(0), 0.75f);
    EXPECT_EQ(old.estimate.bouncedFraction, 0.25f);
    EXPECT_EQ(old.estimate.palette.at(0).fraction, 0.5f);
    save(true);
    EXPECT_EQ(document()["studio"]["job"], 42) << "unknown keys of version 1 are kept";
}

TEST_F(ShotFile, MovesTogetherWithItsCapture) {
    save();
    fs::create_directories(folder / "elsewhere");
    fs::rename(folder / "capture", folder / "elsewhere/capture");
    fs::rename(target, folder / "elsewhere/out.relamp");
    target = folder / "elsewhere/out.relamp";
    EXPECT_EQ(open().capture.mesh.vertexCount(), scene.mesh.vertexCount());
}

TEST_F(ShotFile, KeepsTheLooksFilesRelative) {
    shot.look.environment.source = EnvironmentLook::Source::file;
    shot.look.environment.file = folder / "studio.exr";
    shot.look.added.push_back({EmitterShape::spot, "spot-1"});
    shot.look.added[0].shaping.iesFile = folder / "beam.ies";
    save();
    EXPECT_EQ(document()["look"]["environment"]["file"], "../studio.exr");
    EXPECT_EQ(document()["look"]["added_emitters"][0]["shaping"]["ies_file"], "../beam.ies");
    const Look back = open().look;
    EXPECT_EQ(fs::weakly_canonical(back.environment.file), fs::weakly_canonical(folder / "studio.exr"));
    EXPECT_EQ(fs::weakly_canonical(back.added.at(0).shaping.iesFile), fs::weakly_canonical(folder / "beam.ies"));
}

TEST_F(ShotFile, OpensTheSameWithADamagedCacheAndPrefersAPaintedEnvironment) {
    save();
    const Rgb whole = open().estimate.environment[100];
    folder.write("out.relamp/cache/environment_cells.exr", "not an image");
    EXPECT_NEAR(open().estimate.environment[100].x, whole.x, 0.05f * whole.x + 1e-4f);
    save(true);
    Image painted(1024, 512, Rgb(7));
    writeImage(target / "environment.exr", painted);
    fs::last_write_time(target / "environment.exr", fs::file_time_type::clock::now() + std::chrono::seconds(5));
    EXPECT_NEAR(open().estimate.environment[100].x, 7, 0.01f);
}

TEST_F(ShotFile, TakesAFolderNameWithASlashAtItsEnd) {
    target = (folder / "out.relamp").string() + "/";
    save();
    EXPECT_TRUE(fs::exists(folder / "out.relamp/shot.json"));
    save(true);
    EXPECT_EQ(folder.entries(), 2u) << "the capture and the shot";
}

TEST_F(ShotFile, RefusesToOverwriteUnlessToldAndKeepsUnknownKeysAndFiles) {
    save();
    EXPECT_EQ(test::messageOf([&] { save(); }), target.string() + ": exists already, add --overwrite to replace it");
    json j = document();
    j["studio"] = {{"job", 42}};
    putDocument(j);
    folder.write("out.relamp/notes.txt", "mine");
    folder.write("out.relamp/cache/old.bin", "x");
    shot.quality = "fine";
    save(true);
    EXPECT_EQ(document()["quality"], "fine");
    EXPECT_EQ(document()["studio"]["job"], 42);
    EXPECT_EQ(test::TemporaryFolder::read(target / "notes.txt"), "mine");
    EXPECT_FALSE(fs::exists(target / "cache/old.bin"));
    EXPECT_EQ(folder.entries(), 2u) << "nothing temporary is left beside it";
}

TEST_F(ShotFile, DoesNotOverwriteAFolderThatIsNoShot) {
    folder.write("out.relamp/thesis.tex", "ten years of work");
    EXPECT_NE(test::messageOf([&] { save(true); }).find("is not a shot"), std::string::npos);
    EXPECT_EQ(test::TemporaryFolder::read(target / "thesis.tex"), "ten years of work");
    fs::remove_all(target);
    folder.write("out.relamp", "a file");
    EXPECT_NE(test::messageOf([&] { save(true); }).find("is not a shot"), std::string::npos);
}

TEST_F(ShotFile, LeavesTheOldShotUntouchedWhenTheNewOneCannotBeWritten) {
    save();
    const std::string before = test::TemporaryFolder::read(target / "shot.json");
    shot.quality = "fine";
    // As on a full disk: no file may grow beyond 4 KiB.
    struct rlimit old {};
    getrlimit(RLIMIT_FSIZE, &old);
    const auto handler = signal(SIGXFSZ, SIG_IGN);
    struct rlimit small = old;
    small.rlim_cur = 4096;
    setrlimit(RLIMIT_FSIZE, &small);
    const std::string message = test::messageOf([&] { save(true); });
    setrlimit(RLIMIT_FSIZE, &old);
    signal(SIGXFSZ, handler);
    EXPECT_NE(message, "");
    EXPECT_EQ(test::TemporaryFolder::read(target / "shot.json"), before);
    EXPECT_EQ(folder.entries(), 2u) << "nothing temporary is left";
    EXPECT_EQ(open().quality, "draft");
}

TEST_F(ShotFile, NamesAParentThatCannotHoldIt) {
    folder.write("file", "");
    target = folder / "file/out.relamp";
    EXPECT_EQ(test::messageOf([&] { save(); }).substr(0, target.string().size()), target.string());
    if (::geteuid() == 0) return;  // root may write anywhere
    fs::create_directories(folder / "locked");
    fs::permissions(folder / "locked", fs::perms::owner_read | fs::perms::owner_exec);
    target = folder / "locked/out.relamp";
    EXPECT_EQ(test::messageOf([&] { save(); }).substr(0, target.string().size()), target.string());
    fs::permissions(folder / "locked", fs::perms::owner_all);
}

TEST_F(ShotFile, NamesTheFieldOfShotJsonThatIsBad) {
    save();
    const json good = document();
    const struct {
        const char* pointer;
        const char* value;  ///< empty: the field is taken away
        const char* message;
    } cases[] = {
        {"/version", "", "version: is missing"},
        {"/version", "4", "version: is 4, expected 1 to 3"},
        {"/version", "\"1\"", "version: expected a number"},
        {"/capture", "", "capture: is missing"},
        {"/capture", "5", "capture: expected a text"},
        {"/capture", "\"../nowhere\"", "capture: "},
        {"/mode", "1", "mode: expected a text"},
        {"/quality", "[]", "quality: expected a text"},
        {"/seed", "-1", "seed: is -1"},
        {"/seed", "\"a\"", "seed: expected a number"},
        {"/emitters", "", "emitters: is missing"},
        {"/emitters", "{}", "emitters: expected a list"},
        {"/emitters/0", "5", "emitters[0]: expected an object"},
        {"/emitters/0/id", "5", "emitters[0].id: expected a text"},
        {"/emitters/0/radiance", "", "emitters[0].radiance: is missing"},
        {"/emitters/0/radiance", "[1, 2]", "emitters[0].radiance: expected three numbers"},
        {"/emitters/0/radiance", "[1, -2, 3]", "emitters[0].radiance[1]: is -2"},
        {"/emitters/0/radiance", "[1, 1e300, 3]", "emitters[0].radiance[1]: is 1e+300, which is too large"},
        {"/emitters/0/centroid", "\"here\"", "emitters[0].centroid: expected three numbers"},
        {"/emitters/0/normal", "[null, 1, 2]", "emitters[0].normal: expected three numbers"},
        {"/emitters/0/area_m2", "[]", "emitters[0].area_m2: expected a number"},
        {"/emitters/0/two_sided", "1", "emitters[0].two_sided: expected true or false"},
        {"/emitters/0/views_seen", "\"all\"", "emitters[0].views_seen: expected a number"},
        {"/emitters/0/radiance_stddev", "3", "emitters[0].radiance_stddev: expected three numbers"},
        {"/emitters/0/identifiability", "\"x\"", "emitters[0].identifiability: expected a number"},
        {"/basis", "", "basis: is missing"},
        {"/basis", "[]", "basis: expected lambert first"},
        {"/basis/0", "[]", "basis[0]: expected an object"},
        {"/basis/1/kind", "\"velvet\"", "basis[1].kind: is velvet"},
        {"/basis/1/alpha", "0", "basis[1].alpha: is 0"},
        {"/basis/1/alpha", "\"wide\"", "basis[1].alpha: expected a number"},
        {"/capture_fix/mesh_up", "\"w\"", "capture_fix.mesh_up: expected \"x\""},
        {"/capture_fix/registration", "1", "capture_fix.registration: expected an object"},
        {"/capture_fix/registration", R"({"displacements": [20000]})",
         "capture_fix.registration.displacements: expected -10000 to 10000"},
        {"/capture_fix/registration", R"({"outline_displacements": [-10001]})",
         "capture_fix.registration.outline_displacements: expected -10000 to 10000"},
        {"/capture_fix/registration", R"({"poses": [{"view": "a"}]})",
         "capture_fix.registration.poses[0].turn: is missing"},
        {"/capture_fix/registration", R"({"poses": [{"view": "a", "turn": [0, 2, 0], "shift": [0, 0, 0]}]})",
         "capture_fix.registration.poses[0].turn: pose of a"},
        {"/look", "7", "look: expected an object"},
        {"/look/environment/tint", "0", "look: environment.tint: expected three numbers"},
        {"/timeline", "3", "timeline: expected a list"},
        {"/timeline/0/seconds", "\"x\"", "timeline[0].seconds: expected a number"},
        {"/timeline/0/iteration", "1e12", "timeline[0].iteration: is 1e+12"},
        {"/left_out", "\"x\"", "left_out: expected a list"},
        {"/left_out/0/what", "1", "left_out[0].what: expected a text"},
        {"/gauge", "[]", "gauge: expected an object"},
        {"/gauge/kind", "1", "gauge.kind: expected a text"},
        {"/stability/kkt_residual", "\"x\"", "stability.kkt_residual: expected a number"},
        {"/resources/threads", "\"x\"", "resources.threads: expected a number"},
        {"/stopped_early", "1", "stopped_early: expected true or false"},
    };
    for (const auto& c : cases) {
        json j = good;
        j.erase("capture_absolute");
        const json::json_pointer pointer(c.pointer);
        if (*c.value) j[pointer] = json::parse(c.value);
        else j[pointer.parent_pointer()].erase(pointer.back());
        putDocument(j);
        const std::string expected = (target / "shot.json").string() + ": " + c.message;
        EXPECT_EQ(openError().substr(0, expected.size()), expected) << c.pointer << " = " << c.value;
    }
    putDocument(good);
    EXPECT_EQ(openError(), "");
}

TEST_F(ShotFile, NamesTheFileThatIsMissingOrBroken) {
    save();
    folder.write("out.relamp/shot.json", "{\"version\": 1");
    EXPECT_NE(openError().find((target / "shot.json").string() + ": is not valid JSON (parse error at line "),
              std::string::npos);
    fs::remove(target / "shot.json");
    EXPECT_NE(openError().find("there is no shot.json"), std::string::npos);
    fs::remove_all(target);
    save();
    for (const char* name : {"environment.exr", "reflectance.ply"}) {
        const std::string bytes = test::TemporaryFolder::read(target / name);
        fs::remove(target / name);
        EXPECT_NE(openError().find(name), std::string::npos) << openError();
        folder.write(std::string("out.relamp/") + name, bytes.substr(0, bytes.size() / 2));
        EXPECT_NE(openError().find(name), std::string::npos);
        folder.write(std::string("out.relamp/") + name, "");
        EXPECT_NE(openError().find(name), std::string::npos) << openError();
        folder.write(std::string("out.relamp/") + name, bytes);
        EXPECT_EQ(openError(), "");
    }
}

TEST_F(ShotFile, NamesAPropertyThatDoesNotFitTheMesh) {
    save();
    std::vector<VertexProperty> properties = readVertexPly(target / "reflectance.ply");
    Mesh smaller = test::sheet({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, 2, 2);
    std::vector<VertexProperty> fewer = properties;
    for (VertexProperty& p : fewer) p.values.resize(smaller.vertexCount());
    writeVertexPly(target / "reflectance.ply", smaller, fewer);
    EXPECT_NE(openError().find("9 values, the mesh has 34 vertices"), std::string::npos) << openError();

    std::vector<VertexProperty> without;
    for (const VertexProperty& p : properties)
        if (p.name != "weight_1_g") without.push_back(p);
    writeVertexPly(target / "reflectance.ply", scene.mesh, without);
    EXPECT_NE(openError().find("property weight_1_g is missing"), std::string::npos) << openError();

    for (VertexProperty& p : properties)
        if (p.name == "confidence") p.values[3] = std::nanf("");
    writeVertexPly(target / "reflectance.ply", scene.mesh, properties);
    EXPECT_NE(openError().find("confidence of vertex 3"), std::string::npos) << openError();
}

}  // namespace
}  // namespace relamp
