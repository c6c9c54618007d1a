// Images on disk. OpenImageIO is named only in image_reader.cpp and image_writer.cpp.
#pragma once
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "image/image.h"

namespace relamp {

/// What was set right while reading.
struct ImageReport {
    size_t nan = 0, negative = 0, infinite = 0;  ///< pixels (all marked not usable and set to zero)
    size_t transparent = 0;                      ///< pixels with alpha < 0.5 (not usable)
    bool integer = false;                        ///< 8- or 16-bit file: sRGB was decoded unless told, 1.0 is clipped
    float clipLevel = 0;                         ///< value at which the file clips, in linear units; 0 = none known
};

/// Reads EXR, HDR, TIFF, PNG, JPEG, DPX or camera raw to linear Rec.709. Integer files are decoded as sRGB, except with
/// `dataFile` (masks). Grey is spread over three channels. `between` is called before every 256 rows or row of tiles
/// and may throw, which ends the reading (interlaced PNG, progressive JPEG and camera raw are decoded as a whole).
/// Memory: the image and one such band. Throws Error naming the file: missing, unreadable, no pixels, more than
/// `maxPixels`; whatever `between` throws.
Image readImage(const std::filesystem::path& file, ImageReport* report = nullptr, bool dataFile = false,
                size_t maxPixels = size_t(1) << 28, const std::function<void()>& between = {});

/// The same of an image that lies in `size` bytes of a file from `begin` on, as a mesh holds its textures; a size of 0
/// is the whole file.
Image readImagePart(const std::filesystem::path& file, size_t begin, size_t size, size_t maxPixels = size_t(1) << 28,
                    const std::function<void()>& between = {});

/// The same with the values as they stand, for images that are changed and written again: negative ones stay and alpha
/// is no mask; NaN and infinite ones are 0 and not usable.
Image readValues(const std::filesystem::path& file, ImageReport* report = nullptr, bool dataFile = false,
                 size_t maxPixels = size_t(1) << 28, const std::function<void()>& between = {});

/// The codes of an 8 or 16 bit image as stored. Throws Error as readImage, and for floating-point files.
CodeImage readCodes(const std::filesystem::path& file, size_t maxPixels = size_t(1) << 28,
                    const std::function<void()>& between = {});

/// Exposure time, f-number and sensitivity from EXIF. Throws Error as readImage.
ExposureTags readExposureTags(const std::filesystem::path& file);

/// Width and height from the header alone. Throws Error as readImage.
std::pair<int, int> readImageSize(const std::filesystem::path& file);

/// Writes EXR (half, ZIP), HDR, or sRGB-encoded PNG/JPEG by extension, whole or not at all. Throws Error,
/// OutOfResources.
void writeImage(const std::filesystem::path& file, const Image& image,
                const std::map<std::string, std::string>& header = {});

/// An sRGB-encoded 8-bit PNG in memory, for pages that carry their images. Throws Error when there are no pixels.
std::string encodePng(const Image& image);

/// Writes a single-part EXR with the channels in the order given (ZIP). Same errors.
void writeChannels(const std::filesystem::path& file, int width, int height, const std::vector<Channel>& channels,
                   const std::map<std::string, std::string>& header = {});

/// How a channel of a file that is written in strips is kept.
struct ChannelFormat {
    std::string name;  ///< as written, for example "Combined_world.R"
    bool half = true;  ///< half float; what exceeds it is written as its largest number
};

/// Channels that are stored together.
struct ChannelPart {
    std::string name;  ///< of the part; used only when there are several
    std::vector<ChannelFormat> channels;
};

/// Where rows lie in a larger image; 0 x 0: they are all of it.
struct FileWindow {
    int left = 0, top = 0, wholeWidth = 0, wholeHeight = 0;
};

/// Fills rows [first, first + count): out[c] takes count x width values of channel c, counted through all parts.
using FillChannelRows = std::function<void(int first, int count, const std::vector<float*>& out)>;

/// Writes an EXR (ZIP) strip by strip: `fill` is asked once for each strip of `stripRows` rows (the last may be lower),
/// top to bottom. One part is a single-part file; several are a multi-part one, for which the pixels wait in a nameless
/// file beside the target. Memory: one strip. `between` is called after every few rows that were packed, which takes
/// longer than rendering them can. Whole or not at all; errors as writeChannels, and whatever `fill` and `between`
/// throw. With a `window` the rows are the file's data window, and the whole image is its
/// display window.
void writeChannelRows(const std::filesystem::path& file, int width, int height, int stripRows,
                      const std::vector<ChannelPart>& parts, const FillChannelRows& fill,
                      const std::map<std::string, std::string>& header = {}, const std::function<void()>& between = {},
                      const FileWindow& window = {});

/// Fills rows [first, first + count) of an image.
using FillColourRows = std::function<void(int first, int count, Rgb* out)>;

/// Writes a PNG, JPEG or HDR strip by strip, as writeImage does; `encoded`: PNG and JPEG values are display values
/// already.
void writeColourRows(const std::filesystem::path& file, int width, int height, int stripRows,
                     const FillColourRows& fill, bool encoded = false);

/// sRGB transfer curve (IEC 61966-2-1) and its inverse; both map [0,1] to [0,1].
float srgbEncode(float linear);
float srgbDecode(float encoded);

}  // namespace relamp
