// Small images for the panels as textures, each made once.
#pragma once
#include <functional>
#include <map>
#include <string>

#include "image/image.h"
#include "viewport/gl_objects.h"

namespace relamp::ui {

class ThumbnailTextures {
public:
    static constexpr int longestSide = 256;
    /// Texture for the key; `make` gives display values (sRGB, 0 to 1) when it is asked for the first time. 0: an empty
    /// image.
    uint64_t texture(const std::string& key, const std::function<Image()>& make);
    void drop(const std::string& prefix);

private:
    std::map<std::string, GlTexture> textures_;
};

}  // namespace relamp::ui
