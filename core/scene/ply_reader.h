// PLY: the header and a cursor over its elements, for meshes and for per-vertex properties.
#pragma once
#include <string>
#include <string_view>
#include <vector>

namespace relamp {

enum class PlyType { int8, uint8, int16, uint16, int32, uint32, float32, float64 };
enum class PlyEncoding { ascii, littleEndian, bigEndian };

struct PlyProperty {
    std::string name;
    PlyType type = PlyType::float32;
    bool isList = false;
    PlyType countType = PlyType::uint8;  ///< of a list's length
};

struct PlyElement {
    std::string name;
    size_t count = 0;
    std::vector<PlyProperty> properties;
    /// Place of a property; -1 when there is none of that name.
    int find(std::string_view property) const;
};

struct PlyHeader {
    PlyEncoding encoding = PlyEncoding::ascii;
    std::vector<PlyElement> elements;
    std::vector<std::string> textureFiles;  ///< "comment TextureFile NAME", as MeshLab writes it
    size_t bodyAt = 0;                      ///< first byte after end_header
};

/// Parses the header. Throws Error on anything that is no PLY, and when a count is negative or needs more bytes than
/// the file has.
PlyHeader readPlyHeader(std::string_view bytes);

/// Reads the values of the elements one after another. Throws Error where the file ends early.
class PlyCursor {
public:
    PlyCursor(std::string_view bytes, const PlyHeader& header)
        : bytes_(bytes), encoding_(header.encoding), at_(header.bodyAt) {}

    /// The next value as a double.
    double scalar(PlyType type);
    /// A list's length and values into `values`. A length beyond the rest of the file throws.
    void list(const PlyProperty& property, std::vector<double>& values);
    /// Steps over a whole element.
    void skip(const PlyElement& element);

private:
    double binaryScalar(PlyType type);
    std::string_view bytes_;
    PlyEncoding encoding_;
    size_t at_;
};

size_t plySize(PlyType type);

}  // namespace relamp
