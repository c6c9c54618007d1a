// Formats in text and numpy's: RealityCapture, Bundler, VisualSFM, LLFF.
#include <cstring>

#include "capture/formats/foreign_shots.h"

namespace relamp {
namespace {

using test::ForeignLens;
using test::ForeignShot;

class RealityCapture : public test::ForeignCapture {
protected:
    /// Heading, pitch and roll by what they mean: heading turns clockwise from +y seen from above, pitch lifts the view
    /// from straight down, roll turns about the camera's own up.
    static std::string row(const ForeignShot& s, const ForeignLens& lens) {
        // worldFromCamera = Rz(-h) Rx(p) Ry(r), columns right, up, back.
        const DVec3 up = -s.down, back = -s.ahead;
        const double pitch = std::asin(up.z), heading = std::atan2(up.x, up.y), roll = std::atan2(-s.right.z, back.z);
        const double degrees = 180 / piD;
        return fmt::format(
            "{},{:.17g},{:.17g},{:.17g},{:.17g},{:.17g},{:.17g},{:.17g},{:.17g},{:.17g},{:.17g},{:.17g},{:.17g},{:.17g}"
            ","
            "{:.17g},{:.17g}\r\n",
            s.name, s.position.x, s.position.y, s.position.z, heading * degrees, pitch * degrees, roll * degrees,
            lens.f * 36 / 1600, (lens.cx - 800) / 1600, (lens.cy - 600) / 1600, lens.k1, lens.k2, lens.k3, lens.k4,
            lens.p1, lens.p2);
    }
    void write(const ForeignLens& lens, const std::string& before = "") const {
        std::string text = before + "#name,x,y,alt,heading,pitch,roll,f,px,py,k1,k2,k3,k4,t1,t2\r\n";
        for (const ForeignShot& s : shots) text += row(s, lens);
        folder.write("cameras.csv", text);
    }
    const ForeignLens whole{1234.5, 1234.5, 803.25, 596.5, -0.11, 0.06, -0.013, 0.004, 0.0011, -0.0007};
};

TEST_F(RealityCapture, EveryColumnGivesThePixelsOfItsLens) {
    for (const char* before : {"", "#cameras 5\r\n", "\xef\xbb\xbf"}) {
        write(whole, before);
        const CaptureSource source = read();
        EXPECT_LT(worstPixel(source, whole), 1e-6);
        EXPECT_EQ(source.up, Vec3(0, 0, 1));
    }
}

TEST_F(RealityCapture, AnglesMeanWhatAnAerialPhotographersMean) {
    const auto camera = [&](const char* angles) {
        folder.write("cameras.csv", fmt::format("#name,x,y,alt,heading,pitch,roll,f\nimg_0.png,1,2,3,{},36\n", angles));
        return read().frames[0].camera;
    };
    EXPECT_LT(glm::distance(camera("0,0,0").forward(), DVec3(0, 0, -1)), 1e-9);
    EXPECT_LT(glm::distance(camera("0,90,0").forward(), DVec3(0, 1, 0)), 1e-9);
    EXPECT_LT(glm::distance(camera("90,90,0").forward(), DVec3(1, 0, 0)), 1e-9);
    EXPECT_LT(glm::distance(DVec3(camera("90,90,0").worldFromCamera[1]), DVec3(0, 0, 1)), 1e-9);
    // A right wing that is down looks to the left.
    EXPECT_LT(camera("0,0,10").forward().x, -0.1);
    EXPECT_EQ(camera("0,0,0").focalX, 1600);
    EXPECT_EQ(camera("0,0,0").centreY, 600);
}

TEST_F(RealityCapture, BadRowsAreNamed) {
    const auto with = [&](const std::string& row) {
        folder.write("cameras.csv", "#name,x,y,alt,heading,pitch,roll,f,px\n" + row + "\n");
        return error();
    };
    EXPECT_EQ(with("img_0.png,1,2"), "cameras.csv: img_0.png: alt is missing");
    EXPECT_EQ(with("img_0.png,1,2,3,nan,5,6,7"),
              "cameras.csv: img_0.png: heading is \"nan\", expected a finite number");
    EXPECT_EQ(with("img_0.png,1,2,3,4,5,6,0"),
              "cameras.csv: img_0.png: f (in pixels) is 0, expected 0.001 to 1e+09 pixels");
    EXPECT_EQ(with(",1,2,3,4,5,6,7"), "cameras.csv: name is missing");
    EXPECT_EQ(with(""), "cameras.csv: holds no camera with a pose");
    EXPECT_NE(with("absent.png,1,2,3,4,5,6,7").find("absent.png"), std::string::npos);
    folder.write("cameras.csv", "name;x;y\n1;2;3\n");
    EXPECT_FALSE(findCapture(folder.path()));
}

class Bundler : public test::ForeignCapture {
protected:
    static std::string camera(const ForeignShot& s, const ForeignLens& lens) {
        // Camera axes right, up, back; t = -R c.
        const DVec3 axes[] = {s.right, -s.down, -s.ahead};
        std::string text = fmt::format("{:.17g} {:.17g} {:.17g}\n", lens.f, lens.k1, lens.k2);
        for (const DVec3& a : axes) text += fmt::format("{:.17g} {:.17g} {:.17g}\n", a.x, a.y, a.z);
        for (const DVec3& a : axes) text += fmt::format("{:.17g} ", -glm::dot(a, s.position));
        return text + "\n";
    }
    std::string bundle(size_t extra = 0) const {
        std::string text = fmt::format("# Bundle file v0.3\n{} 1\n", shots.size() + extra);
        for (const ForeignShot& s : shots) text += camera(s, lens);
        return text;
    }
    std::string list() const {
        std::string text;
        for (const ForeignShot& s : shots) text += "./images/" + s.name + " 0 1234.5\n";
        return text;
    }
    const ForeignLens lens{1234.5, 1234.5, 800, 600, -0.11, 0.06};
};

TEST_F(Bundler, CamerasLookBackwardsAndPixelsCountFromTheMiddle) {
    folder.write("bundle.out", bundle() + "0 0 0\n255 0 0\n0\n");
    folder.write("list.txt", list());
    EXPECT_LT(worstPixel(read(), lens), 1e-6);
    EXPECT_EQ(read().otherFiles, std::vector<std::filesystem::path>{folder / "list.txt"});
    // Bundler's own folders, and the names that COLMAP gives.
    std::filesystem::create_directories(folder / "bundle");
    std::filesystem::rename(folder / "bundle.out", folder / "bundle/bundle.out");
    EXPECT_LT(worstPixel(read(), lens), 1e-6);
    std::filesystem::rename(folder / "bundle/bundle.out", folder / "model.bundle.out");
    std::filesystem::rename(folder / "list.txt", folder / "model.list.txt");
    EXPECT_LT(worstPixel(read(), lens), 1e-6);
}

TEST_F(Bundler, ACameraWithoutAFocalLengthIsLeftOut) {
    folder.write("bundle.out", bundle(1) + "0 0 0\n0 0 0\n0 0 0\n0 0 0\n0 0 0\n");
    folder.write("list.txt", list() + "lost.png\n");
    const CaptureSource source = read();
    EXPECT_LT(worstPixel(source, lens), 1e-6);
    EXPECT_TRUE(holds(source.notes, "1 of 6 cameras have no pose"));
}

TEST_F(Bundler, BadFilesAreNamed) {
    folder.write("bundle.out", bundle());
    EXPECT_EQ(error(), "bundle.out: list.txt with the photographs' names is not there");
    folder.write("list.txt", "img_0.png\n");
    EXPECT_EQ(error(), "bundle.out: holds 5 cameras, and list.txt names 1 photographs");
    const auto with = [&](const std::string& text) {
        folder.write("bundle.out", "# Bundle file v0.3\n" + text);
        return error();
    };
    EXPECT_EQ(with("1e9 3\n"), "bundle.out: number of cameras is 1000000000, expected at most 100000");
    EXPECT_EQ(with("-1 3\n"), "bundle.out: number of cameras is -1, expected at most 100000");
    EXPECT_EQ(with("x 3\n"), "bundle.out: number of cameras is \"x\", expected a finite number");
    EXPECT_EQ(with("1 0\n900 0 0\n1 0 0 0 1 0 0 0\n"), "bundle.out: img_0.png: R is missing");
    EXPECT_EQ(with("1 0\n900 0 0\n1 0 0 0 1 0 0 0 nan\n0 0 0\n"),
              "bundle.out: img_0.png: R is \"nan\", expected a finite number");
    EXPECT_EQ(with("1 0\n900 0 0\n1 0 0 0 1 0 0 0 -1\n0 0 0\n"),
              "bundle.out: img_0.png: R mirrors the world, expected a rotation and a translation");
    EXPECT_EQ(with("1 0\n-9 0 0\n1 0 0 0 1 0 0 0 1\n0 0 0\n"),
              "bundle.out: img_0.png: f is -9, expected 0.001 to 1e+09 pixels");
    folder.write("bundle.out", "something else");
    EXPECT_FALSE(findCapture(folder.path()));
}

class VisualSfm : public test::ForeignCapture {
protected:
    static std::string camera(const ForeignShot& s, double f, double d) {
        // The quaternion of camera-from-world, from its trace (none of these cameras turns by half a circle).
        const double w = 0.5 * std::sqrt(1 + s.right.x + s.down.y + s.ahead.z);
        const double x = (s.ahead.y - s.down.z) / (4 * w), y = (s.right.z - s.ahead.x) / (4 * w),
                     z = (s.down.x - s.right.y) / (4 * w);
        return fmt::format("{}\t{:.17g} {:.17g} {:.17g} {:.17g} {:.17g} {:.17g} {:.17g} {:.17g} {:.17g} 0\n", s.name, f,
                           w, x, y, z, s.position.x, s.position.y, s.position.z, d);
    }
    void write(double d) const {
        std::string text = fmt::format("NVM_V3 \n\n{}\n", shots.size());
        for (const ForeignShot& s : shots) text += camera(s, 1234.5, d);
        folder.write("scan.nvm", text + "\n0\n0\n");
    }
};

TEST_F(VisualSfm, QuaternionsTurnTheWorldIntoTheCamera) {
    write(0);
    EXPECT_LT(worstPixel(read(), {1234.5, 1234.5, 800, 600}), 1e-6);
}

TEST_F(VisualSfm, MatricesAndTranslationsAreTheSameCameras) {
    for (const double d : {0.0, 0.1}) {
        write(d);
        const CaptureSource quaternions = read();
        std::string text = fmt::format("NVM_V3_R9T\n{}\n", shots.size());
        for (const ForeignShot& s : shots) {
            text += s.name + " 1234.5";
            for (const DVec3& row : {s.right, s.down, s.ahead})
                text += fmt::format(" {:.17g} {:.17g} {:.17g}", row.x, row.y, row.z);
            for (const DVec3& row : {s.right, s.down, s.ahead})
                text += fmt::format(" {:.17g}", -glm::dot(row, s.position));
            text += fmt::format(" {} 0\n", d);
        }
        folder.write("scan.nvm", text + "\n0\n0\n");
        const CaptureSource matrices = read();
        if (d == 0) {
            EXPECT_LT(worstPixel(matrices, {1234.5, 1234.5, 800, 600}), 1e-6);
        }
        ASSERT_EQ(matrices.frames.size(), quaternions.frames.size());
        for (size_t i = 0; i < shots.size(); ++i)
            EXPECT_EQ(matrices.frames[i].camera.distortion, quaternions.frames[i].camera.distortion);
    }
}

TEST_F(VisualSfm, TheFittedLensUndoesItsDistortion) {
    for (const double d : {0.1, -0.1}) {
        write(d);
        const CaptureSource source = read();
        EXPECT_TRUE(holds(source.notes, "inverse of VisualSFM's, fitted to 0.00")) << source.notes[0];
        const Camera& c = source.frames[0].camera;
        double worst = 0;
        for (double u = 5; u < 1600; u += 95)
            for (double v = 5; v < 1200; v += 85) {
                // The documented direction: a measured point gives the undistorted one.
                const double mx = (u - 800) / 1234.5, my = (v - 600) / 1234.5, grow = 1 + d * (mx * mx + my * my);
                const DVec3 world = c.position() + DVec3(c.worldFromCamera * glm::dvec4(mx * grow, -my * grow, -1, 0));
                const auto pixel = c.projectByFormula(world);
                ASSERT_TRUE(pixel);
                worst = std::max(worst, glm::distance(*pixel, glm::dvec2(u, v)));
            }
        EXPECT_LT(worst, 0.01) << d;
        EXPECT_GT(worst, 0);
    }
}

TEST_F(VisualSfm, ALensThatCannotBeUndoneIsRefused) {
    for (const double d : {-3.0, 5.0}) {
        write(d);
        EXPECT_EQ(error().find(fmt::format("scan.nvm: img_0.png: radial distortion is {}", d)), 0u) << error();
    }
}

TEST_F(VisualSfm, BadLinesAreNamed) {
    const auto with = [&](const std::string& text) {
        folder.write("scan.nvm", "NVM_V3\n\n" + text);
        return error();
    };
    EXPECT_EQ(with("9e9\n"), "scan.nvm: number of cameras is 9000000000, expected at most 100000");
    EXPECT_EQ(with("2\nimg_0.png 1 2\n"), "scan.nvm: camera 0: is no line of a name and 10 numbers");
    EXPECT_EQ(with("1\nimg_0.png 900 0 0 0 0 1 2 3 0 0\n"),
              "scan.nvm: img_0.png: quaternion is 0 0 0 0, expected a rotation");
    EXPECT_EQ(with("1\nimg_0.png 900 1 0 0 0 1 inf 3 0 0\n"),
              "scan.nvm: img_0.png: camera is \"inf\", expected a finite number");
    EXPECT_EQ(with("1\nimg_0.png -1 1 0 0 0 1 2 3 0 0\n"),
              "scan.nvm: img_0.png: focal length is -1, expected 0.001 to 1e+09 pixels");
    // Names may hold spaces.
    std::filesystem::copy_file(folder / "images/img_0.png", folder / "images/a b.png");
    EXPECT_EQ(with("1\na b.png 900 1 0 0 0 1 2 3 0 0\n"), "");
    folder.write("scan.nvm", "NVM_V3_R9T\n1\nimg_0.png 900 1 0 0 0 1 2 3 0 0\n");
    EXPECT_EQ(error(), "scan.nvm: camera 0: is no line of a name and 15 numbers");
    folder.write("scan.nvm", "NVM_V3_R9T\n1\nimg_0.png 900 1 0 0 0 2 0 0 0 1 1 2 3 0 0\n");
    EXPECT_EQ(error().find("scan.nvm: img_0.png: rotation is not rigid"), 0u) << error();
    folder.write("scan.nvm", "NVM_V3_R12T\n1\n");
    EXPECT_EQ(error(), "scan.nvm: the header is \"NVM_V3_R12T\", expected \"NVM_V3\" or \"NVM_V3_R9T\"");
    folder.write("scan.nvm", "NVM_V3 FixedK 900 800 900 600 0\n1\n");
    EXPECT_EQ(error(), "scan.nvm: the header holds \"FixedK\", expected no fixed calibration");
    folder.write("scan.nvm", "something else");
    EXPECT_FALSE(findCapture(folder.path()));
}

class Llff : public test::ForeignCapture {
protected:
    static std::string array(const std::string& kind, const std::string& shape, const std::vector<double>& numbers,
                             const std::string& order = "False") {
        std::string header = "{'descr': '" + kind + "', 'fortran_order': " + order + ", 'shape': " + shape + ", }";
        while ((10 + header.size() + 1) % 64) header += ' ';
        header += '\n';
        std::string bytes("\x93NUMPY\x01\x00", 8);
        bytes += char(header.size() & 0xff);
        bytes += char(header.size() >> 8);
        bytes += header;
        for (const double x : numbers) {
            char raw[8];
            const float single = float(x);
            const size_t size = kind == "<f4" ? 4 : 8;
            std::memcpy(raw, size == 8 ? static_cast<const void*>(&x) : &single, size);
            bytes.append(raw, size);
        }
        return bytes;
    }
    std::vector<double> rows() const {
        std::vector<double> n;
        for (const ForeignShot& s : shots) {
            const double hwf[] = {1200, 1600, 1234.5};
            for (int r = 0; r < 3; ++r)
                for (const double x : {s.down[r], s.right[r], -s.ahead[r], s.position[r], hwf[r]}) n.push_back(x);
            n.push_back(0.5), n.push_back(9);
        }
        return n;
    }
};

TEST_F(Llff, AxesAreDownRightBack) {
    const ForeignLens lens{1234.5, 1234.5, 800, 600};
    folder.write("poses_bounds.npy", array("<f8", "(5, 17)", rows()));
    EXPECT_LT(worstPixel(read(), lens), 1e-6);
    folder.write("poses_bounds.npy", array("<f4", "(5, 17)", rows()));
    EXPECT_LT(worstPixel(read(), lens), 0.01);
}

TEST_F(Llff, BadArraysAreNamed) {
    const auto with = [&](const std::string& bytes) {
        folder.write("poses_bounds.npy", bytes);
        return error();
    };
    EXPECT_EQ(with(array("<i8", "(5, 17)", rows())),
              "poses_bounds.npy: header: descr is '<i8', expected '<f8' or '<f4'");
    EXPECT_EQ(with(array("<f8", "(5, 17)", rows(), "True")), "poses_bounds.npy: header: fortran_order is not False");
    EXPECT_EQ(with(array("<f8", "(99999999999, 17)", rows())),
              "poses_bounds.npy: header: shape is (99999999999, 17), expected 1 to 100000 rows of 17");
    EXPECT_EQ(with(array("<f8", "(17,)", rows())),
              "poses_bounds.npy: header: shape is (17,), expected 1 to 100000 rows of 17");
    EXPECT_EQ(with(array("<f8", "(6, 17)", rows())), "poses_bounds.npy: holds 680 bytes of numbers, expected 816");
    EXPECT_EQ(with(array("<f8", "(5, 17)", rows()).substr(0, 11)), "poses_bounds.npy: is no numpy array");
    EXPECT_EQ(with(array("<f8", "(5, 17)", rows()).substr(0, 40)), "poses_bounds.npy: header: is longer than the file");
    std::vector<double> bad = rows();
    bad[3] = std::nan("");
    EXPECT_EQ(with(array("<f8", "(5, 17)", bad)),
              "poses_bounds.npy: img_0.png: number 3 is nan, expected a finite number");
    bad = rows();
    bad[0] = 9;
    EXPECT_EQ(with(array("<f8", "(5, 17)", bad)),
              "poses_bounds.npy: img_0.png: pose is not rigid, expected a rotation and a translation");
    std::filesystem::remove(folder / "images/img_4.png");
    EXPECT_EQ(with(array("<f8", "(5, 17)", rows())),
              "poses_bounds.npy: holds 5 cameras, and the folder of images 4 images: they belong together by their "
              "order");
}

}  // namespace
}  // namespace relamp
