#include "capture/transforms_json.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "base/error.h"
#include "capture/load_capture.h"
#include "support/temporary_folder.h"

namespace relamp {
namespace {

using nlohmann::json;
using testing::Test;

json goodFile() {
    const json matrix = {{1, 0, 0, 0.5}, {0, 1, 0, 0}, {0, 0, 1, 2}, {0, 0, 0, 1}};
    return {{"camera_model", "OPENCV"},
            {"w", 64},
            {"h", 48},
            {"fl_x", 50.0},
            {"fl_y", 51.0},
            {"cx", 32.0},
            {"cy", 24.0},
            {"k1", 0.1},
            {"k2", 0.2},
            {"p1", 0.3},
            {"p2", 0.4},
            {"mesh_path", "mesh.ply"},
            {"frames",
             {{{"file_path", "a.exr"}, {"transform_matrix", matrix}},
              {{"file_path", "b.exr"}, {"transform_matrix", matrix}}}}};
}

Transforms parse(const json& file) {
    return parseTransforms(file.dump(), [](const std::string&) { return std::pair(640, 480); });
}
std::string errorOf(const json& file) {
    return test::messageOf([&] { parse(file); });
}

TEST(TransformsJson, ReadsCamerasInOrder) {
    const Transforms t = parse(goodFile());
    ASSERT_EQ(t.frames.size(), 2u);
    const Camera& c = t.frames[1].camera;
    EXPECT_EQ(t.frames[1].filePath, "b.exr");
    EXPECT_EQ(c.model, LensModel::openCv);
    EXPECT_EQ(c.width, 64);
    EXPECT_EQ(c.height, 48);
    EXPECT_EQ(c.focalX, 50);
    EXPECT_EQ(c.focalY, 51);
    EXPECT_EQ(c.centreX, 32);
    EXPECT_EQ(c.centreY, 24);
    EXPECT_EQ(c.distortion, (std::array<double, 8>{0.1, 0.2, 0.3, 0.4, 0, 0, 0, 0}));
    EXPECT_EQ(c.position(), DVec3(0.5, 0, 2));
    EXPECT_EQ(t.meshPath, "mesh.ply");
    EXPECT_EQ(t.up, Vec3(0, 0, 1));
    EXPECT_TRUE(t.notes.empty());
}

TEST(TransformsJson, FrameKeysOverrideTheGlobalOnes) {
    json file = goodFile();
    file["frames"][1]["fl_x"] = 99;
    file["frames"][1]["camera_model"] = "PINHOLE";
    const Transforms t = parse(file);
    EXPECT_EQ(t.frames[0].camera.focalX, 50);
    EXPECT_EQ(t.frames[1].camera.focalX, 99);
    EXPECT_EQ(t.frames[1].camera.model, LensModel::pinhole);
    ASSERT_FALSE(t.notes.empty());
    EXPECT_NE(t.notes[0].find("is ignored because PINHOLE"), std::string::npos);
}

TEST(TransformsJson, FieldOfViewStandsInForTheFocalLength) {
    json file = goodFile();
    for (const char* key : {"fl_x", "fl_y", "cx", "cy"}) file.erase(key);
    file["camera_angle_x"] = piD / 2;
    const Camera c = parse(file).frames[0].camera;
    EXPECT_NEAR(c.focalX, 32, 1e-9);
    EXPECT_NEAR(c.focalY, 32, 1e-9);
    EXPECT_EQ(c.centreX, 32);
    EXPECT_EQ(c.centreY, 24);
}

TEST(TransformsJson, MissingSizesAreTakenFromTheImage) {
    json file = goodFile();
    file.erase("w");
    file.erase("h");
    const Camera c = parse(file).frames[0].camera;
    EXPECT_EQ(c.width, 640);
    EXPECT_EQ(c.height, 480);
}

TEST(TransformsJson, HigherCoefficientsMakeOpenCvTheFullModel) {
    json file = goodFile();
    file["k3"] = 0.5;
    file["k6"] = 0.8;
    const Camera c = parse(file).frames[0].camera;
    EXPECT_EQ(c.model, LensModel::fullOpenCv);
    EXPECT_EQ(c.distortion, (std::array<double, 8>{0.1, 0.2, 0.3, 0.4, 0.5, 0, 0, 0.8}));
}

TEST(TransformsJson, FisheyeTakesFourRadialCoefficients) {
    json file = goodFile();
    file["camera_model"] = "OPENCV_FISHEYE";
    file["k3"] = 0.5, file["k4"] = 0.6, file["p1"] = 0, file["p2"] = 0;
    const Camera c = parse(file).frames[0].camera;
    EXPECT_EQ(c.distortion, (std::array<double, 8>{0.1, 0.2, 0.5, 0.6, 0, 0, 0, 0}));
}

TEST(TransformsJson, NamesTheFrameAndTheFieldWhenAFocalLengthIsZero) {
    json file = goodFile();
    file["frames"][1]["fl_x"] = 0;
    EXPECT_EQ(errorOf(file), "frame 1: fl_x is 0, expected more than 0");
    test::TemporaryFolder folder;
    const auto path = folder.write("transforms.json", file.dump());
    EXPECT_EQ(test::messageOf([&] { readTransforms(path, {}); }),
              "transforms.json: frame 1: fl_x is 0, expected more than 0");
}

TEST(TransformsJson, EachNumberBrokenInTurnIsNamed) {
    for (const char* key : {"w", "h", "fl_x", "fl_y", "cx", "cy", "k1", "k2", "p1", "p2"}) {
        json file = goodFile();
        file[key] = "twelve";
        EXPECT_EQ(errorOf(file), std::string(key) + " is text, expected a number");
        file[key] = json::array();
        EXPECT_EQ(errorOf(file), std::string(key) + " is a list, expected a number");
        file[key] = true;
        EXPECT_NE(errorOf(file).find(std::string(key) + " is true or false"), std::string::npos);
    }
    for (const char* key : {"w", "h", "fl_x", "fl_y"}) {
        json file = goodFile();
        file[key] = -3;
        EXPECT_EQ(errorOf(file), std::string(key) + " is -3, expected more than 0");
    }
    json file = goodFile();
    file["w"] = 64.5;
    EXPECT_NE(errorOf(file).find("w is 64.5, expected a whole number"), std::string::npos);
    file["w"] = 1e300;
    EXPECT_NE(errorOf(file).find("w is 1e+300"), std::string::npos);
}

TEST(TransformsJson, EveryMissingFieldIsNamed) {
    json file = goodFile();
    file.erase("fl_x");
    file.erase("fl_y");
    EXPECT_EQ(errorOf(file), "frame 0: fl_x is missing, and camera_angle_x as well");
    file = goodFile();
    file["frames"][1].erase("file_path");
    EXPECT_EQ(errorOf(file), "frame 1: file_path is missing");
    file = goodFile();
    file["frames"][1].erase("transform_matrix");
    EXPECT_EQ(errorOf(file), "frame 1: transform_matrix is missing");
    file = goodFile();
    file.erase("frames");
    EXPECT_EQ(errorOf(file), "frames is missing");
    file["frames"] = json::array();
    EXPECT_EQ(errorOf(file), "frames is empty, expected at least one");
    file["frames"] = 7;
    EXPECT_EQ(errorOf(file), "frames is a number, expected a list");
    file["frames"] = {7};
    EXPECT_EQ(errorOf(file), "frame 0: is a number, expected an object");
}

TEST(TransformsJson, UnknownModelsAndAxesAreNamed) {
    json file = goodFile();
    file["camera_model"] = "EQUIRECTANGULAR";
    EXPECT_NE(errorOf(file).find("camera_model is \"EQUIRECTANGULAR\", a panorama"), std::string::npos);
    EXPECT_NE(errorOf(file).find("cut it into perspective images"), std::string::npos);
    file["camera_model"] = 5;
    EXPECT_EQ(errorOf(file), "camera_model is a number, expected text");
    file = goodFile();
    file["up"] = "w";
    EXPECT_NE(errorOf(file).find("up is \"w\""), std::string::npos);
    file["up"] = "-y";
    EXPECT_EQ(parse(file).up, Vec3(0, -1, 0));
    file = goodFile();
    file["mesh_path"] = 3;
    EXPECT_EQ(errorOf(file), "mesh_path is a number, expected text");
    file = goodFile();
    file["camera_angle_x"] = 4;
    file.erase("fl_x");
    EXPECT_EQ(errorOf(file), "camera_angle_x is 4, expected radians less than pi");
}

TEST(TransformsJson, MatricesThatAreNoPoseAreRefused) {
    const auto withMatrix = [](const json& matrix) {
        json file = goodFile();
        file["frames"][1]["transform_matrix"] = matrix;
        return errorOf(file);
    };
    EXPECT_EQ(withMatrix({{1, 0}, {0, 1}}), "frame 1: transform_matrix is no 4 x 4 matrix (rows of numbers)");
    EXPECT_EQ(withMatrix({{1, 0, 0, 0}, {0, 1, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}}),
              "frame 1: transform_matrix row 1 is no list of 4 numbers");
    EXPECT_EQ(withMatrix({{1, 0, 0, "x"}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}}),
              "frame 1: transform_matrix row 0 column 3 is text, expected a number");
    EXPECT_EQ(withMatrix({{1, 0, 0, 0}, {0, 0, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}}),
              "frame 1: transform_matrix is singular, expected a rotation and a translation");
    EXPECT_EQ(withMatrix({{1, 0, 0, 0}, {0, 2, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}}),
              "frame 1: transform_matrix is not rigid, expected a rotation and a translation");
    EXPECT_EQ(withMatrix({{-1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}}),
              "frame 1: transform_matrix mirrors the world, expected a rotation and a translation; where a left-handed "
              "program wrote it, --mirror x, y or z names the axis that it reversed");
    EXPECT_EQ(withMatrix({{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 1, 1}}),
              "frame 1: transform_matrix has a last row other than 0 0 0 1");
    EXPECT_EQ(withMatrix({{1e200, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}}),
              "frame 1: transform_matrix row 0 column 0 is 1e+200, which is too large; expected at most 1e12");
    EXPECT_EQ(withMatrix("identity"), "frame 1: transform_matrix is no 4 x 4 matrix (rows of numbers)");
}

TEST(TransformsJson, UniformScaleIsTakenOutWithANote) {
    json file = goodFile();
    file["frames"][1]["transform_matrix"] = {{0, -3, 0, 7}, {3, 0, 0, 8}, {0, 0, 3, 9}};
    const Transforms t = parse(file);
    const DMat4& m = t.frames[1].camera.worldFromCamera;
    EXPECT_NEAR(glm::determinant(glm::dmat3(m)), 1, 1e-12);
    EXPECT_NEAR(m[0][1], 1, 1e-12);
    EXPECT_EQ(t.frames[1].camera.position(), DVec3(7, 8, 9));
    ASSERT_EQ(t.notes.size(), 1u);
    EXPECT_EQ(t.notes[0], "1 of 2 transform matrices held a uniform scale, which was taken out.");
}

TEST(TransformsJson, UnknownKeysAreIgnored) {
    json file = goodFile();
    file["aabb_scale"] = 16;
    file["scale"] = "any";
    file["frames"][0]["sharpness"] = {1, 2};
    EXPECT_EQ(parse(file).frames.size(), 2u);
}

TEST(TransformsJson, ExposuresAreReadAndChecked) {
    json file = goodFile();
    json& frame = file["frames"][1];
    frame["exposures"] = {{{"file_path", "b0.jpg"}, {"exposure_time", 0.5}, {"iso", 100}},
                          {{"file_path", "b1.jpg"}, {"exposure_time", 2}}};
    const std::vector<Exposure> exposures = parse(file).frames[1].exposures;
    ASSERT_EQ(exposures.size(), 2u);
    EXPECT_EQ(exposures[0].filePath, "b0.jpg");
    EXPECT_EQ(exposures[0].seconds, 0.5);
    EXPECT_EQ(exposures[0].iso, 100);
    EXPECT_EQ(exposures[1].aperture, 0);
    frame["exposures"][1]["exposure_time"] = 0;
    EXPECT_EQ(errorOf(file), "frame 1: exposures entry 1: exposure_time is 0, expected more than 0");
    frame["exposures"][1].erase("exposure_time");
    EXPECT_EQ(parse(file).frames[1].exposures[1].seconds, 0);  // EXIF is asked
    frame["exposures"][1] = {{"file_path", "b1.jpg"}, {"exposure_time", 2}};
    frame.erase("file_path");
    EXPECT_EQ(parse(file).frames[1].filePath, "");
    frame.erase("exposures");
    EXPECT_EQ(errorOf(file), "frame 1: file_path is missing");
}

TEST(TransformsJson, TextThatIsNoJsonIsRefused) {
    const auto error = [](const std::string& text) { return test::messageOf([&] { parseTransforms(text, {}); }); };
    EXPECT_NE(error("").find("is not valid JSON"), std::string::npos);
    EXPECT_NE(error("{\"frames\": [").find("is not valid JSON"), std::string::npos);
    EXPECT_NE(error("{\"w\": NaN}").find("is not valid JSON"), std::string::npos);
    EXPECT_NE(error("{\"w\": 1e999}").find("is not valid JSON"), std::string::npos);
    EXPECT_NE(error(std::string("{\"a\xff\xfe\": 1}")).find("is not valid JSON"), std::string::npos);
    EXPECT_NE(error("[]").find("is a list"), std::string::npos);
    EXPECT_NE(error("null").find("is null"), std::string::npos);
}

TEST(TransformsJson, BracketsInsideTextAreNoNesting) {
    json file = goodFile();
    file["comment"] = std::string(100, '[') + "\"\\" + std::string(100, '{');
    EXPECT_EQ(parse(file).frames.size(), 2u);
}

TEST(TransformsJson, HostileNestingAndCountsAreRefused) {
    const auto error = [](const std::string& text) { return test::messageOf([&] { parseTransforms(text, {}); }); };
    EXPECT_EQ(error(std::string(1'000'000, '[')), "is nested deeper than 32 levels");
    EXPECT_EQ(error("{\"a\":" + std::string(100, '[') + std::string(100, ']') + "}"),
              "is nested deeper than 32 levels");
    EXPECT_EQ(error("{\"a\":[" + std::string(9'000'000, ',') + "]}"), "holds more than 8000000 values");
    std::string many = "{\"frames\":[";
    for (int i = 0; i < 100'001; ++i) many += i ? ",{}" : "{}";
    EXPECT_EQ(error(many + "]}"), "frames has 100001 entries, expected at most 100000");
}

TEST(TransformsJson, ALensWithSkewIsReadByName) {
    json file = goodFile();
    file["camera_model"] = "BROWN";
    file["k3"] = 0.5, file["k4"] = 0.6, file["skew"] = 0.001;
    const Transforms t = parse(file);
    EXPECT_EQ(t.frames[0].camera.model, LensModel::brown);
    EXPECT_EQ(t.frames[0].camera.distortion, (std::array<double, 8>{0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.001, 0}));
    EXPECT_TRUE(t.notes.empty());
}

TEST(TransformsJson, WhatNerfstudioDidToTheCamerasIsSaid) {
    json file = goodFile();
    file["applied_transform"] = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}};
    EXPECT_TRUE(parse(file).notes.empty());
    file["applied_transform"] = {{0, 1, 0, 0}, {1, 0, 0, 0}, {0, 0, -1, 0}};
    ASSERT_EQ(parse(file).notes.size(), 1u);
    file["applied_scale"] = 1;
    EXPECT_EQ(parse(file).notes.size(), 1u);
    file["applied_scale"] = 0.25;
    ASSERT_EQ(parse(file).notes.size(), 2u);
    EXPECT_NE(parse(file).notes[1].find("--mesh-scale 0.25"), std::string::npos);
    file.erase("applied_scale");
    EXPECT_EQ(parse(file).notes[0].find("applied_transform says that the cameras were moved"), 0u);
    file["ply_file_path"] = "sparse_pc.ply";
    EXPECT_EQ(parse(file).notes.size(), 1u);
    file.erase("mesh_path");
    EXPECT_EQ(parse(file).notes.size(), 2u);
    for (const json& odd : {json(3), json({1, "a"}), json({{"a"}}), json::object()}) {
        file["applied_transform"] = odd;
        EXPECT_EQ(parse(file).frames.size(), 2u);
    }
}

TEST(TransformsJson, OneCameraIsReadForRendering) {
    test::TemporaryFolder folder;
    json file = goodFile();
    file["transform_matrix"] = file["frames"][0]["transform_matrix"];
    file.erase("frames");
    const Camera camera = readCameraFile(folder.write("eye.json", file.dump()));
    EXPECT_EQ(camera.focalX, 50);
    EXPECT_EQ(camera.position(), DVec3(0.5, 0, 2));
    file.erase("h");
    const auto path = folder.write("eye.json", file.dump());
    EXPECT_EQ(test::messageOf([&] { readCameraFile(path); }), "eye.json: h is missing");
}

}  // namespace
}  // namespace relamp
