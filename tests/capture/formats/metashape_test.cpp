// Metashape's cameras.xml: the manual's formula, chunk transforms, what is left out and what is refused.
#include "capture/formats/foreign_shots.h"

namespace relamp {
namespace {

using test::ForeignLens;
using test::ForeignShot;

/// A rotation about (1, 2, 3), a translation and a scale that lead from the chunk to the world.
struct Chunk {
    glm::dmat3 turn{1.0};
    DVec3 move{0};
    double scale = 1;
};

class Metashape : public test::ForeignCapture {
protected:
    static std::string calibration(const ForeignLens& lens) {
        // Metashape's f is that of y, b1 the excess of x; cx and cy count from the middle; p1 is OpenCV's p2.
        return fmt::format(
            "<calibration type=\"frame\" class=\"adjusted\"><resolution width=\"1600\" height=\"1200\"/>"
            "<f>{:.17g}</f><cx>{:.17g}</cx><cy>{:.17g}</cy><b1>{:.17g}</b1><b2>{:.17g}</b2><k1>{:.17g}</k1>"
            "<k2>{:.17g}</k2><k3>{:.17g}</k3><k4>{:.17g}</k4><p1>{:.17g}</p1><p2>{:.17g}</p2></calibration>",
            lens.fy, lens.cx - 800, lens.cy - 600, lens.f - lens.fy, lens.skew, lens.k1, lens.k2, lens.k3, lens.k4,
            lens.p2, lens.p1);
    }
    std::string camera(size_t i, const Chunk& chunk, const std::string& more = "") const {
        const ForeignShot& s = shots[i];
        const glm::dmat3 back = glm::transpose(chunk.turn);
        const DVec3 x = back * s.right, y = back * s.down, z = back * s.ahead,
                    p = back * (s.position - chunk.move) / chunk.scale;
        std::string rows;
        for (int r = 0; r < 3; ++r) rows += fmt::format("{:.17g} {:.17g} {:.17g} {:.17g} ", x[r], y[r], z[r], p[r]);
        return fmt::format(
            "<camera id=\"{}\" sensor_id=\"0\" component_id=\"0\" label=\"img_{}\"><transform>{}0 0 0 1</transform>{}"
            "</camera>\n",
            i, i, rows, more);
    }
    std::string cameras(const Chunk& chunk) const {
        std::string text;
        for (size_t i = 0; i < shots.size(); ++i) text += camera(i, chunk);
        return text;
    }
    void write(const std::string& sensors, const std::string& cameras, const std::string& rest = "") const {
        folder.write("cameras.xml", fmt::format("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<document "
                                                "version=\"2.0.0\">\n<chunk label=\"Chunk 1\" enabled=\"true\">\n"
                                                "<sensors next_id=\"1\">{}</sensors>\n<cameras>\n{}</cameras>\n{}"
                                                "</chunk></document>\n",
                                                sensors, cameras, rest));
    }
    static std::string sensor(const ForeignLens& lens, const std::string& type = "frame") {
        return fmt::format("<sensor id=\"0\" label=\"a\" type=\"{}\">{}</sensor>", type, calibration(lens));
    }
    static std::string transform(const Chunk& c) {
        std::string text = "<transform><rotation>";
        for (int r = 0; r < 3; ++r)
            for (int k = 0; k < 3; ++k) text += fmt::format("{:.17g} ", c.turn[k][r]);
        return text + fmt::format(
                          "</rotation><translation>{:.17g} {:.17g} {:.17g}</translation><scale>{:.17g}</scale>"
                          "</transform>",
                          c.move.x, c.move.y, c.move.z, c.scale);
    }
    const ForeignLens whole{1240, 1234.5, 803.25, 596.5, -0.11, 0.06, -0.013, 0.004, 0.0011, -0.0007, 0.8};
};

TEST_F(Metashape, EveryCoefficientAndTheSkewGiveThePixelsOfTheManual) {
    write(sensor(whole), cameras({}));
    const CaptureSource source = read();
    EXPECT_LT(worstPixel(source, whole), 1e-6);
    EXPECT_EQ(source.frames[0].camera.model, LensModel::brown);
    EXPECT_EQ(source.mesh.filename(), "mesh.obj");
    EXPECT_GT(source.up.z, 0.9f);
    EXPECT_TRUE(holds(source.notes, "cameras.xml does not say what is up"));
}

TEST_F(Metashape, TheUsualLensIsOneThatOtherProgramsKnow) {
    ForeignLens usual = whole;
    usual.k4 = usual.skew = 0, usual.f = usual.fy;
    write(sensor(usual), cameras({}));
    EXPECT_LT(worstPixel(read(), usual), 1e-6);
    EXPECT_EQ(read().frames[0].camera.model, LensModel::fullOpenCv);
    write(sensor({}), cameras({}));
    EXPECT_LT(worstPixel(read(), {}), 1e-6);
    EXPECT_EQ(read().frames[0].camera.model, LensModel::pinhole);
}

TEST_F(Metashape, TheChunksTransformLeadsToTheWorldOfTheMesh) {
    const double c = std::cos(0.7), s = std::sin(0.7);
    const Chunk chunk{glm::dmat3(c, s, 0, -s, c, 0, 0, 0, 1) * glm::dmat3(1, 0, 0, 0, c, -s, 0, s, c), {7, -3, 2}, 2.5};
    write(sensor(whole), cameras(chunk), transform(chunk));
    EXPECT_LT(worstPixel(read(), whole), 1e-6);
    EXPECT_TRUE(holds(read().notes, "scale (2.5) were applied"));
    // A component's own transform counts instead.
    write(sensor(whole), cameras(chunk),
          "<transform><scale>9</scale></transform><components><component id=\"0\">" + transform(chunk) +
              "</component></components>");
    EXPECT_LT(worstPixel(read(), whole), 1e-6);
}

TEST_F(Metashape, CamerasThatCannotBeUsedAreLeftOutAndSaid) {
    std::string others = "<camera id=\"90\" sensor_id=\"0\" label=\"lost\"/>";
    others += "<camera id=\"91\" sensor_id=\"0\" label=\"off\" enabled=\"false\"><transform/></camera>";
    others += "<camera id=\"92\" sensor_id=\"0\" master_id=\"1\" label=\"rig\"/>";
    others +=
        "<camera id=\"93\" sensor_id=\"0\" component_id=\"7\" label=\"other\"><transform>1 0 0 0 0 1 0 0 0 0 1 0 "
        "0 0 0 1</transform></camera>";
    // Groups may be nested.
    write(sensor(whole), "<group><group>" + cameras({}) + "</group></group>" + others);
    const CaptureSource source = read();
    EXPECT_LT(worstPixel(source, whole), 1e-6);
    for (const char* why :
         {"1 of 9 cameras have no pose", "1 of 9 cameras are disabled", "1 of 9 cameras take their pose from another",
          "1 of 9 cameras belong to another component"})
        EXPECT_TRUE(holds(source.notes, why)) << why;
}

TEST_F(Metashape, ExposuresBesideAPhotographAreItsBracket) {
    for (const ForeignShot& s : shots)
        for (const char* stops : {"_ev-2", "_ev+2"})
            std::filesystem::copy_file(
                folder / ("images/" + s.name),
                folder / ("images/" + std::filesystem::path(s.name).stem().string() + stops + ".png"));
    // One of the exposures was aligned as well: its pose is the worse one.
    std::string second = camera(1, {});
    second.replace(second.find("img_1"), 5, "img_0_ev+2");
    write(sensor(whole), cameras({}) + second);
    const CaptureSource source = read();
    EXPECT_LT(worstPixel(source, whole), 1e-6);
    ASSERT_EQ(source.frames[0].exposures.size(), 3u);
    EXPECT_EQ(std::filesystem::path(source.frames[0].exposures[0].filePath).filename(), "img_0_ev-2.png");
    EXPECT_EQ(source.frames[0].exposures[2].seconds, 4);
    EXPECT_TRUE(holds(source.notes, "1 of 6 cameras are exposures of others"));
}

TEST_F(Metashape, WhatIsNoFrameCameraIsRefusedByItsName) {
    for (const char* type : {"equisolid_fisheye", "spherical", "cylindrical", "rpc"}) {
        write(sensor(whole, type), cameras({}));
        EXPECT_EQ(error().find(fmt::format(
                      "cameras.xml: camera img_0: sensor 0: type is \"{}\", expected \"frame\" or \"fisheye\":", type)),
                  0u)
            << error();
    }
    write(sensor(whole), camera(0, {}, "<rolling_shutter>0 0 1</rolling_shutter>"));
    EXPECT_EQ(error().find("cameras.xml: camera img_0: rolling_shutter is there"), 0u) << error();
    std::string old = sensor(whole);
    old.replace(old.find("<f>"), 3, "<fx>1</fx><f>");
    write(old, cameras({}));
    EXPECT_EQ(error().find("cameras.xml: camera img_0: sensor 0: calibration: fx is a field of PhotoScan"), 0u);
    std::string higher = sensor(whole);
    higher.replace(higher.find("<f>"), 3, "<p3>0.5</p3><f>");
    write(higher, cameras({}));
    EXPECT_EQ(error().find("cameras.xml: camera img_0: sensor 0: calibration: p3 is 0.5, expected 0"), 0u);
}

TEST_F(Metashape, AFisheyeGivesThePixelsOfTheManual) {
    ForeignLens fisheye = whole;
    fisheye.equidistant = true, fisheye.skew = 0;
    for (const char* type : {"fisheye", "equidistant_fisheye"}) {
        write(sensor(fisheye, type), cameras({}));
        EXPECT_LT(worstPixel(read(), fisheye), 1e-6) << type;
        EXPECT_EQ(read().frames[0].camera.model, LensModel::thinPrismFisheye);
    }
    fisheye.p1 = fisheye.p2 = 0;
    write(sensor(fisheye, "fisheye"), cameras({}));
    EXPECT_LT(worstPixel(read(), fisheye), 1e-6);
    EXPECT_EQ(read().frames[0].camera.model, LensModel::openCvFisheye);
    // The pixels of a frame camera are others: the formula matters here.
    fisheye.equidistant = false;
    EXPECT_GT(worstPixel(read(), fisheye), 10);
    // None of the models has a fisheye's skew.
    write(sensor(whole, "fisheye"), cameras({}));
    EXPECT_EQ(error().find("cameras.xml: camera img_0: sensor 0: calibration: b2 is 0.8, expected 0 of a fisheye"), 0u)
        << error();
}

TEST_F(Metashape, BadFieldsAreNamed) {
    const auto with = [&](const std::string& from, const std::string& to) {
        std::string text = sensor(whole);
        const size_t at = text.find(from), end = text.find('<', at + from.size());
        text.replace(at, end - at, to);
        write(text, cameras({}));
        return error();
    };
    const std::string where = "cameras.xml: camera img_0: sensor 0: ";
    EXPECT_EQ(with("<f>", "<f>nan"), where + "calibration: f is \"nan\", expected a finite number");
    EXPECT_EQ(with("<f>", "<f>"), where + "calibration: f is missing");
    EXPECT_EQ(with("<f>", "<f>-5"), where + "calibration: f is -5, expected 0.001 to 1e+09 pixels");
    EXPECT_EQ(with("<k3>", "<k3>1e400"), where + "calibration: k3 is \"1e400\", expected a finite number");
    EXPECT_NE(with("<cx>", "<cx>1e9").find("calibration: cx"), std::string::npos);
    EXPECT_NE(with("<resolution", "<resolution width=\"0\" height=\"9\"/>").find("width is 0"), std::string::npos);
    write("", cameras({}));
    EXPECT_EQ(error(), "cameras.xml: camera img_0: sensor_id is \"0\", which is not among the sensors");
    const auto pose = [&](const std::string& numbers) {
        write(sensor(whole),
              "<camera id=\"0\" sensor_id=\"0\" label=\"img_0\"><transform>" + numbers + "</transform></camera>");
        return error();
    };
    const std::string here = "cameras.xml: camera img_0: transform ";
    EXPECT_EQ(pose("1 0 0"), here + "holds 3 numbers, expected 16");
    EXPECT_EQ(pose("1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1 5"), here + "holds more than 16 numbers");
    EXPECT_EQ(pose("2 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1"), here + "is not rigid, expected a rotation and a translation");
    EXPECT_EQ(pose("2 0 0 0 0 2 0 0 0 0 2 0 0 0 0 1"),
              here + "has a scale of 2, expected a rotation and a translation");
    EXPECT_EQ(pose("-1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1"),
              here + "mirrors the world, expected a rotation and a translation");
    EXPECT_EQ(pose("0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 1"), here + "is singular, expected a rotation and a translation");
    EXPECT_EQ(pose("inf 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1"), here + "is \"inf\", expected a finite number");
    write(sensor(whole), camera(0, {}) + camera(0, {}));
    EXPECT_EQ(error(), "cameras.xml: img_0 is there twice");
    write(sensor(whole), "");
    EXPECT_EQ(error(), "cameras.xml: holds no camera with a pose");
}

TEST_F(Metashape, OtherXmlIsNotClaimed) {
    for (const char* text : {"<html><chunk/></html>", "<document/>", "", "<?xml version=\"1.0\"?><camera/>"}) {
        folder.write("cameras.xml", text);
        EXPECT_FALSE(findCapture(folder.path())) << text;
    }
    // Any name is claimed by content.
    write(sensor(whole), cameras({}));
    std::filesystem::rename(folder / "cameras.xml", folder / "project export.xml");
    ASSERT_TRUE(findCapture(folder.path()));
    EXPECT_STREQ(findCapture(folder.path())->format->name, "Metashape cameras");
    EXPECT_EQ(captureFolderOf(folder / "project export.xml"), folder.path());
    folder.write("project export.xml", "<document><chunk>");
    EXPECT_NE(error().find("project export.xml: is not valid XML (byte "), std::string::npos) << error();
}

TEST_F(Metashape, DeepAndLargeFilesEndInAnError) {
    std::string deep = "<document><chunk>";
    for (int i = 0; i < 200'000; ++i) deep += "<group>";
    folder.write("cameras.xml", deep);
    EXPECT_NE(error().find("is not valid XML"), std::string::npos);
    std::string nested = "<cameras>";
    for (int i = 0; i < 100'000; ++i) nested += "<group>";
    for (int i = 0; i < 100'000; ++i) nested += "</group>";
    folder.write("cameras.xml", "<document><chunk>" + nested + "</cameras></chunk></document>");
    EXPECT_EQ(error(), "cameras.xml: holds no camera with a pose");
    std::string many = "<document><chunk>";
    for (int i = 0; i < 2'100'000; ++i) many += "<a/>";
    folder.write("cameras.xml", many + "</chunk></document>");
    EXPECT_EQ(error(), "cameras.xml: holds more than 2000000 elements");
}

}  // namespace
}  // namespace relamp
