// Do photographs lie on the colours that the mesh's own file has? Inner part of the check, not a door.
#pragma once
#include <string>
#include <vector>

#include "base/progress.h"
#include "capture/mesh_colours.h"
#include "capture/view_sight.h"

namespace relamp {

/// How one photograph lies on those colours.
struct ColourView {
    std::string name;
    double correlation = 0;  ///< of local changes of brightness, where they agree best
    double asPlaced = 0;     ///< the same as the camera stands
    Vec2 shift{0};           ///< pixels that the photograph is moved for that
    double cell = 0;         ///< pixels: finer changes are not compared
    size_t compared = 0;     ///< pairs of cells
};

/// How photographs lie on the colours of the mesh.
struct ColourAgreement {
    std::vector<ColourView> views;  ///< that show enough of them, at most 24
    double shift = 0;               ///< pixels, median of the views' lengths
    double correlation = 0;         ///< median
    const ColourView& worst() const;
    /// Photographs and colours belong together, so that shifts mean something.
    bool alike() const { return correlation > 0.4; }
};

/// No views: the photographs show too little of them. Cost: O(pixels) and 300 small images a view. Throws Cancelled.
ColourAgreement colourAgreement(const Capture& capture, const MeshColours& colours,
                                const std::vector<ViewSight>& sights, Progress& progress);

}  // namespace relamp
