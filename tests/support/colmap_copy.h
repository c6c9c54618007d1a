// A capture with transforms.json as a COLMAP text model of the same cameras.
#pragma once
#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "base/math.h"
#include "support/temporary_folder.h"

namespace relamp::test {

/// Writes cameras.txt and images.txt into `model`, a folder inside `capture`, and removes transforms.json.
inline void makeColmap(const std::filesystem::path& capture, const std::string& model) {
    const nlohmann::json file = nlohmann::json::parse(TemporaryFolder::read(capture / "transforms.json"));
    std::string images;
    for (size_t i = 0; i < file["frames"].size(); ++i) {
        const nlohmann::json& m = file["frames"][i]["transform_matrix"];
        const auto at = [&](size_t r, size_t c) { return m[r][c].get<double>(); };
        // cameraFromWorld with y and z turned about: rows are right, down, ahead.
        glm::dmat3 r;
        DVec3 t(0);
        for (int row = 0; row < 3; ++row)
            for (int c = 0; c < 3; ++c) {
                r[c][row] = (row == 0 ? 1 : -1) * at(size_t(c), size_t(row));
                t[row] -= r[c][row] * at(size_t(c), 3);
            }
        const double w = std::sqrt(std::max(0.0, 1 + r[0][0] + r[1][1] + r[2][2])) / 2;
        if (w < 1e-3) throw std::runtime_error("a camera that this quaternion cannot hold");
        images +=
            fmt::format("{} {:.17g} {:.17g} {:.17g} {:.17g} {:.17g} {:.17g} {:.17g} 4 {}\r\n\r\n", 90 - 7 * i, w,
                        (r[1][2] - r[2][1]) / (4 * w), (r[2][0] - r[0][2]) / (4 * w), (r[0][1] - r[1][0]) / (4 * w),
                        t.x, t.y, t.z, file["frames"][i]["file_path"].get<std::string>());
    }
    std::filesystem::create_directories(capture / model);
    std::ofstream(capture / model / "cameras.txt") << "4 PINHOLE 96 72 95 95 48 36\r\n";
    std::ofstream(capture / model / "images.txt") << images;
    std::filesystem::remove(capture / "transforms.json");
}

}  // namespace relamp::test
