// VisualSFM's NVM_V3, which COLMAP writes too.
//
// From VisualSFM's documentation of the format and the writer of its bundle adjustment (PBA, util.h): a camera is "name
// focal-length qw qx qy qz cx cy cz d 0", the quaternion turns the world into the camera (Y down, looking along +Z), c
// is its position, and a measured point m, in focal lengths from the middle of the image, has the undistorted place m
// (1 + d |m|^2). NVM_V3_R9T has a rotation matrix, row by row, and the translation that
// follows it (x in the camera = R x + t) in place of quaternion and position. Our lenses go the other way: the inverse
// is fitted by Brown's polynomial up to r^8, and the note says how well. Of several models the first is read.
#include "base/atomic_file.h"
#include "base/text_scanner.h"
#include "capture/formats/readers.h"

namespace relamp {
namespace fs = std::filesystem;
namespace {

constexpr double largestError = 0.1;  // pixels

bool isNvmHead(std::string_view head) { return head.starts_with("NVM_V3"); }

/// m with m (1 + d m^2) = r, by Newton's steps; none where the lens folds back before it.
std::optional<double> distortedRadius(double d, double r) {
    double m = r;
    for (int step = 0; step < 50; ++step) {
        const double slope = 1 + 3 * d * m * m;
        if (!(slope > 1e-3)) return std::nullopt;
        const double change = (m * (1 + d * m * m) - r) / slope;
        m -= change;
        if (std::abs(change) < 1e-14 * (1 + r)) return m;
    }
    return std::nullopt;
}

/// Least squares for k1 to k4 of m / r = 1 + k1 r^2 + ... over the image; returns the largest error, pixels.
double fitInverse(Camera& camera, double d) {
    const double corner = 0.5 * std::hypot(camera.width, camera.height) / camera.focalX;
    const double reach = corner * (1 + d * corner * corner);  // the undistorted radius of the corner
    if (!(reach > 0) || !(1 + 3 * d * corner * corner > 0.05))
        throw Error("radial distortion is {}, which folds the image over itself", d);
    constexpr int samples = 200, unknowns = 4;
    glm::dmat4 normal(0.0);
    glm::dvec4 right(0);
    const auto factor = [&](double r) {
        const auto m = distortedRadius(d, r);
        if (!m) throw Error("radial distortion is {}, which has no inverse over the image", d);
        return *m / r;
    };
    const auto powers = [](double s) { return glm::dvec4(s, s * s, s * s * s, s * s * s * s); };
    for (int i = 1; i <= samples; ++i) {
        const double x = double(i) / samples;  // radii in units of reach keep the equations well conditioned
        const glm::dvec4 row = powers(x * x) * x;
        normal += glm::outerProduct(row, row);
        right += row * ((factor(x * reach) - 1) * x);
    }
    const glm::dvec4 k = glm::inverse(normal) * right;
    double worst = 0;
    for (int i = 1; i <= samples; ++i) {
        const double x = (i - 0.5) / samples;
        worst = std::max(worst, std::abs(1 + glm::dot(k, powers(x * x)) - factor(x * reach)) * x * reach);
    }
    double scale = 1, scaled[unknowns];
    for (int i = 0; i < unknowns; ++i) scaled[i] = k[i] / (scale *= reach * reach);
    setLens(camera, {.k1 = scaled[0], .k2 = scaled[1], .k3 = scaled[2], .k4 = scaled[3]});
    return worst * camera.focalX;
}

ForeignCameras parseNvm(const fs::path& file, const ForeignFolder& around, Progress& progress) {
    const std::string text = readBytes(file, size_t(2) << 30);
    TextScanner scanner(text);
    TextScanner header(scanner.line());
    const std::string_view kind = header.word();
    if (kind != "NVM_V3" && kind != "NVM_V3_R9T")
        throw Error("the header is \"{}\", expected \"NVM_V3\" or \"NVM_V3_R9T\"", kind.substr(0, 40));
    const bool matrices = kind == "NVM_V3_R9T";
    const int numbers = matrices ? 15 : 10;
    if (const std::string_view word = header.word(); !word.empty())
        throw Error("the header holds \"{}\", expected no fixed calibration", word.substr(0, 40));
    const double count = numberFrom(scanner.word(), "number of cameras");
    if (!(count >= 0 && count <= double(foreignViews)) || count != std::floor(count))
        throw Error("number of cameras is {}, expected at most {}", count, foreignViews);
    scanner.line();
    ForeignCameras result;
    double worst = 0;
    for (size_t i = 0; i < size_t(count); ++i) {
        progress.check();
        const std::string_view line = scanner.line();
        // Names may hold spaces: the numbers are counted from the end.
        size_t end = line.find_last_not_of(" \t\r") + 1, begin = end;
        for (int words = 0; words < numbers && begin != line.npos && begin > 0; ++words) {
            const size_t last = line.find_last_not_of(" \t", begin - 1);
            if (last == line.npos) break;
            begin = line.find_last_of(" \t", last);
            begin = begin == line.npos ? 0 : begin + 1;
        }
        std::string_view name = line.substr(0, begin);
        while (!name.empty() && TextScanner::isSpace(name.back())) name.remove_suffix(1);
        if (name.empty()) throw Error("camera {}: is no line of a name and {} numbers", i, numbers);
        withContext(std::string(name.substr(0, 200)), [&] {
            const auto n = numbersFrom(line.substr(begin, end - begin), size_t(numbers), "camera");
            ForeignView view{std::string(name), {}};
            Camera& camera = view.camera;
            const auto [width, height] = around.sizeOf(view.name);
            setSize(camera, width, height);
            camera.focalX = camera.focalY = n[0];
            camera.centreX = 0.5 * width, camera.centreY = 0.5 * height;
            checkIntrinsics(camera, {"focal length", "focal length", "the middle's x", "the middle's y"});
            if (matrices) {
                const glm::dmat3 axes(n[1], n[2], n[3], n[4], n[5], n[6], n[7], n[8], n[9]);  // rows of R are columns
                camera.worldFromCamera = poseFromAxes(axes, -(axes * DVec3(n[10], n[11], n[12])), "rotation");
            } else {
                const glm::dmat3 axes = glm::transpose(rotationFromQuaternion(n[1], n[2], n[3], n[4], "quaternion"));
                camera.worldFromCamera = poseFromAxes(axes, {n[5], n[6], n[7]}, "quaternion");
            }
            if (const double distortion = n[n.size() - 2]; distortion != 0) {
                const double error = fitInverse(camera, distortion);
                if (!(error <= largestError))
                    throw Error("radial distortion is {}: its inverse fits to {:.2f} pixels, expected {} or better",
                                distortion, error, largestError);
                worst = std::max(worst, error);
            }
            result.views.push_back(std::move(view));
        });
    }
    if (worst > 0)
        result.notes.push_back(
            fmt::format("The lens is the inverse of VisualSFM's, fitted to {:.4f} pixels or better.", worst));
    return result;
}

std::optional<fs::path> findNvm(const fs::path& folder) {
    constexpr const char* names[] = {"reconstruction.nvm"};
    return findByHead(folder, names, ".nvm", isNvmHead);
}

bool ownsNvm(const std::string& name) { return name.ends_with(".nvm"); }

}  // namespace

const ForeignReader nvmReader{findNvm, ownsNvm, parseNvm};

}  // namespace relamp
