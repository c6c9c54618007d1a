// Which images a mesh's file names for its surface. Not a door.
#pragma once
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "scene/mesh.h"

namespace relamp {

/// A file that a mesh in `folder` names: there, or by the last part of its name; of places where there is none the
/// first. Backslashes part folders, as Windows writes them.
std::filesystem::path fileNamedIn(const std::filesystem::path& folder, const std::string& name);

/// The materials of an OBJ. What is missing or broken paints nothing.
class ObjMaterials {
public:
    explicit ObjMaterials(std::filesystem::path folder) : folder_(std::move(folder)) {}
    /// A material library, by what follows "mtllib".
    void read(const std::string& names);
    /// In images(); -1: none.
    int imageOf(const std::string& material) const;
    const std::vector<MeshImage>& images() const { return images_; }
    const std::vector<std::filesystem::path>& libraries() const { return libraries_; }

private:
    std::filesystem::path folder_;
    std::vector<MeshImage> images_;
    std::vector<std::filesystem::path> libraries_;
    std::map<std::string, int> imageOf_;

    void readLibrary(const std::filesystem::path& file);
};

}  // namespace relamp
