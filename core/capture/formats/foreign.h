// What the readers of other programs' camera files share. Each reader gives complete cameras in the file's own world;
// images, mesh and what is up are found here, alike for all of them.
#pragma once
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/json_fields.h"
#include "capture/camera_fault.h"
#include "capture/capture_formats.h"

namespace relamp {

/// One posed photograph as a foreign file names it.
struct ForeignView {
    std::string name;  ///< a path, relative or absolute, or a label without ending
    Camera camera;
};

struct ForeignCameras {
    std::vector<ForeignView> views;
    std::vector<std::string> notes;  ///< what was left out or turned, one sentence each
    std::optional<Vec3> up;          ///< none: the format does not say, the cameras are asked
    std::vector<std::filesystem::path> otherFiles;  ///< what was read beside the cameras' own file
};

/// Where a foreign file's photographs may be.
class ForeignFolder {
public:
    /// `images`: the folder that the user names, or empty.
    ForeignFolder(std::filesystem::path folder, const std::filesystem::path& cameras, const std::string& images);
    const std::filesystem::path& folder() const { return folder_; }
    /// The file of a name: as written, then by its last part alone, in the capture folder's images, the capture folder,
    /// and beside the cameras. Where none is there, the place where it should be, for the error message.
    std::filesystem::path photograph(const std::string& name) const;
    /// The names of all images in the first of these places that holds any, in the order of their bytes.
    std::vector<std::string> photographs() const;
    /// Width and height in pixels, from the image's header. Throws Error naming the file.
    std::pair<int, int> sizeOf(const std::string& name) const;

private:
    std::filesystem::path folder_;
    std::vector<std::filesystem::path> places_;
};

/// A format of another program: a row of captureFormats() is made of one.
struct ForeignReader {
    /// The file or folder that holds the cameras; none: there is none. Looks at names, and at the heads of few files.
    std::optional<std::filesystem::path> (*find)(const std::filesystem::path& folder);
    /// Whether a file of that name may be one of the format's own.
    bool (*owns)(const std::string& fileName);
    /// Throws Error naming the field, without the name of `cameras`.
    ForeignCameras (*parse)(const std::filesystem::path& cameras, const ForeignFolder& around, Progress& progress);
};

/// Cameras by `reader`, with their photographs, the mesh and what is up. Views are in the order of their names. Throws
/// Error naming file and field.
CaptureSource sourceFromForeign(const ForeignReader& reader, const std::filesystem::path& folder,
                                const std::filesystem::path& cameras, const CaptureFix& fix, Progress& progress);

// ---- finding

/// A file in `folder` that ends in `ending` and whose first 4 KiB please `isHead`: one of `names` if it does, else the
/// first in alphabetical order. At most 64 heads are read.
std::optional<std::filesystem::path> findByHead(const std::filesystem::path& folder, std::span<const char* const> names,
                                                std::string_view ending, bool (*isHead)(std::string_view head));
/// The first bytes of a file; empty when it cannot be read.
std::string headOf(const std::filesystem::path& file, size_t bytes = 4096);

// ---- cameras

constexpr size_t foreignFileBytes = size_t(64) << 20;  ///< largest camera file
constexpr size_t foreignViews = 100'000;               ///< most views of one

/// worldFromCamera in OpenGL's axes, from the camera's axes in the world (columns: right, down, ahead) and its
/// position. Throws Error "FIELD: is not rigid ..." for anything but a rotation.
DMat4 poseFromAxes(const glm::dmat3& rightDownAhead, const DVec3& position, const std::string& field);
/// The same for columns right, up, back: OpenGL's axes.
DMat4 poseFromOpenGl(const glm::dmat3& rightUpBack, const DVec3& position, const std::string& field);
/// The rotation of a quaternion w x y z of any length. Throws Error for one without length.
glm::dmat3 rotationFromQuaternion(double w, double x, double y, double z, const std::string& field);

/// The lens that Metashape, RealityCapture, OpenMVG and Meshroom share: a radial polynomial up to r^8, tangential terms
/// in OpenCV's order, skew in units of focalX.
struct BrownLens {
    double k1 = 0, k2 = 0, k3 = 0, k4 = 0, p1 = 0, p2 = 0, skew = 0;
};
/// Sets model and distortion: the simplest model that holds the lens exactly.
void setLens(Camera& camera, const BrownLens& lens);

/// Width and height of a camera; throws Error unless both are 1 to 131072.
void setSize(Camera& camera, double width, double height);
/// Throws Error when focal lengths, principal point or distortion cannot be a camera's.
void checkIntrinsics(const Camera& camera, const IntrinsicNames& names);

// ---- numbers

/// A finite number of at most 1e12. Throws Error "FIELD: ..." for other words.
double numberFrom(std::string_view word, const std::string& field);
/// Exactly `count` numbers with spaces between.
std::vector<double> numbersFrom(std::string_view text, size_t count, const std::string& field);
/// A JSON number, or text that is one.
double looseNumber(const Json& value, const std::string& field);
/// A JSON list of exactly `count` numbers, or texts that are numbers.
std::vector<double> looseNumbers(const Json& value, size_t count, const std::string& field);
/// "3 of 40 cameras have no pose and are left out."; nothing for 0.
void noteLeftOut(std::vector<std::string>& notes, size_t count, size_t all, const char* why);

}  // namespace relamp
