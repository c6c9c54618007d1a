// The few components a self-contained page is made of: text made safe, images carried along, and the page around them.
#pragma once
#include <string>

#include "image/image.h"

namespace relamp {

/// Text for an element or a quoted attribute.
std::string htmlText(const std::string& text);
std::string base64(const std::string& bytes);

/// A figure whose image travels inside the page (PNG, sRGB). `caption` and `about` are plain text.
std::string htmlImage(const Image& image, const std::string& caption, const std::string& about);

/// A whole page with its style; nothing is fetched from anywhere. Dark and neutral, because people judge colour on it.
std::string htmlPage(const std::string& title, const std::string& part);

}  // namespace relamp
