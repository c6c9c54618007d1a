// The container of a glTF 2.0 file: its JSON, its buffers and the accessors over them. What a file claims is held
// against the bytes that are there before memory is asked for.
#pragma once
#include <deque>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/json_fields.h"
#include "scene/mesh.h"

namespace relamp {

/// Numbers of an accessor, `width` for each of its elements, as doubles.
struct GltfValues {
    size_t count = 0, width = 0;
    std::vector<double> values;
    DVec3 vector(size_t i) const { return {values[3 * i], values[3 * i + 1], values[3 * i + 2]}; }
};

class GltfDocument {
public:
    /// `bytes`: of the .glb or .gltf `file`, which must outlive this; files that it names are looked for beside it.
    /// Throws Error naming the field.
    GltfDocument(std::string_view bytes, const std::filesystem::path& file);
    ~GltfDocument();

    JsonFields root() const;
    /// The objects of the lists at the top. `at` throws Error naming `from` where there is no such element.
    const JsonFields& node(size_t index, const std::string& from) const { return at(nodes_, "nodes", index, from); }
    const JsonFields& mesh(size_t index, const std::string& from) const { return at(meshes_, "meshes", index, from); }
    size_t nodes() const { return nodes_.size(); }
    size_t meshes() const { return meshes_.size(); }

    /// What an accessor claims, without reading it. `most`: elements that it may have at most.
    size_t count(size_t accessor, size_t most, const std::string& from) const;
    /// Numbers of VEC4, VEC3, VEC2 or SCALAR accessors (`width` 4 to 1); integers as they are, or in [-1, 1] where they
    /// are `normalized`. `whole`: only unsigned integers. Throws Error naming the field.
    GltfValues read(size_t accessor, size_t width, bool whole, const std::string& from) const;

    /// Files that the buffers and the images name.
    std::vector<std::filesystem::path> bufferFiles() const;
    std::vector<std::filesystem::path> imageFiles() const;
    /// The image that a material has for its colour, where it is read by TEXCOORD_0 as that stands; nothing where there
    /// is none, or only in the text as base64.
    std::optional<MeshImage> colourImage(size_t material) const;
    /// "VEC3" or the like.
    std::string shapeOf(size_t accessor, const std::string& from) const;
    /// Bytes of the file and of the buffers read so far.
    size_t bytes() const { return bytes_; }

private:
    using List = std::vector<JsonFields>;
    std::filesystem::path file_, folder_;
    std::unique_ptr<const Json> root_;
    std::string_view chunk_;
    size_t chunkBegin_ = 0;  ///< in the file
    bool hasChunk_ = false;
    List nodes_, meshes_, accessors_, views_, buffers_, materials_, textures_, images_;
    mutable std::vector<std::optional<std::string_view>> contents_;  ///< of the buffers, once they are read
    mutable std::deque<std::string> owned_;
    mutable size_t bytes_ = 0;

    static const JsonFields& at(const List& list, const char* name, size_t index, const std::string& from);
    std::vector<std::filesystem::path> filesBeside(const List& list) const;
    std::filesystem::path fileOf(const std::string& uri, const std::string& where) const;
    std::string_view buffer(size_t index, const std::string& from) const;
    std::string_view view(size_t index, const std::string& from, size_t& stride) const;
};

/// A .glb, or a .gltf as it begins.
bool isGltf(std::string_view bytes);

}  // namespace relamp
