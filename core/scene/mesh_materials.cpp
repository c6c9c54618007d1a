#include "scene/mesh_materials.h"

#include <algorithm>
#include <fstream>

#include "base/atomic_file.h"
#include "base/is_there.h"
#include "base/text_scanner.h"
#include "scene/gltf_document.h"
#include "scene/mesh_io.h"

namespace relamp {
namespace fs = std::filesystem;
namespace {

constexpr size_t mostLibraryBytes = size_t(16) << 20, mostLibraries = 64, mostImages = 4096;

std::string trimmedWord(std::string_view words) {
    while (!words.empty() && TextScanner::isSpace(words.front())) words.remove_prefix(1);
    while (!words.empty() && TextScanner::isSpace(words.back())) words.remove_suffix(1);
    return std::string(words);
}

/// What follows "map_Kd" without its options; empty: it has some that move or scale the image.
std::string imageNameIn(std::string_view words) {
    TextScanner scanner(words);
    for (;;) {
        const size_t left = scanner.remaining();
        const std::string_view option = scanner.word();
        if (option.empty() || option[0] != '-') return trimmedWord(words.substr(words.size() - left));
        if (option == "-o" || option == "-s" || option == "-t") return "";
        // One word each, but -mm has two.
        scanner.word();
        if (option == "-mm") scanner.word();
    }
}

/// From its header; the rest, which may be large, is not read.
std::vector<std::string> textureFilesOfPly(const fs::path& file) {
    std::vector<std::string> names;
    std::ifstream stream(file, std::ios::binary);
    std::string line;
    for (size_t lines = 0; lines < 10000 && std::getline(stream, line) && line.rfind("end_header", 0) != 0; ++lines) {
        TextScanner words(line);
        if (words.word() == "comment" && words.word() == "TextureFile")
            names.push_back(trimmedWord(std::string_view(line).substr(line.size() - words.remaining())));
    }
    return names;
}

}  // namespace

fs::path fileNamedIn(const fs::path& folder, const std::string& name) {
    std::string slashed = name;
    std::replace(slashed.begin(), slashed.end(), '\\', '/');
    slashed.erase(std::remove(slashed.begin(), slashed.end(), '\0'), slashed.end());
    const fs::path named = folder / slashed, beside = folder / fs::path(slashed).filename();
    return !isFile(named) && isFile(beside) ? beside : named;
}

void ObjMaterials::read(const std::string& names) {
    if (names.empty() || libraries_.size() >= mostLibraries) return;
    // One name that may hold spaces, or several.
    if (const fs::path whole = fileNamedIn(folder_, names); isFile(whole)) return readLibrary(whole);
    TextScanner scanner(names);
    for (std::string_view name = scanner.word(); !name.empty() && libraries_.size() < mostLibraries;
         name = scanner.word())
        if (const fs::path file = fileNamedIn(folder_, std::string(name)); isFile(file)) readLibrary(file);
}

void ObjMaterials::readLibrary(const fs::path& file) {
    if (std::find(libraries_.begin(), libraries_.end(), file) != libraries_.end()) return;
    libraries_.push_back(file);
    std::string bytes;
    try {
        bytes = readBytes(file, mostLibraryBytes);
    } catch (const Error&) { return; }
    TextScanner lines(bytes);
    std::string material;
    while (!lines.atEnd()) {
        const std::string_view line = lines.line();
        TextScanner words(line);
        const std::string_view key = words.word('#');
        const std::string_view rest = line.substr(line.size() - words.remaining());
        if (key == "newmtl") material = trimmedWord(rest);
        if (key != "map_Kd" || images_.size() >= mostImages) continue;
        const std::string name = imageNameIn(rest);
        if (name.empty()) continue;
        const MeshImage image{fileNamedIn(folder_, name)};
        const auto at = std::find(images_.begin(), images_.end(), image);
        imageOf_[material] = int(at - images_.begin());
        if (at == images_.end()) images_.push_back(image);
    }
}

int ObjMaterials::imageOf(const std::string& material) const {
    const auto at = imageOf_.find(material);
    return at == imageOf_.end() ? -1 : at->second;
}

std::vector<fs::path> filesBesideMesh(const fs::path& file) {
    std::string ending = file.extension().string();
    for (char& c : ending) c = char(std::tolower(static_cast<unsigned char>(c)));
    const fs::path folder = file.parent_path();
    std::vector<fs::path> files;
    if (ending == ".ply") {
        for (const std::string& name : textureFilesOfPly(file)) files.push_back(fileNamedIn(folder, name));
        return files;
    }
    if (ending != ".obj" && ending != ".gltf" && ending != ".glb") return files;
    try {
        const std::string bytes = readBytes(file, mostMeshBytes);
        if (isGltf(bytes)) {
            const GltfDocument document(bytes, file);
            files = document.bufferFiles();
            for (const fs::path& image : document.imageFiles()) files.push_back(image);
        } else if (ending == ".obj") {
            ObjMaterials materials(folder);
            constexpr std::string_view key = "mtllib";
            for (size_t at = bytes.find(key); at != bytes.npos; at = bytes.find(key, at + 1))
                if (at == 0 || bytes[at - 1] == '\n' || bytes[at - 1] == '\r')
                    materials.read(trimmedWord(TextScanner(std::string_view(bytes).substr(at + key.size())).line()));
            files = materials.libraries();
            for (const MeshImage& image : materials.images()) files.push_back(image.file);
        }
    } catch (const Error&) { return {}; }  // reading it says what is wrong
    return files;
}

}  // namespace relamp
