#include "capture/orientation.h"

#include "base/error.h"
#include "base/text_scanner.h"

namespace relamp {

Vec3 axisFromName(const std::string& name) {
    const bool sign = !name.empty() && (name[0] == '-' || name[0] == '+');
    const std::string axis = name.substr(sign);
    const float length = sign && name[0] == '-' ? -1.0f : 1.0f;
    if (axis == "x" || axis == "X") return {length, 0, 0};
    if (axis == "y" || axis == "Y") return {0, length, 0};
    if (axis == "z" || axis == "Z") return {0, 0, length};
    std::string words = name;
    std::replace(words.begin(), words.end(), ',', ' ');
    TextScanner scanner(words);
    DVec3 given(0);
    bool good = true;
    for (int c = 0; c < 3; ++c) {
        const auto value = TextScanner::number(scanner.word());
        good = good && value && std::isfinite(*value) && std::abs(*value) < 1e9;
        if (good) given[c] = *value;
    }
    if (good && scanner.word().empty() && glm::length(given) > 1e-9) return Vec3(glm::normalize(given));
    throw Error("expected \"x\", \"y\", \"z\", \"-x\", \"-y\", \"-z\" or three numbers");
}

std::string nameFromAxis(const Vec3& axis) {
    for (int c = 0; c < 3; ++c)
        if (std::abs(axis[c]) > 1 - 1e-6f) return std::string(axis[c] < 0 ? "-" : "") + "xyz"[c];
    return fmt::format("{:.4f},{:.4f},{:.4f}", axis.x, axis.y, axis.z);
}

Mat3 rotationToZUp(const Vec3& up) {
    if (std::max({std::abs(up.x), std::abs(up.y), std::abs(up.z)}) < 1 - 1e-6f) {
        // The shortest turn, about up x Z; a world that hangs upside down is turned over about X first.
        if (up.z < 0)
            return rotationToZUp(Vec3(up.x, -up.y, -up.z)) * Mat3(Vec3(1, 0, 0), Vec3(0, -1, 0), Vec3(0, 0, -1));
        const glm::dvec3 axis(up.y, -up.x, 0);  // its length is the sine
        const double c = up.z, k = 1 / (1 + c);
        return Mat3(glm::dmat3(c + k * axis.x * axis.x, k * axis.x * axis.y, -axis.y, k * axis.x * axis.y,
                               c + k * axis.y * axis.y, axis.x, axis.y, -axis.x, c));
    }
    // Columns: where the file's x, y and z go. One axis stays, so that "right" stays right.
    if (up.y > 0.5f) return Mat3(Vec3(1, 0, 0), Vec3(0, 0, 1), Vec3(0, -1, 0));
    if (up.y < -0.5f) return Mat3(Vec3(1, 0, 0), Vec3(0, 0, -1), Vec3(0, 1, 0));
    if (up.x > 0.5f) return Mat3(Vec3(0, 0, 1), Vec3(0, 1, 0), Vec3(-1, 0, 0));
    if (up.x < -0.5f) return Mat3(Vec3(0, 0, -1), Vec3(0, 1, 0), Vec3(1, 0, 0));
    if (up.z < -0.5f) return Mat3(Vec3(1, 0, 0), Vec3(0, -1, 0), Vec3(0, 0, -1));
    return Mat3(1);
}

int mirrorAxis(const std::string& name) {
    if (name.size() == 1 && name[0] >= 'x' && name[0] <= 'z') return name[0] - 'x';
    throw Error("expected \"x\", \"y\" or \"z\"");
}

void mirrorMesh(int axis, Mesh& mesh, MeshReport& report, std::vector<TexturedFace>& texcoords) {
    for (Vec3& p : mesh.positions) p[axis] = -p[axis];
    for (Vec3& n : mesh.normals) n[axis] = -n[axis];
    for (Triangle& t : mesh.triangles) std::swap(t[1], t[2]);
    for (TexturedFace& face : texcoords) {
        std::swap(face.corners[1], face.corners[2]);
        std::swap(face.texcoords[1], face.texcoords[2]);
    }
    report.origin[axis] = -report.origin[axis];
}

void orientCapture(Capture& capture, const Vec3& up, const CaptureFix& fix) {
    for (const auto& [name, value] : {std::pair{"scale", fix.scale}, std::pair{"mesh scale", fix.meshScale}})
        if (!(value > 0 && value < 1e12)) throw Error("the {} is {}, expected more than 0", name, value);
    capture.up = up;
    capture.metresPerUnit = fix.scale;
    capture.worldFromFile = rotationToZUp(up);
    const bool turned = capture.worldFromFile != Mat3(1);
    Mat3 worldFromMesh = capture.worldFromFile;
    if (!fix.meshUp.empty())
        worldFromMesh = withContext("--mesh-up", [&] { return rotationToZUp(axisFromName(fix.meshUp)); });
    else if (capture.meshReport.yUp && up == Vec3(0, 0, 1)) {
        worldFromMesh = rotationToZUp({0, 1, 0});
        capture.notes.emplace_back(
            "The mesh has Y up, as glTF says, and was turned to the cameras' Z; --mesh-up z leaves it as it is.");
    }
    if (worldFromMesh != Mat3(1)) {
        for (Vec3& p : capture.mesh.positions) p = worldFromMesh * p;
        for (Vec3& n : capture.mesh.normals) n = worldFromMesh * n;
    }
    if (const float grown = float(fix.scale * fix.meshScale); grown != 1)
        for (Vec3& p : capture.mesh.positions) p *= grown;
    capture.readAs.meshScale = fix.meshScale;
    capture.readAs.meshUp = fix.meshUp;
    capture.readAs.flipCameras = fix.flipCameras;
    capture.readAs.mirror = fix.mirror;
    capture.readAs.meshMirror = fix.meshMirror;
    capture.readAs.worldFromMesh = worldFromMesh;
    if (!fix.mirror.empty()) {
        const int axis = withContext("--mirror", [&] { return mirrorAxis(fix.mirror); });
        for (DVec3& p : capture.points) p[axis] = -p[axis];
        for (View& view : capture.views) {
            DMat4& m = view.camera.worldFromCamera;
            m[axis] = -m[axis];
            for (int column = 0; column < 4; ++column) m[column][axis] = -m[column][axis];
        }
    }
    const glm::dmat3 rotation(capture.worldFromFile);
    capture.origin = glm::dmat3(worldFromMesh) * (capture.meshReport.origin * fix.meshScale * fix.scale);
    for (DVec3& p : capture.points) p = rotation * p * fix.scale - capture.origin;
    if (fix.scale != 1)
        for (View& view : capture.views)
            view.camera.worldFromCamera[3] = glm::dvec4(view.camera.position() * fix.scale, 1);
    const DMat4 turn{rotation};
    for (View& view : capture.views) {
        DMat4& m = view.camera.worldFromCamera;
        if (turned) m = turn * m;
        if (fix.flipCameras) {
            m[1] = -m[1];
            m[2] = -m[2];
        }
        m[3] -= glm::dvec4(capture.origin, 0);
    }
}

std::optional<DVec3> guessUp(const std::vector<Camera>& cameras) {
    if (cameras.empty()) return std::nullopt;
    DVec3 mean(0);
    glm::dmat3 spread(0.0);
    for (const Camera& camera : cameras) {
        const DVec3 right(camera.worldFromCamera[0]);
        mean += DVec3(camera.worldFromCamera[1]);
        spread += glm::outerProduct(right, right);
    }
    const double length = glm::length(mean);
    if (!(length > 1e-6 * double(cameras.size()))) return DVec3(0, 0, 1);
    mean /= length;
    // Horizons are level, so up is the direction least present among the right-hand directions: the smallest
    // eigenvector, by inverse iteration from the mean.
    const double trace = spread[0][0] + spread[1][1] + spread[2][2];
    const glm::dmat3 shifted = spread + glm::dmat3(1e-6 * trace);
    DVec3 up = mean;
    for (int i = 0; i < 100; ++i) up = glm::normalize(glm::inverse(shifted) * up);
    const double least = glm::dot(up, spread * up) / trace;
    // The other two must both be there, else the axis is not determined: what is left over after the largest.
    DVec3 most = glm::normalize(glm::cross(up, std::abs(up.x) < 0.9 ? DVec3(1, 0, 0) : DVec3(0, 1, 0)));
    for (int i = 0; i < 100; ++i) most = glm::normalize(spread * most);
    const double middle = 1 - least - glm::dot(most, spread * most) / trace;
    if (!(middle > 0.05) || !(middle > 4 * least) || glm::dot(up, mean) < 0.3) return mean;
    return up;
}

}  // namespace relamp
