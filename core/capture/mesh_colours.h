// How a mesh's own file paints its surface: a first look, and a check of registration. Never a measurement: light of
// another day is in it.
#pragma once
#include <string>
#include <vector>

#include "base/progress.h"
#include "capture/capture.h"

namespace relamp {

/// Colours of the mesh's vertices.
struct MeshColours {
    std::vector<Rgb> linear;          ///< per vertex of the capture's mesh
    std::vector<uint8_t> painted;     ///< per vertex: the file says something of it
    size_t images = 0;                ///< that were read
    std::vector<std::string> faults;  ///< of images that could not be read, one sentence each
    bool empty() const { return linear.empty(); }
};

/// From the images of Capture::paint by texture coordinates, each a mean over the faces around a vertex, elsewhere from
/// its colours. Empty where the file says nothing. Images are read one after the other. Throws Cancelled.
MeshColours meshColours(const Capture& capture, Progress& progress);

}  // namespace relamp
