// A plate relit: frames of a tracked, moving camera, with what the capture does not hold kept out by a matte.
#pragma once
#include <map>
#include <memory>

#include "plate/matte_light.h"
#include "plate/plate_camera.h"
#include "plate/plate_light.h"
#include "plate/plate_match.h"
#include "relight/plate_look.h"
#include "shot/relit_looks.h"

namespace relamp {

struct PlateRequest {
    std::filesystem::path plate, cameras;  ///< plate.####.exr; see readPlateCameras
    PlateCameraOptions track{};
    PlateCurve curve = PlateCurve::automatic;
    PlateMatching match = PlateMatching::automatic;
    std::filesystem::path matte{};  ///< matte.####.exr, white where the plate is held out; empty: nowhere
    bool relightMatte = false;      ///< by the light at its place (matte_light.h); false: it stays as it is
    Ratio ratio = Ratio::quotient;
    int neighbours = 3;  ///< frames before and after that steady a frame's light
    PlateUnsure unsure = PlateUnsure::model;
};

/// Samples a pixel unless others are asked for: neighbouring frames make up for fewer than a still needs.
inline constexpr int defaultPlateSamples = 4;

/// A look's plate as a request. Throws Error for a curve or matching of another name.
PlateRequest plateRequest(const PlateLook& look);

struct PlateFrame {
    int number = 1;
    std::filesystem::path file, matte;  ///< matte empty: nothing is held out
    Camera camera;
};

struct Plate {
    std::vector<PlateFrame> frames;   ///< by number: those with a plate and a camera
    int first = 1, last = 0;          ///< numbers of its files, those that cannot be used among them
    std::vector<std::string> faults;  ///< frames that lack something and are not there, one sentence each
    std::vector<std::string> notes;   ///< what was assumed or looks odd, one sentence each
};

/// Finds files and cameras. The plate's size is that of most of 24 frames spread over it. Throws Error when there is no
/// plate that can be read or no camera at all, BadOption for patterns and orders that cannot be meant.
Plate openPlate(const Capture& capture, const PlateRequest& request, Progress& progress);

/// A relit frame and what it took.
struct RelitPlate {
    Image image;  ///< linear, in the plate's own scale; where the matte is white the plate itself, bit for bit
    float saturation = 0;
    Rgb gain{1};  ///< plate / capture
    std::optional<MatteLight> matteLight;
    float covered = 1;  ///< fraction of the frame in which the camera sees the capture's surfaces
};

/// Relights frames in order. As captured each is rendered once and kept while a neighbour wants it; under a look once
/// as long as it lasts. Keeps references to all that it is given.
class PlateRelighter {
public:
    /// Matches the plate's colours over the whole plate. `looks` gives the scene of each frame.
    PlateRelighter(const Plate& plate, const PlateRequest& request, RelitLooks& looks, const FrameOptions& options,
                   Progress& progress);
    /// With gains that were matched before, of the same plate, request and estimate.
    PlateRelighter(const Plate& plate, const PlateRequest& request, RelitLooks& looks, const FrameOptions& options,
                   PlateGains gains)
        : plate_(plate), request_(request), looks_(looks), options_(options), gains_(std::move(gains)) {}
    const PlateGains& gains() const { return gains_; }

    /// Frame `index` of the plate, the same bits whichever frames came before. Cost beyond the first: two frames of
    /// beauty alone; one with its groups where the edit changes powers and colours alone; and where the look changes
    /// from frame to frame in another way, one and as many more as steady it. Memory: 30 bytes a pixel for it and each
    /// neighbour, 12 more for each light whose power changes, and about 60. Throws Error naming a file that cannot be
    /// read or has another size, OutOfResources, Cancelled.
    RelitPlate relit(size_t index, Progress& progress);

private:
    const Plate& plate_;
    const PlateRequest& request_;
    RelitLooks& looks_;
    FrameOptions options_;
    PlateGains gains_;
    struct HeldLight {
        Look look;
        PlateLight light;
    };
    std::map<size_t, std::shared_ptr<const PlateGround>> grounds_;
    std::map<size_t, HeldLight> lights_;  ///< of frame n under the look last asked for

    std::set<int> tried_;  ///< numbers that were matched one by one

    PlateMatchOptions matching() const;
    PlateKey keyOf(const PlateFrame& frame, Progress& progress) const;
    /// The frame's own gain, where gains follow the frames.
    void matchFrame(size_t index, Progress& progress);
    std::pair<size_t, size_t> around(size_t index) const;
    /// The light groups of frame `index` that the looks of its neighbours change alone. They go by no other frame, so
    /// that a frame has the same bits whichever came before.
    std::set<int> groupsOf(size_t index, const RelitScene& captured) const;
    void findLights(size_t first, size_t last, size_t index, const Look& look, Progress& progress);
    /// At the place, or, where that lies inside one of the capture's objects, a little nearer to the camera; none where
    /// no light arrives there either.
    std::optional<MatteLight> lightAt(const MattePlace& place, const RelitScene& captured, const RelitScene& look,
                                      const Camera& camera) const;
    Image read(const PlateFrame& frame, float& saturation, Progress& progress) const;
};

/// The light at a matte's place as JSON: frame, place, directions and their irradiance before and after.
std::string matteLightJson(int frame, const MatteLight& light, const DVec3& origin);

}  // namespace relamp
