// Where another camera sees a place on the projector.
#pragma once
#include <optional>

#include "scan/decode.h"

namespace relamp {

/// The pixels of a decoded view, sorted by the projector's pixel they see. 4 bytes for each pixel of the projector and
/// each decoded one; `view` must outlive it.
class CodeIndex {
public:
    /// Throws Error for a projector of more than 2^26 pixels.
    CodeIndex(const DecodedView& view, const std::array<int, 2>& projectorSize);

    /// Position in the view, pixels, of a place on the projector: of the pixels that see places around it, those about
    /// the nearest, by the affine map that fits them best. None where no pixel sees a place within a projector pixel.
    std::optional<glm::dvec2> pixelOf(const glm::vec2& place) const;

private:
    const DecodedView& view_;
    std::array<int, 2> size_;
    std::vector<uint32_t> start_, pixels_;
    float reach_ = 3;  ///< pixels of the view
};

}  // namespace relamp
