#include "report/estimate_tables.h"

#include <fmt/format.h>

#include "base/significant.h"
#include "display/html.h"
#include "image/image_io.h"

namespace relamp {
namespace {

/// Three digits, without exponents as long as people read numbers without them.
std::string times(float value) {
    return std::abs(value) < 1e5f ? fmt::format("{:.{}f}", value,
                                                value < 10    ? 2
                                                : value < 100 ? 1
                                                              : 0)
                                  : fmt::format("{:.0e}", value);
}

std::string evidenceText(const EmitterEvidence& e) {
    std::string text = fmt::format("{} times as bright as the other surfaces", times(e.sceneContrast));
    if (e.localContrast > 0) text += fmt::format(", {} times its environment", times(e.localContrast));
    text += fmt::format("; even within {:.1f} %, changes by {:.1f} % from view to view", 100 * e.uniformity,
                        100 * e.viewSpread);
    if (e.demandedAlbedo > 0)
        text += fmt::format("; a surface would have to reflect {} times what reaches it", times(e.demandedAlbedo));
    return text;
}

}  // namespace

std::string rgbText(const Rgb& c) {
    return significant(c.x, 3) + " " + significant(c.y, 3) + " " + significant(c.z, 3);
}

std::string swatch(const Rgb& c) {
    const Rgb hue = c / std::max(maxChannel(c), 1e-12f);
    return fmt::format("<span class=\"swatch\" style=\"background:rgb({:.0f},{:.0f},{:.0f})\"></span>",
                       255 * srgbEncode(hue.x), 255 * srgbEncode(hue.y), 255 * srgbEncode(hue.z));
}

std::string emittersTable(const Estimate& e) {
    if (e.emitters.emitters.empty())
        return "<p>No patch of the scene shines on its own: everything is lit from far away.</p>\n";
    std::string rows;
    for (size_t i = 0; i < e.emitters.emitters.size(); ++i) {
        const EmitterCluster& emitter = e.emitters.emitters[i];
        const Rgb& radiance = e.lighting.emitterRadiance[i];
        const std::string sigma = i < e.emitterSigma.size() ? fmt::format("\u00b1 {}", rgbText(e.emitterSigma[i])) : "";
        const std::string fraction =
            i < e.identifiability.size() ? fmt::format("{:.0f} %", 100 * e.identifiability[i]) : "";
        const std::string clipped = emitter.evidence.clippedFraction > 0
                                        ? fmt::format("<small>{:.0f} % of the observations are clipped</small>",
                                                      100 * emitter.evidence.clippedFraction)
                                        : "";
        rows += fmt::format(
            "<tr><td class=\"number\">{}{}</td><td class=\"number\">{}<small>{}</small></td><td "
            "class=\"number\">{} cm\u00b2</td><td class=\"number\">{}{}</td>"
            "<td class=\"number\">{}</td><td>{}<small>{}</small></td></tr>\n",
            swatch(radiance), htmlText(emitter.id), rgbText(radiance), sigma, significant(emitter.area * 1e4, 3),
            emitter.evidence.viewsSeen, clipped, fraction, htmlText(evidenceText(emitter.evidence)),
            fmt::format("{} observations", emitter.evidence.samples));
    }
    return "<div class=\"wide\"><table><tr><th>Light</th><th>Radiance R G "
           "B</th><th>Area</th><th>Views</th><th>Certain</th><th>Evidence</th></tr>\n" +
           rows +
           "</table></div>\n"
           "<p>Certain: the fraction of the light's effect on the photographs that no distant light could imitate. "
           "Below "
           "15 % its power is a guess.</p>\n";
}

std::string rejectedTable(const Estimate& e, const DVec3& origin) {
    if (e.emitters.rejected.empty()) return "";
    constexpr size_t most = 20;
    std::string rows;
    for (size_t i = 0; i < std::min(most, e.emitters.rejected.size()); ++i) {
        const RejectedPatch& patch = e.emitters.rejected[i];
        const DVec3 place = origin + DVec3(patch.centroid);
        rows += fmt::format(
            "<tr><td class=\"number\">{:.2f} {:.2f} {:.2f} m</td><td class=\"number\">{}{}</td><td>{}</td></tr>\n",
            place.x, place.y, place.z, swatch(patch.radiance), rgbText(patch.radiance), htmlText(patch.reason));
    }
    std::string more;
    if (e.emitters.rejected.size() > most)
        more = fmt::format("<p>and {} more.</p>\n", e.emitters.rejected.size() - most);
    return "<h3>Bright, but no lights</h3>\n<div class=\"wide\"><table><tr><th>Where</th><th>Radiance R G "
           "B</th><th>Why "
           "it was not taken for a light</th></tr>\n" +
           rows + "</table></div>\n" + more;
}

}  // namespace relamp
