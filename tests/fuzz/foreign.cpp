// The readers of other programs' cameras: whatever they accept is a camera that can be used.
#include "capture/formats/readers.h"
#include "fuzz/target.h"
#include "image/image_io.h"

namespace relamp::fuzz {
namespace {

/// Reads FOLDER/cameras beside a mesh and an image of 8 x 6 pixels called a.png.
void read(const ForeignReader& reader, const std::string& name, const std::string& cameras) {
    const std::filesystem::path place = folder() / name;
    if (!std::filesystem::exists(place / "a.png")) {
        fileWith(name + "/mesh.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
        writeImage(place / "a.png", Image(8, 6, Rgb(0.5f)));
    }
    reader.find(place);
    Progress progress;
    const CaptureSource source = sourceFromForeign(reader, place, place / cameras, {}, progress);
    for (const FrameSource& frame : source.frames) {
        const Camera& c = frame.camera;
        if (c.width < 1 || c.height < 1 || !(c.focalX > 0) || !(c.focalY > 0) || !std::isfinite(c.centreX + c.centreY))
            throw std::logic_error("intrinsics that are none");
        const glm::dmat3 rotation(c.worldFromCamera);
        const glm::dmat3 off = glm::transpose(rotation) * rotation - glm::dmat3(1.0);
        for (int i = 0; i < 3; ++i)
            if (!(glm::length(off[i]) < 1e-9) || !std::isfinite(c.position()[i]))
                throw std::logic_error("a pose that is no rotation and translation");
        c.project(c.position() + c.forward());
        c.rayDirection({1, 2});
    }
}

template <const ForeignReader& reader>
void one(std::string_view bytes, const char* name, const char* file) {
    fileWith(std::string(name) + "/" + file, bytes);
    read(reader, name, file);
}

const Target metashape("metashape", [](std::string_view b) { one<metashapeReader>(b, "metashape", "cameras.xml"); });
const Target meshroom("meshroom", [](std::string_view b) { one<meshroomReader>(b, "meshroom", "cameras.sfm"); });
const Target reality("reality-capture",
                     [](std::string_view b) { one<realityCaptureReader>(b, "reality", "cameras.csv"); });
const Target openMvg("open-mvg", [](std::string_view b) { one<openMvgReader>(b, "open-mvg", "sfm_data.json"); });
const Target nvm("nvm", [](std::string_view b) { one<nvmReader>(b, "nvm", "scan.nvm"); });
const Target llff("llff", [](std::string_view b) { one<llffReader>(b, "llff", "poses_bounds.npy"); });
const Target record3d("record3d", [](std::string_view b) { one<record3dReader>(b, "record3d", "metadata.json"); });
const Target bundler("bundler", [](std::string_view bytes) {
    fileWith("bundler/list.txt", part(bytes, 1));
    one<bundlerReader>(part(bytes, 0), "bundler", "bundle.out");
});
const Target polycam("polycam", [](std::string_view bytes) {
    fileWith("polycam/keyframes/cameras/a.json", part(bytes, 0));
    if (const std::string_view info = part(bytes, 1); !info.empty()) fileWith("polycam/mesh_info.json", info);
    else std::filesystem::remove(folder() / "polycam/mesh_info.json");
    read(polycamReader, "polycam", "keyframes/cameras");
});
/// Two frames, of which one has a photograph.
const Target scannerApp("scanner-app", [](std::string_view bytes) {
    static const bool there = [] {
        std::filesystem::create_directories(folder() / "scanner");
        writeImage(folder() / "scanner/frame_00001.jpg", Image(8, 6, Rgb(0.5f)));
        return true;
    }();
    fileWith("scanner/frame_00000.json", part(bytes, there ? 0 : 1));
    fileWith("scanner/frame_00001.json", part(bytes, 1));
    read(scannerAppReader, "scanner", "frame_00000.json");
});

}  // namespace
}  // namespace relamp::fuzz
