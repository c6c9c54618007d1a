// The smallest capture: a mesh and one grey photograph.
#pragma once
#include <filesystem>
#include <nlohmann/json.hpp>

#include "image/image_io.h"
#include "scene/mesh_io.h"
#include "support/temporary_folder.h"

namespace relamp::test {

/// Writes it to folder/capture: 16 x 12 pixels, seen from two metres above.
inline void writeOneViewCapture(TemporaryFolder& folder, const Mesh& mesh) {
    std::filesystem::create_directories(folder / "capture/images");
    writeVertexPly(folder / "capture/mesh.ply", mesh, {});
    writeImage(folder / "capture/images/0.exr", Image(16, 12, Rgb(0.5f)));
    const nlohmann::json frame{{"file_path", "images/0.exr"},
                               {"transform_matrix", {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 2}, {0, 0, 0, 1}}}};
    const nlohmann::json cameras{{"w", 16}, {"h", 12}, {"fl_x", 12}, {"mesh_path", "mesh.ply"}, {"frames", {frame}}};
    folder.write("capture/transforms.json", cameras.dump());
}

}  // namespace relamp::test
