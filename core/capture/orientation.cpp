#include "capture/orientation.h"

#include "base/error.h"

namespace relamp {

Vec3 axisFromName(const std::string& name) {
    const bool sign = !name.empty() && (name[0] == '-' || name[0] == '+');
    const std::string axis = name.substr(sign);
    const float length = sign && name[0] == '-' ? -1.0f : 1.0f;
    if (axis == "x" || axis == "X") return {length, 0, 0};
    if (axis == "y" || axis == "Y") return {0, length, 0};
    if (axis == "z" || axis == "Z") return {0, 0, length};
    throw Error("expected \"x\", \"y\", \"z\", \"-x\", \"-y\" or \"-z\"");
}

Mat3 rotationToZUp(const Vec3& up) {
    // Columns: where the file's x, y and z go. One axis stays, so that "right" stays right.
    if (up.y > 0.5f) return Mat3(Vec3(1, 0, 0), Vec3(0, 0, 1), Vec3(0, -1, 0));
    if (up.y < -0.5f) return Mat3(Vec3(1, 0, 0), Vec3(0, 0, -1), Vec3(0, 1, 0));
    if (up.x > 0.5f) return Mat3(Vec3(0, 0, 1), Vec3(0, 1, 0), Vec3(-1, 0, 0));
    if (up.x < -0.5f) return Mat3(Vec3(0, 0, -1), Vec3(0, 1, 0), Vec3(1, 0, 0));
    if (up.z < -0.5f) return Mat3(Vec3(1, 0, 0), Vec3(0, -1, 0), Vec3(0, 0, -1));
    return Mat3(1);
}

void orientCapture(Capture& capture, const Vec3& up, bool flipCameras) {
    capture.up = up;
    capture.worldFromFile = rotationToZUp(up);
    const bool turned = capture.worldFromFile != Mat3(1);
    if (turned) {
        for (Vec3& p : capture.mesh.positions) p = capture.worldFromFile * p;
        for (Vec3& n : capture.mesh.normals) n = capture.worldFromFile * n;
    }
    const DMat4 turn{glm::dmat3(capture.worldFromFile)};
    for (View& view : capture.views) {
        DMat4& m = view.camera.worldFromCamera;
        if (turned) m = turn * m;
        if (flipCameras) {
            m[1] = -m[1];
            m[2] = -m[2];
        }
    }
}

}  // namespace relamp
