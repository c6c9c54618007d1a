// Formats in JSON: Meshroom, OpenMVG, Polycam, Record3D, 3D Scanner App.
#include <glm/gtc/quaternion.hpp>
#include <nlohmann/json.hpp>

#include "capture/formats/foreign_shots.h"

namespace relamp {
namespace {

using nlohmann::json;
using test::ForeignLens;
using test::ForeignShot;

const ForeignLens brown{1234.5, 1234.5, 803.25, 596.5, -0.11, 0.06, -0.013, 0, 0.0011, -0.0007};
const ForeignLens radial{1234.5, 1234.5, 803.25, 596.5, -0.11, 0.06, -0.013};

/// Every number of a list as a text, as boost writes them.
json texts(const std::vector<double>& numbers) {
    json list = json::array();
    for (const double x : numbers) list.push_back(fmt::format("{:.17g}", x));
    return list;
}

/// Rows of camera-from-world.
std::vector<DVec3> rowsOf(const ForeignShot& s) { return {s.right, s.down, s.ahead}; }

/// worldFromCamera in OpenGL's axes, row-major, 3 x 4.
std::vector<double> openGlRows(const ForeignShot& s) {
    std::vector<double> n;
    for (int r = 0; r < 3; ++r)
        for (const double x : {s.right[r], -s.down[r], -s.ahead[r], s.position[r]}) n.push_back(x);
    return n;
}

/// The shots' world with Y up instead of Z.
std::vector<ForeignShot> withYUp(std::vector<ForeignShot> shots) {
    for (ForeignShot& s : shots)
        for (DVec3* v : {&s.right, &s.down, &s.ahead, &s.position}) *v = DVec3(v->x, v->z, -v->y);
    return shots;
}

class Meshroom : public test::ForeignCapture {
protected:
    json document(const std::vector<int>& version, const ForeignLens& lens, const std::string& kind) const {
        json root{{"version", json::array()}, {"views", json::array()}, {"poses", json::array()}};
        for (const int v : version) root["version"].push_back(std::to_string(v));
        const int patch = version[1] == 2 ? version[2] : -1;
        json i{{"intrinsicId", "17"}, {"width", "1600"}, {"height", "1200"}, {"type", kind}};
        // Pixels count from the first one's centre; from 1.2.1 on the principal point counts from the middle.
        i["principalPoint"] =
            patch >= 1 ? texts({lens.cx - 0.5 - 800, lens.cy - 0.5 - 600}) : texts({lens.cx - 0.5, lens.cy - 0.5});
        if (patch < 0) i["pxFocalLength"] = fmt::format("{:.17g}", lens.f);
        else if (patch < 2) i["pxFocalLength"] = texts({lens.f, lens.fy});
        else {
            i["sensorWidth"] = "30";
            const double x = lens.f * 30 / 1600, y = lens.fy * 30 / 1600;
            i["focalLength"] = fmt::format("{:.17g}", patch < 11 ? x : y);
            i["pixelRatio"] = fmt::format("{:.17g}", patch < 5 ? x / y : y / x);
        }
        if (patch >= 8) i["type"] = "pinhole", i["distortionType"] = kind, i["undistortionType"] = "none";
        std::vector<double> k;
        if (kind.starts_with("radial")) k = {lens.k1, lens.k2, lens.k3};
        if (kind == "brown") k = {lens.k1, lens.k2, lens.k3, lens.p1, lens.p2};
        if (kind == "fisheye" || kind == "fisheye4") k = {0, 0, 0, 0};
        i["distortionParams"] = k.empty() ? json("") : texts(k);
        root["intrinsics"] = json::array({i});
        for (size_t n = 0; n < shots.size(); ++n) {
            const std::string id = std::to_string(900 - n);
            root["views"].push_back({{"viewId", id},
                                     {"poseId", id},
                                     {"intrinsicId", "17"},
                                     {"path", "/home/somebody/photographs/" + shots[n].name},
                                     {"metadata", {{"Make", "a camera"}}}});
            // Column by column, camera-from-world.
            std::vector<double> columns;
            for (int c = 0; c < 3; ++c)
                for (const DVec3& row : rowsOf(shots[n])) columns.push_back(row[c]);
            const DVec3 p = shots[n].position;
            root["poses"].push_back(
                {{"poseId", id},
                 {"pose", {{"transform", {{"rotation", texts(columns)}, {"center", texts({p.x, p.y, p.z})}}}}}});
        }
        return root;
    }
    void write(const json& root) const { folder.write("cameras.sfm", root.dump(1)); }
};

TEST_F(Meshroom, EveryVersionGivesTheSamePixels) {
    const glm::dmat3 same(1.0), turned(1, 0, 0, 0, -1, 0, 0, 0, -1);
    ForeignLens wide = brown;  // a pixel that is not square
    wide.f = 1251;
    const struct {
        std::vector<int> version;
        ForeignLens lens;
        glm::dmat3 turn;
    } files[] = {{{1, 0, 0}, brown, same},  {{1, 2, 0}, wide, same},   {{1, 2, 1}, wide, same},
                 {{1, 2, 2}, wide, same},   {{1, 2, 3}, wide, turned}, {{1, 2, 5}, wide, turned},
                 {{1, 2, 11}, wide, turned}};
    for (const auto& file : files) {
        write(document(file.version, file.lens, "brown"));
        const CaptureSource source = read();
        EXPECT_LT(worstPixel(source, file.lens, file.turn), 1e-6) << file.version[2];
        EXPECT_EQ(source.frames[4].name, "img_4.png") << "paths of another machine are shown by their last part";
        EXPECT_EQ(holds(source.notes, "turned by 180 degrees about x"), file.turn != same);
    }
}

TEST_F(Meshroom, LensesAreThoseOfItsNames) {
    write(document({1, 1, 0}, radial, "radial3"));
    EXPECT_LT(worstPixel(read(), radial), 1e-6);
    write(document({1, 2, 8}, radial, "radialk3"));
    EXPECT_LT(worstPixel(read(), radial, glm::dmat3(1, 0, 0, 0, -1, 0, 0, 0, -1)), 1e-6);
    write(document({1, 0, 0}, {}, "pinhole"));
    EXPECT_LT(worstPixel(read(), {}), 1e-6);
    write(document({1, 0, 0}, {}, "fisheye4"));
    EXPECT_EQ(read().frames[0].camera.model, LensModel::openCvFisheye);
    for (const char* kind : {"3deanamorphic4", "radialk3pt"}) {
        write(document({1, 2, 8}, {}, kind));
        EXPECT_EQ(error().find(fmt::format("cameras.sfm: intrinsics[0].type: the distortion is \"{}\"", kind)), 0u)
            << error();
    }
}

TEST_F(Meshroom, ViewsWithoutAPoseAndRigsAreLeftOut) {
    json root = document({1, 0, 0}, brown, "brown");
    root["views"].push_back({{"viewId", "1"}, {"poseId", "1"}, {"intrinsicId", "17"}, {"path", "lost.png"}});
    root["views"].push_back({{"viewId", "2"}, {"poseId", "2"}, {"rigId", "5"}, {"path", "rig.png"}});
    write(root);
    const CaptureSource source = read();
    EXPECT_LT(worstPixel(source, brown), 1e-6);
    EXPECT_TRUE(holds(source.notes, "1 of 7 cameras have no pose"));
    EXPECT_TRUE(holds(source.notes, "1 of 7 cameras belong to a rig"));
}

TEST_F(Meshroom, PhotographsOfOneNameInTwoFoldersAreToldApart) {
    json root = document({1, 0, 0}, brown, "brown");
    for (const char* side : {"left", "right"}) {
        std::filesystem::create_directories(folder / (std::string("images/") + side));
        std::filesystem::copy_file(folder / "images/img_0.png", folder / (std::string("images/") + side + "/a.png"));
    }
    root["views"][0]["path"] = "right\\a.png";
    root["views"][1]["path"] = "left\\a.png";
    write(root);
    const CaptureSource source = read();
    ASSERT_EQ(source.frames.size(), 5u);
    EXPECT_EQ(source.frames[3].name, "left\\a.png");
    EXPECT_EQ(source.frames[3].file, folder / "images/left/a.png");
    EXPECT_EQ(source.frames[4].file, folder / "images/right/a.png");
}

TEST_F(Meshroom, BadFieldsAreNamed) {
    const json good = document({1, 2, 11}, brown, "brown");
    const auto with = [&](const char* pointer, const json& value) {
        json root = good;
        root[json::json_pointer(pointer)] = value;
        write(root);
        return error();
    };
    EXPECT_EQ(with("/intrinsics/0/focalLength", "nan"),
              "cameras.sfm: intrinsics[0].focalLength is \"nan\", expected a finite number");
    EXPECT_EQ(with("/intrinsics/0/sensorWidth", 0),
              "cameras.sfm: intrinsics[0].sensorWidth is 0, expected more than 0");
    EXPECT_EQ(with("/intrinsics/0/width", -4),
              "cameras.sfm: intrinsics[0].width: width is -4, expected a whole number from 1 to 131072");
    EXPECT_EQ(with("/intrinsics/0/distortionParams", {1, 2}),
              "cameras.sfm: intrinsics[0].distortionParams holds 2 numbers, expected 5 for brown");
    EXPECT_EQ(with("/intrinsics/0/type", "equidistant"),
              "cameras.sfm: intrinsics[0].type is \"equidistant\", expected \"pinhole\"");
    EXPECT_EQ(with("/poses/0/pose/transform/rotation/4", "9"),
              "cameras.sfm: poses[0].pose.transform.rotation is not rigid, expected a rotation and a translation");
    EXPECT_EQ(with("/poses/0/pose/transform/center", {1, 2}),
              "cameras.sfm: poses[0].pose.transform.center is no list of 3 numbers");
    EXPECT_EQ(with("/views/0/intrinsicId", "3"),
              "cameras.sfm: views[0].intrinsicId is 3, which is not among the intrinsics");
    EXPECT_EQ(with("/views/0/path", 3), "cameras.sfm: views[0].path: expected a text");
    EXPECT_EQ(with("/version", {1, 2}), "cameras.sfm: version is no list of 3 numbers");
    EXPECT_EQ(with("/views", json::array()), "cameras.sfm: holds no camera with a pose");
    folder.write("cameras.sfm", "{\"version\": [\"1\"], \"views\": " + std::string(200'000, '['));
    EXPECT_EQ(error(), "cameras.sfm: is nested deeper than 32 levels");
    folder.write("cameras.sfm", "{\"other\": 3}");
    EXPECT_FALSE(findCapture(folder.path()));
}

class OpenMvg : public test::ForeignCapture {
protected:
    json document(const ForeignLens& lens, const char* coefficients) const {
        json data{{"width", 1600},
                  {"height", 1200},
                  {"focal_length", lens.f},
                  {"principal_point", {lens.cx - 0.5, lens.cy - 0.5}}};
        const std::string kind = coefficients;
        if (kind == "disto_k1") data[kind] = {lens.k1};
        if (kind == "disto_k3") data[kind] = {lens.k1, lens.k2, lens.k3};
        if (kind == "disto_t2") data[kind] = {lens.k1, lens.k2, lens.k3, lens.p1, lens.p2};
        if (kind == "fisheye") data[kind] = {0.1, 0.2, 0.3, 0.4};
        json root{{"sfm_data_version", "0.3"}, {"root_path", "/somewhere/else"}};
        root["intrinsics"] = {{{"key", 3},
                               {"value",
                                {{"polymorphic_id", 2147483649u},
                                 {"polymorphic_name", "pinhole"},
                                 {"ptr_wrapper", {{"id", 2147483660u}, {"data", data}}}}}}};
        for (size_t n = 0; n < shots.size(); ++n) {
            json view{{"local_path", "/"}, {"filename", shots[n].name}, {"id_view", n},
                      {"id_intrinsic", 3}, {"id_pose", n + 20},         {"width", 1600}};
            root["views"].push_back({{"key", n}, {"value", {{"ptr_wrapper", {{"data", view}}}}}});
            json rows = json::array();
            for (const DVec3& row : rowsOf(shots[n])) rows.push_back({row.x, row.y, row.z});
            const DVec3 p = shots[n].position;
            root["extrinsics"].push_back(
                {{"key", n + 20}, {"value", {{"rotation", rows}, {"center", {p.x, p.y, p.z}}}}});
        }
        return root;
    }
    void write(const json& root) const { folder.write("sfm_data.json", root.dump(1)); }
};

TEST_F(OpenMvg, EveryLensGivesItsPixels) {
    const ForeignLens one{1234.5, 1234.5, 803.25, 596.5, -0.11};
    for (const auto& [lens, name] : {std::pair{ForeignLens(), "none"}, std::pair{one, "disto_k1"},
                                     std::pair{radial, "disto_k3"}, std::pair{brown, "disto_t2"}}) {
        write(document(lens, name));
        EXPECT_LT(worstPixel(read(), lens), 1e-6) << name;
    }
    write(document({}, "fisheye"));
    EXPECT_EQ(read().frames[0].camera.model, LensModel::openCvFisheye);
    EXPECT_EQ(read().frames[0].camera.distortion[3], 0.4);
}

TEST_F(OpenMvg, BadFieldsAreNamed) {
    const json good = document(brown, "disto_t2");
    const auto with = [&](const char* pointer, const json& value) {
        json root = good;
        root[json::json_pointer(pointer)] = value;
        write(root);
        return error();
    };
    const std::string data = "intrinsics[0].value.ptr_wrapper.data";
    EXPECT_EQ(with("/intrinsics/0/value/ptr_wrapper/data/disto_t2", {1}),
              "sfm_data.json: " + data + ".disto_t2 is no list of 5 numbers");
    EXPECT_EQ(with("/intrinsics/0/value/ptr_wrapper/data/focal_length", nullptr).find("sfm_data.json: " + data), 0u);
    EXPECT_NE(error().find("no spherical ones"), std::string::npos);
    EXPECT_EQ(with("/extrinsics/0/value/rotation/1", {0, 0, 0}),
              "sfm_data.json: extrinsics[0].value.rotation is singular, expected a rotation and a translation");
    EXPECT_EQ(with("/extrinsics/0/value/center", "here"),
              "sfm_data.json: extrinsics[0].value.center is no list of 3 numbers");
    EXPECT_EQ(with("/views/0/value/ptr_wrapper/data/filename", 4),
              "sfm_data.json: views[0].value.ptr_wrapper.data.filename: expected a text");
    EXPECT_EQ(with("/views/0/value", 4), "sfm_data.json: views[0].value: expected an object");
    json lost = good;
    lost["extrinsics"].erase(0);
    write(lost);
    EXPECT_TRUE(holds(read().notes, "1 of 5 cameras have no pose"));
}

class PhoneScan : public test::ForeignCapture {
protected:
    void SetUp() override {
        ForeignCapture::SetUp();
        shots = withYUp(shots);
    }
    const ForeignLens phone{1234.5, 1230, 803.25, 596.5};
};

TEST_F(PhoneScan, PolycamKeyframesMeetTheMeshThatTheyWereAlignedTo) {
    const auto write = [&](const std::string& of) {
        std::filesystem::create_directories(folder / ("keyframes/" + of + "images"));
        for (const ForeignShot& s : shots) {
            std::filesystem::copy_file(folder / ("images/" + s.name),
                                       folder / ("keyframes/" + of + "images/" + s.name));
            json frame{{"fx", phone.f}, {"fy", phone.fy}, {"cx", phone.cx},    {"cy", phone.cy},
                       {"width", 1600}, {"height", 1200}, {"blur_score", 70.5}};
            const auto rows = openGlRows(s);
            for (size_t i = 0; i < 12; ++i) frame[fmt::format("t_{}{}", i / 4, i % 4)] = rows[i];
            folder.write("keyframes/" + of + "cameras/" + std::filesystem::path(s.name).stem().string() + ".json",
                         frame.dump());
        }
    };
    write("corrected_");
    CaptureSource source = read();
    EXPECT_LT(worstPixel(source, phone), 1e-6);
    EXPECT_EQ(source.up, Vec3(0, 1, 0));
    EXPECT_EQ(source.frames[0].file.parent_path().filename(), "corrected_images");
    EXPECT_FALSE(holds(source.notes, "does not say what is up"));
    // Column-major: a turn about y and a step.
    folder.write("mesh_info.json",
                 json{{"alignmentTransform", {0, 0, -1, 0, 0, 1, 0, 0, 1, 0, 0, 0, 5, 6, 7, 1}}}.dump());
    source = read();
    const glm::dmat3 turn(0, 0, -1, 0, 1, 0, 1, 0, 0);
    const DVec3 moved = source.frames[2].camera.position() - (turn * shots[2].position + DVec3(5, 6, 7));
    EXPECT_LT(glm::length(moved), 1e-9);
    for (FrameSource& f : source.frames) f.camera.worldFromCamera[3] -= glm::dvec4(5, 6, 7, 0);
    EXPECT_LT(worstPixel(source, phone, turn), 1e-6);
    EXPECT_TRUE(holds(source.notes, "alignmentTransform"));
    folder.write("mesh_info.json",
                 json{{"alignmentTransform", {0, 0, 0, 0, 0, 1, 0, 0, 1, 0, 0, 0, 5, 6, 7, 1}}}.dump());
    EXPECT_EQ(error(),
              "corrected_cameras: mesh_info.json: alignmentTransform is singular, expected a rotation and a "
              "translation");
    folder.write("keyframes/corrected_cameras/img_1.json", "{\"t_00\": 1, \"width\": 1600, \"height\": 1200}");
    EXPECT_EQ(error(), "corrected_cameras: img_1.json: fx: is missing");
}

TEST_F(PhoneScan, Record3dHasQuaternionsAndIntrinsicsByColumns) {
    json root{{"w", 1600}, {"h", 1200}, {"fps", 60}, {"dw", 192}, {"poses", json::array()}};
    root["K"] = {phone.f, 0, 0, 0, phone.fy, 0, phone.cx, phone.cy, 1};
    std::filesystem::create_directories(folder / "rgb");
    for (size_t i = 0; i < shots.size(); ++i) {
        const ForeignShot& s = shots[i];
        const std::string name = fmt::format("{}.png", i);
        std::filesystem::copy_file(folder / ("images/" + s.name), folder / ("rgb/" + name));
        // The quaternion of a rotation, by its trace.
        const glm::dmat3 m(s.right, -s.down, -s.ahead);
        const glm::dquat q = glm::quat_cast(m);
        root["poses"].push_back({q.x, q.y, q.z, q.w, s.position.x, s.position.y, s.position.z});
        shots[i].name = name;
    }
    folder.write("metadata.json", root.dump());
    EXPECT_LT(worstPixel(read(), phone), 1e-6);
    EXPECT_EQ(read().up, Vec3(0, 1, 0));
    root["perFrameIntrinsicCoeffs"] = json::array();
    for (size_t i = 0; i < shots.size(); ++i)
        root["perFrameIntrinsicCoeffs"].push_back({phone.f + 1, phone.fy + 1, phone.cx, phone.cy});
    folder.write("metadata.json", root.dump());
    ForeignLens other = phone;
    other.f += 1, other.fy += 1;
    EXPECT_LT(worstPixel(read(), other), 1e-6);
    root["poses"][3] = {0, 0, 0, 0, 1, 2, 3};
    folder.write("metadata.json", root.dump());
    EXPECT_EQ(error(), "metadata.json: poses[3]: qx qy qz qw is 0 0 0 0, expected a rotation");
    root["poses"] = 4;
    folder.write("metadata.json", root.dump());
    EXPECT_EQ(error(), "metadata.json: poses is a number, expected a list");
}

TEST_F(PhoneScan, ScannerAppFramesWithoutAPhotographAreLeftOut) {
    for (size_t i = 0; i < shots.size() + 2; ++i) {
        const std::string name = fmt::format("frame_{:05}", i);
        auto rows = openGlRows(shots[i % shots.size()]);
        for (const double x : {0, 0, 0, 1}) rows.push_back(x);
        folder.write(name + ".json", json{{"cameraPoseARFrame", rows},
                                          {"intrinsics", {phone.f, 0, phone.cx, 0, phone.fy, phone.cy, 0, 0, 1}}}
                                         .dump());
        if (i >= shots.size()) continue;
        writeImage(folder / (name + ".jpg"), Image(test::foreignWidth, test::foreignHeight, Rgb(0.5f)));
        shots[i].name = name + ".jpg";
    }
    const CaptureSource source = read();
    EXPECT_LT(worstPixel(source, phone), 1e-6);
    EXPECT_TRUE(holds(source.notes, "2 of 7 cameras have no photograph"));
    folder.write("frame_00001.json", json{{"cameraPoseARFrame", {1, 2}}, {"intrinsics", 3}}.dump());
    EXPECT_EQ(error(), "frame_00000.json: frame_00001.json: intrinsics is no list of 9 numbers");
}

}  // namespace
}  // namespace relamp
