// Which lobes of a large basis a component of surface needs: all are tried on the same rays, and a few are kept.
#pragma once
#include "brdf/basis.h"
#include "solve/gloss/gloss.h"

namespace relamp {

/// A lobe, or a mixture of up to `mostLobes`, with weights above 0, and what it leaves unexplained.
struct LobeChoice {
    Lobe lobe;
    double residual = 0;  ///< weighted sum of squares over the observations, all channels
};

/// One lobe after the other, the one that explains most beside those chosen first: non-negative least squares per
/// channel on the observations [Weistroffer07], the Lambert part of every vertex eliminated (or absent: `withLambert`
/// false). A mixture has one set of shares for all channels. Looks are grouped by vertex, as glossyLooks gives them;
/// their weights are computed anew as the fit comes near (outliers count little). Empty where no lobe explains
/// anything.
std::vector<LobeChoice> chooseLobes(const std::vector<Lobe>& lobes, const std::vector<std::vector<Rgb>>& responses,
                                    const std::vector<GlossyObservation>& observations, bool withLambert,
                                    size_t mostLobes);

}  // namespace relamp
