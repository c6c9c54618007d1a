// How far the model rests on what photographs showed, pixel by pixel: a mask for what is made from it.
#pragma once
#include "capture/camera.h"
#include "relight/relit_scene.h"

namespace relamp {

/// Rows [first, first + count) of the camera's image, a value a pixel in [0, 1]: the confidence of the surface at the
/// pixel's centre (RelitScene::confidenceAt), 1 on emitters, 0 where no surface is. Cost: a ray a pixel.
std::vector<float> modelConfidence(const RelitScene& relit, const Camera& camera, int first, int count);

}  // namespace relamp
