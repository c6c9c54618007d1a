// Small images in panels. The window sets the maker; without a window (tests) there is none and panels draw a grey
// box.
#pragma once
#include <cstdint>
#include <functional>
#include <string>

#include "image/image.h"

namespace relamp::ui {

/// Texture for `key`, made once from display values (sRGB, 0 to 1) that `make` gives; 0: none.
using ThumbnailMaker = std::function<uint64_t(const std::string& key, const std::function<Image()>& make)>;
void setThumbnailMaker(ThumbnailMaker maker);
uint64_t thumbnail(const std::string& key, const std::function<Image()>& make);
/// Drops textures whose key starts with `prefix`, when another capture is opened.
void setThumbnailDropper(std::function<void(const std::string& prefix)> dropper);
void dropThumbnails(const std::string& prefix);

}  // namespace relamp::ui
