// The known world, from whose mesh its emitter is taken and whose pixels on the emitter are unusable: its light is all
// that is left of it.
#pragma once
#include <limits>

#include "support/known_world.h"

namespace relamp::test {

/// Of a capture that paintKnownWorld has written with its emitter, in so many lighting states.
inline void hideEmitter(const std::filesystem::path& folder, KnownWorld& world, size_t states = 1) {
    Mesh mesh = world.mesh;
    mesh.triangles.resize(world.emitterTriangles.front());
    mesh.positions.resize(world.ballEnd);
    mesh.normals.resize(world.ballEnd);
    writeVertexPly(folder / "mesh.ply", mesh, {});
    world.albedo.resize(world.ballEnd);
    for (int i = 0; i < world.views * int(states); ++i) {
        const std::filesystem::path file = folder / fmt::format("images/{:02}.exr", i);
        Image image = readImage(file);
        // The back of the emitter is black, and so are no other pixels.
        for (Rgb& p : image.pixels)
            if (maxChannel(p) > 15 || maxChannel(p) == 0) p = Rgb(std::numeric_limits<float>::quiet_NaN());
        writeImage(file, image);
    }
}

}  // namespace relamp::test
