#include "solve/reproduction.h"

#include <algorithm>

namespace relamp {

namespace {
constexpr const char* causeNames[] = {"none", "moving-light", "poses", "exposures", "some-views", "shape", "model"};
}

std::string causeName(MisfitCause cause) { return causeNames[size_t(cause)]; }

std::optional<MisfitCause> causeNamed(const std::string& name) {
    for (size_t i = 0; i < std::size(causeNames); ++i)
        if (name == causeNames[i]) return MisfitCause(i);
    return {};
}

size_t Reproduction::worst() const {
    return size_t(
        std::min_element(views.begin(), views.end(),
                         [](const ViewReproduction& a, const ViewReproduction& b) { return a.psnr < b.psnr; }) -
        views.begin());
}

}  // namespace relamp
