// How steady a relit plate is: the same surface points in neighbouring frames, in the plate, in the relit plate, and in
// the factor between them; and whether what a matte holds out is the plate, bit for bit.
//   plate_flicker mattes FOLDER WIDTH HEIGHT FRAMES     writes matte.####.exr: a soft disc that crosses the frame
//   plate_flicker SHOT CAMERAS PLATE RELIT MATTE|- [MAP.exr]
//       patterns with ####; MAP: where the factor differs, in each frame's place the largest of all pairs
#include <cstdio>

#include "base/statistics.h"
#include "image/image_io.h"
#include "plate/plate_sequence.h"
#include "scene/scene.h"
#include "shot/frame_jobs.h"
#include "shot/shot_file.h"

namespace relamp::bench {
namespace {

void writeMattes(const std::filesystem::path& folder, int width, int height, int frames) {
    for (int f = 1; f <= frames; ++f) {
        Image matte(width, height);
        const Vec2 middle(float(width) * (0.2f + 0.6f * float(f) / float(frames)), 0.6f * float(height));
        const float radius = 0.18f * float(height);
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x) {
                const float inside = radius - glm::distance(Vec2(float(x), float(y)), middle);
                matte.at(x, y) = Rgb(std::clamp(inside / 6, 0.0f, 1.0f));
            }
        writeImage(folder / fmt::format("matte.{:04}.exr", f), matte);
    }
}

constexpr int sparse = 6;  ///< pixels from one point to the next

struct Moment {
    Camera camera;
    Image plate, relit, matte;
};

Rgb sampled(const Image& image, const Vec2& pixel) {
    const Vec2 p = pixel - 0.5f;
    const int x = std::clamp(int(std::floor(p.x)), 0, image.width - 2);
    const int y = std::clamp(int(std::floor(p.y)), 0, image.height - 2);
    const Vec2 t = glm::clamp(p - Vec2(float(x), float(y)), Vec2(0), Vec2(1));
    return glm::mix(glm::mix(image.at(x, y), image.at(x + 1, y), t.x),
                    glm::mix(image.at(x, y + 1), image.at(x + 1, y + 1), t.x), t.y);
}

/// Of relative differences between frames.
struct Differences {
    std::vector<double> all;
    void add(double a, double b) { all.push_back(std::abs(a - b) / (0.5 * (a + b))); }
    void print(const char* what) const {
        double squares = 0;
        for (const double d : all) squares += d * d;
        const double most = quantileOf(all, 0.99);
        double common = 0, count = 0;
        for (const double d : all)
            if (d <= most) common += d * d, ++count;
        std::printf("%s: RMS %.3f %% (%.3f %% without the largest hundredth), median %.3f %%\n", what,
                    100 * std::sqrt(squares / double(all.size())), 100 * std::sqrt(common / count),
                    100 * quantileOf(all, 0.5));
    }
};

/// Points that both cameras see, away from edges of depth and from lights. Beside creases a pixel shows two surfaces in
/// parts that depend on where it lies; the true factor between two renderings changes there from frame to frame, too.
void compare(const Scene& scene, const std::vector<bool>& shines, const Moment& a, const Moment& b, Differences& plate,
             Differences& relit, Differences& factor, Differences& smooth, Image& map) {
    const auto hitAt = [&](const Camera& camera, const Vec2& pixel) {
        return scene.cameraTracer->closest({Vec3(camera.position()), camera.rayDirection(pixel), 0, 1e30f});
    };
    for (int y = 4; y < a.camera.height - 4; y += sparse)
        for (int x = 4; x < a.camera.width - 4; x += sparse) {
            const Vec2 pixel(float(x) + 0.5f, float(y) + 0.5f);
            const Hit hit = hitAt(a.camera, pixel);
            if (!hit || shines[hit.triangle]) continue;
            bool edge = false, crease = false;
            for (const Vec2& step : {Vec2(3, 0), Vec2(-3, 0), Vec2(0, 3), Vec2(0, -3)}) {
                const Hit near = hitAt(a.camera, pixel + step);
                edge = edge || !near || std::abs(near.distance - hit.distance) > 0.02f * hit.distance ||
                       shines[near.triangle];
                crease = crease || (near && glm::dot(scene.normalOf(near), scene.normalOf(hit)) < 0.85f);
            }
            if (edge) continue;
            const Vec3 place = Vec3(a.camera.position()) + hit.distance * a.camera.rayDirection(pixel);
            const auto there = b.camera.project(DVec3(place));
            if (!there || there->x < 4 || there->y < 4 || there->x > float(b.camera.width) - 4 ||
                there->y > float(b.camera.height) - 4)
                continue;
            const Hit again = hitAt(b.camera, *there);
            if (!again ||
                std::abs(again.distance - glm::distance(Vec3(b.camera.position()), place)) > 0.005f * again.distance)
                continue;
            if (a.matte.width > 0 && (sampled(a.matte, pixel).y > 0 || sampled(b.matte, *there).y > 0)) continue;
            const auto level = [](const Image& image, const Vec2& at) { return double(luminance(sampled(image, at))); };
            const double p = level(a.plate, pixel), q = level(b.plate, *there);
            const double r = level(a.relit, pixel), s = level(b.relit, *there);
            if (!(p > 0) || !(q > 0) || !(r > 0) || !(s > 0)) continue;
            plate.add(p, q);
            relit.add(r, s);
            factor.add(r / p, s / q);
            if (!crease) smooth.add(r / p, s / q);
            float& most = map.at(x / sparse, y / sparse).x;
            most = std::max(most, float(factor.all.back()));
        }
}

int run(const std::vector<std::string>& a) {
    if (a.size() == 5 && a[0] == "mattes") {
        writeMattes(a[1], std::stoi(a[2]), std::stoi(a[3]), std::stoi(a[4]));
        return 0;
    }
    if (a.size() < 5 || a.size() > 6) return 2;
    Progress progress;
    const Shot shot = openShot(a[0], false, progress);
    const Scene scene = buildScene(shot.capture.mesh, progress);
    std::vector<bool> shines(scene.mesh.triangles.size(), false);
    for (const EmitterCluster& e : shot.estimate.emitters.emitters)
        for (const uint32_t t : e.triangles) shines[t] = true;
    const PlateFiles plates = plateFiles(a[2], "plate"), relits = plateFiles(a[3], "relit");
    PlateFiles mattes;
    if (a[4] != "-") mattes = plateFiles(a[4], "matte");
    const auto jobs = frameJobs(shot.capture, a[1], "", "", "frame.####.exr");
    Differences plate, relit, factor, smooth;
    std::optional<Moment> before;
    size_t held = 0, wrong = 0;
    Image map;
    for (const FrameJob& job : jobs) {
        if (!plates.contains(job.number) || !relits.contains(job.number)) continue;
        Moment now{job.camera, readImage(plates.at(job.number)), readImage(relits.at(job.number)), {}};
        if (!mattes.empty()) now.matte = readImage(mattes.at(job.number));
        for (size_t p = 0; p < now.matte.pixels.size(); ++p)
            if (now.matte.pixels[p].y >= 1) ++held, wrong += now.plate.pixels[p] != now.relit.pixels[p];
        if (!before) map = Image(now.camera.width / sparse + 1, now.camera.height / sparse + 1);
        else compare(scene, shines, *before, now, plate, relit, factor, smooth, map);
        before = std::move(now);
    }
    std::printf("%zu pairs of points; held out: %zu pixels, %zu of them changed\n", factor.all.size(), held, wrong);
    plate.print("plate");
    relit.print("relit");
    factor.print("factor");
    smooth.print("factor away from creases");
    if (a.size() == 6) writeImage(a[5], map);
    return 0;
}

}  // namespace
}  // namespace relamp::bench

int main(int argc, char** argv) { return relamp::bench::run({argv + 1, argv + argc}); }
