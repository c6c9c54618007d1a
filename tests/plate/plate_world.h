// What tests of plates share: a small scene with a plate of it, and the relighting of that plate.
#pragma once
#include <cmath>
#include <string>
#include <vector>

#include "image/image_io.h"
#include "plate/relight_plate.h"
#include "support/estimates.h"
#include "support/shapes.h"
#include "support/temporary_folder.h"

namespace relamp::test {

/// A table and a ball under a square emitter and a grey sky, and a camera that moves past them.
struct PlateWorld {
    Shot shot;
    Scene scene;
    std::vector<Camera> cameras;
    explicit PlateWorld(int frames = 5) {
        Mesh mesh = sheet({-2, -2, 0}, {4, 0, 0}, {0, 4, 0}, 24, 24);
        append(mesh, ball({0.3f, 0.2f, 0.3f}, 0.3f, 16, 24));
        const std::vector<uint32_t> emitter = append(mesh, squareAbove(0.4f, -0.5f, 0.2f, 1.2f));
        scene = sceneOf(mesh);
        shot.capture.mesh = mesh;
        shot.capture.views.resize(1);
        shot.estimate =
            matteEstimate(scene, Rgb(0.5f, 0.4f, 0.3f), Rgb(0.3f), emittersOf(scene, {emitter}, {Rgb(8, 7, 6)}));
        for (int i = 0; i < frames; ++i)
            cameras.push_back(cameraAt({-1 + 0.02 * i, -3, 1.6}, {0.02 * i, 0, 0.2}, 64, 48, 70));
    }
    static Look dimmed() {
        Look look;
        EmitterLook emitter;
        emitter.id = "emitter-1";
        emitter.powerScale = Rgb(0.25f, 0.5f, 1);
        look.emitters.push_back(emitter);
        return look;
    }
    RelitScene relit(const Look& look) const { return relitOf(scene, shot.estimate, look); }

    /// Writes plate.####.exr from 1001 on, each frame times its gain, and the track.
    PlateRequest writePlate(const TemporaryFolder& folder, const std::vector<Rgb>& gains = {}, int samples = 16) const {
        Progress progress;
        const RelitScene captured = relit({});
        std::string frames;
        FrameOptions options;
        options.samplesPerPixel = samples;
        for (size_t i = 0; i < cameras.size(); ++i) {
            const Frame frame = renderFrame(captured, cameras[i], options, progress);
            Image image(frame.width, frame.height);
            image.pixels = frame.beauty;
            if (!gains.empty())
                for (Rgb& p : image.pixels) p *= gains[i];
            image.pixels[5] = Rgb(-0.01f, 0.2f, 0.1f);  // lens corrections leave such values
            writeImage(folder / fmt::format("plate.{}.exr", 1001 + i), image);
            std::string rows;
            for (int r = 0; r < 4; ++r) {
                const DMat4& m = cameras[i].worldFromCamera;
                rows += fmt::format("{}[{},{},{},{}]", r ? "," : "", m[0][r], m[1][r], m[2][r], m[3][r]);
            }
            frames += fmt::format("{}{{\"file_path\": \"plate.{}.exr\", \"transform_matrix\": [{}]}}", i ? "," : "",
                                  1001 + i, rows);
        }
        folder.write("track.json", "{\"w\": 64, \"h\": 48, \"fl_x\": 70, \"frames\": [" + frames + "]}");
        PlateRequest request;
        request.plate = folder / "plate.####.exr";
        request.cameras = folder / "track.json";
        return request;
    }
};

inline double rootMeanSquare(const std::vector<double>& values) {
    double sum = 0;
    for (double v : values) sum += v * v;
    return std::sqrt(sum / double(values.size()));
}

struct Relighting {
    Plate plate;
    LookTrack track;
    RelitLooks looks;
    FrameOptions options;
    Progress progress;
    PlateRelighter relighter;
    Relighting(const PlateWorld& world, const PlateRequest& request, const Look& look,
               int samples = FrameOptions{}.samplesPerPixel)
        : plate(openPlate(world.shot.capture, request, progress)),
          track(look),
          looks(world.shot, world.scene, track),
          relighter(plate, request, looks, denoised(samples), progress) {}
    const FrameOptions& denoised(int samples) {
        options.denoise = true;
        options.samplesPerPixel = samples;
        return options;
    }
};

}  // namespace relamp::test
