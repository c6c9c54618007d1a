// The readers of files that people bring: captures, meshes, COLMAP models, images, measured reflectance.
#include "brdf/merl.h"
#include "capture/colmap.h"
#include "capture/load_capture.h"
#include "capture/mesh_colours.h"
#include "capture/orientation.h"
#include "capture/transforms_json.h"
#include "fuzz/target.h"
#include "image/environment_map.h"
#include "image/image_io.h"
#include "plate/plate_camera.h"
#include "relight/ies_profile.h"
#include "scan/scan_calibration.h"
#include "scene/mesh_io.h"
#include "scene/texcoords.h"

namespace relamp::fuzz {
namespace {

std::pair<int, int> someSize(const std::string&) { return {640, 480}; }

const Target transforms("transforms", [](std::string_view bytes) { parseTransforms(std::string(bytes), someSize); });
const Target camera("camera", [](std::string_view bytes) { readCameraFile(fileWith("camera.json", bytes)); });
const Target scanCameras("scan-cameras",
                         [](std::string_view bytes) { readScanCalibration(fileWith("cameras.json", bytes)); });

template <int kind>
void mesh(std::string_view bytes) {
    constexpr const char* names[] = {"mesh.ply", "mesh.obj", "mesh.off", "mesh.stl", "mesh.om", "mesh.glb"};
    MeshReport report;
    std::vector<TexturedFace> faces;
    MeshPaint paint;
    const Mesh read = readMesh(fileWith(names[kind], bytes), &report, {}, &faces, &paint);
    texcoordsOf(faces, read.triangles);
    for (const TexturedFace& face : faces)
        if (face.image < -1 || face.image >= int(paint.images.size()))
            throw std::logic_error("a face names an image that is not there");
    if (!paint.colours.empty() && paint.colours.size() != read.vertexCount())
        throw std::logic_error("there are more or fewer colours than vertices");
    for (const Triangle& t : read.triangles)
        for (const uint32_t v : t)
            if (v >= read.vertexCount()) throw std::logic_error("a triangle names a vertex that is not there");
    for (const Vec3& p : read.positions)
        if (!std::isfinite(p.x + p.y + p.z)) throw std::logic_error("a position that is no number");
}
const Target ply("mesh-ply", mesh<0>), obj("mesh-obj", mesh<1>), off("mesh-off", mesh<2>), stl("mesh-stl", mesh<3>),
    om("mesh-om", mesh<4>), gltf("mesh-gltf", mesh<5>);
/// The materials of a square, whatever they say.
const Target mtl("mesh-mtl", [](std::string_view bytes) {
    fileWith("square.mtl", bytes);
    const auto square = fileWith("square.obj",
                                 "mtllib square.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nvt 0 0\nvt 1 0\nvt 1 1\n"
                                 "usemtl print\nf 1/1 2/2 3/3\n");
    Capture capture;
    std::vector<TexturedFace> faces;
    MeshPaint paint;
    capture.mesh = readMesh(square, nullptr, {}, &faces, &paint);
    filesBesideMesh(square);
    capture.texcoords = std::make_shared<const std::vector<TexturedFace>>(faces);
    capture.paint = std::make_shared<const MeshPaint>(paint);
    Progress progress;
    if (meshColours(capture, progress).painted.size() > capture.mesh.vertexCount())
        throw std::logic_error("more vertices are painted than there are");
});
const Target vertexPly("vertex-ply", [](std::string_view bytes) { readVertexPly(fileWith("vertices.ply", bytes)); });

const Target ies("ies", [](std::string_view bytes) {
    const IesProfile profile = iesFromText(std::string(bytes));
    for (const Vec3& d : {Vec3(0, 0, -1), Vec3(0, 0, 1), Vec3(1, 0, 0), Vec3(-0.6f, 0, -0.8f), Vec3(0, -0.8f, 0.6f)})
        if (const float value = profile.at(d); !(value >= 0 && value <= 1.0001f))
            throw std::logic_error("an intensity that is no fraction of the largest");
});

/// cameras, images and points3D, one after the other.
void colmap(std::string_view bytes, const char* ending) {
    const char* names[] = {"cameras", "images", "points3D"};
    for (size_t i = 0; i < 3; ++i)
        fileWith(std::string("model-") + ending + "/" + names[i] + "." + ending, part(bytes, i));
    Progress progress;
    const ColmapModel model = readColmapModel(folder() / (std::string("model-") + ending), {}, progress);
    std::vector<Camera> cameras;
    for (const ColmapView& view : model.views) cameras.push_back(view.camera);
    guessUp(cameras);
}
const Target colmapText("colmap-text", [](std::string_view bytes) { colmap(bytes, "txt"); });
const Target colmapBinary("colmap-binary", [](std::string_view bytes) { colmap(bytes, "bin"); });

template <int kind>
void image(std::string_view bytes) {
    constexpr const char* names[] = {"a.exr", "a.hdr", "a.jpg", "a.png", "a.tif", "a.dpx"};
    const std::filesystem::path file = fileWith(names[kind], bytes);
    constexpr size_t mostPixels = size_t(1) << 14;  // larger ones cost time and show nothing new
    const auto tolerant = [](auto&& part) {
        try {
            part();
        } catch (const Error&) {}
    };
    tolerant([&] { readImageSize(file); });
    tolerant([&] { readExposureTags(file); });
    tolerant([&] { readCodes(file, mostPixels); });
    ImageReport report;
    const Image image = readImage(file, &report, false, mostPixels);
    if (image.pixels.size() != size_t(image.width) * size_t(image.height)) throw std::logic_error("pixels are missing");
    for (const Rgb& p : image.pixels)
        if (!isFinite(p)) throw std::logic_error("a pixel that is no number");
}
const Target exr("image-exr", image<0>), hdr("image-hdr", image<1>), jpeg("image-jpeg", image<2>),
    png("image-png", image<3>), tiff("image-tiff", image<4>), dpx("image-dpx", image<5>);

/// A file of the right size with the bytes at its beginning and end: the whole would be 35 MB.
const Target merl("merl", [](std::string_view bytes) {
    constexpr size_t whole = 12 + 8 * 3 * size_t(90) * 90 * 180;
    const std::filesystem::path file = fileWith("m.binary", bytes);
    if (!bytes.empty() && bytes[0] == char(90)) std::filesystem::resize_file(file, whole);  // the rest reads as zeros
    readMerl(file);
});

template <int kind>
void track(std::string_view bytes) {
    const std::filesystem::path file = fileWith(kind ? "track.usda" : "track.chan", bytes);
    const CameraTrack track = kind ? readUsdCamera(file, "") : readChan(file, "ZXY");
    for (const auto& [frame, tracked] : track.byFrame)
        for (int c = 0; c < 4; ++c)
            for (int r = 0; r < 4; ++r)
                if (!std::isfinite(tracked.worldFromCamera[c][r])) throw std::logic_error("a pose that is no number");
}
const Target chan("chan", track<0>), usda("usda", track<1>);

/// A whole capture: what the files say together.
const Target capture("capture", [](std::string_view bytes) {
    fileWith("capture/transforms.json", part(bytes, 0));
    fileWith("capture/mesh.obj", part(bytes, 1));
    static const bool painted = [] {
        writeImage(folder() / "capture/a.png", Image(8, 6, Rgb(0.5f)));
        writeImage(folder() / "capture/b.png", Image(8, 6, Rgb(0.2f)));
        return true;
    }();
    LoadOptions options;
    options.images = painted;
    options.maxPixels = 1 << 16;
    Progress progress;
    loadCapture(folder() / "capture", options, progress);
});

}  // namespace
}  // namespace relamp::fuzz
