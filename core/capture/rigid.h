// Matrices of cameras that must be a rotation and a translation: one rule for every file that poses come from.
#pragma once
#include <string>

#include "base/math.h"

namespace relamp {

/// Makes `matrix` a rotation and a translation: a uniform scale is taken out into `scale`, small errors of rounding go
/// (Gram and Schmidt). Returns why it cannot be, for a sentence that begins with the field's name ("is singular,
/// expected a rotation and a translation"); empty when it can. Off by more than a thousandth, it is refused.
std::string makeRigid(DMat4& matrix, double& scale);

}  // namespace relamp
