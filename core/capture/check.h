// The import doctor: figures about a capture that tell before a solve what is wrong with it. Projection and a small
// depth image only, no ray tracer, so it takes seconds.
#pragma once
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "base/progress.h"
#include "capture/capture.h"
#include "capture/mesh_colours.h"

namespace relamp {

struct CaptureFix;

/// Shares are of all pixels of the view unless said otherwise, in [0, 1].
struct ViewCheck {
    std::string name;
    int width = 0, height = 0;                   ///< pixels
    double meshFraction = 0;                     ///< pixels that see the mesh
    double clippedFraction = 0;                  ///< usable pixels at or above the clip level
    double maskedFraction = 0;                   ///< pixels left out: masks, alpha, NaN, Inf, negative
    double openFraction = 0;                     ///< pixels beside the mesh
    double lightFraction = 0;                    ///< of those: neither left out nor black beside the surfaces
    size_t nan = 0, infinite = 0, negative = 0;  ///< pixels
    double meanRadiance = 0;                     ///< mean luminance of the usable pixels, image units
    double verticesInside = 0;                   ///< fraction of the mesh's vertices that project into the image
    double exposureStops = 0;         ///< brightness against the other views of the same vertices, log2; 0: as they
    double exposureScatterStops = 0;  ///< half the vertices lie within this span around it; large on glossy surfaces
    size_t comparedVertices = 0;      ///< vertices that exposureStops rests on
};

/// How the files would have to be read for the photographs to agree on the surface.
struct PlacementAdvice {
    std::string words;   ///< a sentence
    std::string option;  ///< of the command line: "--mesh-scale 0.01"
    std::string button;  ///< "Read the mesh in centimetres"
    double scale = 1;    ///< CaptureFix::scale
    ReadAs readAs;       ///< the rest
};

/// Whether lengths are told in another unit, by how large and how far away things are; nothing else rests on it.
struct UnitQuestion {
    std::string words;   ///< a question
    std::string button;  ///< "Lengths are centimetres"
    double scale = 1;    ///< CaptureFix::scale
};

/// How photographs lie on the colours that the mesh's own file has, as far as they are alike.
struct ColourCheck {
    size_t images = 0;       ///< textures that were read; 0: colours of vertices
    size_t views = 0;        ///< photographs that show enough of them
    double correlation = 0;  ///< of local changes of brightness, median of the views; 1: they are the same
    double shift = 0;        ///< pixels that photographs lie off, median
    double worstShift = 0;   ///< of one view
    double resolution = 0;   ///< pixels, median: finer changes were not compared
    std::string worstView;
};

struct CaptureCheck {
    std::string format;  ///< Capture::format
    std::vector<ViewCheck> views;
    std::vector<std::pair<std::string, size_t>> states;  ///< lighting states, with how many views each has
    std::vector<std::string> environments;               ///< of them (environmentInWords); empty: all states share one
    MeshReport mesh;
    Vec3 meshMin{0}, meshMax{0};     ///< metres from origin, bounding box of the triangles
    DVec3 origin{0};                 ///< Capture::origin
    double seenFraction = 0;         ///< vertices seen by at least one view
    double seenTwiceFraction = 0;    ///< vertices seen by at least two views
    double meanViewsPerVertex = 0;   ///< of all vertices of triangles
    double exposureSpreadStops = 0;  ///< largest minus smallest exposureStops
    bool backdrop = false;           ///< an object before a masked or black background: none of its light is seen
    std::string up;                  ///< axis the file says is up: "z", "-y", ..., or three numbers where it is none
    std::string upGuess;             ///< axis closest to the cameras' own up directions
    double cameraDistance = 0;       ///< metres, median distance of the cameras from the middle of the mesh
    double pointsOnMesh = -1;  ///< fraction of a reconstruction's points that lie on the mesh; negative: there are none
    double meshToPoints = 0;   ///< size of the mesh over the size of the points' cloud; 0: there are none
    std::optional<ReconstructionFigures> reconstruction;
    std::shared_ptr<const MeshColours> meshColours;  ///< of the mesh's own file; null: none
    std::optional<ColourCheck> colours;  ///< none: the mesh's file has no colours, or photographs show too few of them
    double upAgreement = 0;              ///< cosine between the mean camera up and the file's up
    bool lookBackwards = false;          ///< the mesh lies behind the cameras: axes are OpenCV's, not OpenGL's
    std::optional<PlacementAdvice>
        advice;  ///< what the photographs speak for; the other warnings of poses then stay out
    std::optional<UnitQuestion> unitQuestion;
    std::vector<std::string> notes;     ///< from loading
    std::vector<std::string> warnings;  ///< what should be looked at before a solve, one sentence each
};

/// Cost: a small image is rasterised for each view, O(views x triangles). Throws Cancelled only.
CaptureCheck checkCapture(const Capture& capture, Progress& progress);

/// `fix` with what the advice says.
CaptureFix advised(CaptureFix fix, const PlacementAdvice& advice);

/// Names of the lighting states, with how many views each has; empty: there is one. O(views).
std::vector<std::pair<std::string, size_t>> viewsOfStates(const Capture& capture);
/// Of a capture with environmentOfState, what environment a state has: "none", "own", or the first state that has the
/// same.
std::string environmentInWords(const Capture& capture, size_t state);

nlohmann::json toJson(const CaptureCheck& check);
/// For people: a table of the views, the mesh, the warnings.
std::string toText(const CaptureCheck& check);

}  // namespace relamp
