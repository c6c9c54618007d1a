// What reading and writing of image files share. Not a door.
#pragma once
#include <filesystem>
#include <string>

namespace relamp {

/// Prepares OpenImageIO, once. The library's own threads are off because callers already read several images at once.
void setUpImageLibrary();

std::string lowerCase(std::string text);

/// The ending with its point, in small letters.
std::string lowerExtension(const std::filesystem::path& file);

}  // namespace relamp
