// What Python tells of a capture's files and of its light, as dictionaries (docs/python.md). All throw Error that names
// dictionary and key, for unknown keys too.
#pragma once
#include <pybind11/pybind11.h>

#include "pipeline/pipeline.h"

namespace relamp::python {

/// How the capture's files are to be read: "colmap", "images", "mesh", "up", "mesh_up", "scale", "mesh_scale",
/// "flip_cameras", "mirror", "mesh_mirror", as the options of the command line.
void takeFiles(const pybind11::dict& files, CaptureFix& fix);
/// {"albedo": A}, {"white_patch": (view, x, y)} or {"emitter": ID, "radiance": (r, g, b)}; empty: automatic.
void takeGauge(const pybind11::dict& gauge, GaugeChoice& choice);
/// "light_probes": files; "mirror_balls", "greys", "charts": dictionaries of view and pixels.
void takeReferences(const pybind11::dict& references, PipelineOptions& options);

}  // namespace relamp::python
