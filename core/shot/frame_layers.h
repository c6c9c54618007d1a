// The layers of an EXR frame: which there are, what they are called, and how a strip of a frame becomes their channels.
#pragma once
#include <map>
#include <string>
#include <vector>

#include "image/image_io.h"
#include "relight/frame.h"

namespace relamp {

/// How light groups are called: Combined_<group> (Blender) or RGBA_<group> (Arnold).
enum class LayerNaming { blender, arnold };

/// Throws BadOption when `name` is neither.
LayerNaming layerNaming(const std::string& name);

/// A layer group that may be asked for.
struct LayerRequest {
    bool groups = false, albedo = false, correction = false, residual = false, normal = false, position = false,
         depth = false, cryptomatte = false, confidence = false;
    bool all = false;  ///< everything there is was asked for, nothing by name
};

/// "", "all" or a comma list of groups, albedo, correction, residual, normal, position, depth, cryptomatte, confidence.
/// Throws BadOption naming what does not exist.
LayerRequest layerRequest(const std::string& layers);

/// A strip of a frame with what is derived from it; the others have a value a pixel or are empty.
struct FrameStrip {
    Frame frame;
    std::vector<Rgb> rest;          ///< beauty - sum of the groups
    std::vector<Rgb> correction;    ///< see bakedFactor
    std::vector<Rgb> residual;      ///< photograph - model as captured
    std::vector<float> confidence;  ///< see modelConfidence
};

/// Fills `rest` and returns the largest difference over all pixels and channels between the beauty and the groups; with
/// `detail` (the beauty is a photograph, whose detail no light group has) between the beauty and groups + rest.
double closeGroups(FrameStrip& strip, bool detail);

/// What a reading that knows distant light only would bake into the surface: the captured light divided by its part
/// from the environment, per channel. 1 where no emitter reaches, at most 64, and 1 where an emitter itself or nothing
/// is seen. Multiplied with the albedo it is the colour such a reading paints on the surface, the environment being the
/// recovered one; a distant-only solve would move some of it into its environment, which takes a second solve to know
/// (`relamp compare`).
std::vector<Rgb> bakedFactor(const Frame& captured);

/// The layers of a frame over emitters of these names, no two alike, in the order they are written.
class FrameLayers {
public:
    /// `origin` is added to the positions (Capture::origin).
    FrameLayers(const LayerRequest& request, LayerNaming naming, const std::vector<std::string>& emitterNames,
                const DVec3& origin = DVec3(0));
    const DVec3& origin() const { return origin_; }

    /// One part with every channel, or with `multipart` a part a layer (channel names are the same).
    std::vector<ChannelPart> parts(bool multipart) const;
    /// Channels of a strip, in the order of parts(); `out[c]` takes a value a pixel.
    void fill(const FrameStrip& strip, const std::vector<float*>& out) const;
    /// Entries for the header: the Cryptomatte's, when it is among the layers.
    std::map<std::string, std::string> header() const;

private:
    LayerRequest request_;
    LayerNaming naming_;
    std::vector<std::string> names_;
    std::vector<float> cryptomatteIds_;
    DVec3 origin_;
};

}  // namespace relamp
